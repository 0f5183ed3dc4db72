"""Small OpenSCENARIO files on a straight road, run in both forms of the engine, and what the rows say.

The road goes along x: lanes -1, -2, -3 to the right (centres at y = -1.75, -5.25, -8.75), 1 and 2 to the left. From
x = 1000 on it climbs by 0.1. Lane -3 narrows to nothing between x = 700 and 750.

In against.xodr, road 1 goes along x as far as x = 300, where road 2 begins, whose s runs against x.
In bend.xodr, the road begins along x and is an arc to the left with a radius of 50 m, two lanes on either side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns.opcodes import FAULT_NONE
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Simulation

STEP = 0.05
ROADS = Path(__file__).parent

STEPWISE = 'dynamicsShape="step" dynamicsDimension="time" value="0"'
"""Dynamics of a change that is made at once."""


@dataclass(frozen=True)
class Actor:
    """Where an entity begins.

    Attributes:
        lane: Its lane; traffic in lanes above 0 goes against x.
        s: Its distance along the road, m.
        speed: Its speed, m/s.
        offset: Its offset from the lane's centre, m.
        position: A position in place of lane, s and offset.
        action: An action of the init after its position and before its speed.
    """

    lane: int = -1
    s: float = 50.0
    speed: float = 10.0
    offset: float = 0.0
    position: str = ""
    action: str = ""

    def init(self, name: str) -> str:
        """Return its actions of the init."""
        place = self.position or lane_position(self.lane, self.s, self.offset)
        actions = [f"<TeleportAction>{place}</TeleportAction>", self.action, speed(self.speed, STEPWISE)]
        private = "".join(f"<PrivateAction>{one}</PrivateAction>" for one in actions if one)
        return f'<Private entityRef="{name}">{private}</Private>'


@dataclass(frozen=True)
class Event:
    """An event of the story, in a group and maneuver of its own unless `maneuver` names one.

    Attributes:
        actor: Who acts; empty where the triggering entities do.
        action: What is done, as the content of a PrivateAction.
        trigger: When: a time, or conditions as elements.
        name: Name of the event.
        maneuver: Name of its maneuver.
        priority: Its priority.
        count: How often it may be executed.
    """

    actor: str
    action: str
    trigger: float | str = 1.0
    name: str = "event"
    maneuver: str = ""
    priority: str = "parallel"
    count: int = 1

    def text(self) -> str:
        """Return the element."""
        start = after(self.trigger) if isinstance(self.trigger, float | int) else self.trigger
        groups = start if "<ConditionGroup>" in start else f"<ConditionGroup>{start}</ConditionGroup>"
        action = (
            self.action if self.action.startswith("<GlobalAction") else f"<PrivateAction>{self.action}</PrivateAction>"
        )
        return (
            f'<Event name="{self.name}" priority="{self.priority}" maximumExecutionCount="{self.count}">'
            f'<Action name="of {self.name}">{action}</Action><StartTrigger>{groups}</StartTrigger></Event>'
        )


@dataclass(frozen=True)
class Seen:
    """An entity in one row: SI units, heading in rad."""

    x: float
    y: float
    h: float
    v: float
    pitch: float
    lane: int


class Played:
    """A run: the rows of each entity."""

    def __init__(self, rows: Sequence[dict[str, Seen]]) -> None:
        self.rows = rows

    def at(self, name: str, time: float) -> Seen:
        """Return the row of an entity at a time."""
        return self.rows[round(time / STEP)][name]

    def acts(self, name: str, speed: float) -> float | None:
        """Return the time of the first row in which an entity has a speed, None if it never has."""
        times = (k * STEP for k, row in enumerate(self.rows) if name in row and abs(row[name].v - speed) < 1e-6)
        return next((round(time, 6) for time in times), None)


def play(
    folder: Path,
    actors: dict[str, Actor],
    events: Sequence[Event],
    seconds: float = 10.0,
    signals: str = "",
    road: str = "straight",
) -> Played:
    """Run a story in both forms, which must leave the same numbers, and return its rows.

    Args:
        folder: Where the file is written.
        actors: The entities by name.
        events: What they do.
        seconds: How long, s.
        signals: Controllers of traffic signals, as elements.
        road: Name of the road file beside this module.
    """
    return play_text(folder, document(actors, events, seconds, signals, road), seconds)


def play_text(folder: Path, text: str, seconds: float) -> Played:
    """Run the text of a file in both forms, which must leave the same numbers, for a time in s; return its rows."""
    file = folder / "told.xosc"
    file.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    done = compile_target(file, {}, sink, overrides=Overrides(perception="ideal", step=STEP, duration=seconds))
    assert done is not None, [as_text(one) for one in sink]
    program = build_program(done.plan, done.network)
    forms = [Simulation(done.network.tables, program, interpreted=one) for one in (True, False)]
    for one in forms:
        one.reset(make_draws(1, 0))
    rows = []
    while True:
        slow, fast = (seen_by(one, [entity.id for entity in done.plan.entities]) for one in forms)
        assert slow == fast
        rows.append(slow)
        if not all([one.step() for one in forms]):
            break
    assert forms[0].state.flag[0] == FAULT_NONE
    return Played(rows)


def seen_by(simulation: Simulation, names: Sequence[str]) -> dict[str, Seen]:
    """Return the present entities of a row."""
    st = simulation.state
    return {
        name: Seen(st.x[i], st.y[i], st.h[i], st.v[i], st.pitch[i], st.lane[i])
        for i, name in enumerate(names)
        if st.present[i]
    }


def document(
    actors: dict[str, Actor], events: Sequence[Event], seconds: float, signals: str = "", road: str = "straight"
) -> str:
    """Return the file of a story."""
    groups: dict[str, list[Event]] = {}
    for k, one in enumerate(events):
        groups.setdefault(one.maneuver or f"maneuver {k}", []).append(one)
    story = "".join(
        f'<ManeuverGroup name="{name}" maximumExecutionCount="1">{_actors(of[0].actor)}<Maneuver name="{name}">'
        + "".join(one.text() for one in of)
        + "</Maneuver></ManeuverGroup>"
        for name, of in groups.items()
    )
    return (
        "<OpenSCENARIO>"
        f'<FileHeader revMajor="1" revMinor="3" date="2026-01-01T00:00:00" description="" author=""/>'
        f'<CatalogLocations/><RoadNetwork><LogicFile filepath="{ROADS / f"{road}.xodr"}"/>{signals}</RoadNetwork>'
        f"<Entities>{''.join(map(_object, actors))}</Entities>"
        f"<Storyboard><Init><Actions>{''.join(one.init(name) for name, one in actors.items())}</Actions></Init>"
        f'<Story name="story"><Act name="act">{story}<StartTrigger><ConditionGroup>{after(0.0)}</ConditionGroup>'
        f"</StartTrigger></Act></Story><StopTrigger><ConditionGroup>{after(seconds)}</ConditionGroup></StopTrigger>"
        "</Storyboard></OpenSCENARIO>"
    )


def _actors(name: str) -> str:
    if not name:
        return '<Actors selectTriggeringEntities="true"/>'
    return f'<Actors selectTriggeringEntities="false"><EntityRef entityRef="{name}"/></Actors>'


def _object(name: str) -> str:
    return (
        f'<ScenarioObject name="{name}"><Vehicle name="{name}" vehicleCategory="car">'
        '<BoundingBox><Center x="1.5" y="0" z="0.75"/><Dimensions width="2" length="5" height="1.5"/></BoundingBox>'
        '<Performance maxSpeed="70" maxAcceleration="10" maxDeceleration="10"/><Axles>'
        '<FrontAxle maxSteering="0.5" wheelDiameter="0.8" trackWidth="1.7" positionX="3" positionZ="0.4"/>'
        '<RearAxle maxSteering="0" wheelDiameter="0.8" trackWidth="1.7" positionX="0" positionZ="0.4"/></Axles>'
        "<Properties/></Vehicle></ScenarioObject>"
    )


def lane_position(lane: int, s: float, offset: float = 0.0, tag: str = "Position") -> str:
    """Return a position in a lane, in an element of a tag."""
    return f'<{tag}><LanePosition roadId="1" laneId="{lane}" s="{s}" offset="{offset}"/></{tag}>'


def condition(inner: str, edge: str = "none", delay: float = 0.0) -> str:
    """Return a condition by value."""
    return (
        f'<Condition name="c" conditionEdge="{edge}" delay="{delay}"><ByValueCondition>{inner}</ByValueCondition>'
        "</Condition>"
    )


def after(time: float, edge: str = "none", delay: float = 0.0) -> str:
    """Return the condition that a time has come."""
    return condition(f'<SimulationTimeCondition value="{time}" rule="greaterOrEqual"/>', edge, delay)


def of_entity(names: str, inner: str, rule: str = "any", edge: str = "none", delay: float = 0.0) -> str:
    """Return a condition on entities, whose names are parted by blanks."""
    entities = "".join(f'<EntityRef entityRef="{name}"/>' for name in names.split())
    return (
        f'<Condition name="c" conditionEdge="{edge}" delay="{delay}"><ByEntityCondition><TriggeringEntities '
        f'triggeringEntitiesRule="{rule}">{entities}</TriggeringEntities><EntityCondition>{inner}</EntityCondition>'
        "</ByEntityCondition></Condition>"
    )


def speed(value: float, dynamics: str = STEPWISE) -> str:
    """Return a change to a speed."""
    return _speed(f'<AbsoluteTargetSpeed value="{value}"/>', dynamics)


def relative_speed(to: str, value: float, dynamics: str, kind: str = "delta", continuous: str = "false") -> str:
    """Return a change to a speed that depends on another entity's."""
    more = f'speedTargetValueType="{kind}" continuous="{continuous}"'
    return _speed(f'<RelativeTargetSpeed entityRef="{to}" value="{value}" {more}/>', dynamics)


def _speed(target: str, dynamics: str) -> str:
    return (
        f"<LongitudinalAction><SpeedAction><SpeedActionDynamics {dynamics}/><SpeedActionTarget>{target}"
        "</SpeedActionTarget></SpeedAction></LongitudinalAction>"
    )


def by(shape: str, dimension: str, value: float) -> str:
    """Return the attributes of dynamics."""
    return f'dynamicsShape="{shape}" dynamicsDimension="{dimension}" value="{value}"'


def lane_change(target: str, dynamics: str, offset: float = 0.0) -> str:
    """Return a change of lane."""
    return (
        f'<LateralAction><LaneChangeAction targetLaneOffset="{offset}"><LaneChangeActionDynamics {dynamics}/>'
        f"<LaneChangeTarget>{target}</LaneChangeTarget></LaneChangeAction></LateralAction>"
    )


def lane_offset(target: str, shape: str = "sinusoidal", most: float | None = 2.0, continuous: str = "false") -> str:
    """Return a move to an offset from the lane's centre."""
    limit = "" if most is None else f' maxLateralAcc="{most}"'
    return (
        f'<LateralAction><LaneOffsetAction continuous="{continuous}"><LaneOffsetActionDynamics dynamicsShape="{shape}"'
        f"{limit}/><LaneOffsetTarget>{target}</LaneOffsetTarget></LaneOffsetAction></LateralAction>"
    )
