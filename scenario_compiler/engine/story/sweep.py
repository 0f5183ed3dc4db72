"""Runs of many variants of a plan in one call, each given by a row of numbers and a row of draws.

All arrays are flat: `rows` holds the numbers of `Program.const` for each variant, `draws` DRAWS_PER_RUN numbers for
each; `out` receives SUMMARY_SIZE numbers for each variant, and `trace` the rows of its run.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import SUMMARY, SUMMARY_SIZE, TAKEOVERS_AT, Totals
from scenario_compiler.engine.columns.trace import TRACE_FIELDS, TRACE_HEAD
from scenario_compiler.engine.measures.judging import finish_totals, judge_row
from scenario_compiler.engine.measures.rows import take_row
from scenario_compiler.engine.measures.takeovers import write_takeovers
from scenario_compiler.engine.story.step import begin_step, end_step, move_step, reset
from scenario_compiler.forms.declaration import put_to_start, write_first
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def trace_row(p: Program, st: State, trace: list[float], base: int) -> int:
    """Write the present row into a trace at index `base`; return the index of the next one."""
    trace[base] = st.clock[0]
    trace[base + 1] = 1.0 * st.takeover_state[0]
    trace[base + 2] = 1.0 * st.cause[0]
    trace[base + 3] = st.conf_left[0]
    trace[base + 4] = st.conf_right[0]
    trace[base + 5] = st.health[0]
    trace[base + 6] = st.blocked_distance[0]
    trace[base + 7] = st.lane_end_distance[0]
    at = base + TRACE_HEAD
    for i in range(p.entity_count[0]):
        trace[at] = st.x[i]
        trace[at + 1] = st.y[i]
        trace[at + 2] = st.z[i]
        trace[at + 3] = st.h[i]
        trace[at + 4] = st.v[i]
        trace[at + 5] = st.a[i]
        trace[at + 6] = st.steer[i]
        trace[at + 7] = 1.0 * st.road[i]
        trace[at + 8] = 1.0 * st.lane[i]
        trace[at + 9] = st.s[i]
        trace[at + 10] = st.off[i]
        trace[at + 11] = st.throttle[i]
        trace[at + 12] = st.brake[i]
        trace[at + 13] = 1.0 * st.present[i]
        at = at + TRACE_FIELDS
    return at


@compiled
def run_variant(
    n: RoadTables, p: Program, st: State, m: Totals, limit: int, trace: list[float], base: int, every: int
) -> None:
    """Run a variant from reset to stop, at most `limit` steps, and compute its totals.

    If `every` is positive, each such row is written to the trace from index `base`, as long as there is room.
    """
    reset(n, p, st)
    put_to_start(m)
    take_row(p, st, m)
    at = base
    size = TRACE_HEAD + TRACE_FIELDS * p.entity_count[0]
    if every > 0 and at + size <= len(trace):
        at = trace_row(p, st, trace, at)
    while st.stop[0] == op.STOP_NONE and m.rows[0] <= limit and begin_step(n, p, st) == 1:
        judge_row(p, st, m)
        move_step(n, p, st)
        end_step(n, p, st)
        if every > 0 and m.rows[0] % every == 0 and at + size <= len(trace):
            at = trace_row(p, st, trace, at)
        take_row(p, st, m)
    finish_totals(p, st, m)


@compiled
def sweep(
    n: RoadTables,
    p: Program,
    st: State,
    m: Totals,
    count: int,
    rows: list[float],
    draws: list[float],
    limit: int,
    trace: list[float],
    stride: int,
    every: int,
    out: list[float],
) -> None:
    """Run `count` variants.

    The trace of variant k starts at k * stride, with a row every `every` steps (0: none); its summary starts at k *
    SUMMARY_SIZE.
    """
    width = len(p.const)
    for k in range(count):
        for q in range(width):
            p.const[q] = rows[k * width + q]
        for q in range(op.DRAWS_PER_RUN):
            st.draw[q] = draws[k * op.DRAWS_PER_RUN + q]
        run_variant(n, p, st, m, limit, trace, k * stride, every)
        write_first(m, SUMMARY, out, k * SUMMARY_SIZE)
        write_takeovers(m, out, k * SUMMARY_SIZE + TAKEOVERS_AT)
