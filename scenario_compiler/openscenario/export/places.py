"""The starts and targets of a plan's entities, as positions of the standard."""

from __future__ import annotations

from scenario_compiler.diagnostics import FilePlace
from scenario_compiler.expressions import Expression, parse_expression
from scenario_compiler.openscenario.output import LOST, Output
from scenario_compiler.openscenario.positions import POSITIONS
from scenario_compiler.plan.binding import travel_direction
from scenario_compiler.plan.model import Entity, Plan
from scenario_compiler.roads import LanePosition, Network
from scenario_compiler.vocabulary.positions import (
    FreePosition,
    LanePositionWord,
    LanesAwayPosition,
    Position,
    RelativeLanePosition,
)
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.traversal import parameters_in
from scenario_compiler.vocabulary.word import Number, number_value

SEED = 1
"""Seed of the random positions that are written; each run draws its own."""


def native_start(plan: Plan, network: Network, entity: Entity, output: Output) -> Position:
    """Return an entity's start as a position of the standard; report a random start, of which one draw is written."""
    start = entity.start
    if start is not None and type(start) in POSITIONS.by_word:
        return start  # type: ignore[return-value]  # every position that is said is one
    if isinstance(start, RelativeLanePosition) and parameters_in(start):
        ahead = _ahead(plan, network, start)
        if ahead is not None:
            return ahead
    pose = plan.derived.get(entity.id)
    if pose is not None:
        if start is not None and parameters_in(start):
            message = f"the start of '{entity.id}' is written for the parameters' present values"
            output.sink.add(LOST, message, start.origin)
        return FreePosition(x=pose.x, y=pose.y, z=pose.z, heading=pose.heading)
    message = f"the start of '{entity.id}' is random in each run; the file has the one for seed {SEED}"
    output.sink.add(LOST, message, FilePlace(plan.name) if start is None else start.origin)
    return _drawn(plan, network, entity.id)


def _ahead(plan: Plan, network: Network, start: RelativeLanePosition) -> LanesAwayPosition | None:
    """Return a start ahead of an entity in the standard's terms; None if its direction is not known."""
    other = next((one.start for one in plan.entities if one.id == start.entity), None)
    if not isinstance(other, LanePositionWord):
        return None
    s = number_value(other.s, parameter_values(plan.parameters))
    along = travel_direction(network, LanePosition(other.road, other.lane, s))
    return LanesAwayPosition(
        entity=start.entity,
        lanes=start.lanes * along,
        distance=start.distance,
        along="lane",
        offset=_times(start.offset, along),
        turn=start.turn,
    )


def _times(number: Number, sign: int) -> Number:
    if sign > 0:
        return number
    return parse_expression(f"-({number.text})") if isinstance(number, Expression) else -number


def _drawn(plan: Plan, network: Network, entity: str) -> FreePosition:
    from scenario_compiler.engine.columns.state import make_draws, new_state
    from scenario_compiler.engine.program import build_program
    from scenario_compiler.engine.story.step import reset

    try:
        program = build_program(plan, network)
    except ValueError:
        return FreePosition(x=0.0, y=0.0)
    state = new_state(program)
    state.draw[:] = make_draws(SEED)
    reset(network.tables, program, state)
    k = [one.id for one in plan.entities].index(entity)
    return FreePosition(x=state.x[k], y=state.y[k], z=state.z[k], heading=state.h[k])


def goal_of(plan: Plan, entity: Entity) -> LanePositionWord | None:
    """Return the destination of an entity, or None."""
    if entity.kind == "ego":
        return plan.destination
    if not entity.route:
        return None
    last = entity.route[-1]
    return LanePositionWord(road=last.road, lane=last.lane, s=last.s_to)
