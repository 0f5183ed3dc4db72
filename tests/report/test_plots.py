"""Maps of a run: a legend that stays within the picture and names what is drawn, and colours that mean one thing."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable

import pytest

from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import MOMENTS
from scenario_compiler.report.palette import MOMENT_COLOURS, WORDS
from scenario_compiler.report.plots import WIDTH, close_up_map, overview_map
from scenario_compiler.report.run import Run

Draw = Callable[[Run, str], str]


def with_events(run: Run, *events: EventRow) -> Run:
    return dataclasses.replace(run, recording=dataclasses.replace(run.recording, events=events))


@pytest.mark.parametrize("draw", [overview_map, close_up_map])
def test_a_legend_of_many_entries_wraps_within_the_picture(finished: Run, draw: Draw) -> None:
    eventful = with_events(finished, *(EventRow(t=2.0 + k, kind=kind) for k, kind in enumerate(MOMENTS)))
    texts = re.findall(
        r'<text style="font-size: 8px[^>]* x="([0-9.-]+)" y="([0-9.-]+)"[^>]*>([^<]+)<', draw(eventful, "it")
    )
    entries = {text.partition(", ")[0]: (float(x), float(y)) for x, y, text in texts}
    assert {*(WORDS[kind] for kind in MOMENTS), "others", "ways of others", "ego"} <= set(entries)
    assert len({y for _, y in entries.values()}) > 2
    assert all(x >= 0.0 and x + 4.0 * len(text) <= 72 * WIDTH for text, (x, _) in entries.items())


@pytest.mark.parametrize("draw", [overview_map, close_up_map])
def test_colours_of_moments_are_used_for_moments_only(finished: Run, draw: Draw) -> None:
    drawn = draw(with_events(finished), "it").lower()
    assert [kind for kind, colour in MOMENT_COLOURS.items() if colour.lower() in drawn] == []


def test_a_map_is_as_high_as_what_is_on_it(finished: Run) -> None:
    box = re.search(r'viewBox="0 0 ([0-9.]+) ([0-9.]+)"', close_up_map(with_events(finished), "it"))
    assert box is not None
    assert float(box[1]) == 72 * WIDTH
    assert float(box[2]) < 200.0


def test_names_of_vehicles_beside_each_other_stand_on_both_sides(finished: Run) -> None:
    recording = finished.recording
    x, y = recording.x.copy(), recording.y.copy()
    x[:, 2], y[:, 2] = x[:, 1], y[:, 1] + 3.5  # in the lane to the left
    names = recording.header.entities[1:]
    beside = dataclasses.replace(finished, recording=dataclasses.replace(recording, x=x, y=y))
    drawn = close_up_map(beside, "it")
    shown = re.findall(r'<text style="font-size: 7.5px[^>]* x="([0-9.-]+)" y="([0-9.-]+)"[^>]*>([^<]+)<', drawn)
    heights = {text: float(y) for _, y, text in shown if text in names}
    assert set(heights) == set(names)
    assert abs(heights[names[0]] - heights[names[1]]) > 15.0
