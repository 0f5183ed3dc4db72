"""Measures of a run: each is declared once in `MEASURES`, with its definition, unit and source.

A measure is computed in two ways with the same result: from `Traces`, the arrays of recordings with any leading axes
for runs, and from `RunTotals`, which the engine adds up during the run. Both return one number per run, NaN if the
measure is not defined. Rows after the first collision do not change a measure, except the final speed. Every file that
contains the number also contains its definition.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from scenario_compiler.engine.columns.opcodes import CAUSE_LANE_ENDS, CAUSE_NONE, CAUSE_PATH_BLOCKED
from scenario_compiler.engine.measures.encroachment import APART, LONGEST
from scenario_compiler.engine.measures.lane_keeping import BAND, SETTLED, SETTLING, WINDOW
from scenario_compiler.engine.measures.reversals import cut_off
from scenario_compiler.engine.measures.rows import STILL
from scenario_compiler.engine.measures.takeover import BRAKING
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.boxes import least_box_distance
from scenario_compiler.recording.durations import Timed, after_request, whole_steps
from scenario_compiler.recording.encroachment import least_encroachment, least_encroachment_total
from scenario_compiler.recording.in_lane import (
    deepest_departure,
    first_departure,
    heading_error_at_response,
    lane_departures,
    lane_departures_total,
    least_time_to_crossing,
    longest_departure,
    longest_departure_total,
    mean_time_to_crossing,
    mean_time_to_crossing_total,
    time_off_road,
    time_off_road_total,
)
from scenario_compiler.recording.inputs import (
    braking_time,
    braking_total,
    input_time,
    input_total,
    steering_time,
    steering_total,
)
from scenario_compiler.recording.lateral import (
    lane_position_deviation,
    lateral_offset_at_response,
    maximum_lateral_offset,
    settled_deviation,
    stabilisation_time,
    stabilisation_time_total,
    time_off_lanes,
    time_off_lanes_total,
)
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.on_path import (
    STEEPEST,
    drac_of_room,
    greatest_drac,
    least_headway,
    least_time_to_collision,
)
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.reversals import (
    COARSE,
    FINE,
    LEAST,
    coarse_rate,
    coarse_total,
    fine_rate,
    fine_total,
)
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces
from scenario_compiler.vocabulary.horizon import HORIZON


class Measure(NamedTuple):
    """A measure.

    Attributes:
        name: Key in outcome.json.
        unit: SI unit.
        definition: How it is computed.
        undefined: When it has no value.
        compute: Function from Traces (...) to an array (...).
        total: The same measure, computed from RunTotals.
        source: Source of the definition; empty for our own.
        of_takeover: Whether it concerns the takeover, so that a run without an automated vehicle does not have it.
        whole: Whether its values are whole numbers.
    """

    name: str
    unit: str
    definition: str
    undefined: str
    compute: Callable[[Traces], Floats]
    total: Callable[[RunTotals], Floats]
    source: str = ""
    of_takeover: bool = True
    whole: bool = False


def total(name: str) -> Callable[[RunTotals], Floats]:
    """Return a function that reads a measure from a column of the engine's totals."""

    def of_runs(totals: RunTotals) -> Floats:
        return totals.column(name)

    return of_runs


def takeover_time(runs: Timed) -> Floats:
    """Time from the request to the driver's response."""
    return after_request(runs, runs.times["response"])


def eyes_on_time(runs: Timed) -> Floats:
    """Time from the request until the driver's eyes are on the road."""
    return after_request(runs, runs.times["eyes_on"])


def hands_on_time(runs: Timed) -> Floats:
    """Time from the request until the driver's hands are on the wheel."""
    return after_request(runs, runs.times["hands_on"])


def first_brake_time(traces: Traces) -> Floats:
    """Time from the request to the driver's first braking."""
    braking = traces.driven & (traces.brake[..., 0] > BRAKING)
    return after_request(traces, np.fmin.reduce(np.where(braking, traces.t, np.nan), axis=-1, initial=np.nan))


def _first_brake_total(totals: RunTotals) -> Floats:
    return after_request(totals, totals.column("time_first_brake"))


def limit_distance(traces: Traces) -> Floats:
    """Distance at the request to the place that caused it."""
    return distance_to_limit(
        cause_of_request(traces),
        _at_request(traces, traces.blocked_distance),
        _at_request(traces, traces.lane_end_distance),
    )


def _limit_distance_total(totals: RunTotals) -> Floats:
    return distance_to_limit(
        totals.column("request_cause"), totals.column("request_blocked"), totals.column("request_lane_end")
    )


def distance_to_limit(cause: Floats, blocked: Floats, ends: Floats) -> Floats:
    """Return the distance to the place that caused a request, m, by the code of the cause; NaN for other causes."""
    return np.where(cause == CAUSE_PATH_BLOCKED, blocked, np.where(cause == CAUSE_LANE_ENDS, ends, np.nan))


def cause_of_request(traces: Traces) -> Floats:
    """Code of the cause of the first request, NaN if there is none."""
    return _at_request(traces, traces.cause.astype(np.float64))


def time_budget(traces: Traces) -> Floats:
    """Time at the request until the limit is reached at unchanged speed."""
    towards, left = (_at_request(traces, values) for values in (traces.blocked_speed, traces.limit_time))
    cause, distance = cause_of_request(traces), limit_distance(traces)
    return whole_steps(traces.step, time_to_limit(cause, distance, _speed_at_request(traces), towards, left))


def _time_budget_total(totals: RunTotals) -> Floats:
    cause, speed, towards, left = (
        totals.column(f"request_{name}") for name in ("cause", "speed", "blocked_speed", "limit_time")
    )
    return whole_steps(totals.step, time_to_limit(cause, _limit_distance_total(totals), speed, towards, left))


def time_to_limit(cause: Floats, distance: Floats, speed: Floats, towards: Floats, left: Floats) -> Floats:
    """Return the time until a limit is reached at unchanged speeds, s; NaN if nothing moves.

    Args:
        cause: Code of the request's cause.
        distance: Distance to an obstacle or the lane's end, m; NaN if the request is not about one.
        speed: Speed of the vehicle, m/s.
        towards: Speed at which what blocks the path comes towards it, m/s.
        left: The time itself, s, where the request is not about an obstacle; NaN else.
    """
    closing = np.where(cause == CAUSE_PATH_BLOCKED, speed + towards, speed)
    reached = np.where(closing > 0, distance / np.where(closing > 0, closing, 1.0), np.nan)
    return np.where(np.isnan(distance), left, reached)


def request_lead(traces: Traces) -> Floats:
    """Time from the request to the event that it preceded."""
    return after_request(traces, np.fmin(first_departure(traces), traces.times["collision"]))


def _request_lead_total(totals: RunTotals) -> Floats:
    return after_request(totals, np.fmin(totals.column("time_departed"), totals.times["collision"]))


def _at_request(traces: Traces, values: Floats) -> Floats:
    """Return a run's column (..., n) in the first row after the request that has a cause, NaN if there is none.

    The row at the time of the request was recorded before the request; its findings are in the rows after it.
    """
    return _in_first(traces.behind(traces.times["request"]) & (traces.cause != CAUSE_NONE), values)


def _speed_at_request(traces: Traces) -> Floats:
    return _in_first(traces.between(traces.times["request"]), traces.v[..., 0])


def _in_first(rows: Booleans, values: Floats) -> Floats:
    """Return the values (..., n) in the first of these rows, NaN if there are none."""
    row = np.argmax(rows, axis=-1)[..., None]
    return np.where(rows.any(axis=-1), np.take_along_axis(values, row, axis=-1)[..., 0], np.nan)


def takeover_buffer(traces: Traces) -> Floats:
    """Remaining time budget when the driver responds."""
    return whole_steps(traces.step, time_budget(traces) - takeover_time(traces))


def _takeover_buffer_total(totals: RunTotals) -> Floats:
    return whole_steps(totals.step, _time_budget_total(totals) - takeover_time(totals))


def minimum_time_to_collision(traces: Traces) -> Floats:
    """Least time to collision in the run."""
    return least_time_to_collision(traces)


def minimum_distance(traces: Traces) -> Floats:
    """Least distance to another entity."""
    return least_box_distance(traces)


def minimum_lane_time_to_collision(traces: Traces) -> Floats:
    """Least time to collision along the lane."""
    least = _greatest(-traces.lane_time_to_collision, traces.until_collision)
    return np.where(-least < HORIZON, -least, np.nan)


def traffic_density(traces: Traces) -> Floats:
    """Vehicles per kilometre at the first request."""
    return _at_request(traces, traces.traffic_density)


def maximum_longitudinal_acceleration(traces: Traces) -> Floats:
    """Greatest acceleration or deceleration after the request."""
    return _greatest(np.abs(traces.a[..., 0]), traces.since_request)


def maximum_lateral_acceleration(traces: Traces) -> Floats:
    """Greatest lateral acceleration after the request."""
    lateral = np.abs(traces.v[..., 0] * traces.v[..., 0] * traces.curvature)
    return _greatest(lateral, traces.since_request)


def _greatest(values: Floats, where: Booleans) -> Floats:
    return np.asarray(np.fmax.reduce(np.where(where, values, np.nan), axis=-1, initial=np.nan))


def minimum_confidence(traces: Traces) -> Floats:
    """Least lane confidence up to the first collision, each time of the better side."""
    better = np.fmax(traces.confidence_left, traces.confidence_right)
    intact = np.where(traces.until_collision, better, np.nan)
    return np.asarray(np.fmin.reduce(intact, axis=-1, initial=np.nan))


def final_speed(traces: Traces) -> Floats:
    """Speed in the last row."""
    row = np.maximum((~np.isnan(traces.t)).sum(axis=-1) - 1, 0)[..., None]
    return np.asarray(np.take_along_axis(traces.v[..., 0], row, axis=-1)[..., 0])


def collision_speed(traces: Traces) -> Floats:
    """Speed of the ego vehicle in the last row before the first collision."""
    before = traces.t < traces.times["collision"][..., None] - 1e-6
    row = np.maximum(before.sum(axis=-1) - 1, 0)[..., None]
    speed = np.take_along_axis(traces.v[..., 0], row, axis=-1)[..., 0]
    return np.where(np.isnan(traces.times["collision"]), np.nan, speed)


def _collision_speed_total(totals: RunTotals) -> Floats:
    return np.where(np.isnan(totals.times["collision"]), np.nan, totals.column("speed_before_collision"))


def requests(traces: Traces) -> Floats:
    """Number of requests of the run."""
    return np.asarray(traces.requests, dtype=np.float64)


def _requests_total(totals: RunTotals) -> Floats:
    return totals.raw("requests")


def _time_of(kind: EventKind, what: str, otherwise: str = "") -> Measure:
    def first_time(runs: Timed) -> Floats:
        return runs.times[kind]

    definition, undefined = f"Time of the first {what}.", otherwise or f"no {what}"
    return Measure(f"{kind}_time", "s", definition, undefined, first_time, first_time, of_takeover=kind != "collision")


def measures_of(plan: Plan) -> tuple[Measure, ...]:
    """Return the measures of a plan's runs: none without an entity; those of the takeover only with an ego."""
    if not plan.entities:
        return ()
    return tuple(one for one in MEASURES if plan.controller is not None or not one.of_takeover)


def _no_rate(variant: int) -> str:
    """Return when a variant of the steering reversal rate is undefined."""
    return (
        f"the driver drove for less than {LEAST:g} s, or the step is {0.5 / cut_off(variant):.3g} s or longer, so that "
        "it cannot show the filter's frequency"
    )


MEASURES: tuple[Measure, ...] = (
    Measure(
        "takeover_time",
        "s",
        "Time from the request to the driver's response, which is the first input by which the driver takes over "
        "control.",
        "there was no request, or no response to it",
        takeover_time,
        takeover_time,
    ),
    Measure(
        "eyes_on_time",
        "s",
        "Time from the request until the driver's eyes are on the road.",
        "there was no request, or the run ended, the vehicle collided or the driver never responded before that",
        eyes_on_time,
        eyes_on_time,
    ),
    Measure(
        "hands_on_time",
        "s",
        "Time from the request until the driver's hands are on the wheel.",
        "there was no request, or the run ended, the vehicle collided or the driver never responded before that",
        hands_on_time,
        hands_on_time,
    ),
    Measure(
        "steering_time",
        "s",
        "Time from the request to the first row in which the driver drives and the steering wheel has turned since "
        "the response by more than `steering` of <inputs>. The default is 2 degrees, with a steering ratio of 16.",
        "there was no response, or no steering after it",
        steering_time,
        steering_total,
        "after Gold et al. 2013, not verified",
    ),
    Measure(
        "braking_time",
        "s",
        "Time from the request to the first row in which the driver drives and the brake is pressed by more than "
        "`brake` of <inputs>. The default is 10 %.",
        "there was no response, or no braking after it",
        braking_time,
        braking_total,
        "after Gold et al. 2013, not verified",
    ),
    Measure(
        "input_time",
        "s",
        "Time from the request to the first steering or braking: the smaller of steering_time and braking_time.",
        "there was no response, or no input after it",
        input_time,
        input_total,
        "after Gold et al. 2013, not verified",
    ),
    Measure(
        "first_brake_time",
        "s",
        f"Time from the request to the first row in which the brake is pressed by more than {100 * BRAKING:g} %. Only "
        "rows in which the driver drives count, from the response until control is handed back or the first collision.",
        "there was no response, or no braking after it",
        first_brake_time,
        _first_brake_total,
    ),
    Measure(
        "time_budget",
        "s",
        "Time until a limit is reached at unchanged speed: the distance to the limit at the request, divided "
        "by the speed at that moment, to the nearest whole step. For a blocked path or the end of the lane, "
        "the limit is that place; the speed of an obstacle that comes towards the vehicle is added. For lane "
        "confidence, the limit is the place, up to 60 m ahead, from which on neither side has sufficiently "
        "visible paint; the budget is 0 if the front bumper has reached it, as at most requests for lost "
        "paint. For other causes, and where no such place is in sight, it is the time until a side of "
        "the vehicle would leave its lane at unchanged speed and steering angle, if that is less than "
        f"{HORIZON:g} s.",
        "there was no request, or its limit would not be reached",
        time_budget,
        _time_budget_total,
        "lead time, Eriksson and Stanton 2017",
    ),
    Measure(
        "takeover_buffer",
        "s",
        "Time budget minus takeover time. It is negative if the driver responded after the limit would have been "
        "reached.",
        "there is no time budget or no takeover time",
        takeover_buffer,
        _takeover_buffer_total,
        "arXiv 2507.22262",
    ),
    Measure(
        "request_lead",
        "s",
        "Time from the request to the first collision, or to the first row of a lane departure after the request, "
        "whichever came first. It shows how early the request was.",
        "there was no request, or neither event followed",
        request_lead,
        _request_lead_total,
    ),
    Measure(
        "limit_distance",
        "m",
        "Distance at the request from the front bumper to the obstacle or the end of the lane, along the lane.",
        "there was no request, or it was not caused by a place ahead",
        limit_distance,
        _limit_distance_total,
    ),
    Measure(
        "traffic_density",
        "1/km",
        "Vehicles per kilometre of road at the first request that drive in the vehicle's direction at 2 m/s or more, "
        "on all lanes from 500 m behind to 500 m ahead.",
        "there was no request",
        traffic_density,
        total("request_density"),
    ),
    Measure(
        "minimum_time_to_collision",
        "s",
        "Least time to collision over the run: gap divided by closing speed, to any entity whose box overlaps "
        "the path ahead. The path is as wide as the vehicle and has the curvature that it drives at that "
        f"moment, which is known from the second row on; at {STILL:g} m/s or less it counts as straight. The gap is "
        "measured to the part of the box within the path; it is 0 while boxes overlap. Values of "
        f"{HORIZON:g} s or more are ignored.",
        f"nothing in the path would ever be reached within {HORIZON:g} s",
        minimum_time_to_collision,
        total("least_time_to_collision"),
        of_takeover=False,
    ),
    Measure(
        "minimum_lane_time_to_collision",
        "s",
        "Least time to collision along the lane: gap divided by closing speed, to any entity ahead that overlaps the "
        "vehicle's front at its lateral position in the lane, however it steers: the time to an obstacle until the "
        "front has moved aside. Only entities that the automation, or the driver who drives, sees count. It is "
        f"measured at control steps, up to the first collision. Values of {HORIZON:g} s or more are ignored.",
        f"nothing ahead would ever be reached within {HORIZON:g} s",
        minimum_lane_time_to_collision,
        total("least_lane_time"),
        "J. Adv. Transp. 2020/6173150, table 2",
    ),
    Measure(
        "minimum_time_headway",
        "s",
        "Least time gap over the run: gap divided by the vehicle's own speed, to any entity whose box "
        "overlaps the path ahead, defined as for the time to collision. It is 0 while boxes overlap. Values of "
        f"{HORIZON:g} s or more are ignored.",
        f"nothing in the path was within {HORIZON:g} s",
        least_headway,
        total("least_headway"),
        "time gap of SAE J2944, whose headway is from front to front",
        of_takeover=False,
    ),
    Measure(
        "maximum_drac",
        "m/s2",
        "Greatest value over the run of the squared closing speed divided by twice the gap, which is the "
        "constant deceleration that would just avoid a crash. It applies to any entity that would be reached "
        f"within {HORIZON:g} s, as for the time to collision. It is at most {STEEPEST:g} m/s², the value while "
        "boxes overlap.",
        "the vehicle never approached anything in the path",
        greatest_drac,
        lambda totals: drac_of_room(totals.column("least_room")),
        "deceleration rate to avoid a crash (DRAC)",
        of_takeover=False,
    ),
    Measure(
        "minimum_post_encroachment_time",
        "s",
        "Least time between the moment at which one vehicle leaves a place and the moment at which the other "
        "one reaches it, over the run, for the vehicle and any entity that has moved. It is the least time between "
        f"overlapping boxes of both, whose poses are interpolated between rows at most {APART:g} s apart, and 0 if the "
        "boxes overlap at the same time. An entity that is followed on the same way has one too: its time gap. Values "
        f"of {LONGEST:g} s or more are ignored.",
        f"no place was reached by both within {LONGEST:g} s",
        least_encroachment,
        least_encroachment_total,
        "post-encroachment time (PET), Allen, Shin and Cooper 1978",
        of_takeover=False,
    ),
    Measure(
        "minimum_distance",
        "m",
        "Least distance in the plane between the vehicle's box and another entity's box over the run; 0 when they "
        "overlap.",
        "there is no other entity",
        minimum_distance,
        total("least_distance"),
        of_takeover=False,
    ),
    Measure(
        "maximum_longitudinal_acceleration",
        "m/s2",
        "Greatest absolute acceleration along the heading from the request to the end or the first collision.",
        "there was no request",
        maximum_longitudinal_acceleration,
        total("greatest_longitudinal"),
        "J. Adv. Transp. 2020/6173150, table 2",
    ),
    Measure(
        "maximum_lateral_acceleration",
        "m/s2",
        "Greatest absolute product of squared speed and driven curvature at the rear axle from the request to the end "
        "or the first collision.",
        "there was no request",
        maximum_lateral_acceleration,
        total("greatest_lateral"),
        "J. Adv. Transp. 2020/6173150, table 2",
    ),
    Measure(
        "lane_position_deviation",
        "m",
        f"Standard deviation (n - 1) of the lateral position in the lane over the {SETTLING:g} s after the response.",
        "there was no response or there was a lane change, or the run ended, the vehicle collided or control was "
        f"handed back within {SETTLING:g} s of the response",
        lane_position_deviation,
        total("settling_deviation"),
        "standard deviation of lateral position (SDLP)",
    ),
    Measure(
        "settled_lane_position_deviation",
        "m",
        f"Standard deviation (n - 1) of the lateral position in the lane from {SETTLING:g} s to {SETTLED:g} s "
        "after the response.",
        "there was no response, a lane change in that time, or the run ended, the vehicle collided or control was "
        f"handed back within {SETTLED:g} s of the response",
        settled_deviation,
        total("settled_deviation"),
        "standard deviation of lateral position (SDLP)",
    ),
    Measure(
        "stabilisation_time",
        "s",
        "Time from the request until lane keeping is stable. From the response on, the time in which the "
        "driver drives, up to the first collision, is divided into consecutive windows of "
        f"{WINDOW:g} s. Lane keeping is stable from the start of the first window from which on the standard "
        f"deviation of the lateral position is at most {BAND:g} m in every window. A lane change counts as motion.",
        f"there was no response or no such window, or the driver drove for less than {WINDOW:g} s",
        stabilisation_time,
        stabilisation_time_total,
        "after Merat et al. 2014, whose criterion is not verified",
    ),
    Measure(
        "maximum_lateral_offset",
        "m",
        "Greatest absolute distance, from the request to the end or the first collision, of the reference point from "
        "the centre of the lane in which it was at the request. When the reference point enters another lane, it is "
        "taken to move across in that step as in the step before; from then on the centre keeps its distance from that "
        "of the present lane, also where a lane becomes wider or narrower. Rows off every lane are ignored. The "
        "criterion of the same name is about the centre of the present lane, in the whole run.",
        "there was no request",
        maximum_lateral_offset,
        total("greatest_offset_after"),
    ),
    Measure(
        "steering_reversal_rate",
        "1/min",
        "Reversals of the steering wheel per minute, of at least 3 degrees after a low-pass filter of 0.6 Hz "
        "(Butterworth, second order, forwards). Only rows in which the driver drives count, from the response until "
        "control is handed back or the first collision.",
        _no_rate(COARSE),
        coarse_rate,
        coarse_total,
        "after Markkula and Engstrom 2006, not verified",
    ),
    Measure(
        "fine_steering_reversal_rate",
        "1/min",
        "Reversals of the steering wheel per minute, as above, but of at least 0.1 degrees after a low-pass filter of "
        "2 Hz.",
        _no_rate(FINE),
        fine_rate,
        fine_total,
        "after Markkula and Engstrom 2006, not verified",
    ),
    Measure(
        "lateral_offset_at_response",
        "m",
        "Distance of the reference point to the left of the centre of the lane at the request, in the direction of "
        "travel, in the row of the response. It is negative to the right.",
        "no response",
        lateral_offset_at_response,
        total("offset_at_response"),
    ),
    Measure(
        "heading_error_at_response",
        "rad",
        "Heading of the vehicle relative to its lane's direction in the row of the response, positive to the left.",
        "no response",
        heading_error_at_response,
        total("heading_at_response"),
    ),
    Measure(
        "lane_departures",
        "1",
        "Number of lane departures. One begins when a corner of the box passes an edge of the lane that contains the "
        "reference point, or when this point leaves every lane; it ends when the box is within one lane again. A lane "
        "change counts as one. Rows after the first collision are ignored, here and in the next two measures.",
        "never",
        lane_departures,
        lane_departures_total,
        whole=True,
    ),
    Measure(
        "longest_lane_departure",
        "s",
        "Duration of the longest lane departure: its number of rows times the step.",
        "there was no lane departure",
        longest_departure,
        longest_departure_total,
    ),
    Measure(
        "deepest_lane_departure",
        "m",
        "Greatest distance of a corner of the box beyond the edge of the lane that it left, in lane departures, with "
        "the lane's width where the departure began. When the reference point enters another lane, the edge is "
        "continued as the centre is for `maximum_lateral_offset`. Rows off every lane are ignored.",
        "there was no lane departure",
        deepest_departure,
        total("deepest_departure"),
    ),
    Measure(
        "minimum_time_to_lane_crossing",
        "s",
        "Least time to line crossing over the rows from the request to the end or the first collision: the distance "
        "from the outermost corner of the box to the lane's edge, on the side to which the vehicle moves, divided by "
        "its lateral speed. The lateral speed is the speed times the sine of the heading relative to the lane. It is 0 "
        f"in a lane departure. Values of {HORIZON:g} s or more are ignored.",
        f"there was no request, or no edge would have been crossed within {HORIZON:g} s",
        least_time_to_crossing,
        total("least_crossing"),
        "time to line crossing (TLC), after SAE J2944, not verified",
    ),
    Measure(
        "mean_time_to_lane_crossing",
        "s",
        "Mean time to line crossing over the rows from the request to the end or the first collision that have one.",
        f"there was no request, or no edge would have been crossed within {HORIZON:g} s",
        mean_time_to_crossing,
        mean_time_to_crossing_total,
        "time to line crossing (TLC), after SAE J2944, not verified",
    ),
    Measure(
        "time_off_road",
        "s",
        "Time for which the reference point was off the road: off every lane, or on a lane that is neither for motor "
        "traffic nor a shoulder or parking lane. It is the number of such rows up to the first collision times the "
        "step.",
        "never",
        time_off_road,
        time_off_road_total,
    ),
    Measure(
        "time_off_lanes",
        "s",
        "Time for which the reference point was off every lane: the number of such rows up to the first collision "
        "times the step.",
        "never",
        time_off_lanes,
        time_off_lanes_total,
        of_takeover=False,
    ),
    Measure(
        "minimum_confidence",
        "1",
        "Least lane confidence of the run up to the first collision, each time of the better side.",
        "no lane confidence was recorded",
        minimum_confidence,
        total("least_confidence"),
    ),
    Measure(
        "final_speed",
        "m/s",
        "Speed in the last row of the run, also after a collision.",
        "no row",
        final_speed,
        total("row_v"),
        of_takeover=False,
    ),
    Measure(
        "collision_speed",
        "m/s",
        "Speed in the last row before the first collision.",
        "no collision",
        collision_speed,
        _collision_speed_total,
        of_takeover=False,
    ),
    Measure(
        "requests",
        "1",
        "Number of takeover requests in the run.",
        "never",
        requests,
        _requests_total,
        whole=True,
    ),
    _time_of("warning", "warning"),
    _time_of("request", "request"),
    _time_of("escalation", "escalation"),
    _time_of("response", "response"),
    _time_of("minimum_risk", "minimum-risk manoeuvre"),
    _time_of("standstill", "standstill"),
    _time_of("collision", "collision"),
    _time_of("outside_domain", "look outside the domain of surrogate perception"),
    _time_of(
        "short_start",
        "control step if the run begins within the time budget of a limit ahead",
        "the run did not begin within the time budget of a limit ahead",
    ),
)
"""All measures, in the order in which they are shown."""
