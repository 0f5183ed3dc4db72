"""All actions, in the order of their numbers, and what follows from their entries."""

from __future__ import annotations

from scenario_compiler.engine.moves import (
    appearance,
    camera,
    control,
    follow_path,
    keeping_aside,
    keeping_distance,
    lane_changes,
    lane_offsets,
    places,
    routing,
    run,
    signals,
    speed_profiles,
    speeds,
    synchronizing,
    traffic,
    trajectories,
    variables,
)
from scenario_compiler.engine.moves.entry import Entry

ACTIONS: tuple[Entry, ...] = (
    *(speeds.SPEED, speeds.RELATIVE_SPEED, speed_profiles.SPEED_PROFILE),
    *(keeping_distance.KEEP_DISTANCE, synchronizing.SYNCHRONIZE),
    *(lane_changes.LANE_CHANGE, lane_changes.LANE_CHANGE_TO),
    *(lane_offsets.LANE_OFFSET, lane_offsets.LIMITED_LANE_OFFSET, keeping_aside.KEEP_LATERAL_DISTANCE),
    *(follow_path.FOLLOW_PATH, trajectories.FOLLOW_TRAJECTORY),
    *(routing.ASSIGN_ROUTE, routing.ACQUIRE_POSITION, routing.RANDOM_ROUTE),
    *(places.TELEPORT, places.ADD_ENTITY, places.DELETE_ENTITY, places.VISIBILITY),
    *(places.CONNECT_TRAILER, places.DISCONNECT_TRAILER),
    *(control.ACTIVATE_CONTROLLER, control.ASSIGN_CONTROLLER, control.OVERRIDE_CONTROLLER),
    *(appearance.LIGHT, appearance.ANIMATION),
    *(camera.SENSOR_NOISE, camera.BEGIN_FAILURE, camera.END_FAILURE),
    *(run.CHANGE_WEATHER, run.ENVIRONMENT, run.MESSAGE, run.STOP, run.COMMAND),
    *(variables.SET_VARIABLE, variables.MODIFY_VARIABLE, signals.SIGNAL_STATE, signals.SIGNAL_PHASE),
    *(traffic.TRAFFIC_SWARM, traffic.TRAFFIC_SOURCE, traffic.TRAFFIC_SINK, traffic.STOP_TRAFFIC),
)
"""Every action; its place is the number that a program has for it."""

STARTS = tuple(entry.start for entry in ACTIONS)
STEPS = tuple(entry.step for entry in ACTIONS)
HOLDS = tuple(entry.holds for entry in ACTIONS)
TOLD = tuple(1 if entry.told is not None else 0 for entry in ACTIONS)
"""By the number of an action: what starts it, what steps it, the domains that it holds, whether the log tells of it."""

NUMBERS: dict[str, int] = {tag: number for number, entry in enumerate(ACTIONS) for tag in entry.words}
"""Number of the action that a word becomes, by the word's tag."""
