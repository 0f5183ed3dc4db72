"""The arrays from which measures and criteria are computed, of one run or of many along a leading axis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.engine.measures.rows import STILL
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Booleans, Floats, Integers, Recording
from scenario_compiler.vocabulary.word import number_value

TIMED_EVENTS: tuple[EventKind, ...] = (
    "warning",
    "request",
    "escalation",
    "eyes_on",
    "hands_on",
    "response",
    "minimum_risk",
    "standstill",
    "no_progress",
    "obstruction",
    "collision",
    "outside_domain",
    "short_start",
)
"""Events whose first time is used in a measure."""


Singles: TypeAlias = NDArray[np.float32]

SINGLE = 1e-5
"""Relative slack of bounds that are computed in single precision: about 100 roundings."""

ROUNDING = 1e-4
"""Additional slack of bounds of distances, m."""


class InputLimits(NamedTuple):
    """The limits above which the driver's inputs count.

    Attributes:
        steering: Change of the steering wheel's angle, rad.
        brake: Position of the brake pedal, 0 to 1.
        steering_ratio: Angle of the steering wheel divided by that of the front wheels.
    """

    steering: float
    brake: float
    steering_ratio: float


def input_limits(plan: Plan, parameters: Mapping[str, Value]) -> InputLimits:
    """Return the limits of the driver's inputs at values of the plan's parameters."""
    said = plan.takeover.inputs
    return InputLimits(*(number_value(one, parameters) for one in (said.steering, said.brake, said.steering_ratio)))


class Seen(NamedTuple):
    """Boxes in the ego's frame, each array (m - 1, ..., n); NaN if one of the two entities is absent.

    They are only used for bounds and are in single precision, in which sines and all else are several times faster.

    Attributes:
        ahead: Distance of the box's centre ahead of the ego's reference point, m.
        left: Distance of the box's centre to the left of the ego's reference point, m.
        cos: Cosine of its heading relative to the ego's.
        sin: Sine of that heading.
        reach: Extent from its centre forwards and backwards in the ego's direction, m.
        slack: Greatest error of distances, m.
        apart: Lower bound of its distance from the ego's box, m; infinite if one of the two is absent, or above the
            other as on a bridge, or if they are coupled.
    """

    ahead: Singles
    left: Singles
    cos: Singles
    sin: Singles
    reach: Singles
    slack: Singles
    apart: Singles


@dataclass(frozen=True, eq=False, repr=False)
class Traces:
    """Arrays with any number of leading axes for runs, written `...` here; n rows, m entities, the ego vehicle first.

    Runs of different length are padded: `t` is NaN and `present` false after a run's end.

    Attributes:
        t: (..., n), s.
        present: (..., n, m).
        x: (..., n, m), m, of the reference point; y likewise.
        y: See x.
        z: See x.
        h: (..., n, m), rad.
        v: (..., n, m), m/s, signed along the heading.
        a: (..., n, m), m/s2.
        road: (..., n, m), index, -1 off every road.
        lane: (..., n, m), lane id, 0 off the lanes.
        s: (..., n, m), m.
        off: (..., n, m), m left of the lane's centre in the road's s direction.
        steer: (..., n, m), rad, of the front wheels, positive to the left.
        brake: (..., n, m), 0 to 1.
        towed_by: (..., n, m), index of the entity that tows it, -1 if none.
        takeover_state: (..., n), code.
        cause: (..., n), code.
        confidence_left: (..., n); confidence_right likewise.
        confidence_right: See confidence_left.
        blocked_distance: (..., n), m, NaN if the path is free.
        blocked_speed: (..., n), m/s, at which what blocks the path comes towards the ego.
        lane_end_distance: (..., n), m, NaN if the lane goes on.
        traffic_density: (..., n), 1/km, at the last request; 0 before.
        lane_time_to_collision: (..., n), s, along the lane at the vehicle's place in it; NaN if there is none.
        limit_time: (..., n), s, that the last request left which was not about an obstacle; NaN if there is none.
        lane_width: (..., n), m, of the ego vehicle's lane; 0 off the lanes.
        lane_heading: (..., n), rad, of the ego vehicle against its lane's direction, positive to the left.
        on_road: (..., n), on a lane for motor traffic, a shoulder or a parking lane.
        length: (m,), m; of the entities' boxes.
        width: (m,), m.
        height: (m,), m.
        center: (m,), m from the reference point forward to the box's centre.
        step: Length of a time step, s.
        inputs: What counts as the driver's input.
        times: First time of each kind of `TIMED_EVENTS`, (...), s, NaN when it never happened.
        requests: Number of takeover requests, (...).
    """

    t: Floats
    present: Booleans
    x: Floats
    y: Floats
    z: Floats
    h: Floats
    v: Floats
    a: Floats
    road: Integers
    lane: Integers
    s: Floats
    off: Floats
    steer: Floats
    brake: Floats
    towed_by: Integers
    takeover_state: Integers
    cause: Integers
    confidence_left: Floats
    confidence_right: Floats
    blocked_distance: Floats
    blocked_speed: Floats
    lane_end_distance: Floats
    limit_time: Floats
    traffic_density: Floats
    lane_time_to_collision: Floats
    lane_width: Floats
    lane_heading: Floats
    on_road: Booleans
    length: Floats
    width: Floats
    height: Floats
    center: Floats
    step: float
    inputs: InputLimits
    times: Mapping[EventKind, Floats]
    requests: Floats

    def between(self, begin: Floats, end: Floats | None = None) -> Booleans:
        """Return which rows are in [begin, end], (..., n); none if `begin` or a given `end` is NaN."""
        inside = self.t >= begin[..., None] - SAME_TIME
        return inside if end is None else inside & (self.t <= end[..., None] + SAME_TIME)

    def behind(self, begin: Floats) -> Booleans:
        """Return which rows are after a time, (..., n); none if it is NaN."""
        return self.t > begin[..., None] + SAME_TIME

    def at_response(self, values: Floats) -> Floats:
        """Return values (..., n) in the row of the response, (...): the first one from it on in which the ego is there.

        It is NaN if there is none.
        """
        there = self.between(self.times["response"]) & self.present[..., 0]
        found = np.take_along_axis(values, np.argmax(there, axis=-1)[..., None], axis=-1)[..., 0]
        return np.where(there.any(axis=-1), found, np.nan)

    @cached_property
    def driven(self) -> Booleans:
        """Rows driven by the driver who responded first, until control was handed back, (..., n).

        The row of the response is not included, because the automation commanded the motion up to it; nor are rows
        after the first collision, because nobody commands the motion any more.
        """
        with np.errstate(invalid="ignore"):
            after = self.t > self.times["response"][..., None] + SAME_TIME
        manual = np.isin(self.takeover_state, (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK))
        there = self.present[..., 0] & self.until_collision
        return np.asarray(after & np.logical_and.accumulate(manual | ~after, axis=-1) & there)

    @cached_property
    def coupled(self) -> Booleans:
        """Which entities are in one combination of trailers with the ego vehicle, (..., n, m); it is with itself."""
        front = np.broadcast_to(np.arange(self.x.shape[-1]), self.towed_by.shape)
        for _ in range(self.x.shape[-1] if (self.towed_by >= 0).any() else 0):
            by = np.take_along_axis(self.towed_by, front, axis=-1)
            front = np.where(by >= 0, by, front)
        return np.asarray(front == front[..., :1])

    @cached_property
    def turned_in_lane(self) -> tuple[Floats, Floats]:
        """Sine and cosine of the ego's heading relative to its lane's direction, each (..., n).

        An unknown heading counts as 0. They are computed with the C library, as in the engine, because numpy's differ
        in the last place.
        """
        headings = np.nan_to_num(self.lane_heading, nan=0.0).ravel().tolist()
        sines, cosines = (np.array([turn(one) for one in headings]) for turn in (math.sin, math.cos))
        return sines.reshape(self.t.shape), cosines.reshape(self.t.shape)

    @cached_property
    def seen(self) -> Seen:
        """The other entities' boxes as the ego vehicle sees them."""
        single = np.float32
        with np.errstate(over="ignore", invalid="ignore"):
            x, y, h = (np.moveaxis(each, -1, 0) for each in (self.x, self.y, self.h))
            dx, dy = (x[1:] - x[0]).astype(single), (y[1:] - y[0]).astype(single)
            h = h.astype(single)
            c, s = np.cos(h), np.sin(h)
            cos, sin = c[1:] * c[0] + s[1:] * s[0], s[1:] * c[0] - c[1:] * s[0]
            center, length, width = (self.of_others(each) for each in (self.center, self.length, self.width))
            ahead = dx * c[0] + dy * s[0] + center * cos
            left = dy * c[0] - dx * s[0] + center * sin
            along, across = single(0.5) * np.abs(cos), single(0.5) * np.abs(sin)
            reach = length * along + width * across
            front, side = single(0.5 * self.length[0]), single(0.5 * self.width[0])
            before = np.maximum(np.abs(ahead - single(self.center[0])) - (reach + front), single(0.0))
            beside = np.maximum(np.abs(left) - (length * across + width * along + side), single(0.0))
            slack = single(SINGLE) * (np.abs(ahead) + np.abs(left)) + single(ROUNDING)
            apart = np.sqrt(before * before + beside * beside) - slack
            z = np.moveaxis(self.z, -1, 0)
            out = (z[1:] - z[0] > self.height[0]) | (z[0] - z[1:] > self.of_others(self.height))
            out |= np.moveaxis(self.coupled, -1, 0)[1:]
        return Seen(ahead, left, cos, sin, reach, slack, np.where(out, np.inf, np.fmin(apart, np.inf)).astype(single))

    def of_others(self, values: Floats) -> Singles:
        """Return one number of each other entity, (m - 1, ..., 1), in single precision."""
        return values[1:].astype(np.float32).reshape(-1, *[1] * self.t.ndim)

    @cached_property
    def curvature(self) -> Floats:
        """The curvature of the ego's motion, 1/m, positive to the left, (..., n).

        It is the change of heading since the row before, divided by the way, which the speed of the later row gives:
        a step first changes the speed, then the place. It is 0 at a standstill and NaN in the first row.
        """
        turned = np.diff(self.h[..., 0], axis=-1)
        turned -= (2 * np.pi) * (turned >= np.pi)
        turned += (2 * np.pi) * (turned < -np.pi)
        v = self.v[..., 1:, 0]
        moving = (np.abs(v) > STILL) & np.isfinite(turned)
        way = np.where(moving, v * np.diff(self.t, axis=-1), 1.0)
        curvature = np.where(moving, turned / way, 0.0)
        return np.concatenate([np.full_like(self.t[..., :1], np.nan), curvature], axis=-1)

    @property
    def since_request(self) -> Booleans:
        """Rows from the first request to the end or the first collision, (..., n)."""
        return self.between(self.times["request"]) & self.until_collision

    @property
    def last_time(self) -> Floats:
        """Time of each run's last row, s, (...); 0 if there is none."""
        return np.asarray(np.fmax.reduce(self.t, axis=-1, initial=0.0))

    @property
    def until_collision(self) -> Booleans:
        """Rows up to the first collision, (..., n)."""
        crash = self.times["collision"]
        return self.t <= np.where(np.isnan(crash), np.inf, crash)[..., None] + SAME_TIME


def traces_of(plan: Plan, recording: Recording) -> Traces:
    """Return the arrays of one run, without leading axes."""
    same = (
        *("t", "present", "x", "y", "z", "h", "v", "a", "road", "lane", "s", "off", "steer", "brake"),
        *("towed_by", "takeover_state", "cause"),
        *("confidence_left", "confidence_right", "blocked_distance", "blocked_speed", "lane_end_distance"),
        *("limit_time", "traffic_density", "lane_time_to_collision", "lane_width", "lane_heading", "on_road"),
    )
    vehicles = [entity.vehicle for entity in plan.entities]
    return Traces(
        **{name: getattr(recording, name) for name in same},
        length=np.array([vehicle.length for vehicle in vehicles]),
        width=np.array([vehicle.width for vehicle in vehicles]),
        height=np.array([vehicle.height for vehicle in vehicles]),
        center=np.array([vehicle.center for vehicle in vehicles]),
        step=plan.step,
        inputs=input_limits(plan, recording.header.parameters),
        times={kind: np.asarray(_first(recording, kind)) for kind in TIMED_EVENTS},
        requests=np.asarray(float(sum(event.kind == "request" for event in recording.events))),
    )


def _first(recording: Recording, kind: EventKind) -> float:
    return next((event.t for event in recording.events if event.kind == kind), float("nan"))
