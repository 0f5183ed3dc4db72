"""The data of a run for the player in a page: motion, curves, events and roads as small integers.

A column is rounded to multiples of a step, such as a centimetre for positions, and stored as the differences between
rows, which are small where motion is smooth. The whole is JSON, compressed by gzip and encoded in base64. Equal runs
give equal text.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.painted import lines_beside, mark_stretches, secondary_lines
from scenario_compiler.recording.names import MOMENTS
from scenario_compiler.recording.recording import COLUMNS, Floats, Recording
from scenario_compiler.report.blocked import blocks_of
from scenario_compiler.report.palette import (
    BLUE,
    GREEN,
    MOMENT_COLOURS,
    ORANGE,
    PURPLE,
    STATE_COLOURS,
    VERMILION,
    WORDS,
    words_of,
)
from scenario_compiler.report.run import HEALTHY, Run
from scenario_compiler.report.surroundings import PAVED, Window, surroundings
from scenario_compiler.report.wording import unit_words
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.positions import Pose, SecondaryLine
from scenario_compiler.vocabulary.word import number_value

TIME_STEP, PLACE_STEP = 1e-4, 0.01
"""Steps of times and positions, s and m."""

ENTITY_STEPS = {"x": PLACE_STEP, "y": PLACE_STEP, "h": 1e-3, "v": 0.01, "a": 0.01, "lane": 1.0, "road": 1.0, "s": 0.1}
"""Columns of each entity and their steps, in their units."""

RUN_STEPS = {
    "confidence_left": 1e-3,
    "confidence_right": 1e-3,
    "sensor_health": 1e-3,
    "blocked_distance": 0.01,
    "lane_end_distance": 0.01,
}
"""Columns of the run and their steps, in their units."""

EGO_STEPS = {"throttle": 1e-3, "brake": 1e-3, "steer": 1e-3}
"""Columns that are only shown for the ego, and their steps, in their units."""

SPACING = 2.0
"""Greatest distance between two samples of a road's reference line, m, in a section of up to a kilometre."""

FLATNESS = 0.02
"""Greatest distance of a line of the map from the samples from which it is made, m."""

MARGIN = 80.0
"""Distance beyond the ego's positions that the map covers, m."""

LARGEST = 2.0**50
"""Greatest number of steps of a value in a page: JavaScript counts exactly up to 2^53."""

MARK_COLOURS = {"yellow": ORANGE, "orange": ORANGE, "blue": BLUE, "red": VERMILION, "green": GREEN, "violet": PURPLE}
"""Colours of marks; others have the page's colour for paint."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A first-person picture in a page.

    Attributes:
        t: Time, s.
        label: The kind of the event at its moment; empty for a picture of a series.
        type: Its media type, such as "image/png".
        data: The file.
    """

    t: float
    label: str
    type: str
    data: bytes


def pictures_of(run: Run) -> tuple[Picture, ...]:
    """Return the pictures in the recording, ordered by time."""
    return tuple(Picture(one.t, one.label, "image/png", one.png) for one in run.recording.frames)


def packed(data: object) -> str:
    """Return data as JSON, compressed by gzip, in base64; equal data give equal text."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return base64.b64encode(gzip.compress(text.encode(), compresslevel=9, mtime=0)).decode()


def replay_of(run: Run, name: str, *, pictured: bool) -> dict[str, Any]:
    """Return the player's data of a run, as JSON.

    Args:
        run: The run, with at least one row.
        name: Its name.
        pictured: Whether the player has a pane for first-person pictures.
    """
    recording = run.recording
    origin = _origin(run)
    blocks = blocks_of(run)
    return {
        "name": name,
        "pictured": pictured,
        "map": run.plan.map.name,
        "automated": run.plan.controller is not None,
        "origin": origin,
        "t": {"step": TIME_STEP, "data": _differences(recording.t, TIME_STEP)},
        "entities": [
            {
                "id": entity.id,
                "length": entity.vehicle.length,
                "width": entity.vehicle.width,
                "center": entity.vehicle.center,
                "category": entity.vehicle.category,
            }
            for entity in run.plan.entities
        ],
        "roads": recording.roads,
        "columns": _columns(run, origin),
        "blocked": {
            "step": PLACE_STEP,
            "x": _differences(blocks.x - origin[0], PLACE_STEP),
            "y": _differences(blocks.y - origin[1], PLACE_STEP),
            "h": _differences(blocks.h, 1e-3),
            "by": _differences(blocks.by.astype(np.float64), 1.0),
        },
        "states": _states(run),
        "events": _events(run),
        "curves": _curves(run),
        "roadmap": roadmap(run.plan, run.network, _window(run), origin, starts_of(recording)),
        "focus": run.focus[1],
    }


def _origin(run: Run) -> tuple[float, float]:
    """Return the origin of positions: that of the first entity in its first row, rounded to metres."""
    there = np.nonzero(run.recording.present)
    if not len(there[0]):
        return 0.0, 0.0
    row, entity = int(there[0][0]), int(there[1][0])
    return float(np.round(run.recording.x[row, entity])), float(np.round(run.recording.y[row, entity]))


def _differences(values: NDArray[Any], step: float) -> list[int | None]:
    """Return values as multiples of a step: each as its difference from the previous shown one, others as null.

    Shown are finite values that are not too large for a page to count.
    """
    finite = np.isfinite(values) & (np.abs(np.nan_to_num(values)) < step * LARGEST)
    whole = np.round(values[finite] / step).astype(np.int64)
    out: list[int | None] = [None] * len(values)
    for at, change in zip(np.nonzero(finite)[0].tolist(), np.diff(whole, prepend=0).tolist(), strict=True):
        out[at] = change
    return out


def _columns(run: Run, origin: tuple[float, float]) -> dict[str, Any]:
    """Return the columns by name: unit, description, step, and a list of differences for each entity or for the run."""
    recording, declared = run.recording, {column.name: column for column in COLUMNS}
    shift = {"x": origin[0], "y": origin[1]}
    found: dict[str, Any] = {}
    for name, step in (ENTITY_STEPS | EGO_STEPS | RUN_STEPS).items():
        values = np.asarray(getattr(recording, name), np.float64)
        if declared[name].per == "entity":
            count = 1 if name in EGO_STEPS else values.shape[1]
            held = [np.where(recording.present[:, i], values[:, i], np.nan) for i in range(count)]
            if name == "h":
                held = [_unwrapped(one) for one in held]
        else:
            held = [values]
        data = [_differences(one - shift.get(name, 0.0), step) for one in held]
        found[name] = {
            "unit": unit_words(declared[name].unit),
            "description": declared[name].description,
            "step": step,
            "data": data,
        }
    return found


def _unwrapped(heading: Floats) -> Floats:
    """Return headings without jumps by a full turn."""
    finite, out = np.isfinite(heading), heading.copy()
    out[finite] = np.unwrap(heading[finite])
    return out


def _states(run: Run) -> list[tuple[float, float, str, str]]:
    """Return the takeover's states as (start, end, words, colour), s."""
    if run.plan.controller is None:
        return []
    return [(one.begin, one.end, WORDS[one.state], STATE_COLOURS[one.state]) for one in run.outcome.timeline]


def _events(run: Run) -> list[dict[str, Any]]:
    return [
        {
            "t": event.t,
            "words": words_of(event.kind),
            "entity": event.entity,
            "cause": words_of(event.cause),
            "message": event.message,
            "colour": MOMENT_COLOURS.get(event.kind, "") if event.kind != "collision" else "",
            "moment": event.kind in MOMENTS,
        }
        for event in run.recording.events
    ]


def _curves(run: Run) -> list[dict[str, Any]]:
    """Return the curves: title, unit, limits of the axis, levels, and series of (words, column, colour, dashed)."""
    recording = run.recording
    speed = [("speed", "v", "ego", False)]
    curves: list[dict[str, Any]] = []
    if run.plan.controller is not None:
        series = [("left", "confidence_left", "ego", False), ("right", "confidence_right", VERMILION, True)]
        if (recording.sensor_health < HEALTHY).any():
            series.append(("sensor health", "sensor_health", PURPLE, True))
        curves.append({"title": "lane confidence", "range": [0, 1], "levels": _levels(run), "series": series})
    curves.append({"title": "speed", "range": [0, None], "levels": [], "series": speed})
    distances = [
        ("to what blocks the path", "blocked_distance", "ego", False),
        ("to the lane's end", "lane_end_distance", VERMILION, True),
    ]
    distances = [one for one in distances if np.isfinite(getattr(recording, one[1])).any()]
    if distances:
        curves.append({"title": "distance", "range": [0, None], "levels": [], "series": distances})
    curves.append(
        {"title": "acceleration", "range": [None, None], "levels": [], "series": [("acceleration", "a", "ego", False)]}
    )
    if run.plan.controller is not None:
        pedals = [("throttle", "throttle", GREEN, False), ("brake", "brake", VERMILION, True)]
        curves.append({"title": "pedals", "range": [0, 1], "levels": [], "series": pedals})
        wheels = [("front wheels", "steer", "ego", False)]
        curves.append({"title": "steering", "range": [None, None], "levels": [], "series": wheels})
    return curves


def _levels(run: Run) -> list[tuple[str, float]]:
    """Return the thresholds of the lane confidence, (words, value)."""
    cause = next((one for one in run.plan.takeover.causes if one.kind == "lane_confidence"), None)
    named = ((name, getattr(cause, name, None)) for name in ("warning_below", "request_below"))
    values = run.recording.header.parameters
    return [(name.replace("_", " "), number_value(level, values)) for name, level in named if level is not None]


def roadmap(
    plan: Plan, network: Network, window: Window, origin: tuple[float, float], starts: Sequence[Pose]
) -> dict[str, Any]:
    """Return the roads in a window: lanes as outlines, marks as lines, in steps of a centimetre from an origin.

    Args:
        plan: The plan, which changes the paint.
        network: Its map.
        window: The part to show.
        origin: The origin of positions, m.
        starts: Start of each entity; empty if unknown.
    """
    size = max(window.x_max - window.x_min, window.y_max - window.y_min)
    painted = network.with_mark_quality(mark_stretches(plan))
    around = surroundings(painted, window, spacing=max(SPACING, size / 500.0))
    strips = []
    for strip in around.strips:
        half = len(strip.outline) // 2
        outline = np.concatenate([simplified(strip.outline[:half]), simplified(strip.outline[half:])])
        strips.append((_kind(strip.type, strip.drivable), _line(outline, origin)))
    marks = [
        (MARK_COLOURS.get(mark.colour, ""), "broken" in mark.type, mark.quality, _line(simplified(mark.points), origin))
        for mark in around.marks
        if mark.quality > 0.0
    ]
    beside = lines_beside(plan, network, starts) if starts else ()
    for line in (*secondary_lines(plan), *beside):
        points = _points_of(network, line)
        if len(points) > 1:
            colour = MARK_COLOURS.get(line.colour, "")
            marks.append((colour, line.broken, line.quality, _line(simplified(points), origin)))
    return {"step": PLACE_STEP, "strips": strips, "marks": marks}


def _window(run: Run) -> Window:
    """Return the part of the plane around the ego's path."""
    recording = run.recording
    there = recording.present[:, 0] if recording.present[:, :1].any() else recording.present.any(axis=1)
    x, y = (one[there, :1] if recording.present[:, :1].any() else one[there] for one in (recording.x, recording.y))
    if not np.isfinite(x).any():
        return Window(0.0, 0.0, 0.0, 0.0)
    low, high = (np.nanmin(x), np.nanmin(y)), (np.nanmax(x), np.nanmax(y))
    return Window(low[0] - MARGIN, low[1] - MARGIN, high[0] + MARGIN, high[1] + MARGIN)


def _kind(lane_type: str, drivable: bool) -> str:
    """Return the name of the page's colour for a lane."""
    if drivable:
        return "asphalt"
    return "pavement" if lane_type in PAVED else "verge"


def starts_of(recording: Recording) -> list[Pose]:
    """Return the pose of each entity in the first row; none for a recording without rows."""
    if not len(recording.t):
        return []
    columns = (recording.x, recording.y, recording.z, recording.h)
    places = np.nan_to_num(np.stack([one[0] for one in columns], axis=-1))
    return [Pose(x, y, z, h, 0.0, 0.0) for x, y, z, h in places.tolist()]


def _points_of(network: Network, line: SecondaryLine) -> Floats:
    begin, end = max(line.s_from, 0.0), min(line.s_to, network.tables.road_length[network.road_index(line.road)])
    stations = np.linspace(begin, end, max(2, int((end - begin) / SPACING) + 1)) if end > begin else ()
    return np.array([network.road_pose(line.road, float(s), line.t)[:2] for s in stations])


def _line(points: Floats, origin: tuple[float, float]) -> list[int]:
    """Return a line as integers: x and y of the first point from the origin, then of each from the previous one."""
    whole = np.round((points - np.array(origin)) / PLACE_STEP).astype(np.int64)
    steps: list[int] = np.diff(whole, axis=0, prepend=np.zeros((1, 2), np.int64)).ravel().tolist()
    return steps


def simplified(points: Floats) -> Floats:
    """Return the points of a line (k, 2) that keep it within `FLATNESS` (Ramer 1972, Douglas and Peucker 1973)."""
    kept = np.zeros(len(points), np.bool_)
    kept[[0, -1]] = True
    spans = [(0, len(points) - 1)]
    while spans:
        first, last = spans.pop()
        if last - first < 2:
            continue
        along = points[last] - points[first]
        away = points[first + 1 : last] - points[first]
        size = float(along @ along)
        share = np.zeros(len(away)) if size == 0.0 else np.clip(away @ along / size, 0.0, 1.0)
        off = np.hypot(*(away - share[:, None] * along).T)
        farthest = int(np.argmax(off))
        if off[farthest] > FLATNESS:
            middle = first + 1 + farthest
            kept[middle] = True
            spans += [(first, middle), (middle, last)]
    return np.asarray(points[kept])
