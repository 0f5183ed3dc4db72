"""The event camera's pixels: each further threshold above or below the last event's level is an event."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.carla_server.sensors.events import EVENT, LEAST_THRESHOLD, EventPixels

MS = 1_000_000


def noise() -> np.random.Generator:
    return np.random.Generator(np.random.Philox(key=[1, 2]))


def seen(pixels: EventPixels, *pictures: tuple[int, list[list[float]]]) -> list[tuple[int, int, int, bool]]:
    """Return the events of the last of some pictures, each with its time in ms."""
    events: NDArray[np.void] = np.empty(0, EVENT)
    for time, brightness in pictures:
        events = pixels.see(np.array(brightness, np.float32), time * MS, noise())
    return [(int(one["x"]), int(one["y"]), round(int(one["t"]) / MS), bool(one["pol"])) for one in events]


def test_the_first_picture_has_no_events() -> None:
    assert seen(EventPixels((0.3, 0.3), (0.0, 0.0), 0), (0, [[0.0, 5.0]])) == []


def test_crossings_come_at_even_times_of_a_steady_change() -> None:
    pixels = EventPixels((0.5, 0.25), (0.0, 0.0), 0)
    dark, bright = [[0.0, 1.0, 2.0]], [[1.0, 0.0, 2.0]]
    assert seen(pixels, (100, dark), (200, bright)) == [
        (0, 0, 125, True),
        (1, 0, 150, False),
        (0, 0, 150, True),
        (0, 0, 175, True),
        (1, 0, 200, False),
        (0, 0, 200, True),
    ]


def test_a_pixel_remembers_the_level_of_its_last_event() -> None:
    """Three changes of 0.2 cross a threshold of 0.5 once, in the third."""
    pixels = EventPixels((0.5, 0.5), (0.0, 0.0), 0)
    first, second = (0, [[0.0], [0.0]]), (10, [[0.2], [0.0]])
    assert seen(pixels, first, second) == []
    assert seen(pixels, (20, [[0.4], [0.0]])) == []
    assert seen(pixels, (30, [[0.6], [0.0]])) == [(0, 0, 25, True)]


def test_a_pixel_rests_after_an_event() -> None:
    """Of crossings every 25 ms, one that comes less than 40 ms after an event is lost."""
    pixels = EventPixels((0.25, 0.25), (0.0, 0.0), 40 * MS)
    assert [one[2] for one in seen(pixels, (0, [[0.0]]), (100, [[1.0]]))] == [25, 75]
    assert [one[2] for one in seen(pixels, (200, [[0.0]]))] == [125, 175]


def test_noise_moves_the_thresholds_but_never_below_the_least() -> None:
    before, after = np.zeros((40, 50), np.float32), np.full((40, 50), 0.31, np.float32)
    exact, noisy, none = (EventPixels((0.3, c), (s, s), 0) for c, s in ((0.3, 0.0), (0.3, 0.1), (-5.0, 0.0)))
    counts = []
    for pixels in (exact, noisy, none):
        pixels.see(before, 0, noise())
        counts.append(len(pixels.see(after, MS, noise())))
    assert counts[0] == 2000
    assert counts[1] not in (0, 2000)
    assert counts[2] == 2000 * int(0.31 / LEAST_THRESHOLD)


def test_a_threshold_that_is_small_against_the_change_does_not_flood(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenario_compiler.carla_server.sensors.events.MOST_EVENTS", 5000)
    pixels = EventPixels((0.01, 0.01), (0.0, 0.0), 0)
    pixels.see(np.zeros((10, 100), np.float32), 0, noise())
    assert len(pixels.see(np.full((10, 100), 255.0, np.float32), MS, noise())) == 5000
