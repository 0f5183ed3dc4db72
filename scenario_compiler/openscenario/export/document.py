"""The whole file: header, parameters, road network, entities and storyboard of a plan."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, FilePlace
from scenario_compiler.openscenario.export.entities import scenario_object
from scenario_compiler.openscenario.export.header import file_header
from scenario_compiler.openscenario.export.kept import (
    appears_by_action,
    entity_kept,
    scenario_kept,
    vehicles_kept,
)
from scenario_compiler.openscenario.export.places import goal_of, native_start
from scenario_compiler.openscenario.export.storyboard import StoryboardWriter
from scenario_compiler.openscenario.output import LOST, Output, Version
from scenario_compiler.openscenario.spelling import made
from scenario_compiler.plan.model import Entity, Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    AcquirePositionAction,
    FollowTrajectoryAction,
    SpeedAction,
    TeleportAction,
    TrajectoryTiming,
    WeatherAction,
)
from scenario_compiler.vocabulary.actions.path import Path
from scenario_compiler.vocabulary.conditions import ReachPositionCondition, SimulationTimeCondition
from scenario_compiler.vocabulary.positions import (
    AnyOfPosition,
    Polyline,
    RelativeObjectPosition,
    RoutePosition,
    Trajectory,
    TrajectoryPosition,
    Vertex,
)
from scenario_compiler.vocabulary.scenario import Scenario, parameter_values
from scenario_compiler.vocabulary.storyboard import ConditionGroup, Trigger, TriggerCondition
from scenario_compiler.vocabulary.weather import USUAL_WEATHER, Weather, weather_numbers, weather_of, weather_preset

DESTINATION_TOLERANCE = 2.0
"""Distance from the destination at which the file's stop trigger ends a run, m."""

_TRAFFIC = ("traffic", "walker")


def export_openscenario(
    plan: Plan, network: Network, road_file: str, version: Version, sink: Diagnostics, scenario: Scenario | None = None
) -> etree._Element:
    """Return a plan as the <OpenSCENARIO> element of a version; report what OpenSCENARIO cannot express.

    Args:
        plan: The plan.
        network: Its map.
        road_file: The OpenDRIVE file, as the exported file refers to it.
        version: The version.
        sink: Receives what OpenSCENARIO cannot express.
        scenario: The scenario of the plan, if available: the plan alone lacks the source of its traffic.
    """
    values = parameter_values(plan.parameters)
    export = _Export(plan, network, Output(version, sink, values), scenario)
    return export.document(road_file)


@dataclass
class _Export:
    plan: Plan
    network: Network
    output: Output
    scenario: Scenario | None

    def __post_init__(self) -> None:
        self.entities = [one for one in self.plan.entities if one.kind not in _TRAFFIC]
        self.automated = self.plan.controller is not None
        self.writer = StoryboardWriter(self.output, [one.id for one in self.plan.entities])

    def document(self, road_file: str) -> etree._Element:
        """Return the root element."""
        storyboard = self.storyboard()
        self.tell_kept()
        return made(
            "OpenSCENARIO",
            file_header(self.plan.summary or self.plan.name, self.output),
            *self.declarations(),
            made("CatalogLocations"),
            made("RoadNetwork", made("LogicFile", filepath=road_file), *self.signals()),
            self.entity_elements(),
            storyboard,
        )

    def declarations(self) -> Iterator[etree._Element]:
        """Yield the declarations of parameters and variables; before 1.2 a variable is a parameter."""
        parameters = made("ParameterDeclarations")
        for one in self.plan.parameters:
            text = self.output.text(float(one.value()), one)
            parameters.append(made("ParameterDeclaration", name=one.name, parameterType="double", value=text))
        variables = made("VariableDeclarations")
        for variable in self.plan.variables:
            kind = "int" if variable.type == "integer" and self.output.version >= (1, 2) else variable.type
            if self.output.version >= (1, 2):
                attributes = {"name": variable.name, "variableType": kind, "value": variable.value}
                variables.append(made("VariableDeclaration", **attributes))
            else:
                attributes = {"name": variable.name, "parameterType": kind, "value": variable.value}
                parameters.append(made("ParameterDeclaration", **attributes))
        yield parameters
        if len(variables):
            yield variables

    def signals(self) -> list[etree._Element]:
        """Return the traffic signal controllers, if any."""
        controllers = []
        for one in self.plan.signal_controllers:
            element = made("TrafficSignalController", name=one.name, delay=self.output.text(one.delay, one))
            if one.reference:
                element.set("reference", one.reference)
            for phase in one.phases:
                switched = self.network.model().signals_of(one.name) if phase.state else ()
                said = {**dict.fromkeys(switched, phase.state), **{s.signal: s.state for s in phase.states}}
                states = [made("TrafficSignalState", trafficSignalId=id, state=state) for id, state in said.items()]
                duration = self.output.text(phase.duration, phase)
                element.append(made("Phase", *states, name=phase.name, duration=duration))
            controllers.append(element)
        return [made("TrafficSignals", *controllers)] if controllers else []

    def entity_elements(self) -> etree._Element:
        """Return the <Entities>; the first entity's controller keeps what belongs to no entity."""
        element = made("Entities")
        for number, entity in enumerate(self.entities):
            kept = entity_kept(self.plan, entity)
            if number == 0:
                kept += (
                    scenario_kept(self.plan, self.scenario, self.own_groups())
                    if self.automated
                    else vehicles_kept(self.plan, self.scenario)
                )
                kept += self.writer.kept
            element.append(scenario_object(entity, kept, self.output))
        if not self.entities and self.writer.kept:
            message = "a scenario without entities has no place for what OpenSCENARIO cannot express"
            self.output.sink.add(LOST, message, FilePlace(self.plan.name))
        return element

    def tell_kept(self) -> None:
        """Report the parts that other programs will ignore."""
        plan = self.plan
        told = []
        if self.automated:
            what = "its automation, camera and takeover, the criteria and the road's marks"
            told.append(f"'{plan.ego.id}' keeps its speed in other programs: {what} are kept as properties")
        following = [one.id for one in self.entities if one.follow is not None]
        if following:
            told.append(f"{len(following)} vehicles keep a distance to the vehicle ahead, which is kept as properties")
        kept = self.scenario is not None
        traffic = [one for one in plan.entities if one.kind in _TRAFFIC]
        if not all(map(appears_by_action, traffic)):
            told.append("background traffic is kept as properties" if kept else "a plan's background traffic is lost")
        if any(map(appears_by_action, traffic)):
            told.append(f"the vehicles of actions on traffic are {'kept as properties' if kept else 'lost'}")
        for message in told:
            self.output.sink.add(LOST, message, FilePlace(plan.name))

    def storyboard(self) -> etree._Element:
        """Return the <Storyboard>."""
        self.add_init()
        stories = self.writer.stories(self.plan.storyboard)
        stop = self.writer.trigger(self.stop(), "StopTrigger", "stop", "")
        return made("Storyboard", made("Init", made("Actions", *self.writer.init_actions())), *stories, stop)

    def add_init(self) -> None:
        """Add the actions for start positions, speeds and weather, and those of the plan's own init."""
        self.add_weather(self.plan.weather)
        for entity in self.entities:
            if entity.start is not None:
                self.add_start(entity)
        for init in self.plan.storyboard.init:
            self.writer.add_init(init.action, init.entity)

    def add_weather(self, weather: Weather) -> None:
        """Set the whole weather at the start, unless a plan without automated vehicle has the default weather."""
        numbers = weather.model_dump(exclude={"word", "preset"})
        action = WeatherAction.model_validate({"preset": weather.preset, **numbers})
        if self.automated or weather != weather_preset(USUAL_WEATHER):
            whole = weather_of(weather_numbers(weather)).model_dump(exclude={"word"})
            self.writer.add_init(action, said=WeatherAction.model_validate(whole), for_others=self.automated)

    def add_start(self, entity: Entity) -> None:
        """Add an entity's start position, speed, destination and path."""
        place = entity.start
        if place is None:
            return
        said = native_start(self.plan, self.network, entity, self.output)
        kept = TeleportAction(position=said if isinstance(place, AnyOfPosition) else place)
        self.writer.add_init(kept.written_at(place.origin), entity.id, said=TeleportAction(position=said))
        speed = SpeedAction(to=entity.speed, shape="step")
        self.writer.add_init(speed, entity.id)
        goal = goal_of(self.plan, entity)
        if goal is not None:
            self.writer.add_init(AcquirePositionAction(position=goal), entity.id, for_others=True)
        if entity.path is not None:
            self.add_path(entity, entity.path)

    def add_path(self, entity: Entity, path: Path) -> None:
        """Write the path with which an entity begins as a trajectory from its position."""
        timed = any(point.time is not None for point in path.points)
        here = RelativeObjectPosition(entity=entity.id, dx=0.0, dy=0.0)
        first = Vertex(time=0.0 if timed else None, position=here)
        points = [one for one in path.points if not isinstance(one.position, RoutePosition | TrajectoryPosition)]
        rest = [Vertex.model_validate({"time": one.time, "position": one.position}) for one in points]
        shape = Polyline(vertices=(first, *rest))
        timing = TrajectoryTiming(domain="relative") if timed else None
        action = FollowTrajectoryAction(trajectory=Trajectory(name=f"path of {entity.id}", shape=shape), timing=timing)
        if path.speed is not None:
            self.writer.add_init(SpeedAction(to=path.speed, shape="step"), entity.id, for_others=True)
        self.writer.add_init(action, entity.id, for_others=True)

    def own_groups(self) -> int:
        """Return the number of groups of the plan's own stop trigger."""
        own = self.plan.storyboard.stop
        return 0 if own is None else len(own.groups)

    def stop(self) -> Trigger:
        """Return the stop trigger: the plan's own, its destination, and its duration."""
        own = self.plan.storyboard.stop
        more = [TriggerCondition(name="duration", condition=SimulationTimeCondition(after=self.plan.duration))]
        if self.plan.destination is not None:
            near = ReachPositionCondition(
                entity=self.plan.ego.id, tolerance=DESTINATION_TOLERANCE, position=self.plan.destination
            )
            more.append(TriggerCondition(name="destination", condition=near))
        groups = tuple(ConditionGroup(conditions=(one,)) for one in more)
        return Trigger(groups=(*(() if own is None else own.groups), *groups))
