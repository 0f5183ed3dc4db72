"""Compares two runs: when they begin to differ, by how much, and which events are in only one of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.recording.decimals import shortest, to_the_nanosecond
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import CAUSES, SOURCES, TAKEOVER_STATES, WISHES, WORLD_EVENTS
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.recording import COLUMNS, Column, Floats, Integers, Recording
from scenario_compiler.recording.trajectory import TRAJECTORY_COLUMNS


@dataclass(frozen=True, slots=True)
class Fact:
    """A property of both runs that is compared.

    Attributes:
        what: Its name.
        first: Its value in the first run.
        second: Its value in the second run.
        counts: Whether a difference in it makes the runs different; otherwise it can only explain differences.
    """

    what: str
    first: str
    second: str
    counts: bool = False


@dataclass(frozen=True, slots=True)
class Parting:
    """The first value that differs, in the order of time, entity and column.

    Attributes:
        t: Time of the row, s.
        entity: Id of the entity; empty for a column of the run.
        column: The column; "x, y" if only positions are compared.
        first: The value in the first run.
        second: The value in the second run.
    """

    t: float
    entity: str
    column: str
    first: str
    second: str


@dataclass(frozen=True, slots=True)
class Apart:
    """The greatest differences of an entity in the rows that both runs have.

    Attributes:
        entity: Its id.
        rows: Number of rows in which it is present in both.
        alone: Number of rows in which it is present in only one of them.
        distance: Greatest distance, m.
        t: Time of the greatest distance, s.
        x: Greatest difference in x, m.
        y: Greatest difference in y, m.
        h: Greatest difference of the headings, rad, at most pi.
        v: Greatest difference in speed, m/s.
    """

    entity: str
    rows: int
    alone: int
    distance: float = 0.0
    t: float = 0.0
    x: float = 0.0
    y: float = 0.0
    h: float = 0.0
    v: float = 0.0


@dataclass(frozen=True, slots=True)
class EventPair:
    """An event that is in only one run, or differs in time or value between the runs.

    Attributes:
        kind: The kind of event.
        entity: Id of the entity concerned.
        cause: Its cause.
        message: The message to the driver, or a name.
        first: Time in the first run, s; None if it is not in it.
        second: Time in the second run, s; None if it is not in it.
        counts: Whether the runs differ by it; not if only the sensors of one of two worlds report such events.
    """

    kind: str
    entity: str
    cause: str
    message: str
    first: float | None
    second: float | None
    counts: bool = True


@dataclass(frozen=True, slots=True)
class MeasurePair:
    """A measure of both runs, and the second value minus the first; None if one is not defined."""

    name: str
    unit: str
    first: float | None
    second: float | None
    difference: float | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """The comparison of two runs.

    Attributes:
        facts: The properties of both.
        rows: Number of rows at times that both have.
        same_times: Whether the rows are at the same times; with a tolerance, whether the ends are at most a step apart.
        parting: The first difference; None if there is none.
        apart: The differences of each entity that both have, in the first run's order.
        events: Events that are not the same in both.
        measures: The measures, if outcomes of both runs are given.
    """

    facts: tuple[Fact, ...]
    rows: int
    same_times: bool
    parting: Parting | None
    apart: tuple[Apart, ...]
    events: tuple[EventPair, ...]
    measures: tuple[MeasurePair, ...]

    @property
    def equal(self) -> bool:
        """Whether the same happened in both runs; their sources may differ."""
        counting = all(fact.first == fact.second for fact in self.facts if fact.counts)
        return counting and self.same_times and self.parting is None and not any(one.counts for one in self.events)


def compare(
    first: Recording,
    second: Recording,
    outcomes: tuple[Outcome, Outcome] | None = None,
    *,
    tolerance: float | None = None,
) -> Comparison:
    """Compare two runs.

    Without a tolerance all columns have to be bitwise equal, and times have to be equal to the nanosecond. With a
    tolerance, positions may differ by it, and times of events and the end by a step; other columns are ignored. For a
    trajectory (see `trajectory.read_trajectory`) only the columns of its file are compared.

    Args:
        first: A run.
        second: The other run.
        outcomes: Their outcomes.
        tolerance: Greatest distance between positions that counts as equal, m; None for exact equality.
    """
    pair = _Pair(first, second)
    whole = bool(first.header.plan_digest and second.header.plan_digest)
    step = max(first.header.step, second.header.step) if tolerance is not None else 0.0
    if tolerance is None:
        columns = [column for column in COLUMNS[1:] if whole or column.name in (*TRAJECTORY_COLUMNS, "present")]
        parting = pair.parting(columns)
        same_times = len(pair.rows[0]) == len(first.t) == len(second.t)
    else:
        parting = pair.parting_by(tolerance)
        same_times = abs(_end(first) - _end(second)) <= step + 1e-9
    facts = [*_facts(first, second, whole=whole), *(_judged(*outcomes) if outcomes else ())]
    return Comparison(
        facts=tuple(facts),
        rows=len(pair.rows[0]),
        same_times=same_times,
        parting=parting,
        apart=tuple(pair.apart()),
        events=tuple(_events(first, second, step, values=tolerance is None)) if whole else (),
        measures=tuple(_measures(*outcomes)) if outcomes else (),
    )


class _Pair:
    """The rows and entities that two recordings have in common."""

    def __init__(self, first: Recording, second: Recording) -> None:
        self.both = (first, second)
        _, *rows = np.intersect1d(np.round(first.t, 9), np.round(second.t, 9), return_indices=True)
        self.rows: list[Integers] = rows
        self.t: Floats = first.t[rows[0]]
        self.entities = [name for name in first.header.entities if name in second.header.entities]
        self.places = [[one.header.entities.index(name) for name in self.entities] for one in self.both]

    def values(self, column: Column) -> list[NDArray[Any]]:
        """Return a column of both: (rows, entities), or (rows, 1) for a column of the run."""
        arrays = []
        for recording, rows, places in zip(self.both, self.rows, self.places, strict=True):
            array = np.asarray(getattr(recording, column.name))[rows]
            array = array[:, places] if column.per == "entity" else array[:, None]
            lists = recording.lists
            arrays.append(np.array([*lists[column.kind], ""])[array] if column.kind in lists else array)
        return arrays

    def numbers(self, name: str) -> list[NDArray[Any]]:
        """Return a column of entities by its name."""
        return self.values(next(column for column in COLUMNS if column.name == name))

    def parting(self, columns: list[Column]) -> Parting | None:
        """Return the first value that differs in these columns."""
        found: list[tuple[int, int, int]] = []
        for number, column in enumerate(columns):
            one, other = self.values(column)
            same = one == other
            if column.kind == "float":
                same |= np.isnan(one) & np.isnan(other)
            if not same.all():
                row = int(np.flatnonzero(~same.all(axis=1))[0])
                entity = int(np.flatnonzero(~same[row])[0]) if column.per == "entity" else len(self.entities)
                found.append((row, entity, number))
        if not found:
            return None
        row, entity, number = min(found)
        column = columns[number]
        name, place = (self.entities[entity], entity) if column.per == "entity" else ("", 0)
        told, other_told = (_said(array[row, place], column) for array in self.values(column))
        return Parting(float(self.t[row]), name, column.name, told, other_told)

    def parting_by(self, tolerance: float) -> Parting | None:
        """Return the first position that differs by more than a tolerance or that only one run has."""
        present = self.numbers("present")
        far = (self.distance() > tolerance) | (present[0] != present[1])
        if not far.any():
            return None
        row, entity = (int(place) for place in np.argwhere(far)[0])
        x, y = self.numbers("x"), self.numbers("y")
        told, other_told = (
            f"{shortest(x[k][row, entity])}, {shortest(y[k][row, entity])}" if present[k][row, entity] else "absent"
            for k in (0, 1)
        )
        return Parting(float(self.t[row]), self.entities[entity], "x, y", told, other_told)

    def apart(self) -> Iterator[Apart]:
        """Yield the greatest differences of each entity."""
        present, other_present = self.numbers("present")
        differences = {name: np.abs(_differences(*self.numbers(name))) for name in ("x", "y", "h", "v")}
        differences["h"] = np.minimum(differences["h"], 2 * np.pi - differences["h"])
        distance = self.distance()
        for i, entity in enumerate(self.entities):
            rows = int((present & other_present)[:, i].sum())
            alone = int((present != other_present)[:, i].sum())
            at = int(np.argmax(np.nan_to_num(distance[:, i], posinf=0.0))) if rows else 0
            greatest = {name: _greatest(values[:, i]) for name, values in differences.items()}
            t = float(self.t[at]) if rows else 0.0
            yield Apart(entity, rows, alone, _greatest(distance[:, i]), t, **greatest)

    def distance(self) -> Floats:
        """Return the distance between the positions of each entity, m: (rows, entities)."""
        return np.hypot(_differences(*self.numbers("x")), _differences(*self.numbers("y")))


def _differences(first: Floats, second: Floats) -> Floats:
    """Return the differences; NaN if both are infinite, as after a fault of the engine."""
    with np.errstate(invalid="ignore"):
        return np.subtract(first, second)


def _greatest(values: Floats) -> float:
    """Return the greatest finite number, or 0."""
    return float(np.max(values, initial=0.0, where=np.isfinite(values)))


def _said(value: Any, column: Column) -> str:
    if column.kind == "state":
        return TAKEOVER_STATES.get(int(value), "none")
    if column.kind == "cause":
        return CAUSES.get(int(value), "") or "none"
    if column.kind == "source":
        return SOURCES.get(int(value), "none")
    if column.kind == "wish":
        return WISHES.get(int(value), "") or "none"
    if column.kind == "flag":
        return "yes" if value else "no"
    return shortest(value) if column.kind == "float" else str(value) or "none"


def _end(recording: Recording) -> float:
    return to_the_nanosecond(float(recording.t[-1])) if len(recording.t) else 0.0


def _facts(first: Recording, second: Recording, *, whole: bool) -> Iterator[Fact]:
    one, other = first.header, second.header
    if whole:
        for what in ("plan_name", "plan_digest", "seed", "variant", "world", "perception"):
            yield Fact(what.replace("_", " "), str(getattr(one, what)), str(getattr(other, what)))
        yield Fact("step, s", shortest(one.step), shortest(other.step))
        for name in dict.fromkeys((*one.parameters, *other.parameters)):
            yield Fact(f"${name}", str(one.parameters.get(name, "")), str(other.parameters.get(name, "")))
        for name in dict.fromkeys((*one.versions, *other.versions)):
            yield Fact(f"version of {name}", one.versions.get(name, ""), other.versions.get(name, ""))
    yield Fact("rows", str(len(first.t)), str(len(second.t)))
    yield Fact("end, s", shortest(_end(first)), shortest(_end(second)))
    alone, other_alone = (
        ", ".join(name for name in a.entities if name not in b.entities) for a, b in ((one, other), (other, one))
    )
    yield Fact("entities in one run alone", alone, other_alone, counts=True)
    if whole:
        yield Fact("why the run ended", first.stop_reason, second.stop_reason, counts=True)
        yield Fact("fault code", str(first.error), str(second.error), counts=True)


def _judged(first: Outcome, second: Outcome) -> Iterator[Fact]:
    for what in ("result", "resolution", "cause", "collision_with"):
        told, other_told = (str(getattr(outcome, what) or "") for outcome in (first, second))
        yield Fact(what.replace("_", " "), told, other_told, counts=True)


def _events(first: Recording, second: Recording, slack: float, *, values: bool) -> list[EventPair]:
    """Return the events that are not the same in both; those that differ only in time are paired in order."""
    grouped: dict[tuple[str, str, str, str], tuple[list[EventRow], list[EventRow]]] = defaultdict(lambda: ([], []))
    for number, recording in enumerate((first, second)):
        for event in recording.events:
            grouped[event.kind, event.entity, event.cause, event.message][number].append(event)
    differing = []
    for about, (ones, others) in grouped.items():
        alone = []
        for one in ones:
            alike = next((other for other in others if _alike(one, other, slack, values=values)), None)
            if alike is None:
                alone.append(one)
            else:
                others.remove(alike)
        times = ([to_the_nanosecond(event.t) for event in events] for events in (alone, others))
        counts = about[0] not in WORLD_EVENTS or first.header.world == second.header.world
        differing += [EventPair(*about, t, other_t, counts) for t, other_t in zip_longest(*times)]
    return sorted(differing, key=lambda pair: min(t for t in (pair.first, pair.second) if t is not None))


def _alike(first: EventRow, second: EventRow, slack: float, *, values: bool) -> bool:
    return abs(first.t - second.t) <= slack + 1e-9 and (not values or first.value == second.value)


def _measures(first: Outcome, second: Outcome) -> Iterator[MeasurePair]:
    for name in dict.fromkeys((*first.measures, *second.measures)):
        pair = [outcome.measures.get(name) for outcome in (first, second)]
        unit = next(measure.unit for measure in pair if measure is not None)
        value, other_value = (None if measure is None else measure.value for measure in pair)
        difference = None if value is None or other_value is None else other_value - value
        yield MeasurePair(name, unit, value, other_value, difference)
