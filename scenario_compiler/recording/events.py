"""Events of a run, and their CSV form."""

import csv
import io
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.cells import text_cell
from scenario_compiler.recording.decimals import shortest, to_the_nanosecond
from scenario_compiler.recording.names import EVENT_TEXTS, EventKind
from scenario_compiler.records import Record, field


class _KnownKind:
    """Tells pydantic which kinds of events there are."""

    def __get_pydantic_core_schema__(self, source: object, handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.no_info_after_validator_function(_known_kind, handler(source))


def _known_kind(kind: str) -> str:
    if kind not in EVENT_TEXTS:
        raise ValueError(f"there is no kind of event '{kind}'")
    return kind


class EventRow(Record):
    """Something that happened at one instant: a row of events.csv, in the order of the fields."""

    t: float = field(description="Time, s.")
    kind: Annotated[EventKind, _KnownKind()] = field(
        description="What happened.", json_schema_extra={"enum": [*EVENT_TEXTS]}
    )
    entity: str = field(default="", description="Id of the entity concerned; for a collision, of the other entity.")
    cause: str = field(
        default="", description="Cause: of a warning or request, the kind of a failure, or who stopped the vehicle."
    )
    message: str = field(
        default="",
        description="The message to the driver, the name of a storyboard event or an entity, or a sentence.",
    )
    value: float | None = field(default=None, description="A number that belongs to the event, in its SI unit.")


def write_events(events: Iterable[EventRow], path: Path) -> None:
    """Write events.csv with one row per event, in order; an absent value is an empty cell."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(EventRow.model_fields)
    for event in events:
        value = "" if event.value is None else shortest(event.value)
        texts = (text_cell(text) for text in (event.kind, event.entity, event.cause, event.message))
        rows.writerow((shortest(to_the_nanosecond(event.t)), *texts, value))
    write_whole(path, text.getvalue())
