"""The world that clients share: the actors on a map, which the engine moves step by step."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
from scenario_compiler.carla_server.debug_shapes import DebugShapes
from scenario_compiler.carla_server.failures import CallError
from scenario_compiler.carla_server.impacts import Footprint, impact
from scenario_compiler.carla_server.signals import Signals
from scenario_compiler.carla_server.signs import SignRules, signs_of
from scenario_compiler.carla_server.snapshot import ACTIVE, LIGHT, SIGN, VEHICLE, WALKER, Rows
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
    carla_rows,
    pose_from_carla,
    vector_from_carla,
)
from scenario_compiler.roads import Pose

PLACES = 1024
"""Bodies that can stand in a world at once."""

MOST_ACTORS = 4096
FIRST_ID = 24
"""Actors at once, and the id of the first: CARLA counts its map's first."""

FARTHEST = 1.0e6
FASTEST = 300.0
"""Bounds of what clients may ask for, m and m/s."""

LEAP = 3.0
"""How many times farther than its speed takes it an actor has moved that was put somewhere else."""

DEFAULT_LIMIT = 30.0
"""Speed limit where the map gives none, km/h: CARLA's."""

STEER_RATE = 3.0
"""How fast wheels are turned, rad/s: to the full angle in 0.4 s, as Unreal's wheeled vehicles do by default (not
verified for CARLA's).
"""

TRIGGER = "static.trigger.friction"
"""Blueprint of a friction trigger."""

WALKER_GAIN = 3.0
"""How fast a walker gains speed again after an impact, or loses it, m/s2."""

SETTLES = 0.2
"""For how long a vehicle that has been put somewhere is on its springs before it leans as the road does, s."""

NO_FAILURE = 0
NEUTRAL = 0
"""No failure of a vehicle, and the gear in which its engine drives nothing."""

GRAVITY = 9.81

REMEMBERED = 10.0
"""For how long box and physics control of a destroyed actor are known, s: clients ask for those of the actors that they
see in the last snapshot, and a Traffic Manager does so in a thread, where an error ends the client.
"""

COLUMNS = ("x", "y", "z", "h", "pitch", "roll")


@dataclass(frozen=True)
class Fall:
    """The fall of a vehicle: the pose of its reference point when it began, OpenDRIVE axes, and the time then, s."""

    begin: Pose
    since: float

    def height(self, time: float) -> float:
        """Return how high the vehicle is at a time while nothing is below it, m."""
        return self.begin.z - 0.5 * GRAVITY * (time - self.since) ** 2


@dataclass(frozen=True)
class Gone:
    """An actor that has been destroyed, its box on the wire, and until when it is remembered, s."""

    actor: Actor
    box: list[Any]
    until: float


class Stage:
    """Actors on a map.

    Attributes:
        town: The map.
        actors: All actors by their id.
        collisions: Pairs of bodies that touched in the last step, with the impulse on the first, N s, CARLA's axes.
        time: Time, s.
        version: Version of CARLA whose protocol is spoken.
        gravity: The gravity that inertial units measure, m/s2.
        shapes: What clients have drawn for debugging.
    """

    def __init__(self, town: Town, version: str) -> None:
        """Begin with the map's own actors: lights, signs and the spectator."""
        self.town, self.version = town, version
        self.gravity = GRAVITY
        self.shapes = DebugShapes()
        self.simulation = Simulation(town.network.tables, build_stage(PLACES, len(town.network.road_ids), 0.05))
        self.simulation.reset(make_draws(1))
        self.actors: dict[int, Actor] = {}
        self.collisions: list[tuple[Body, Body, tuple[float, float, float]]] = []
        self.time = 0.0
        self.rows = Rows(0)
        self._next = FIRST_ID
        self._places = list(range(PLACES - 1, -1, -1))
        self._by_place: dict[int, Body] = {}
        self._stale = True
        self._leapt: set[int] = set()
        self._gone: dict[int, Gone] = {}
        self._falling: dict[int, Fall] = {}
        self._triggers: list[Actor] = []
        self._attached: list[Actor] = []
        self._carried: list[Body] = []
        self._before = np.zeros((PLACES, 6))
        self._bodies: list[Body] = []
        self._place = np.empty(0, np.intp)
        self._index: dict[int, int] = {}
        self._row = np.empty(0, np.intp)
        self._center = np.empty(0)
        self._up = np.empty(0)
        self._limits: dict[tuple[int, int], float] = {}
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
        """Take an actor in and give it its id: the next one, or the wanted one if nobody has it.

        Raises:
            CallError: There are too many.
        """
        if len(self.actors) >= MOST_ACTORS:
            raise CallError(f"unable to spawn actor: there are {MOST_ACTORS} already")
        actor.id = wanted if wanted > 0 and wanted not in self.actors else self._next
        self._next = max(self._next, actor.id + 1)
        self.actors[actor.id] = actor
        if actor.blueprint.name == TRIGGER:
            self._triggers.append(actor)
        if actor.parent:
            self.actors[actor.parent].children.append(actor.id)
        self._stale = True
        return actor

    def add_body(self, body: Body, wanted: int = 0) -> Body:
        """Take a body in; it stands on the road below it, and a vehicle falls onto it.

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
        self._leapt.add(place)
        if isinstance(body, Car):
            self._falling[place] = Fall(pose, self.time)
        return body

    def get(self, number: int) -> Actor:
        """Return an actor; CallError where there is none."""
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
        if len(self._gone) < MOST_ACTORS:
            self._gone[number] = Gone(actor, self.wire(actor)[3], self.time + REMEMBERED)
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
        """Return an actor's box as it lies on the wire; also of one that has been destroyed a moment ago.

        Raises:
            CallError: There is none.
        """
        gone = self._remembered(number)
        if gone is not None:
            return gone.box
        found: list[Any] = self.wire(self.get(number))[3]
        return found

    def gone(self, number: int) -> Actor | None:
        """Return an actor that has been destroyed a moment ago; None for others."""
        found = self._remembered(number)
        return None if found is None else found.actor

    def _remembered(self, number: int) -> Gone | None:
        return None if number in self.actors else self._gone.get(number)

    def remember(self, before: Stage) -> None:
        """Remember the actors of an episode that has ended as those that have been destroyed."""
        for actor in before.bodies():
            self._gone[actor.id] = Gone(actor, before.wire(actor)[3], self.time + REMEMBERED)

    def bodies(self) -> Iterator[Body]:
        """Yield all bodies."""
        yield from self._by_place.values()

    def pose_of(self, body: Body) -> Pose:
        """Return the pose of a body's reference point, OpenDRIVE axes; while it falls, it leans as when it began to."""
        st, place = self.simulation.state, body.place
        pose = Pose(*(getattr(st, name)[place] for name in COLUMNS))
        fall = self._falling.get(place)
        if fall is not None:
            height = max(pose.z, fall.height(self.time))
            pose = pose._replace(z=height, pitch=fall.begin.pitch, roll=fall.begin.roll)
        return pose

    def transform_of(self, actor: Actor) -> CarlaTransform:
        """Return where an actor is now, CARLA's axes."""
        if isinstance(actor, Body):
            pose = self.pose_of(actor)
            if isinstance(actor, Walker):
                pose = pose._replace(pitch=0.0, roll=0.0)
            actor.transform = carla_from_pose(pose, actor.shape.center, actor.up)
        elif actor.parent in self.actors and actor.relative is not None:
            actor.transform = carla_attached(self.transform_of(self.actors[actor.parent]), actor.relative)
        return actor.transform

    def put(self, actor: Actor, transform: CarlaTransform) -> None:
        """Put an actor somewhere; one with a parent relative to it. A vehicle that physics moves falls onto the road.

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
                self.rows.every["transform"][actor.row] = self.transform_of(actor)
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
        self._leapt.add(actor.place)
        self._falling.pop(actor.place, None)
        if falls:
            self._falling[actor.place] = Fall(pose, self.time)

    def _on_ground(self, pose: Pose) -> Pose:
        """Return the pose of what lies on the ground below; where a road is, the engine puts it onto that."""
        ground = self.town.ground_at(pose.x, pose.y)
        return Pose(pose.x, pose.y, ground.z if ground else 0.0, pose.heading, 0.0, 0.0)

    def _carry(self, body: Body) -> None:
        """Put an attached body to where what carries it has taken it."""
        if body.parent in self.actors and body.relative is not None:
            at = carla_attached(self.transform_of(self.actors[body.parent]), body.relative)
            self.simulation.pose(body.place, Pose(*pose_from_carla(at, body.shape.center, body.up)), 0.0)

    def let_simulate(self, body: Body, simulates: bool) -> None:
        """Say whether physics moves a body; a vehicle falls from where it is then, or stays in the air.

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

    def set_speed(self, body: Body, speed: float) -> None:
        """Give a body a speed along its heading, m/s."""
        self.simulation.state.v[body.place] = min(max(speed, -FASTEST), FASTEST)

    def command(self, car: Car) -> None:
        """Hand a vehicle's control to the engine."""
        throttle, steer, brake, hand, reverse, _, _ = car.control
        brake = 1.0 if hand else min(max(brake, 0.0), 1.0)
        scale = car.steers / MAX_STEER
        self.simulation.command(
            car.place,
            min(max(throttle, 0.0), 1.0) * car.grip if car.gear != NEUTRAL else 0.0,
            -min(max(steer, -1.0), 1.0) * scale,
            brake * car.grip,
            reverse=bool(reverse) or car.gear < 0,
        )

    def walk(self, walker: Walker) -> None:
        """Hand a walker's control to the engine: it goes straight on into its direction.

        One whose physics is off walks too: in CARLA, a controller switches it off, and characters move without it.
        """
        (x, y, _), speed, _ = walker.control
        length = math.hypot(x, y)
        walks = speed > 0.0 and length > 1e-6
        if not walker.simulates:
            self.simulation.let_pose(walker.place, posed=not walks)
        if walks:
            dx, dy, _ = vector_from_carla(x, y, 0.0)
            self.simulation.state.h[walker.place] = math.atan2(dy, dx) % math.tau
            self.set_speed(walker, speed)
        else:
            self.set_speed(walker, 0.0)

    def step(self, dt: float) -> None:
        """Advance the time and all bodies by a step, and note which bodies touch."""
        self._gone = {number: one for number, one in self._gone.items() if one.until > self.time}
        self._drive(dt)
        self.simulation.set_step(dt)
        self.simulation.step()
        self._collide()
        for body in self._carried:
            self._carry(body)
        for group in self.groups:
            group.step(dt)
        self.time += dt
        self._heed_signs()
        self.measure(dt)

    def _drive(self, dt: float) -> None:
        st = self.simulation.state
        for body in self._by_place.values():
            if isinstance(body, Walker):
                self._walk_on(body, dt)
            if not isinstance(body, Car):
                continue
            if self._triggers:
                self._enter_triggers(body)
            if body.ackermann is not None:
                self._follow_target(body, body.ackermann, dt)
            if body.pushed:
                self.set_speed(body, st.v[body.place] + body.pushed)
                body.pushed = 0.0
            if body.constant is not None:
                self.set_speed(body, body.constant)
                self.simulation.command(body.place, 0.0, st.command_steer[body.place], 0.0)
            elif body.simulates:
                speed = st.v[body.place]
                if speed != 0.0:
                    lost = body.slowing.at(speed, body.grip) * dt
                    st.v[body.place] = math.copysign(max(abs(speed) - lost, 0.0), speed)

    def _heed_signs(self) -> None:
        """Find the light that each vehicle is at, and let vehicles see what stop and yield signs show them."""
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
        """Return the box of a vehicle on the road, None far from all areas of lights and signs."""
        st, at, shape = self.simulation.state, car.place, car.shape
        x, y = st.middle_x[at], st.middle_y[at]
        if not self._lit.is_near(x, y) and not self._rules.is_near(x, y):
            return None
        return Box(x, y, st.z[at], st.h[at], shape.length, shape.width, shape.height)

    def _walk_on(self, walker: Walker, dt: float) -> None:
        """Let a walker that has been stopped or pushed by an impact walk as it did."""
        wanted, speed = max(walker.control[1], 0.0), self.simulation.state.v[walker.place]
        if speed != wanted:
            change = WALKER_GAIN * dt
            self.set_speed(walker, min(max(wanted, speed - change), speed + change))

    def _enter_triggers(self, car: Car) -> None:
        """Give the tires of a vehicle the friction of the trigger that it is in."""
        friction = self.friction_at(self.transform_of(car))
        if friction != car.friction:
            car.friction = friction
            self.command(car)

    def _follow_target(self, car: Car, target: list[float], dt: float) -> None:
        """Steer and accelerate for an Ackermann controller's target: it sets the vehicle's control, as CARLA's does."""
        steer, steer_speed, speed, acceleration, _ = target
        st, place = self.simulation.state, car.place
        wanted, now = steer, -st.steer[place]
        if steer_speed > 0.0:
            wanted = now + min(max(wanted - now, -steer_speed * dt), steer_speed * dt)
        gain = (speed - st.v[place]) / max(dt, 0.2)
        if acceleration > 0.0:
            gain = min(max(gain, -acceleration), acceleration)
        pushes = gain if speed >= 0.0 else -gain
        throttle = min(max(pushes / car.shape.max_acceleration, 0.0), 1.0) if car.shape.max_acceleration > 0 else 0.0
        brake = min(max(-pushes / car.shape.max_deceleration, 0.0), 1.0) if car.shape.max_deceleration > 0 else 0.0
        turned = min(max(wanted / math.radians(car.steers), -1.0), 1.0) if car.steers > 0.0 else 0.0
        car.gear = -1 if speed < 0.0 else 1
        car.control = [throttle, turned, brake, False, speed < 0.0, False, car.gear]
        self.command(car)

    def _collide(self) -> None:
        """Find the bodies that touch; those that run into each other lose the speed at which they meet."""
        self.collisions = []
        for i, j in self.simulation.contacts():
            one, other = self._by_place.get(i), self._by_place.get(j)
            if one is None or other is None or not (one.collides and other.collides) or self._are_joined(one, other):
                continue
            found = impact(self._footprint(one), self._footprint(other))
            self.set_speed(one, found.speed)
            self.set_speed(other, found.other_speed)
            self.collisions.append((one, other, vector_from_carla(found.x, found.y, 0.0)))

    def _footprint(self, body: Body) -> Footprint:
        st, place = self.simulation.state, body.place
        walks = isinstance(body, Walker)
        inertia = body.mass if walks or body.simulates else math.inf
        at = (st.middle_x[place], st.middle_y[place], st.h[place])
        return Footprint(*at, body.shape.length, body.shape.width, st.v[place], inertia, rolls=not walks)

    def _are_joined(self, one: Body, other: Body) -> bool:
        """Return whether two bodies hang together: one is attached to the other, or both to a third."""
        return self._carrier_of(one) is self._carrier_of(other)

    def _carrier_of(self, actor: Actor) -> Actor:
        """Return what carries an actor in the end, itself if nothing does."""
        while actor.parent in self.actors:
            actor = self.actors[actor.parent]
        return actor

    def _arrange(self) -> None:
        """Assign new rows of the snapshot to all actors."""
        before = self.rows
        rows = Rows(len(self.actors))
        for row, actor in enumerate(self.actors.values()):
            if actor.row >= 0:
                rows.copy_row(row, before, actor.row)
            actor.row = row
        rows.every["id"] = list(self.actors)
        rows.every["state"] = ACTIVE
        for actor in self.actors.values():
            if not isinstance(actor, Body):
                rows.every["transform"][actor.row] = self.transform_of(actor)
            if isinstance(actor, SignActor):
                rows.put(SIGN, actor.row, actor.sign.signal.encode()[:31])
        self.rows = rows
        self._attached = [actor for actor in self.actors.values() if actor.parent and not isinstance(actor, Body)]
        self._carried = [actor for actor in self.actors.values() if actor.parent and isinstance(actor, Body)]
        self._bodies = list(self._by_place.values())
        self._place = np.array([body.place for body in self._bodies], np.intp)
        self._index = {body.place: index for index, body in enumerate(self._bodies)}
        self._row = np.array([body.row for body in self._bodies], np.intp)
        self._center = np.array([body.shape.center for body in self._bodies])
        self._up = np.array([body.up for body in self._bodies])
        self._stale = False

    def measure(self, dt: float) -> None:
        """Write every actor's state into its row, `dt` s after the last time."""
        if self._stale:
            self._arrange()
        if self._bodies:
            self._measure_bodies(dt)
        transforms = self.rows.every["transform"]
        for actor in self._attached:
            transforms[actor.row] = self.transform_of(actor)
        for group in self.groups:
            for light in group.lights:
                row = self.actors[light.actor].row
                name = light.signal.encode()[:31]
                self.rows.put(LIGHT, row, name, *light.times, light.elapsed, light.pole, light.frozen, light.state)

    def _measure_bodies(self, dt: float) -> None:
        every, place, row = self.rows.every, self._place, self._row
        column = self.simulation.column
        pose = [column(name)[place] for name in COLUMNS]
        for one, fall in list(self._falling.items()):  # it leans as the road does once its wheels are on it
            index, height = self._index[one], fall.height(self.time)
            if height <= pose[2][index] and self.time > fall.since + SETTLES:
                del self._falling[one]
                continue
            pose[2][index] = max(pose[2][index], height)
            pose[4][index], pose[5][index] = fall.begin.pitch, fall.begin.roll
        now = carla_rows(np.stack(pose), self._center, self._up)
        before = self._before[place]
        self._before[place] = now
        speed, ahead = column("v")[place], _ahead(now)
        moved = now[:, :3] - before[:, :3]
        turned = (now[:, 4] - before[:, 4] + 180.0) % 360.0 - 180.0
        leapt = np.sqrt((moved * moved).sum(axis=1)) > LEAP * np.abs(speed) * dt + 1.0
        leapt[[self._index[one] for one in self._falling]] = False
        if self._leapt:
            leapt |= np.isin(place, list(self._leapt))
            self._leapt.clear()
        velocity = moved / dt
        velocity[leapt] = (ahead * speed[:, None])[leapt]
        turning = np.zeros_like(velocity)
        turning[:, 2] = np.where(leapt, 0.0, turned / dt)
        gained = (velocity - every["velocity"][row]) / dt
        gained[leapt] = 0.0
        every["transform"][row] = now
        every["velocity"][row] = velocity
        every["angular"][row] = turning
        every["acceleration"][row] = gained
        self._measure_controls()

    def _measure_controls(self) -> None:
        st, rows = self.simulation.state, self.rows
        for body in self._bodies:
            if isinstance(body, Car):
                throttle, steer, brake, hand, reverse, manual, _ = body.control
                light = body.light
                where = (st.road[body.place], st.lane[body.place])
                limit = self._limits.get(where)
                if limit is None:
                    limit = self._limits[where] = self._limit_at(*where, st.s[body.place])
                at = (body.shown, False, 0) if light is None else (light.state, True, light.actor)
                rows.put(
                    VEHICLE, body.row, throttle, steer, brake, hand, reverse, manual, body.gear, limit, *at, NO_FAILURE
                )
            elif isinstance(body, Walker):
                rows.put(WALKER, body.row, *body.control[0], body.control[1], body.control[2])

    def _limit_at(self, road: int, lane: int, s: float) -> float:
        if road < 0:
            return DEFAULT_LIMIT
        limit = self.town.network.speed_limit(self.town.network.road_ids[road], lane, s)
        return DEFAULT_LIMIT if limit is None or not math.isfinite(limit) else limit * 3.6

    def wire(self, actor: Actor) -> list[Any]:
        """Return an actor as it lies on the wire, its token left out."""
        half = list(actor.box)
        middle, turn = [0.0, 0.0, 0.0 if isinstance(actor, Walker) else half[2]], [0.0, 0.0, 0.0]
        if isinstance(actor, LightActor):
            middle, half = actor.light.trigger()
        elif isinstance(actor, SignActor):
            middle, half, turn = actor.sign.trigger()
        tags = bytes([actor.tag]) if actor.tag else b""
        return [actor.id, actor.parent, actor.description, [middle, half, turn, actor.id], tags, b""]


def _ahead(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the directions in which transforms of CARLA's face."""
    pitch, yaw = np.radians(rows[:, 3]), np.radians(rows[:, 4])
    level = np.cos(pitch)
    return np.stack([level * np.cos(yaw), level * np.sin(yaw), np.sin(pitch)], axis=1)
