"""The conditions of a scenario as tags: roads, weather, light, traffic and the actions of others.

The tags and their tree are those of ASAM OpenLABEL 1.0.0's public ontology of scenario tags, whose ODD part follows BSI
PAS 1883, as ISO 34503 does. The standard ISO 34503 itself is not public and was not read. A tag is given only where the
plan or its map says so: a road whose map gives no type has none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import LanePosition, Network
from scenario_compiler.roads.lane_types import (
    BIKING,
    BUS,
    DRIVING,
    LANE_TYPES,
    SHOULDER,
    SIDEWALK,
    STOP,
    TRAM,
    WALKING,
    is_drivable,
)
from scenario_compiler.roads.lanes import lane_direction, lane_type
from scenario_compiler.vocabulary.actions import LaneChangeAction, SpeedAction
from scenario_compiler.vocabulary.entities import Category
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.weather import weather_numbers
from scenario_compiler.vocabulary.word import number_value


@dataclass(frozen=True)
class Term:
    """A tag of the ontology.

    Attributes:
        tag: Its name there.
        words: Its meaning.
        group: Its path in the tree, outermost first.
    """

    tag: str
    words: str
    group: tuple[str, ...]


def _terms(*group: str, **tags: str) -> list[Term]:
    return [Term(tag, words, group) for tag, words in tags.items()]


TERMS: tuple[Term, ...] = (
    *_terms("road", "type", RoadTypeMotorway="motorway", RoadTypeSlip="slip road", RoadTypeMinor="minor road"),
    *_terms(
        "road", "lanes", LaneTypeTraffic="traffic lane", LaneTypeBus="bus lane", LaneTypeCycle="cycle lane",
        LaneTypeTram="tram lane", LaneTypeEmergency="emergency lane", LaneSpecificationLaneCount="number of lanes",
        LaneSpecificationDimensions="lane width", LaneSpecificationMarking="lane markings",
        TravelDirectionRight="right-hand traffic", TravelDirectionLeft="left-hand traffic",
    ),
    *_terms(
        "road", "geometry", HorizontalStraights="straight", HorizontalCurves="curve", LongitudinalLevelPlane="level",
        LongitudinalUpSlope="up-slope", LongitudinalDownSlope="down-slope", TransverseUndivided="undivided",
        TransversePavements="pavements",
    ),
    *_terms(
        "road", "edge", EdgeLineMarkers="line markers", EdgeShoulderPavedOrGravel="shoulder",
        EdgeTemporaryLineMarkers="temporary line markers",
    ),
    *_terms("road", "surface", SurfaceConditionWet="wet", SurfaceConditionStandingWater="standing water"),
    *_terms("road", "junctions", JunctionIntersection="intersection"),
    *_terms(
        "road", "temporary structures", TemporaryStructureRoadWorks="road works",
        TemporaryStructureRoadSignage="temporary signs",
    ),
    *_terms(
        "weather", WeatherRain="rain", WeatherSnow="snow", WeatherWind="wind", ParticulatesWater="mist or fog",
        ParticulatesDust="sand and dust",
    ),
    *_terms(
        "light", IlluminationDay="day", DaySunElevation="elevation of the sun", LowLightAmbient="low ambient light",
        LowLightNight="night", IlluminationCloudiness="clouds",
    ),
    *_terms(
        "traffic", TrafficAgentDensity="background traffic", SubjectVehicleSpeed="speed of the subject vehicle",
        VehicleCar="car", VehicleVan="van", VehicleTruck="truck", VehicleBus="bus", VehicleMotorcycle="motorcycle",
        VehicleCycle="cycle", VehicleTrailer="trailer", HumanPedestrian="pedestrian", HumanCyclist="cyclist",
        HumanMotorcyclist="motorcyclist",
    ),
    *_terms(
        "behaviour of others", MotionDrive="drive", MotionWalk="walk", MotionStop="stop", MotionAccelerate="accelerate",
        MotionDecelerate="decelerate", MotionLaneChangeLeft="lane change left",
        MotionLaneChangeRight="lane change right",
    ),
)  # fmt: skip
"""The tags that are looked for, in the ontology's tree."""

NOT_LOOKED_FOR = (
    "zones, fixed and special structures (tunnels, bridges, crossings), kinds of junctions, signs along the road, "
    "kinds of surface and its damage, smoke, ash and marine particulates, connectivity, special vehicles, volume and "
    "flow of traffic"
)
"""Branches of the tree on which plans and maps here have no information."""

Tags = dict[str, tuple[tuple[str, float], ...]]
"""Tags with their values: pairs of a quantity with its unit and its value."""

REACH, STEP = 400.0, 10.0
"""Distance ahead for which the road is examined without a route, and the interval, m."""

CURVED = 1.0 / 2000.0
"""Least curvature of a curved road, 1/m. Our choice."""

SLOPE = 0.01
"""Least grade of a sloped road. Our choice."""

NOTABLE = 10.0
"""Least percentage of wind, fog and clouds that gives a tag: CARLA's clear noon has wind of 10. Our choice."""

DEEP = 50.0
"""Least percentage of puddles that counts as standing water. Our choice."""

LOW_SUN = 6.0
"""Elevation of the sun, degrees, below which daylight counts as low. Our choice."""

VEHICLES: Mapping[Category, tuple[str, ...]] = {
    "car": ("VehicleCar",),
    "van": ("VehicleVan",),
    "truck": ("VehicleTruck",),
    "bus": ("VehicleBus",),
    "motorbike": ("VehicleMotorcycle", "HumanMotorcyclist"),
    "bicycle": ("VehicleCycle", "HumanCyclist"),
    "pedestrian": ("HumanPedestrian",),
}
ROAD_TAGS = {"motorway": "RoadTypeMotorway", "townLocal": "RoadTypeMinor", "townPrivate": "RoadTypeMinor"}
LANE_TAGS = {
    DRIVING: "LaneTypeTraffic",
    BUS: "LaneTypeBus",
    BIKING: "LaneTypeCycle",
    TRAM: "LaneTypeTram",
    STOP: "LaneTypeEmergency",
    SHOULDER: "EdgeShoulderPavedOrGravel",
    SIDEWALK: "TransversePavements",
    WALKING: "TransversePavements",
}
SLIP = ("entry", "exit", "onRamp", "offRamp", "connectingRamp", "slipLane", "mwyEntry", "mwyExit")


def tags_of(plan: Plan, network: Network) -> Tags:
    """Return the tags of a scenario, in the order of `TERMS`."""
    found: Tags = {}
    for tag, values in (*_road(plan, network), *_weather(plan), *_traffic(plan), *_motions(plan)):
        found[tag] = tuple(dict.fromkeys((*found.get(tag, ()), *values)))
    return {term.tag: found[term.tag] for term in TERMS if term.tag in found}


def way(plan: Plan, network: Network) -> list[LanePosition]:
    """Return places along the route of the first entity, or ahead along its lane; none if it has no start."""
    if plan.route:
        places = []
        for leg in plan.route:
            count = max(1, math.ceil(abs(leg.s_to - leg.s_from) / STEP))
            places += [
                LanePosition(leg.road, leg.lane, leg.s_from + (leg.s_to - leg.s_from) * k / count) for k in range(count)
            ]
        return places
    pose = plan.derived.get(plan.entities[0].id) if plan.entities else None
    place = None if pose is None else next(iter(network.locate(pose.x, pose.y)), None)
    places = []
    while place is not None and len(places) <= REACH / STEP:
        places.append(place)
        place = network.next(place, STEP)
    return places


Found = Iterator[tuple[str, tuple[tuple[str, float], ...]]]


def _road(plan: Plan, network: Network) -> Found:
    places = way(plan, network)
    for road in dict.fromkeys(place.road for place in places):
        described = network.road(road)
        yield "TravelDirectionRight" if described.rule == "RHT" else "TravelDirectionLeft", ()
        if described.type in ROAD_TAGS:
            yield ROAD_TAGS[described.type], ()
        if described.junction is not None:
            yield "JunctionIntersection", ()
    for place in places:
        yield from _section(network, place)
    yield from _geometry(network, places)
    if plan.secondary_markings:
        yield "EdgeTemporaryLineMarkers", ()
    categories = {entity.vehicle.category for entity in plan.entities}
    if categories & {"cone", "barrier"}:
        yield "TemporaryStructureRoadWorks", ()
    if "sign" in categories:
        yield "TemporaryStructureRoadSignage", ()


def _section(network: Network, place: LanePosition) -> Found:
    """Yield the tags of the road at a place: its lanes, their types, and the marks of the lane."""
    n, road = network.tables, network.road_index(place.road)
    mine = lane_direction(n, road, place.lane, place.s)
    if LANE_TYPES[lane_type(n, road, place.lane, place.s)] in SLIP:
        yield "RoadTypeSlip", ()
    count = 0
    for lane in network.lanes_at(place.road, place.s):
        kind = lane_type(n, road, lane.lane, place.s)
        if kind in LANE_TAGS:
            yield LANE_TAGS[kind], ()
        if is_drivable(kind) and lane_direction(n, road, lane.lane, place.s) == mine:
            count += 1
        elif is_drivable(kind):
            yield "TransverseUndivided", ()
        if lane.lane == place.lane:
            yield "LaneSpecificationDimensions", (("width, m", round(lane.t_left - lane.t_right, 2)),)
    yield "LaneSpecificationLaneCount", (("lanes in the direction of travel", float(count)),)
    if any(mark is not None and mark.type != "none" for mark in network.marks(place.road, place.lane, place.s)):
        yield "LaneSpecificationMarking", ()
        yield "EdgeLineMarkers", ()


def _geometry(network: Network, places: list[LanePosition]) -> Found:
    poses = [network.lane_pose(place.road, place.lane, place.s) for place in places]
    for one, other in pairwise(poses):
        apart = math.dist((one.x, one.y), (other.x, other.y))
        if apart < 0.5 * STEP:
            continue
        turned = abs(math.remainder(other.heading - one.heading, 2.0 * math.pi))
        turned = min(turned, math.pi - turned) if turned > 0.5 * math.pi else turned
        yield "HorizontalCurves" if turned / apart > CURVED else "HorizontalStraights", ()
        grade = (other.z - one.z) / apart
        if abs(grade) < SLOPE:
            yield "LongitudinalLevelPlane", ()
        else:
            yield "LongitudinalUpSlope" if grade > 0.0 else "LongitudinalDownSlope", ()


def _weather(plan: Plan) -> Found:
    numbers = weather_numbers(plan.weather)
    clouds, rain, puddles, wind, _, sun, fog, _, _, wetness, *_, dust = numbers
    if sun > 0.0:
        yield "IlluminationDay", ()
        yield "DaySunElevation", (("elevation, degrees", sun),)
    if 0.0 < sun < LOW_SUN:
        yield "LowLightAmbient", ()
    if sun <= 0.0:
        yield "LowLightNight", ()
    for tag, percent, least in (
        ("IlluminationCloudiness", clouds, NOTABLE),
        ("WeatherRain", rain, 0.0),
        ("WeatherWind", wind, NOTABLE),
        ("ParticulatesWater", fog, NOTABLE),
        ("ParticulatesDust", dust, 0.0),
        ("SurfaceConditionWet", max(wetness, puddles, rain), 0.0),
        ("SurfaceConditionStandingWater", puddles, DEEP),
    ):
        if percent > least:
            yield tag, (("share of CARLA's scale, percent", percent),)


def _traffic(plan: Plan) -> Found:
    values = parameter_values(plan.parameters)
    if plan.entities:
        speed = number_value(plan.entities[0].desired_speed, values)
        yield "SubjectVehicleSpeed", (("desired speed, m/s", round(speed, 3)),)
    for entity in plan.entities[1:] if plan.controller is not None else plan.entities:
        for tag in VEHICLES.get(entity.vehicle.category, ()):
            yield tag, ()
    background = sum(entity.kind == "traffic" for entity in plan.entities)
    if background:
        yield "TrafficAgentDensity", (("vehicles", float(background)),)


def _motions(plan: Plan) -> Found:
    others = plan.entities[1:] if plan.controller is not None else plan.entities
    values = parameter_values(plan.parameters)
    for entity in others:
        if entity.kind in ("traffic", "walker") or number_value(entity.speed, values) > 0.0:
            yield "MotionWalk" if entity.vehicle.category == "pedestrian" else "MotionDrive", ()
    speeds = {entity.id: number_value(entity.speed, values) for entity in others}
    for group, event in plan.storyboard.events():
        for named in event.actions:
            yield from _motion(named.action, [speeds[one] for one in group.actors if one in speeds], values)


def _motion(action: object, speeds: list[float], values: Mapping[str, float | bool | str]) -> Found:
    """Yield the tags of an action's motion; motion relative to another entity is ignored."""
    if isinstance(action, LaneChangeAction) and speeds and action.by != 0 and not action.of:
        yield "MotionLaneChangeLeft" if action.by > 0 else "MotionLaneChangeRight", ()
    if isinstance(action, SpeedAction):
        target = number_value(action.to, values)
        for speed in speeds:
            if target == 0.0 and speed > 0.0:
                yield "MotionStop", ()
            if target != speed:
                yield "MotionDecelerate" if target < speed else "MotionAccelerate", ()
