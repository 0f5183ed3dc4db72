"""The driver's inputs after the response, as measured on the trace: the operational definitions of takeover time."""

from __future__ import annotations

import numpy as np

from scenario_compiler.recording.durations import after_request
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces


def steering_time(traces: Traces) -> Floats:
    """Time from the request to the driver's first steering after the response, s, (...)."""
    steer = traces.steer[..., 0]
    turned = np.abs(steer - traces.at_response(steer)[..., None]) * traces.inputs.steering_ratio
    return _first_after(traces, traces.driven & (turned > traces.inputs.steering))


def braking_time(traces: Traces) -> Floats:
    """Time from the request to the driver's first braking after the response, s, (...)."""
    return _first_after(traces, traces.driven & (traces.brake[..., 0] > traces.inputs.brake))


def input_time(traces: Traces) -> Floats:
    """Time from the request to the first of both, s, (...)."""
    return np.asarray(np.fmin(steering_time(traces), braking_time(traces)))


def steering_total(totals: RunTotals) -> Floats:
    """The same as `steering_time`, (runs,)."""
    return after_request(totals, totals.column("time_steered"))


def braking_total(totals: RunTotals) -> Floats:
    """The same as `braking_time`, (runs,)."""
    return after_request(totals, totals.column("time_braked"))


def input_total(totals: RunTotals) -> Floats:
    """The same as `input_time`, (runs,)."""
    return np.asarray(np.fmin(steering_total(totals), braking_total(totals)))


def _first_after(traces: Traces, where: Booleans) -> Floats:
    return after_request(traces, np.fmin.reduce(np.where(where, traces.t, np.nan), axis=-1, initial=np.nan))
