"""Comparisons of two recordings with known differences."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.recording.comparison import Apart, EventPair, MeasurePair, Parting, compare
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.trajectory import TrajectoryError, read_trajectory, write_trajectory
from tests.recording.made import approach, plan_of, record

IDS = ("ego", "parked")
EVENTS = [(0.5, "warning", "path_blocked"), (1.0, "request", "path_blocked"), (2.0, "response", "")]


def made(rows: int = 40, **changes: object) -> Recording:
    return replace(record(IDS, rows, approach(), EVENTS), **changes)  # type: ignore[arg-type]


def shifted(name: str, by: float, row: int = 25, entity: int = 0) -> Recording:
    """Return the recording with one value changed from a row on."""
    values = getattr(made(), name).copy()
    values[(slice(row, None), entity) if values.ndim == 2 else slice(row, None)] += by
    return made(**{name: values})


def test_a_run_is_equal_to_itself() -> None:
    found = compare(made(), made())
    assert found.equal
    assert found.rows == 40
    assert found.parting is None
    assert found.apart == (Apart("ego", 40, 0), Apart("parked", 40, 0))
    assert all(fact.first == fact.second for fact in found.facts)


@pytest.mark.parametrize(
    ("name", "by", "parting"),
    [
        ("x", 0.5, Parting(2.5, "ego", "x", "25", "25.5")),
        ("road", -1, Parting(2.5, "ego", "road", "1", "none")),
        ("confidence_left", 0.05, Parting(2.5, "", "confidence_left", "0.9", "0.9500000000000001")),
        ("takeover_state", 2, Parting(2.5, "", "takeover_state", "automated", "request")),
    ],
)
def test_the_first_value_that_differs_is_named(name: str, by: float, parting: Parting) -> None:
    found = compare(made(), shifted(name, by))
    assert found.parting is not None
    assert replace(found.parting, t=round(found.parting.t, 9)) == parting
    assert not found.equal


def test_the_first_difference_is_the_earliest_then_of_the_first_entity() -> None:
    both = shifted("v", 1.0, row=5, entity=1)
    y = both.y.copy()
    y[5:, 0] += 1.0
    found = compare(made(), replace(both, y=y)).parting
    assert found is not None
    assert (round(found.t, 9), found.entity, found.column) == (0.5, "ego", "y")


def test_missing_values_are_equal() -> None:
    assert np.isnan(made().sensor_health).all()
    assert compare(made(), made()).parting is None


def test_the_greatest_differences_are_those_of_each_entity() -> None:
    found = compare(made(), replace(shifted("x", 3.0), y=shifted("y", 4.0, row=30).y)).apart[0]
    assert (found.x, found.y, found.distance, round(found.t, 9)) == (3.0, 4.0, 5.0, 3.0)


def test_headings_differ_by_half_a_turn_at_most() -> None:
    first, second = shifted("h", 0.1), shifted("h", 2 * math.pi - 0.1)
    assert compare(first, second).apart[0].h == pytest.approx(0.2)


def test_an_absent_entity_has_rows_but_no_position() -> None:
    gone = record(IDS, 40, approach()).present.copy()
    gone[30:, 1] = False
    x = made().x.copy()
    x[30:, 1] = np.nan
    found = compare(made(), made(present=gone, x=x))
    assert found.apart[1] == Apart("parked", 30, 10)
    assert found.parting is not None
    assert (found.parting.column, found.parting.first, found.parting.second) == ("present", "yes", "no")
    within = compare(made(), made(present=gone, x=x), tolerance=1.0).parting
    assert within is not None
    assert (within.entity, within.first, within.second) == ("parked", "64, 0", "absent")


@pytest.mark.parametrize(("tolerance", "equal"), [(None, False), (0.4, False), (0.6, True)])
def test_a_tolerance_is_of_positions(tolerance: float | None, equal: bool) -> None:
    moved = replace(shifted("x", 0.5), v=shifted("v", 0.2).v)
    assert compare(made(), moved, tolerance=tolerance).equal == equal


@pytest.mark.parametrize(("rows", "equal"), [(41, True), (42, False)])
def test_with_a_tolerance_runs_may_end_a_step_apart(rows: int, equal: bool) -> None:
    assert not compare(made(), made(rows)).equal
    assert compare(made(), made(rows), tolerance=0.1).equal == equal


def test_differing_events_are_listed_in_order() -> None:
    other = [EVENTS[0], (1.1, "request", "path_blocked"), (2.5, "collision", "parked")]
    first, second = made(), made(events=record(IDS, 40, approach(), other).events)
    found = compare(first, second)
    assert found.events == (
        EventPair("request", "", "path_blocked", "request!", 1.0, 1.1),
        EventPair("response", "", "", "response!", 2.0, None),
        EventPair("collision", "parked", "", "collision!", None, 2.5),
    )
    assert [one.kind for one in compare(first, second, tolerance=0.1).events] == ["response", "collision"]


def test_an_event_that_both_have_is_not_paired_with_another() -> None:
    once, twice = ([(t, "warning", "lane_ends") for t in times] for times in ([2.0], [1.0, 2.0]))
    first, second = (record(IDS, 40, approach(), events) for events in (once, twice))
    assert compare(first, second).events == (EventPair("warning", "", "lane_ends", "warning!", None, 1.0),)


def test_how_runs_were_made_may_differ_and_how_they_ended_may_not() -> None:
    first = made()
    other = first.header.model_copy(update={"seed": 2, "parameters": {"gap": 2.0}, "versions": {"numpy": "3"}})
    found = compare(first, replace(first, header=other))
    assert [fact.what for fact in found.facts if fact.first != fact.second] == [
        "seed", "$gap", "version of scenario-compiler", "version of numpy",
    ]  # fmt: skip
    assert found.equal
    assert not compare(first, replace(first, stop_reason="collision")).equal


def test_an_entity_that_only_one_run_has_makes_them_differ() -> None:
    header = made().header.model_copy(update={"entities": ("ego", "other")})
    found = compare(made(), made(header=header))
    assert not found.equal
    assert [one.entity for one in found.apart] == ["ego"]
    assert ("parked", "other") in [(fact.first, fact.second) for fact in found.facts]


def test_measures_and_results_are_put_side_by_side() -> None:
    plan = plan_of(*IDS)
    first, second = made(), record(IDS, 70, approach(), [*EVENTS, (6.0, "collision", "parked")])
    found = compare(first, second, (judge(plan, first), judge(plan, second)))
    assert ("pass", "fail") in [(fact.first, fact.second) for fact in found.facts if fact.what == "result"]
    measures = {one.name: one for one in found.measures}
    assert measures["request_time"] == MeasurePair("request_time", "s", 1.0, 1.0, 0.0)
    assert measures["collision_time"] == MeasurePair("collision_time", "s", None, 6.0, None)


def test_a_run_without_rows_or_with_faults_is_compared(recwarn: pytest.WarningsRecorder) -> None:
    broken = made(x=np.full_like(made().x, np.inf))
    assert compare(broken, broken).equal
    assert compare(made(), broken).apart[0].x == 0.0
    empty = record(IDS, 0, approach())
    assert compare(empty, empty).equal
    assert not compare(empty, made()).equal
    assert not recwarn


def test_a_trajectory_is_compared_by_its_columns_alone(tmp_path: Path) -> None:
    file = tmp_path / "it.csv"
    write_trajectory(made(), file)
    read = read_trajectory(file)
    assert read.header.entities == IDS
    assert np.array_equal(read.x, made().x)
    found = compare(read, made())
    assert found.equal
    assert not found.events
    assert not compare(read, shifted("off", 0.1)).equal
    assert compare(read, shifted("brake", 0.1)).equal


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "it has no row"),
        ("t,name\n", "it has no row"),
        ("name,x\na,1\n", "it has no column road"),
        ("t,name,x,y,h,v,road,lane,s,off\n", "it has no row"),
        ("t,name,x,y,h,v,road,lane,s,off\n0,a,1,2\n", "the row of 0 s is incomplete"),
        ("t,name,x,y,h,v,road,lane,s,off\n0,a,1,2,0,nan,1,-1,0,0\n", "nan is not a finite number"),
        ("t,name,x,y,h,v,road,lane,s,off\n0,a,1,2,0,0,1,left,0,0\n", "invalid literal"),
        ("t,name,x,y,h,v,road,lane,s,off\n0,a,1,2,0,0,1,99999999999999999999,0,0\n", "too large"),
        ('t,name,x,y,h,v,road,lane,s,off\n"0,a', "unexpected end of data"),
        ("t,name,x,y,h,v,road,lane,s,off\n0,a,1,2,0,0,1,-1,0,0,7\n\xff\0", "it is not text in UTF-8"),
    ],
)
def test_a_file_without_trajectories_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    file = tmp_path / "it.csv"
    file.write_bytes(text.encode("latin-1"))
    with pytest.raises(TrajectoryError, match=rf"it\.csv does not contain trajectories: .*{reason}"):
        read_trajectory(file)


def test_what_only_the_sensors_of_one_world_report_does_not_count() -> None:
    """CARLA's lane sensor reports each crossing of a mark; in the built-in world nothing does."""
    told = record(IDS, 40, approach(), [*EVENTS, (3.0, "lane_invasion", ""), (3.5, "world_collision", "")])
    in_carla = replace(told, header=told.header.model_copy(update={"world": "carla"}))
    found = compare(made(), in_carla)
    assert found.equal
    assert [(one.kind, one.counts) for one in found.events] == [("lane_invasion", False), ("world_collision", False)]
    assert not compare(replace(made(), header=in_carla.header), in_carla).equal
    without_request = record(IDS, 40, approach(), [EVENTS[0], EVENTS[2]])
    assert not compare(without_request, in_carla).equal
