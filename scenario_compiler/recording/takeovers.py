"""The takeovers of a run: one for each request, with its end and the time that was available.

Like measures, they are computed in two ways with the same result: from a recording and from the engine's totals.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.recording.durations import whole_steps
from scenario_compiler.recording.measures import distance_to_limit, time_to_limit
from scenario_compiler.recording.names import BY_HAND, CAUSES, EventKind
from scenario_compiler.recording.recording import Floats, Recording
from scenario_compiler.recording.resolution import Resolution, resolutions
from scenario_compiler.recording.totals import RunTotals, finite_or_none
from scenario_compiler.recording.traces import Traces
from scenario_compiler.records import Record, field
from scenario_compiler.vocabulary.horizon import HORIZON

ENDS: tuple[EventKind, ...] = ("escalation", "response", "minimum_risk", "standstill", "hand_back")
"""Events that may end a request, each by its first time before the next request."""


QUALITY = ("minimum_lane_time_to_collision", "maximum_longitudinal_acceleration", "maximum_lateral_acceleration")
DRIVEN_TOTALS = ("takeover_lane_time", "takeover_longitudinal", "takeover_lateral")
"""The engine's totals of each of `QUALITY`, in the same order."""


def _seconds(description: str) -> float | None:
    found: float | None = field(default=None, description=description, json_schema_extra={"unit": "s"})
    return found


def _acceleration(where: str) -> float | None:
    found: float | None = field(
        default=None,
        description=f"Greatest absolute acceleration {where} from the request to the next, or the first collision.",
        json_schema_extra={"unit": "m/s2"},
    )
    return found


class Takeover(Record):
    """A request and its outcome. Missing times and durations are null."""

    number: int = field(description="Number of the request in its run, from 1 on.")
    cause: str = field(description="Cause of the request.")
    resolution: Resolution = field(
        description="How the request ended; the values are those of `resolution` of the run."
    )
    request_time: float = field(description="Time of the request.", json_schema_extra={"unit": "s"})
    escalation_time: float | None = _seconds("Time of the escalation.")
    response_time: float | None = _seconds("Time of the driver's response.")
    minimum_risk_time: float | None = _seconds("Time at which the minimum-risk manoeuvre began.")
    standstill_time: float | None = _seconds("Time at which the minimum-risk manoeuvre came to a standstill.")
    hand_back_time: float | None = _seconds("Time at which control was handed back.")
    takeover_time: float | None = _seconds("Time from the request to the driver's response.")
    speed: float | None = field(
        default=None, description="Speed in the row of the request.", json_schema_extra={"unit": "m/s"}
    )
    limit_distance: float | None = field(
        default=None,
        description="Distance from the front bumper to where the path is blocked or the lane ends, in the first row "
        "behind the request.",
        json_schema_extra={"unit": "m"},
    )
    time_budget: float | None = _seconds(
        "Time until the limit is reached, as `time_budget` of the run says of the first request."
    )
    takeover_buffer: float | None = _seconds("Time budget less takeover time.")
    traffic_density: float | None = field(
        default=None,
        description="Vehicles that went the vehicle's way, as `traffic_density` of the run says of the first request.",
        json_schema_extra={"unit": "1/km"},
    )
    minimum_lane_time_to_collision: float | None = _seconds(
        "Least time to collision along the lane from the request to the next, as that of the run."
    )
    maximum_longitudinal_acceleration: float | None = _acceleration("along the heading")
    maximum_lateral_acceleration: float | None = _acceleration("across it")


def takeovers_of(recording: Recording, traces: Traces) -> tuple[Takeover, ...]:
    """Return all takeovers of a recorded run; the traces are the recording's."""
    asked = [k for k, event in enumerate(recording.events) if event.kind == "request"]
    if not asked:
        return ()
    crash = next((event.t for event in recording.events if event.kind == "collision"), math.nan)
    times: dict[EventKind, list[float]] = {kind: [] for kind in ENDS}
    rows = []
    driven = []
    for begin, end in zip(asked, [*asked[1:], len(recording.events)], strict=True):
        inside = [one for one in recording.events[begin:end] if one.cause != BY_HAND]
        for kind, found in times.items():
            found.append(next((one.t for one in inside if one.kind == kind), math.nan))
        until = recording.events[end].t if end < len(recording.events) else math.inf
        rows.append(_described(recording, recording.events[begin].t, until))
        driven.append(_driven(traces, recording.events[begin].t, until))
    causes = [recording.events[k].cause for k in asked]
    request = np.array([recording.events[k].t for k in asked])
    known = np.array([row >= 0 for row in rows])
    at = {
        name: np.where(known, getattr(recording, name)[rows], np.nan)
        for name in ("blocked_distance", "blocked_speed", "lane_end_distance", "limit_time")
    }
    at_request = np.searchsorted(recording.t, request - SAME_TIME)
    speed = recording.v[np.minimum(at_request, len(recording.t) - 1), 0]
    quality = dict(zip(QUALITY, np.array(driven).T, strict=True))
    quality["traffic_density"] = np.where(known, recording.traffic_density[rows], np.nan)
    codes = np.where(known, recording.cause[rows].astype(np.float64), np.nan)
    distance = distance_to_limit(codes, at["blocked_distance"], at["lane_end_distance"])
    ends = {kind: np.array(found) for kind, found in times.items()}
    budget = time_to_limit(codes, distance, speed, at["blocked_speed"], at["limit_time"])
    crashes = np.full(len(asked), crash)
    step = recording.header.step
    columns = _fields(causes, request, ends, crashes, speed, distance, budget, quality, step)
    rows_of_fields = zip(*columns.values(), strict=True)
    return tuple(Takeover.model_construct(**dict(zip(columns, row, strict=True))) for row in rows_of_fields)


def _driven(traces: Traces, begin: float, end: float) -> tuple[float, ...]:
    """Return the numbers named in `QUALITY` for the rows from a takeover's request to the next request."""
    rows = (traces.t >= begin - SAME_TIME) & (traces.t < end - SAME_TIME) & traces.until_collision
    time = float(np.fmin.reduce(traces.lane_time_to_collision[rows], initial=np.nan))
    v = traces.v[rows, 0]
    longitudinal = float(np.fmax.reduce(np.abs(traces.a[rows, 0]), initial=np.nan))
    lateral = float(np.fmax.reduce(np.abs(v * v * traces.curvature[rows]), initial=np.nan))
    return time if time < HORIZON else math.nan, longitudinal, lateral


def _described(recording: Recording, begin: float, end: float) -> int:
    """Return the first row with a cause after a request and before the next; -1 if there is none."""
    there = (recording.t > begin + SAME_TIME) & (recording.t < end - SAME_TIME) & (recording.cause != op.CAUSE_NONE)
    return int(np.argmax(there)) if there.any() else -1


def takeovers_of_totals(totals: RunTotals) -> list[list[tuple[Any, ...]]]:
    """Return the takeovers of each run, up to the number that the engine stores.

    Each is the values of a `Takeover`'s fields, in their order.
    """
    request = totals.of_takeovers("takeover_request")
    runs, places = np.nonzero(~np.isnan(request))
    picked = {
        name: totals.of_takeovers(f"takeover_{name}")[runs, places]
        for name in ("cause", "blocked", "blocked_speed", "lane_end", "speed", "limit_time", *ENDS)
    }
    causes = [str(CAUSES[int(code)]) for code in picked["cause"]]
    distance = distance_to_limit(picked["cause"], picked["blocked"], picked["lane_end"])
    moving = (picked["speed"], picked["blocked_speed"])
    budget = time_to_limit(picked["cause"], distance, *moving, picked["limit_time"])
    ends: dict[EventKind, Floats] = {kind: picked[kind] for kind in ENDS}
    crash = totals.times["collision"][runs]
    found: list[list[tuple[Any, ...]]] = [[] for _ in range(len(request))]
    asked = request[runs, places]
    quality = {
        name: totals.of_takeovers(column)[runs, places]
        for name, column in (*zip(QUALITY, DRIVEN_TOTALS, strict=True), ("traffic_density", "takeover_density"))
    }
    made = _fields(causes, asked, ends, crash, picked["speed"], distance, budget, quality, totals.step, places)
    for run, one in zip(runs.tolist(), zip(*made.values(), strict=True), strict=True):
        found[run].append(one)
    return found


def _fields(
    causes: list[str],
    request: Floats,
    ends: Mapping[EventKind, Floats],
    crash: Floats,
    speed: Floats,
    distance: Floats,
    until_limit: Floats,
    quality: Mapping[str, Floats],
    step: float,
    places: np.ndarray[tuple[int], np.dtype[np.intp]] | None = None,
) -> dict[str, list[Any]]:
    """Return the fields of k takeovers, in the order of `Takeover`, from arrays (k,) of their numbers."""
    answered = whole_steps(step, ends["response"] - request)
    budget = whole_steps(step, until_limit)
    numbers = {
        "request_time": request,
        **{f"{kind}_time": times for kind, times in ends.items()},
        "takeover_time": answered,
        "speed": speed,
        "limit_distance": distance,
        "time_budget": budget,
        "takeover_buffer": whole_steps(step, budget - answered),
        **quality,
    }
    none = np.full(len(request), np.nan)
    how = resolutions({"request": request, **ends, "collision": crash, "no_progress": none})
    order = np.arange(len(request)) if places is None else places
    columns: dict[str, list[Any]] = {
        "number": (order + 1).tolist(),
        "cause": causes,
        "resolution": how,
        **{name: finite_or_none(values) for name, values in numbers.items()},
    }
    return {name: columns[name] for name in Takeover.model_fields}
