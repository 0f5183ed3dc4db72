"""What measures and criteria are computed from: the arrays of one run, or of many along a leading axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Booleans, Floats, Integers, Recording

TIMED_EVENTS: tuple[EventKind, ...] = (
    "warning",
    "request",
    "escalation",
    "response",
    "minimum_risk",
    "standstill",
    "collision",
)
"""Events whose first time counts in a measure."""

SAME_TIME = 1e-6
"""Rows and events at most this far apart are of one instant, s: the rounding of summed steps."""


@dataclass(frozen=True)
class Traces:
    """Arrays with any number of leading axes for runs, written `...` here; n rows, m entities, the ego vehicle first.

    Runs of different length are padded: `t` is NaN and `present` false after a run's end.

    Attributes:
        t: (..., n), s.
        present: (..., n, m).
        x: (..., n, m), m, of the reference point; y likewise.
        y: See x.
        h: (..., n, m), rad.
        v: (..., n, m), m/s, signed along the heading.
        a: (..., n, m), m/s2.
        road: (..., n, m), index, -1 off every road.
        lane: (..., n, m), lane id, 0 off the lanes.
        s: (..., n, m), m.
        off: (..., n, m), m left of the lane's centre in the road's s direction.
        brake: (..., n, m), 0 to 1.
        cause: (..., n), code.
        confidence_left: (..., n); confidence_right likewise.
        confidence_right: See confidence_left.
        blocked_distance: (..., n), m, NaN where the path is free.
        lane_end_distance: (..., n), m, NaN where the lane goes on.
        length: (m,), m; of the entities' boxes.
        width: (m,), m.
        center: (m,), m from the reference point forward to the box's centre.
        times: First time of each kind of `TIMED_EVENTS`, (...), s, NaN when it never happened.
    """

    t: Floats
    present: Booleans
    x: Floats
    y: Floats
    h: Floats
    v: Floats
    a: Floats
    road: Integers
    lane: Integers
    s: Floats
    off: Floats
    brake: Floats
    cause: Integers
    confidence_left: Floats
    confidence_right: Floats
    blocked_distance: Floats
    lane_end_distance: Floats
    length: Floats
    width: Floats
    center: Floats
    times: Mapping[EventKind, Floats]

    def between(self, begin: Floats, end: Floats | None = None) -> Booleans:
        """Return which rows lie in [begin, end], (..., n); none where begin or a given end is NaN."""
        inside = self.t >= begin[..., None] - SAME_TIME
        return inside if end is None else inside & (self.t <= end[..., None] + SAME_TIME)

    @cached_property
    def forward(self) -> tuple[Floats, Floats]:
        """Cosine and sine of the headings, each (..., n, m)."""
        return np.cos(self.h), np.sin(self.h)

    @cached_property
    def centre_distance(self) -> Floats:
        """Distance of the boxes' centres from the ego vehicle's, m, (..., n, m - 1), NaN where one is absent."""
        c, s = self.forward
        x, y = self.x + self.center * c, self.y + self.center * s
        apart = np.hypot(x[..., 1:] - x[..., :1], y[..., 1:] - y[..., :1])
        return np.where(self.present[..., 1:], apart, np.nan)

    @property
    def until_collision(self) -> Booleans:
        """Rows up to the first collision, (..., n)."""
        crash = self.times["collision"]
        return self.t <= np.where(np.isnan(crash), np.inf, crash)[..., None] + SAME_TIME


def traces_of(plan: Plan, recording: Recording) -> Traces:
    """Return the arrays of one run, without leading axes."""
    same = (
        *("t", "present", "x", "y", "h", "v", "a", "road", "lane", "s", "off", "brake", "cause"),
        *("confidence_left", "confidence_right", "blocked_distance", "lane_end_distance"),
    )
    vehicles = [entity.vehicle for entity in plan.entities]
    return Traces(
        **{name: getattr(recording, name) for name in same},
        length=np.array([vehicle.length for vehicle in vehicles]),
        width=np.array([vehicle.width for vehicle in vehicles]),
        center=np.array([vehicle.center for vehicle in vehicles]),
        times={kind: np.asarray(_first(recording, kind)) for kind in TIMED_EVENTS},
    )


def _first(recording: Recording, kind: EventKind) -> float:
    return next((event.t for event in recording.events if event.kind == kind), float("nan"))
