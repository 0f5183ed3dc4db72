"""The CSV forms: trajectories and events."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.recording.decimals import shortest
from scenario_compiler.recording.events import EventRow, write_events
from scenario_compiler.recording.recording import Header, RecordingBuilder
from scenario_compiler.recording.trajectory import write_trajectory


@given(st.floats(allow_nan=False))
def test_a_number_reads_back_to_itself(number: float) -> None:
    assert float(shortest(number)) == number


@pytest.mark.parametrize(("number", "text"), [(20.0, "20"), (-0.0, "0"), (0.1, "0.1"), (1e-7, "1e-07"), (-1.5, "-1.5")])
def test_a_number_is_as_short_as_can_be(number: float, text: str) -> None:
    assert shortest(number) == text


def test_the_trajectory_file(tmp_path: Path) -> None:
    header = Header(plan_digest="", plan_name="p", seed=1, step=0.1, entities=("ego", "a,b"), perception="ideal")
    columns: dict[str, list[float]] = {
        "present": [1, 0],
        **{"x": [0.1, 1.0], "y": [-2.0, 3.0], "h": [-1.0, 0.0], "v": [10.0, 0.0]},
        **{"road": [0, -1], "lane": [-1, 5], "s": [20.0, 7.0], "off": [0.25, 1.0]},
    }
    builder = RecordingBuilder(header, ("12",), columns)
    builder.append(0.0)
    columns["present"][1] = 1
    builder.append(0.1)
    write_trajectory(builder.finish("duration"), tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text(encoding="utf-8") == (
        "t,name,x,y,h,v,road,lane,s,off\n"
        "0,ego,0.1,-2,5.283185307179586,10,12,-1,20,0.25\n"
        "0.1,ego,0.1,-2,5.283185307179586,10,12,-1,20,0.25\n"
        '0.1,"a,b",1,3,0,0,-1,0,0,0\n'
    )


def test_the_events_file(tmp_path: Path) -> None:
    events = (
        EventRow(t=1.5, kind="request", entity="ego", cause="path_blocked", message='Take over, "now"', value=30.0),
        EventRow(t=2.0, kind="response"),
    )
    write_events(events, tmp_path / "events.csv")
    with (tmp_path / "events.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows == [
        ["t", "kind", "entity", "cause", "message", "value"],
        ["1.5", "request", "ego", "path_blocked", 'Take over, "now"', "30"],
        ["2", "response", "", "", "", ""],
    ]
