"""Recordings and their replays, without a client: what is recorded is shown, and what a recording tells."""

from __future__ import annotations

from scenario_compiler.carla_server.recorder import Recording

STEP = 0.1
"""Length of a time step, s."""


def moved(*places: float) -> Recording:
    """Return a recording of one body, at a place in each frame, m."""
    frames = [
        [k + 1, k * STEP, STEP, [[7, [x, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0, [], 0]], [], []] for k, x in enumerate(places)
    ]
    return Recording("made", "town_grid", {7: [[0, "static.prop.box01", []], "other"]}, frames)


def test_each_stop_is_reported_with_its_start_the_longest_first() -> None:
    places = [0.0] * 11 + [2.0, 4.0, 6.0] + [8.0] * 31 + [10.0, 12.0]
    told = moved(*places).blocked(0.5, 100.0).splitlines()
    rows = [line.split() for line in told if " 7 " in line]
    assert [(float(row[0]), float(row[-1])) for row in rows] == [(1.5, 3.0), (0.1, 1.0)]
    assert told[-2:] == ["Frames: 47", "Duration: 4.6 seconds"]


def test_a_stop_that_lasts_to_the_end_is_reported_and_a_short_one_is_not() -> None:
    told = moved(*[0.0] * 3, *[5.0] * 8).blocked(0.5, 100.0)
    rows = [line.split() for line in told.splitlines() if " 7 " in line]
    assert [(float(row[0]), float(row[-1])) for row in rows] == [(0.4, 0.7)]
