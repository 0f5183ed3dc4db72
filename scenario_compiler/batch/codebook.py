"""The codebook of a sweep: the meaning and unit of each column of its tables, and when a column is empty.

It is one declaration for the table's columns, for the notes in the table's own file, and for `codebook.csv` beside it.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Literal

from scenario_compiler.batch.distributions import Distribution
from scenario_compiler.recording.cells import text_cell
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.takeovers import Takeover
from scenario_compiler.records import Field
from scenario_compiler.source.declared import Declaration
from scenario_compiler.vocabulary.word import QUANTITIES

PARAMETER = "parameter."
"""Prefix of the columns of parameters."""

ColumnKind = Literal["integer", "number", "boolean", "text"]


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        column: Its name.
        kind: What its values are.
        unit: Their unit: SI for measured values, that of XML for parameters; empty if they have none.
        definition: What they mean.
        empty: When a value is missing; empty if none is ever missing.
        source: Where the definition comes from; empty for our own.
    """

    column: str
    kind: ColumnKind
    unit: str
    definition: str
    empty: str = ""
    source: str = ""


def parameter_column(name: str, axis: Distribution, declared: Declaration | None) -> Column:
    """Return the column of a parameter that varies as an axis; `declared` is its declaration in the scenario."""
    quantity = None if declared is None else QUANTITIES.get(declared.kind)
    summary = "" if declared is None or not declared.summary else f"{declared.summary.rstrip('.')}. "
    definition = f"{summary}Value of the scenario's parameter '{name}'; it varies by {axis.text}."
    kind: ColumnKind = "integer" if declared is not None and declared.kind == "integer" else axis.kind
    return Column(PARAMETER + name, kind, "" if quantity is None else quantity.unit, definition)


def result_columns(parameters: Iterable[Column]) -> tuple[Column, ...]:
    """Return the columns of results.parquet, in order; `parameters` are those that vary."""
    return (
        Column("variant", "integer", "", "Index of the variant; with the seed it determines the run's random numbers."),
        *parameters,
        Column("seed", "integer", "", "Seed of the run."),
        Column("digest", "text", "", "Digest of the plan with its parameters at their defaults.", "there is no plan"),
        *(Column(name, _kind_of(name), *OUTCOME[name]) for name in OUTCOME),
        *(Column(one.name, "number", one.unit, one.definition, one.undefined, one.source) for one in MEASURES),
    )


def takeover_columns() -> tuple[Column, ...]:
    """Return the columns of takeovers.parquet, in order: a row for each request of each variant."""
    index = Column("variant", "integer", "", "Index of the variant, as in results.parquet.")
    return (index, *(_takeover_column(name, field) for name, field in Takeover.model_fields.items()))


def _takeover_column(name: str, field: Field) -> Column:
    unit = str((field.json_schema_extra or {}).get("unit", ""))
    kind: ColumnKind = "integer" if field.annotation is int else "number" if unit else "text"
    empty = "" if field.is_required() else "there is none"
    return Column(name, kind, unit, str(field.description), empty)


NO_RUN = "the variant broke off before its run"

OUTCOME: Mapping[str, tuple[str, str, str]] = {
    "result": ("", str(Outcome.model_fields["result"].description), ""),
    "error": ("", "Reason why there is no result: the values were refused, or the run could not continue.", ""),
    "stop_reason": ("", str(Outcome.model_fields["stop_reason"].description), NO_RUN),
    "duration": ("s", str(Outcome.model_fields["duration"].description), NO_RUN),
    "resolution": ("", str(Outcome.model_fields["resolution"].description), NO_RUN),
    "cause": ("", str(Outcome.model_fields["cause"].description), ""),
    "collision_with": ("", str(Outcome.model_fields["collision_with"].description), "no collision"),
    "failed": ("", "The criteria that failed, by their names in the conflict language, separated by spaces.", ""),
    "avoided_by": (
        "",
        "Reference drivers of the criteria that have no collision if they drive from the start, separated by spaces.",
        "no criterion names one",
    ),
}
"""Columns of the outcome: their unit, definition and when they are empty."""


def _kind_of(name: str) -> ColumnKind:
    return "number" if name == "duration" else "text"


def codebook_text(tables: Mapping[str, Iterable[Column]]) -> str:
    """Return codebook.csv: one row a column, with the table that it is of; a spreadsheet runs none of its cells."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("table", *(one.name for one in fields(Column))))
    for table, columns in tables.items():
        rows.writerows((table, *(text_cell(cell) for cell in vars(one).values())) for one in columns)
    return text.getvalue()
