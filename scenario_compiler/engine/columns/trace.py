"""What a run leaves in arrays: the rows of its trace, and its summary."""

from __future__ import annotations

from scenario_compiler.engine.columns.program import Program

TRACE_FIELDS = 14
"""Numbers of an entity in a trace: x y z h v a steer road lane s off throttle brake present."""

TRACE_HEAD = 8
"""Numbers of the run before them: t, takeover state, cause, two confidences, health, two distances."""

SUMMARY = (
    *("rows", "stop", "flag", "time_warning", "time_request", "time_escalation", "time_response"),
    *("time_minimum_risk", "time_standstill", "ego_collision_time", "ego_collision_with"),
)
"""What `summarise` writes for a variant, in this order."""

SUMMARY_SIZE = 11


def trace_width(program: Program) -> int:
    """Return the numbers of one row of a trace."""
    return TRACE_HEAD + TRACE_FIELDS * program.entity_count[0]
