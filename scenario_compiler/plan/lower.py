"""Lowers a scenario and a network to a plan, in named passes that each do one thing.

`PASSES` lists them in order. Each pass reads the scenario, reports to the sink and fills in its part of the draft; no
pass calls another.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from scenario_compiler.diagnostics import Code, Diagnostic, Diagnostics, Severity
from scenario_compiler.expressions import Expression, Value, parse_expression
from scenario_compiler.plan.binding import NO_RANDOM_PLACE, RANDOM_HERE, Binder
from scenario_compiler.plan.checks import CHECKS
from scenario_compiler.plan.checks.routes import NO_ROUTE, NOT_IN_A_LANE
from scenario_compiler.plan.criteria import check_criteria
from scenario_compiler.plan.defaults import complete_takeover
from scenario_compiler.plan.init_order import in_order, placed_before
from scenario_compiler.plan.keeping import kept_entities
from scenario_compiler.plan.model import Entity, MapReference, Plan, PlanOrigin, RouteLeg
from scenario_compiler.plan.paint import check_paint
from scenario_compiler.plan.places import rooms_needed, spans_of
from scenario_compiler.plan.provenance import origin_at
from scenario_compiler.plan.standing import Standing, after_init, standings_of, stands_at
from scenario_compiler.plan.traffic import traffic_entities
from scenario_compiler.roads import LanePosition as FoundLane
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.criteria import Criterion, StayOnRoad
from scenario_compiler.vocabulary.entities import Dynamic, Ego, Static, Vehicle
from scenario_compiler.vocabulary.positions import (
    AnyOfPosition,
    BoundPosition,
    ControlPoint,
    FreePosition,
    GeoPosition,
    LanePositionWord,
    NumberedSpawnPoint,
    Position,
    RandomPosition,
    RandomSpawnPoint,
    RoadPosition,
    SpawnPoint,
    Vertex,
    WorldPosition,
)
from scenario_compiler.vocabulary.scenario import Parameter, Scenario
from scenario_compiler.vocabulary.sensors import Camera, ForwardSensor, Odometry, Perception
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.takeover import Takeover
from scenario_compiler.vocabulary.traversal import AnyWord, parameters_in, replaced
from scenario_compiler.vocabulary.word import Word

POSITION_CYCLE = Code(
    "SC230",
    "position-cycle",
    "The start positions of entities depend on each other in a cycle: each is `ahead_of` the next. Give one of them "
    "an independent position.\n\n"
    '    <static id="a"><at><ahead_of entity="b" distance="5"/></at></static>\n'
    '    <static id="b"><at><ahead_of entity="a" distance="5"/></at></static>',
)
NO_DURATION = Code(
    "SC601",
    "no-duration",
    "The scenario has neither a duration nor a stop trigger, so it ends after 60 s. Give the scenario a `duration`, "
    "or pass --duration.\n\n"
    '    <scenario name="paint_fades" map="highway_loop" duration="30">',
    Severity.WARNING,
)

DEFAULT_DURATION = 60.0
"""Duration of a run without a defined end, s."""


@dataclass
class PlanDraft:
    """The parts of a plan that the passes have made so far."""

    scenario: Scenario
    network: Network
    sink: Diagnostics
    binder: Binder
    whole: bool
    entities: list[Entity] = field(default_factory=list)
    standings: dict[str, Standing] = field(default_factory=dict)
    destination: LanePositionWord | None = None
    route: tuple[RouteLeg, ...] = ()
    storyboard: Storyboard = field(default_factory=Storyboard.model_construct)
    takeover: Takeover = field(default_factory=Takeover.model_construct)
    parameters: tuple[Parameter, ...] = ()
    duration: float = DEFAULT_DURATION
    origins: dict[str, PlanOrigin] = field(default_factory=dict)


def lower(
    scenario: Scenario,
    network: Network,
    sink: Diagnostics,
    *,
    values: Mapping[str, Value],
    perception: Perception = "camera",
    whole: bool = True,
) -> Plan:
    """Return the plan of a scenario on its map, checked but not sealed; it can be run if the sink has no errors.

    The checks also run if positions have faults, so that all faults are found at once.

    Args:
        scenario: The scenario, expanded.
        network: The map.
        sink: The sink for diagnostics.
        values: Values of the scenario's open parameters, for the checks.
        perception: The source of the lane confidence; ideal without an automated vehicle.
        whole: Whether the scenario could be read completely; if not, the checks are left out.
    """
    named = {} if scenario.spawn_points is None else {p.name: p.position for p in scenario.spawn_points.points}
    binder = Binder(network, values, sink, named, forgiving=scenario.ego is None)
    draft = PlanDraft(scenario, network, sink, binder, whole)
    for run_pass in PASSES:
        run_pass(draft)
    ego = scenario.ego
    plan = Plan.model_construct(
        name=scenario.name,
        summary=scenario.summary,
        map=MapReference.model_construct(name=scenario.map, file=network.path, sha256=network.sha256),
        step=scenario.step,
        control_every=scenario.control_every,
        duration=draft.duration,
        parameters=draft.parameters,
        limits=tuple(
            limit for limit in scenario.limits if parameters_in(limit) <= {one.name for one in draft.parameters}
        ),
        weather=scenario.weather,
        entities=tuple(draft.entities),
        camera=Camera.model_construct() if ego is None else ego.camera,
        forward_sensor=ForwardSensor.model_construct() if ego is None else ego.forward_sensor,
        odometry=Odometry.model_construct() if ego is None else ego.odometry,
        controller=None if ego is None else ego.controller,
        perception="ideal" if ego is None else perception,
        destination=draft.destination,
        route=draft.route,
        markings=scenario.markings,
        secondary_markings=scenario.secondary_markings,
        variables=scenario.variables,
        signal_controllers=scenario.signal_controllers,
        storyboard=draft.storyboard,
        takeover=draft.takeover,
        criteria=judged_by(scenario),
        classifications=scenario.classifications,
        derived={name: one.pose for name, one in draft.standings.items()},
        origins=draft.origins,
    )
    for check in CHECKS if whole else ():
        check(plan, network, sink)
    return plan


def bind_entities(draft: PlanDraft) -> None:
    """Bind every entity's start to a lane, in document order, because an entity may start relative to an earlier one.

    An entity whose start has a fault keeps the written position, so that no check takes it for one without a start.
    """
    vehicles = {vehicle.name: vehicle for vehicle in draft.scenario.vehicles}
    starts: dict[str, BoundPosition] = {}
    for entity in written_entities(draft.scenario):
        vehicle, written = vehicles[entity.model], start_of(entity)
        start = None if written is None else draft.binder.bind(bound_inside(draft, written), vehicle.center)
        if start is not None:
            starts[entity.id] = start
        draft.entities.append(make_entity(entity, start or written, vehicle))
    draft.standings, circular = standings_of(draft.binder, starts)
    for name in starts:
        if name in circular:
            message = f"the start of '{name}' depends on itself"
            draft.sink.add(POSITION_CYCLE, message, starts[name].origin)


def written_entities(scenario: Scenario) -> tuple[Ego | Static | Dynamic, ...]:
    """Return the entities as written, an automated vehicle first."""
    return scenario.actors if scenario.ego is None else (scenario.ego, *scenario.actors)


def start_of(entity: Ego | Static | Dynamic) -> Position | None:
    """Return an entity's start as written; None if an action gives it its first position."""
    return entity.at if isinstance(entity, Static) else entity.start


def make_entity(entity: Ego | Static | Dynamic, start: BoundPosition | Position | None, vehicle: Vehicle) -> Entity:
    """Return the plan's entity for an entity of the scenario."""
    if isinstance(entity, Static):
        return Entity.model_construct(
            id=entity.id, kind="static", vehicle=vehicle, start=start, speed=0.0, desired_speed=0.0
        )
    if isinstance(entity, Dynamic):
        return Entity.model_construct(
            id=entity.id,
            kind="dynamic",
            vehicle=vehicle,
            start=start,
            speed=entity.speed,
            desired_speed=entity.speed,
            follow=entity.follow,
            path=entity.path,
        )
    desired = entity.speed if entity.desired_speed is None else entity.desired_speed
    return Entity.model_construct(
        id=entity.id, kind="ego", vehicle=vehicle, start=start, speed=entity.speed, desired_speed=desired
    )


def plan_routes(draft: PlanDraft) -> None:
    """Bind the destinations and find the routes to them."""
    ego = draft.scenario.ego
    if ego is not None and ego.destination is not None:
        goal, draft.route = find_way(draft, ego.id, ego.destination)
        if goal is not None:
            draft.destination = LanePositionWord.model_construct(
                road=goal.road, lane=goal.lane, s=goal.s, offset=goal.offset
            )
    routes = {
        actor.id: find_way(draft, actor.id, actor.destination)[1]
        for actor in draft.scenario.actors
        if isinstance(actor, Dynamic) and actor.destination is not None
    }
    draft.entities = [
        one.model_copy(update={"route": routes[one.id]}) if one.id in routes else one for one in draft.entities
    ]


def find_way(draft: PlanDraft, entity: str, written: Position) -> tuple[FoundLane | None, tuple[RouteLeg, ...]]:
    """Return a destination's place and the route to it from an entity's start; report if there is none."""
    bound = bind_fixed(draft, bound_inside(draft, written))
    placed = next((one.start for one in draft.entities if one.id == entity), None)
    if isinstance(placed, RandomPosition | AnyOfPosition):
        message = f"'{entity}' starts at random, so its route to a destination would differ from run to run"
        draft.sink.add(RANDOM_HERE, message, placed.origin)
        return None, ()
    standing = draft.standings.get(entity)
    start = None if standing is None else standing.lane
    found = None if bound is None or start is None else stands_at(draft.binder, bound, draft.standings)
    goal = None if found is None else found.lane
    if goal is None or start is None:
        if not draft.sink.has_errors:  # otherwise the place may be unknown because of a fault in it
            which = "start" if start is None else "destination"
            message = f"no route can be planned for '{entity}': its {which} is in no lane that is known before the run"
            draft.sink.add(NOT_IN_A_LANE, message, written.origin)
        return None, ()
    route = draft.network.route(start, goal)
    if route is None:
        message = f"no route leads from road '{start.road}', lane {start.lane} to road '{goal.road}', lane {goal.lane}"
        draft.sink.add(NO_ROUTE, message, written.origin)
        return goal, ()
    return goal, tuple(
        RouteLeg.model_construct(road=leg.road, lane=leg.lane, s_from=leg.s_from, s_to=leg.s_to) for leg in route.legs
    )


def bind_fixed(draft: PlanDraft, position: Position) -> BoundPosition | None:
    """Bind a position that must be the same in every run, and report one that is random."""
    bound = draft.binder.bind(position, 0.0)
    if isinstance(bound, RandomPosition | AnyOfPosition):
        message = f"<{position.word}> can only be the start of an entity"
        hint = "its place depends on the entities placed before, also with a seed"
        if isinstance(bound, AnyOfPosition):
            message = f"<{position.word}> is drawn again in each run"
            hint = 'give it a seed, as in <random_spawn_point seed="1"/>'
        draft.sink.add(RANDOM_HERE, message, position.origin, hint=hint)
        return None
    return bound


POSITIONS = (
    WorldPosition,
    RoadPosition,
    SpawnPoint,
    NumberedSpawnPoint,
    RandomSpawnPoint,
    RandomPosition,
    LanePositionWord,
    GeoPosition,
)
"""Types of positions that `bind_fixed` binds to the map."""


def bind_corner(draft: PlanDraft, corner: Vertex | ControlPoint) -> Vertex | ControlPoint:
    """Bind a corner of a trajectory; a heading that is not written is not taken from the road or the world's axes."""
    position = corner.position
    aligned = isinstance(position, WorldPosition) and position.yaw == 0.0
    along = isinstance(position, RoadPosition | GeoPosition) and position.turn == 0.0 and position.heading is None
    bound = bind_fixed(draft, position) if aligned or along else None
    if not isinstance(bound, LanePositionWord | FreePosition):
        return corner
    unwritten = {"turn": 0.0} if isinstance(bound, LanePositionWord) else {"heading": None}
    return corner.model_copy(update={"position": bound.model_copy(update=unwritten)})


def bound_inside(draft: PlanDraft, word: AnyWord) -> AnyWord:
    """Return a word in which the positions below it are bound, such as the waypoints of a position on a route."""

    def bind(inner: Word) -> Word:
        if isinstance(inner, Vertex | ControlPoint):
            return bind_corner(draft, inner)
        return bind_fixed(draft, inner) or inner if isinstance(inner, POSITIONS) else inner

    return replaced(word, bind)


def bind_storyboard(draft: PlanDraft) -> None:
    """Bind the positions of conditions, actions and paths."""
    written = draft.scenario.storyboard
    ordered = written.model_copy(update={"init": in_order(written.init, placed_before(draft.entities))})
    draft.storyboard = bound_inside(draft, ordered)
    draft.entities = [
        one if one.path is None else one.model_copy(update={"path": bound_inside(draft, one.path)})
        for one in draft.entities
    ]


def place_by_init(draft: PlanDraft) -> None:
    """Determine the positions of the entities that the init's actions place."""
    draft.standings = after_init(draft.binder, draft.storyboard, draft.standings)


def add_traffic(draft: PlanDraft) -> None:
    """Add the entities of background traffic."""
    vehicles = {vehicle.name: vehicle for vehicle in draft.scenario.vehicles}
    for traffic in draft.scenario.traffic:
        known = [draft.binder.on_road(traffic, road, 0.0, "roads") for road in traffic.roads]
        if not all((*known, traffic.types, traffic.pedestrian_types)):
            continue
        entities = list(traffic_entities(traffic, vehicles, draft.network))
        starts = {entity.start.on: entity.start for entity in entities if isinstance(entity.start, RandomPosition)}
        for surface, start in starts.items():
            if not spans_of(draft.network, start):
                message = f"the map has no {surface} lane that '{traffic.id}' could start on"
                draft.sink.add(NO_RANDOM_PLACE, message, traffic.origin)
        draft.entities.extend(entities)


def keep_random_places_free(draft: PlanDraft) -> None:
    """Increase the clearance of random starts to at least what the entities' boxes need."""
    rooms = rooms_needed(draft.entities, replace(draft.binder, sink=Diagnostics()).value)
    draft.entities = [apart(*rooms[one.id]) if one.id in rooms else one for one in draft.entities]


def apart(entity: Entity, room: float) -> Entity:
    """Return an entity with a random start whose clearance is at least `room` m."""
    start = entity.start
    assert isinstance(start, RandomPosition | AnyOfPosition)
    if not isinstance(start.clear, Expression) and start.clear >= room:
        return entity
    clear = parse_expression(f"max({start.clear.text}, {room})") if isinstance(start.clear, Expression) else room
    moved = start.model_copy(update={"clear": clear}).written_at(start.origin)
    return entity.model_copy(update={"start": moved})


def check_markings(draft: PlanDraft) -> None:
    """Report road marks of the scenario for which the map has no place."""
    check_paint(draft.binder, draft.scenario)


def check_spawn_points(draft: PlanDraft) -> None:
    """Report faults in the scenario's own spawn points that are not used."""
    listed = () if draft.scenario.spawn_points is None else draft.scenario.spawn_points.points
    ego = draft.scenario.ego
    center = next((one.center for one in draft.scenario.vehicles if ego is not None and one.name == ego.model), 0.0)
    told = {_spot(one) for one in draft.sink.found} if listed else set()
    found = Diagnostics()
    for point in listed:
        replace(draft.binder, sink=found, named={}).bind(point.position, center)
    draft.sink.take(one for one in found if _spot(one) not in told)


def _spot(one: Diagnostic) -> tuple[Code, str, int, int]:
    return one.code, one.place.file, one.place.line, one.place.column


def complete_policy(draft: PlanDraft) -> None:
    """Fill in the numbers of the takeover policy that the author left out, and check the criteria."""
    draft.takeover = complete_takeover(draft.scenario.takeover)
    if draft.whole:
        check_criteria(draft.scenario, draft.takeover, draft.sink)


def fill_duration(draft: PlanDraft) -> None:
    """Set the run's duration, by default DEFAULT_DURATION."""
    if draft.scenario.duration is not None:
        draft.duration = draft.scenario.duration
    elif draft.scenario.written("duration") is not None:
        return  # a fault in it has been reported
    elif draft.scenario.storyboard.stop is None and (draft.scenario.ego is None or not draft.scenario.ego.destination):
        message = f"'{draft.scenario.name}' defines no end; it ends after {DEFAULT_DURATION:g} s"
        draft.sink.add(NO_DURATION, message, draft.scenario.origin)


def judged_by(scenario: Scenario) -> tuple[Criterion, ...]:
    """Return the criteria of a scenario; for an automated vehicle StayOnRoad is added unless it is written."""
    written = scenario.criteria
    if scenario.ego is None or any(isinstance(one, StayOnRoad) for one in written):
        return written
    return (*written, StayOnRoad.model_construct())


def add_kept_vehicles(draft: PlanDraft) -> None:
    """Add the vehicles of traffic actions; their number depends on the run's duration."""
    vehicles = draft.scenario.vehicles
    kept = kept_entities(draft.storyboard, vehicles, draft.entities, draft.duration, draft.sink)
    draft.entities.extend(list(kept))


def keep_open_parameters(draft: PlanDraft) -> None:
    """Keep the parameters on which numbers still depend."""
    scenario = draft.scenario
    words: list[Word] = [draft.storyboard, draft.takeover, *scenario.criteria]
    words += [] if scenario.ego is None else [scenario.ego.camera, scenario.ego.forward_sensor, scenario.ego.odometry]
    words += [*scenario.markings, *scenario.secondary_markings, *scenario.signal_controllers]
    words += [word for e in draft.entities for word in (e.start, e.follow, e.path) if word is not None]
    open_names = {name for word in words for name in parameters_in(word)}
    for entity in draft.entities:
        for number in (entity.speed, entity.desired_speed):
            open_names.update(number.names if isinstance(number, Expression) else ())
    draft.parameters = tuple(p for p in scenario.parameters if p.name in open_names)


def note_origins(draft: PlanDraft) -> None:
    """Store the places in the file of the plan's parts that later diagnostics refer to."""
    parts: dict[str, Word] = {f"entities/{e.id}": e for e in written_entities(draft.scenario)}
    parts["scenario"] = draft.scenario
    parts["weather"] = draft.scenario.weather
    if draft.scenario.ego is not None:
        parts["controller"] = draft.scenario.ego.controller
    parts["takeover"] = draft.scenario.takeover
    for key, word in parts.items():
        if word.origin.line:
            draft.origins[key] = origin_at(word.origin)


PASSES: tuple[Callable[[PlanDraft], None], ...] = (
    bind_entities,
    plan_routes,
    bind_storyboard,
    place_by_init,
    keep_random_places_free,
    add_traffic,
    check_markings,
    check_spawn_points,
    complete_policy,
    fill_duration,
    add_kept_vehicles,
    keep_open_parameters,
    note_origins,
)
