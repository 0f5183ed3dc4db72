"""The page of a sweep: rates with their intervals, distributions, heat maps, the worst cases and the repeating command.

Its input is plain tables: rows by column, as in the sweep's Parquet file, and runs of the shown cases.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from scenario_compiler.expressions import format_value
from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.break_off import equal_reasons
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.resolution import WITHOUT_REQUEST
from scenario_compiler.report import plots, sweep_plots
from scenario_compiler.report.palette import words_of
from scenario_compiler.report.run import Run
from scenario_compiler.report.statistics import wilson_interval
from scenario_compiler.report.templates import page_environment
from scenario_compiler.report.wording import decimal, with_unit
from scenario_compiler.vocabulary.criteria import references_in

TEMPLATE = "sweep.html.jinja"

SHOWN = (
    "takeover_time",
    "time_budget",
    "takeover_buffer",
    "minimum_time_to_collision",
    "minimum_lane_time_to_collision",
    "minimum_time_headway",
    "maximum_drac",
    "minimum_distance",
    "maximum_longitudinal_acceleration",
    "maximum_lateral_acceleration",
    "maximum_lateral_offset",
    "collision_speed",
)
"""Measures with a distribution plot."""

MOST_MAPS = 6
"""Greatest number of pairs of parameters with a heat map."""

MOST_CONDITIONS = 4
"""Greatest number of parameters with box plots, and with scatter plots."""

MOST_GROUPS = 8
"""Greatest number of values of a parameter whose values are compared by box plots."""

Rows = Mapping[str, Sequence[Any]]


@dataclass(frozen=True)
class Rate:
    """The frequency of an outcome.

    Attributes:
        name: The outcome.
        hits: Number of runs with it.
        count: Number of runs.
        low: Lower end of the 95 % interval.
        high: Upper end.
    """

    name: str
    hits: int
    count: int
    low: float
    high: float

    @property
    def rate(self) -> float | None:
        """The observed rate; None without a run."""
        return self.hits / self.count if self.count else None


@dataclass(frozen=True)
class Case:
    """A shown variant.

    Attributes:
        index: Its index.
        parameters: Its parameters by name.
        command: The command that repeats it.
        run: Its run, for the pictures; None to show only the row of the table.
    """

    index: int
    parameters: Mapping[str, Any]
    command: str
    run: Run | None = None


@dataclass(frozen=True)
class SweepPage:
    """The contents of a sweep's page.

    Attributes:
        title: Name of the scenario.
        summary: Its summary.
        rows: The table, by column.
        parameters: Name of each varying parameter and its distribution.
        units: Unit of each varying parameter that has one.
        facts: Further lines on the sweep: (what, value).
        cases: The worst cases, the worst first.
        command: The command that repeats the sweep.
    """

    title: str
    summary: str
    rows: Rows
    parameters: Mapping[str, str]
    units: Mapping[str, str]
    facts: Sequence[tuple[str, str]]
    cases: Sequence[Case]
    command: str

    def titled(self, name: str) -> str:
        """Return the title of a parameter's axis or column: its name and unit."""
        return with_unit(name, self.units.get(name, ""))

    @property
    def judged(self) -> bool:
        """Whether the runs have criteria; assumed unless a shown case has none."""
        return all(case.run is None or case.run.plan.criteria for case in self.cases)

    @property
    def references(self) -> tuple[str, ...]:
        """The reference drivers in the shown cases' criteria, whose collisions are drawn beside those of the runs."""
        plans = [case.run.plan for case in self.cases if case.run is not None]
        return tuple(dict.fromkeys(name for plan in plans for name in references_in(plan.criteria)))

    @property
    def automated(self) -> bool:
        """Whether an automated vehicle drives, whose takeover requests count; assumed unless a shown case has none."""
        return all(case.run is None or case.run.plan.controller is not None for case in self.cases)


def write_sweep_report(page: SweepPage, folder: Path) -> Path:
    """Write report.html to a folder and return its path; equal sweeps give equal bytes."""
    environment = page_environment()
    environment.filters["percent"] = lambda share: "–" if share is None else f"{100 * share:.3g} %"
    text = environment.get_template(TEMPLATE).render(
        page=page,
        rates=rates_of(page.rows, judged=page.judged, automated=page.automated),
        errors=equal_reasons(
            (index, error)
            for index, (result, error) in enumerate(zip(page.rows["result"], page.rows["error"], strict=True))
            if result == "error"
        ),
        still_open=_still_open(page.rows) if page.automated else 0,
        pictures=_pictures(page),
        sound=sum(result != "error" for result in page.rows["result"]),
        maps={case.index: _case_pictures(case) for case in page.cases},
        measures=[measure for measure in MEASURES if measure.name in SHOWN],
        values=lambda name, index: page.rows[name][index],
    )
    path = folder / "report.html"
    write_whole(path, text)
    return path


def rates_of(rows: Rows, *, judged: bool = True, automated: bool = True) -> list[Rate]:
    """Return how often runs collided, violated a criterion, requested a takeover, and how the requests ended.

    Requests that were still open at the end of their runs are not included in the last. A driver may answer during the
    minimum-risk manoeuvre too; such a run counts in both of them.
    """
    sound = [k for k, result in enumerate(rows["result"]) if result != "error"]
    requested = [k for k in sound if rows["resolution"][k] not in WITHOUT_REQUEST]
    ended = [k for k in requested if rows["resolution"][k] != "open"]

    def rate(name: str, hits: int, count: int) -> Rate:
        return Rate(name, hits, count, *wilson_interval(hits, count))

    answered = sum(rows["takeover_time"][k] is not None for k in ended)
    stopped_first = sum(rows["resolution"][k] == "minimum_risk" for k in ended)
    rates = [rate("collision", sum(rows["collision_time"][k] is not None for k in sound), len(sound))]
    if judged:
        rates.append(rate("a criterion broken", sum(rows["result"][k] == "fail" for k in sound), len(sound)))
    if automated:
        rates += [
            rate("takeover request", len(requested), len(sound)),
            rate("request answered by the driver", answered, len(ended)),
            rate("minimum-risk manoeuvre before an answer", stopped_first, len(ended)),
        ]
    return rates


def _still_open(rows: Rows) -> int:
    """Return the number of requests that the rates leave out because they were still open at the end of the run."""
    return sum(
        end == "open" and result != "error" for end, result in zip(rows["resolution"], rows["result"], strict=True)
    )


@dataclass(frozen=True)
class Condition:
    """A grouping of runs: the names of its values, in order, and the value of each run."""

    names: Sequence[str]
    taken: Sequence[str]


@dataclass(frozen=True)
class Pictures:
    """The pictures of a page, each as SVG, and notes on what is left out.

    Attributes:
        distributions: Histograms of the measures; empty if none has a value.
        boxes: Measures by condition: (parameter, picture, names of the conditions if they are numbered in it).
        scatter: Measures over a parameter: (parameter, picture).
        along: Rates along a parameter: (parameter, picture).
        maps: Two parameters at a time: (one, other, pictures).
        left_out: Sentences on what is not shown.
    """

    distributions: str
    boxes: list[tuple[str, str, Sequence[str]]]
    scatter: list[tuple[str, str]]
    along: list[tuple[str, str]]
    maps: list[tuple[str, str, list[str]]]
    left_out: list[str]


def _pictures(page: SweepPage) -> Pictures:
    rows = page.rows
    sound = np.array([result != "error" for result in rows["result"]], dtype=bool)
    runs = int(sound.sum())
    left_out = []
    if runs < len(sound):
        left_out.append(f"{len(sound) - runs} of {len(sound)} variants broke off and are in no picture.")
    measures = _measures(rows, sound, left_out)
    collided = np.array([time is not None for time in rows["collision_time"]], dtype=np.float64)[sound]
    axes, conditions = _axes(page, sound, left_out)
    compared = dict(list(conditions.items())[:MOST_CONDITIONS]) if measures else {}
    clouds = {name: values for name, values in axes.items() if name not in conditions}
    scattered = dict(list(clouds.items())[:MOST_CONDITIONS]) if measures else {}
    if scattered:
        left_out += _thinned(collided)
    for kind, drawn, there in (("boxes", compared, conditions), ("scatter", scattered, clouds)):
        if len(drawn) < len(there):
            left_out.append(f"Without {kind}: {', '.join(name for name in there if name not in drawn)}.")
    pairs = list(combinations(axes, 2))
    if len(pairs) > MOST_MAPS:
        left_out.append(f"Two parameters at a time: {MOST_MAPS} of {len(pairs)} pairs are shown.")
    hits = [("collision", collided), *_further_hits(page, sound)]
    return Pictures(
        distributions=sweep_plots.distributions_plot(measures, "measures") if measures else "",
        boxes=[_boxes(name, one, measures) for name, one in compared.items()],
        scatter=[
            (name, sweep_plots.scatter_plot((page.titled(name), values), measures, collided, f"scatter-{name}"))
            for name, values in scattered.items()
        ],
        along=[
            (name, sweep_plots.rate_plot((page.titled(name), values), hits, f"rate-{name}"))
            for name, values in axes.items()
        ],
        maps=[
            (first, second, _heat_maps(page, (first, second), axes, collided, sound))
            for first, second in pairs[:MOST_MAPS]
        ],
        left_out=left_out,
    )


def _measures(rows: Rows, sound: Booleans, left_out: list[str]) -> list[sweep_plots.Panel]:
    """Return the shown measures of the sound runs; one that no run has is named in `left_out`."""
    measures: list[sweep_plots.Panel] = []
    for measure in MEASURES:
        if measure.name in SHOWN:
            title, values = words_of(measure.name), _numbers(rows[measure.name])[sound]
            if np.isfinite(values).any():
                measures.append((title, measure.unit, values))
            else:
                left_out.append(f"No run has a {title}.")
    return measures


def _further_hits(page: SweepPage, sound: Booleans) -> list[tuple[str, Floats]]:
    """Return which sound runs requested a takeover, and in which a reference driver collided: 1 or 0 a run."""
    rows = page.rows
    requested = np.array([end not in WITHOUT_REQUEST for end in rows["resolution"]], dtype=np.float64)[sound]
    avoided = [row if row is not None else "" for row in np.array(rows["avoided_by"], dtype=object)[sound]]
    references = [
        (
            f"collision, {name.replace('_', ' ')} in its place",
            np.array([name not in row.split() for row in avoided], dtype=np.float64),
        )
        for name in page.references
    ]
    return [*([("takeover request", requested)] if page.automated else []), *references]


def _boxes(name: str, one: Condition, measures: Sequence[sweep_plots.Panel]) -> tuple[str, str, Sequence[str]]:
    """Return the measures by condition, with the names of the conditions if they are numbered in the picture."""
    drawn = sweep_plots.boxes_plot(measures, one.names, one.taken, f"boxes-{name}")
    return name, drawn, [] if sweep_plots.names_in_lines(one.names) else one.names


def _axes(page: SweepPage, sound: Booleans, left_out: list[str]) -> tuple[dict[str, Floats], dict[str, Condition]]:
    """Return the numeric parameters, and those with few values as conditions, by their names.

    A parameter that is neither, or has only one value, is named in `left_out`.
    """
    axes: dict[str, Floats] = {}
    conditions: dict[str, Condition] = {}
    for name in page.parameters:
        taken = [value for value, good in zip(page.rows[f"parameter.{name}"], sound, strict=True) if good]
        numbers = bool(taken) and all(isinstance(value, float | int) and not isinstance(value, bool) for value in taken)
        values = _numbers(taken) if numbers else np.empty(0)
        texts = [decimal(value) for value in values.tolist()] if numbers else [format_value(value) for value in taken]
        distinct = len(set(values.tolist())) if numbers else len(set(texts))
        if distinct < 2:
            left_out.append(f"{name} has one value in all runs.")
            continue
        if numbers:
            axes[name] = values
        if distinct <= MOST_GROUPS:
            rising = sorted(range(len(texts)), key=lambda k: values[k] if numbers else texts[k])
            conditions[name] = Condition(tuple(dict.fromkeys(texts[k] for k in rising)), texts)
        elif not numbers:
            left_out.append(f"{name} has {distinct} values; up to {MOST_GROUPS} are shown as conditions.")
    return axes, conditions


def _thinned(collided: Floats) -> list[str]:
    """Return sentences about the runs that scatter plots leave out; `collided` is 1 for a run with a collision."""
    most, hits = sweep_plots.MOST_POINTS, int(collided.sum())
    groups = ((hits, "with"), (len(collided) - hits, "without"))
    return [
        f"Scatter shows at most {most} of the {count} runs {whether} a collision, evenly chosen."
        for count, whether in groups
        if count > most
    ]


def _heat_maps(
    page: SweepPage, names: tuple[str, str], axes: Mapping[str, Floats], collided: Floats, sound: Booleans
) -> list[str]:
    first, second = ((page.titled(name), axes[name]) for name in names)
    suffix = "-".join(names)
    drawn = [sweep_plots.heat_map(first, second, collided, "collision rate", f"collision-{suffix}")]
    closest = _numbers(page.rows["minimum_time_to_collision"])[sound]
    if np.isfinite(closest).any():
        label = "mean of the minimum time to collision (s)"
        drawn.append(sweep_plots.heat_map(first, second, closest, label, f"ttc-{suffix}"))
    return drawn


def _case_pictures(case: Case) -> dict[str, Any]:
    run = case.run
    if run is None or not len(run.recording.t):
        return {"frames": (), "map": "", "course": ""}
    return {
        "frames": run.recording.frames[:3],
        "map": plots.close_up_map(run, f"case-{case.index}-map"),
        "course": plots.timeline_plot(run, f"case-{case.index}-course"),
    }


def _numbers(values: Sequence[float | None]) -> Floats:
    """Return numbers, NaN if there is none; those that differ only by rounding are made equal."""
    return sweep_plots.levelled(np.array([np.nan if value is None else value for value in values], dtype=np.float64))
