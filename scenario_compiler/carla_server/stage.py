"""The world that clients share: the actors on a map, which the engine moves step by step."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from scenario_compiler.carla_server.actors import (
    MAX_STEER,
    Actor,
    Body,
    Car,
    LightActor,
    SignActor,
    Walker,
)
from scenario_compiler.carla_server.areas import AreaIndex, Box
from scenario_compiler.carla_server.blueprints import Blueprint
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.debug_shapes import DebugShapes
from scenario_compiler.carla_server.departed import Departed, Gone
from scenario_compiler.carla_server.driving import FASTEST, STEER_RATE, Driving
from scenario_compiler.carla_server.falling import GRAVITY, JUMP, Fall
from scenario_compiler.carla_server.impacts import Footprint, impact
from scenario_compiler.carla_server.measured import POSE, Measured
from scenario_compiler.carla_server.signals import Signals
from scenario_compiler.carla_server.signs import SignRules, signs_of
from scenario_compiler.carla_server.towns import Town
from scenario_compiler.carla_server.traffic_lights import GREEN, Light, groups_of
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program.stage import build_stage
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.frames import (
    CarlaTransform,
    carla_attached,
    carla_axes,
    carla_from_pose,
    pose_from_carla,
    vector_from_carla,
)
from scenario_compiler.roads import Pose

PLACES = 1024
"""Greatest number of bodies in a world at the same time."""

MOST_ACTORS = 4096
FIRST_ID = 24
"""Greatest number of actors, and the id of the server's first one: CARLA numbers the actors of its map first."""

FARTHEST = 1.0e6
"""Greatest distance from the origin at which clients may put something, m."""

TRIGGER = "static.trigger.friction"
"""Blueprint of a friction trigger."""


class Stage:
    """Actors on a map.

    Attributes:
        town: The map.
        actors: All actors by their id.
        collisions: Pairs of bodies that touched in the last step, with the impulse on the first, N s, CARLA's axes.
        time: Time, s.
        version: Version of CARLA whose protocol is spoken.
        gravity: The gravity that inertial units measure, m/s2.
        shapes: The debug shapes of clients.
        next_id: The id of the next actor.
        simulation: The engine, in which every body has a place.
        driving: Hands the controls of bodies to the engine.
        measured: The states of the actors, as rows of snapshots.
    """

    def __init__(self, town: Town, version: str, next_id: int = FIRST_ID) -> None:
        """Begin with the map's own actors: lights, signs and the spectator."""
        self.town, self.version, self.next_id = town, version, next_id
        self.gravity = GRAVITY
        self.shapes = DebugShapes()
        self.simulation = Simulation(town.network.tables, build_stage(PLACES, len(town.network.road_ids), 0.05))
        self.simulation.reset(make_draws(1))
        self.actors: dict[int, Actor] = {}
        self.collisions: list[tuple[Body, Body, tuple[float, float, float]]] = []
        self.time = 0.0
        self._places = list(range(PLACES - 1, -1, -1))
        self._by_place: dict[int, Body] = {}
        self._stale = True
        self._departed = Departed(MOST_ACTORS)
        self._falling: dict[int, Fall] = {}
        self._triggers: list[Actor] = []
        self._carried: list[Body] = []
        self.driving = Driving(self.simulation)
        self.measured = Measured(self.simulation, town.network, self.transform_of)
        signals = Signals(town.network)
        self.groups = groups_of(signals)
        self.spectator = self.add(
            Actor(0, Blueprint("spectator", "spectator"), {}, [0, "spectator", []], CarlaTransform(0, 0, 50, 0, 0, 0))
        )
        lights = [light for group in self.groups for light in group.lights]
        for light in lights:
            self._add_light(light)
        self._lit = AreaIndex((area, light) for light in lights for area in light.areas)
        signs = signs_of(signals)
        for sign in signs:
            blueprint = Blueprint(sign.kind, sign.kind.replace(".", ","))
            self.add(SignActor(0, blueprint, {}, [0, sign.kind, []], sign.transform, sign=sign))
        self._rules = SignRules(signals, signs)

    def _add_light(self, light: Light) -> None:
        blueprint = Blueprint("traffic.traffic_light", "traffic,traffic_light")
        actor = LightActor(0, blueprint, {}, [0, blueprint.name, []], light.transform, light=light)
        light.actor = self.add(actor).id

    def add(self, actor: Actor, wanted: int = 0) -> Actor:
        """Add an actor and give it its id: the next one, or the wanted one if no actor has it.

        Raises:
            CallError: There are too many.
        """
        if len(self.actors) >= MOST_ACTORS:
            raise CallError(f"unable to spawn actor: there are {MOST_ACTORS} already")
        actor.id = wanted if wanted > 0 and wanted not in self.actors else self.next_id
        self.next_id = max(self.next_id, actor.id + 1)
        self.actors[actor.id] = actor
        if actor.blueprint.name == TRIGGER:
            self._triggers.append(actor)
        if actor.parent:
            self.actors[actor.parent].children.append(actor.id)
        self._stale = True
        return actor

    def add_body(self, body: Body, wanted: int = 0) -> Body:
        """Add a body; it stands on the road below it, and a vehicle falls onto it.

        Args:
            body: The body.
            wanted: The id that it gets if nobody has it.

        Raises:
            CallError: Something stands there already, or there are too many.
        """
        if not self._places:
            raise CallError(f"unable to spawn actor: there are {PLACES} bodies already")
        place = self._places.pop()
        body.place, body.spawned = place, body.transform
        shape = body.shape.model_copy(update={"max_steer": min(MAX_STEER, 80.0), "max_speed": FASTEST})
        pose = Pose(*pose_from_carla(body.transform, shape.center, body.up))
        posed = not isinstance(body, Car | Walker)
        self.simulation.spawn(place, shape, pose, posed=posed, steer_rate=STEER_RATE)
        if not isinstance(body, Car | Walker):
            self.simulation.pose(place, pose, 0.0)
        elif self.simulation.state.road[place] < 0:
            self.simulation.pose(place, self._on_ground(pose), 0.0)
        index = self.simulation.touched(place)
        touched = None if index is None else self._by_place.get(index)
        if touched is not None and not self._is_above(body, touched) and not self._are_joined(body, touched):
            self.simulation.remove(place)
            self._places.append(place)
            raise CallError("Spawn failed because of collision at spawn position")
        try:
            self.add(body, wanted)
        except CallError:
            self.simulation.remove(place)
            self._places.append(place)
            raise
        self._by_place[place] = body
        self.measured.leap(place)
        if isinstance(body, Car):
            self._falling[place] = Fall(pose, self.time)
        return body

    def get(self, number: int) -> Actor:
        """Return an actor; raise CallError if there is none."""
        actor = self.actors.get(number)
        if actor is None:
            raise CallError(f"unable to find actor: actor not found (id {number})")
        return actor

    def destroy(self, number: int) -> None:
        """Remove an actor; things attached to it stay where they are.

        Raises:
            CallError: There is none, or it belongs to the map.
        """
        actor = self.get(number)
        if isinstance(actor, LightActor | SignActor) or actor is self.spectator:
            raise CallError(f"unable to destroy actor: {actor.blueprint.name} belongs to the map")
        self._departed.add(actor, self.wire(actor)[3], self.time)
        del self.actors[number]
        if actor in self._triggers:
            self._triggers.remove(actor)
        if isinstance(actor, Body):
            self.simulation.remove(actor.place)
            del self._by_place[actor.place]
            self._falling.pop(actor.place, None)
            self._places.append(actor.place)
        for child in actor.children:
            if child in self.actors:
                self.actors[child].parent = 0
        if actor.parent in self.actors:
            self.actors[actor.parent].children.remove(number)
        self._stale = True

    def box_of(self, number: int) -> list[Any]:
        """Return an actor's box in the layout of the wire; also of one that was destroyed a moment ago.

        Raises:
            CallError: There is none.
        """
        gone = self._remembered(number)
        if gone is not None:
            return gone.box
        found: list[Any] = self.wire(self.get(number))[3]
        return found

    def gone(self, number: int) -> Actor | None:
        """Return an actor that was destroyed a moment ago; None for others."""
        found = self._remembered(number)
        return None if found is None else found.actor

    def _remembered(self, number: int) -> Gone | None:
        return None if number in self.actors else self._departed.get(number)

    def remember(self, before: Stage) -> None:
        """Remember the actors of an episode that has ended as those that have been destroyed."""
        for actor in before.bodies():
            self._departed.add(actor, before.wire(actor)[3], self.time)

    def bodies(self) -> Iterator[Body]:
        """Yield all bodies."""
        yield from self._by_place.values()

    def pose_of(self, body: Body) -> Pose:
        """Return the pose of a body's reference point, OpenDRIVE axes; while it falls, it leans as when it began to."""
        st, place = self.simulation.state, body.place
        pose = Pose(*(getattr(st, name)[place] for name in POSE))
        fall = self._falling.get(place)
        return pose if fall is None else fall.pose(pose, self.time)

    def transform_of(self, actor: Actor) -> CarlaTransform:
        """Return the present transform of an actor, CARLA's axes."""
        if isinstance(actor, Body):
            pose = self.pose_of(actor)
            if isinstance(actor, Walker):
                pose = pose._replace(pitch=0.0, roll=0.0)
            actor.transform = carla_from_pose(pose, actor.shape.center, actor.up)
        elif actor.parent in self.actors and actor.relative is not None:
            actor.transform = carla_attached(self.transform_of(self.actors[actor.parent]), actor.relative)
        return actor.transform

    def put(self, actor: Actor, transform: CarlaTransform) -> None:
        """Put an actor at a transform, relative to its parent if it has one.

        A vehicle that physics moves falls onto the road.

        Raises:
            CallError: That is too far away.
        """
        if max(abs(value) for value in transform[:3]) > FARTHEST or max(abs(value) for value in transform[3:]) > 1e6:
            raise CallError("the transform is out of bounds")
        if not isinstance(actor, Body):
            if actor.parent in self.actors:
                actor.relative = transform
            else:
                actor.transform = transform
            if not self._stale:
                self.measured.put(actor)
            return
        if actor.parent in self.actors:
            actor.relative = transform
            self._carry(actor)
            return
        pose = Pose(*pose_from_carla(transform, actor.shape.center, actor.up))
        falls = isinstance(actor, Car) and actor.simulates
        self.simulation.pose(
            actor.place, self._on_ground(pose) if falls else pose, self.simulation.state.v[actor.place]
        )
        self.measured.leap(actor.place)
        self._falling.pop(actor.place, None)
        if falls:
            self._falling[actor.place] = Fall(pose, self.time)

    def _on_ground(self, pose: Pose) -> Pose:
        """Return the pose on the ground below; on a road, the engine puts a body onto the road's surface."""
        ground = self.town.ground_at(pose.x, pose.y)
        return Pose(pose.x, pose.y, ground.z if ground else 0.0, pose.heading, 0.0, 0.0)

    def _carry(self, body: Body) -> None:
        """Put an attached body where its carrier has taken it."""
        if body.parent in self.actors and body.relative is not None:
            at = carla_attached(self.transform_of(self.actors[body.parent]), body.relative)
            self.simulation.pose(body.place, Pose(*pose_from_carla(at, body.shape.center, body.up)), 0.0)

    def let_simulate(self, body: Body, simulates: bool) -> None:
        """Set whether physics moves a body; a vehicle falls from where it is then, or stays in the air.

        A prop stays where it has been put.
        """
        if simulates == body.simulates or not isinstance(body, Car | Walker):
            return
        body.simulates = simulates
        now = self.transform_of(body)
        self.simulation.let_pose(body.place, posed=not simulates)
        self.simulation.state.v[body.place] = 0.0
        if isinstance(body, Car):
            self.put(body, now)

    def _is_above(self, body: Body, other: Body) -> bool:
        """Return whether a body that is being spawned is in the air over another one."""
        top = self.transform_of(other).z - other.up + 2.0 * other.box[2]
        return body.spawned.z - body.up > top

    def friction_at(self, at: CarlaTransform) -> float | None:
        """Return the friction of a friction trigger about a point, None if there is none; its extents are in cm."""
        for actor in self._triggers:
            away = [a - b for a, b in zip(at[:3], self.transform_of(actor)[:3], strict=True)]
            axes = carla_axes(*actor.transform[3:])
            try:
                half = [float(actor.attributes[f"extent_{axis}"]) / 100.0 for axis in "xyz"]
                friction = float(actor.attributes["friction"])
            except ValueError:
                continue
            inside = [abs(sum(a * b for a, b in zip(axis, away, strict=True))) for axis in axes]
            if all(one <= most for one, most in zip(inside, half, strict=True)) and math.isfinite(friction):
                return friction
        return None

    def ahead_of(self, body: Body) -> tuple[float, float, float]:
        """Return the direction in which a body faces, CARLA's axes."""
        pose = self.pose_of(body)
        level = math.cos(pose.pitch)
        return (level * math.cos(pose.heading), -level * math.sin(pose.heading), -math.sin(pose.pitch))

    def step(self, dt: float, *, switches: bool = True) -> None:
        """Advance the time and all bodies by a step, and note which bodies touch; traffic lights switch if they may."""
        self._departed.forget(self.time)
        for body in self._by_place.values():
            if self._triggers and isinstance(body, Car):
                self._enter_triggers(body)
            if isinstance(body, Walker) and body.control[2] and body.place not in self._falling:
                self._falling[body.place] = Fall(self.pose_of(body), self.time, JUMP)
            self.driving.advance(body, dt)
        self.simulation.set_step(dt)
        self.simulation.step()
        self._collide()
        for body in self._carried:
            self._carry(body)
        if switches:
            for group in self.groups:
                group.step(dt)
        self.time += dt
        self._heed_signs()
        self.measure(dt)

    def _heed_signs(self) -> None:
        """Find the light that applies to each vehicle, and show vehicles the states of stop and yield signs."""
        if self._lit.empty and self._rules.empty:
            return
        boxes: list[tuple[int, Box]] = []
        for car in self._by_place.values():
            if not isinstance(car, Car):
                continue
            box = self._box_near_areas(car)
            car.light = None if box is None else next(self._lit.touched(box), None)
            if car.light is not None:
                car.shown = GREEN
            if box is not None:
                boxes.append((car.id, box))
        for number, state in self._rules.step(self.time, boxes).items():
            shown_to = self.actors[number]
            assert isinstance(shown_to, Car)
            shown_to.shown = state

    def _box_near_areas(self, car: Car) -> Box | None:
        """Return the box of a vehicle on the road; None if it is far from all areas of lights and signs."""
        st, at, shape = self.simulation.state, car.place, car.shape
        x, y = st.middle_x[at], st.middle_y[at]
        if not self._lit.is_near(x, y) and not self._rules.is_near(x, y):
            return None
        return Box(x, y, st.z[at], st.h[at], shape.length, shape.width, shape.height)

    def _enter_triggers(self, car: Car) -> None:
        """Give a vehicle's tires the friction of the trigger in which the vehicle is."""
        friction = self.friction_at(self.transform_of(car))
        if friction != car.friction:
            car.friction = friction
            self.driving.command(car)

    def _collide(self) -> None:
        """Find the bodies that touch; those that run into each other lose the speed at which they meet."""
        self.collisions = []
        for i, j in self.simulation.contacts():
            one, other = self._by_place.get(i), self._by_place.get(j)
            if one is None or other is None or not (one.collides and other.collides) or self._are_joined(one, other):
                continue
            found = impact(self._footprint(one), self._footprint(other))
            self.driving.set_speed(one, found.speed)
            self.driving.set_speed(other, found.other_speed)
            self.collisions.append((one, other, vector_from_carla(found.x, found.y, 0.0)))

    def _footprint(self, body: Body) -> Footprint:
        st, place = self.simulation.state, body.place
        walks = isinstance(body, Walker)
        inertia = body.mass if walks or body.simulates else math.inf
        at = (st.middle_x[place], st.middle_y[place], st.h[place])
        return Footprint(*at, body.shape.length, body.shape.width, st.v[place], inertia, rolls=not walks)

    def _are_joined(self, one: Body, other: Body) -> bool:
        """Return whether two bodies are connected: one is attached to the other, or both to a third."""
        return self._carrier_of(one) is self._carrier_of(other)

    def _carrier_of(self, actor: Actor) -> Actor:
        """Return the outermost carrier of an actor; the actor itself if it is not attached."""
        while actor.parent in self.actors:
            actor = self.actors[actor.parent]
        return actor

    def measure(self, dt: float) -> None:
        """Measure every actor's state, `dt` s after the last time."""
        if self._stale:
            self.measured.arrange(self.actors)
            self._carried = [actor for actor in self.bodies() if actor.parent]
            self._stale = False
        self.measured.measure(dt, self.time, self._falling)

    def wire(self, actor: Actor) -> list[Any]:
        """Return an actor in the layout of the wire, without its token."""
        half = list(actor.box)
        middle, turn = [0.0, 0.0, 0.0 if isinstance(actor, Walker) else half[2]], [0.0, 0.0, 0.0]
        if isinstance(actor, LightActor):
            middle, half = actor.light.trigger()
        elif isinstance(actor, SignActor):
            middle, half, turn = actor.sign.trigger()
        tags = bytes([actor.tag]) if actor.tag else b""
        return [actor.id, actor.parent, actor.description, [middle, half, turn, actor.id], tags, b""]
