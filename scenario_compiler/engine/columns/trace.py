"""The quantities in a row of a trace."""

from __future__ import annotations

from scenario_compiler.engine.columns.program import Program

TRACE_FIELDS = 14
"""Numbers of an entity in a trace: x y z h v a steer road lane s off throttle brake present."""

TRACE_HEAD = 8
"""Numbers of the run before them: t, takeover state, cause, two confidences, health, two distances."""


def trace_width(program: Program) -> int:
    """Return the numbers of one row of a trace."""
    return TRACE_HEAD + TRACE_FIELDS * program.entity_count[0]
