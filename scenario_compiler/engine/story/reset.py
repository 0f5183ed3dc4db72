"""The state at t = 0: every column at its declared start value, then the start values of the plan."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.controllers import reset_controllers
from scenario_compiler.engine.ego.failures import reset_camera
from scenario_compiler.engine.ego.weather import reset_weather
from scenario_compiler.engine.motion.appearing import start_entity
from scenario_compiler.engine.motion.collision import prepare_boxes, update_boxes
from scenario_compiler.engine.motion.places import reset_positions
from scenario_compiler.engine.moves.signals import reset_signals
from scenario_compiler.engine.moves.variables import reset_variables
from scenario_compiler.engine.traffic.driving import prepare_traffic
from scenario_compiler.forms.declaration import put_to_start
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def reset_entities(p: Program, st: State) -> None:
    """Set which entities are present, their speeds and their guides."""
    for i in range(p.entity_count[0]):
        st.present[i] = p.entity_present[i]
        st.v[i] = p.const[p.entity_const[i] + slot.E_SPEED]
        st.last_v[i] = st.v[i]
        st.guide[i] = p.entity_guide[i]
    if p.ego[0] >= 0:
        st.target_speed[0] = p.const[p.entity_const[p.ego[0]] + slot.E_DESIRED_SPEED]


@compiled
def reset_destination(n: RoadTables, p: Program, st: State) -> None:
    """Write where the ego's destination is."""
    road = p.destination_road[0]
    if road >= 0:
        s = p.const[slot.K_DESTINATION_S]
        x, y, _, _, _, _ = lane_pose(n, road, p.destination_lane[0], s, p.const[slot.K_DESTINATION_OFFSET])
        st.destination_x[0] = x
        st.destination_y[0] = y


@compiled
def reset_columns(n: RoadTables, p: Program, st: State) -> None:
    """Set every column to its value at t = 0, before the init actions."""
    put_to_start(st)
    reset_weather(p, st)
    reset_camera(p, st)
    reset_variables(p, st)
    reset_signals(p, st)
    reset_entities(p, st)
    reset_controllers(p, st)
    for k in range(p.entity_count[0]):
        start_entity(n, p, st, k)
        if st.flag[0] != op.FAULT_NONE:
            return
    if p.traffic_count[0] > 0:
        prepare_traffic(n, p, st)
    reset_positions(n, p, st)
    reset_destination(n, p, st)
    prepare_boxes(p, st)
    update_boxes(p, st)
