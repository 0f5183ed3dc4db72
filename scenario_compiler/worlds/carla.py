"""CARLA as a world: its camera takes pictures, its physics moves the ego, and it mirrors the other entities.

The client runs in synchronous mode. In a step, the others are moved to their poses at the end of the step, the ego gets
its command, the server ticks, and the ego's new state is read. However a run ends, the settings are restored and the
actors destroyed.
"""

from __future__ import annotations

import math
import queue
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar

from scenario_compiler.controllers.data import SensorData
from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.frames import carla_from_pose, pose_from_carla
from scenario_compiler.plan.model import Entity, Plan
from scenario_compiler.roads import Network, Pose
from scenario_compiler.vocabulary.entities import Category
from scenario_compiler.vocabulary.weather import Weather, weather_numbers
from scenario_compiler.worlds.carla_lines import Lines
from scenario_compiler.worlds.carla_session import CANNOT_OPEN, CarlaOptions, CarlaSession
from scenario_compiler.worlds.kinematic import KinematicWorld, degradation_of
from scenario_compiler.worlds.model import (
    EgoCommand,
    EgoState,
    EntityState,
    Snapshot,
    WorldError,
    WorldEvent,
    WorldFinding,
    WorldOptions,
)
from scenario_compiler.worlds.resistance import resistance

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from scenario_compiler.perception.degradation import Sensor

OTHER_BLUEPRINT = Code(
    "SC525",
    "no-such-blueprint",
    "The server has no blueprint for the entity's model, so another one of its category replaces it. Its box and "
    "appearance differ; its motion does not, because the engine moves it.\n\n"
    '    <static id="blocker" model="vehicle.audi.tt">     a blueprint of CARLA',
    Severity.WARNING,
)

BUILT_IN_CAMERA = Code(
    "SC526",
    "built-in-camera",
    "The scenario changes the paint of the road, or turns the camera on its mount. CARLA's images cannot show this: "
    "they would show fresh marks, or the road at its usual place. Therefore the built-in renderer draws the images at "
    "CARLA's poses. `--camera carla` uses CARLA's images nevertheless.\n\n"
    "    scenario-compiler run markings_missing --world carla --camera built-in",
    Severity.WARNING,
)

STAND_INS: dict[Category, str] = {
    "car": "vehicle.tesla.model3",
    "van": "vehicle.mercedes.sprinter",
    "truck": "vehicle.carlamotors.carlacola",
    "bus": "vehicle.mitsubishi.fusorosa",
    "motorbike": "vehicle.yamaha.yzf",
    "bicycle": "vehicle.diamondback.century",
    "pedestrian": "walker.pedestrian.0001",
    "cone": "static.prop.constructioncone",
    "barrier": "static.prop.streetbarrier",
    "sign": "static.prop.trafficwarning",
    "prop": "static.prop.barrel",
}
"""Blueprint by category that is used for one that the server's library does not have."""

LIFTED = 0.3
"""Height above its start at which the ego is spawned, so that it does not touch the road, m."""

ASIDE = 5000.0
"""Position, far from all else, at which other entities are spawned before they are moved to their places, m."""

HAZARD = ("indicatorLeft", "indicatorRight")
LIGHTS = {
    "lowBeam": 0x2,
    "highBeam": 0x4,
    "brakeLights": 0x8,
    "indicatorRight": 0x10,
    "indicatorLeft": 0x20,
    "reversingLights": 0x40,
    "fogLights": 0x80,
    "warningLights": 0x30,
    "specialPurposeLights": 0x200,
}
"""Bits of CARLA's light state by ASAM OpenSCENARIO's names."""

SIGNALS = {"red": "Red", "yellow": "Yellow", "green": "Green", "off": "Off"}
"""CARLA's states of traffic lights by the words of scenarios."""

ONCE = 1.5
"""Lifetime of a line that is visible in one picture, time steps."""


def time_before(t: float, step: float, frames: int) -> float:
    """Return the time of the step that was `frames` steps before the one at time `t`, s; 0 for one before the start."""
    return max(0, round(t / step) - max(0, frames)) * step


def _placed(pose: Pose) -> tuple[float, float, float]:
    """Return where a pose is and its heading, without the tilt of the body and the road."""
    return pose.x, pose.y, pose.heading


class CarlaWorld:
    """A world in a CARLA server; see `World`."""

    name: ClassVar[str] = "carla"
    Options: ClassVar[type[WorldOptions]] = CarlaOptions

    def __init__(self, plan: Plan, network: Network, options: WorldOptions | None = None) -> None:
        """Connect, load the map and set the server to synchronous mode.

        Raises:
            WorldError: CARLA cannot be used for the plan; the code's page says why.
        """
        self.plan, self.network = plan, network
        self.options = options if isinstance(options, CarlaOptions) else CarlaOptions()
        if not plan.entities:
            raise WorldError("the scenario has no entity, so that CARLA has nothing to show", CANNOT_OPEN)
        given = {"ego": self.options.ego, "camera": self.options.camera}
        self.choices = {name: value for name, value in given.items() if value not in (None, "physics")}
        self.moves_ego = self.options.ego == "physics" and plan.controller is not None
        self.findings: list[WorldFinding] = []
        self._built_in = KinematicWorld(plan, network)
        self._carla_sees = self._choose_camera()
        self._actors: dict[int, Any] = {}
        self._numbers: dict[int, int] = {}
        self._left_at = (0.0, 0.0, 0.0)
        self._sensors: list[Any] = []
        self._images: queue.Queue[Any] = queue.Queue()
        self._reports: queue.Queue[tuple[int, WorldEvent]] = queue.Queue()
        self._image: NDArray[np.uint8] | None = None
        self._degradation: Sensor | None = None
        self._lights: dict[int, int] = {}
        self._shown: dict[str, str] = {}
        self._weather: Weather | None = None
        self._clock, self._frame = 0.0, 0
        self._session = CarlaSession(plan, network, self.options)
        self._carla, self._client, self._world = self._session.carla, self._session.client, self._session.world
        self._library = self._session.library
        self._lines = Lines(self._carla, self._world, on_display=self._carla_sees)
        self.versions: dict[str, str] = self._session.versions

    def _choose_camera(self) -> bool:
        """Return whether the automation gets CARLA's images."""
        if self.plan.perception != "camera" or self.plan.controller is None:
            return False
        if self.options.camera is not None:
            return self.options.camera == "carla"
        reasons = {
            "changes the paint of the road": self.plan.markings or self.plan.secondary_markings,
            "turns the camera on its mount": any(one.kind == "misalignment" for one in self.plan.failures),
        }
        for reason in [reason for reason, holds in reasons.items() if holds]:
            message = f"the scenario {reason}, so the built-in renderer draws what the camera sees"
            self.findings.append(WorldFinding(BUILT_IN_CAMERA, message, "scenario"))
        return not any(reasons.values())

    def close(self) -> None:
        """Destroy the actors, restore the settings; a server that does not respond does this if it responds again."""
        self._session.close(self._clear)
        self._built_in.close()

    def __enter__(self) -> Self:
        """Return the world."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the world."""
        self.close()

    def _clear(self) -> None:
        """Destroy all actors in one batch, which goes on after an actor that another client has destroyed."""
        for sensor in self._sensors:
            sensor.stop()
        gone = [*self._sensors, *reversed(self._actors.values())]
        self._client.apply_batch_sync([self._carla.command.DestroyActor(one) for one in gone], False)
        self._sensors, self._actors, self._numbers, self._lights, self._shown = [], {}, {}, {}, {}

    def reset(self, snapshot: Snapshot, seed: int) -> None:
        """Spawn all entities, and tick once without motion, so that there is a picture of t = 0."""
        from scenario_compiler.perception.degradation import Sensor

        self._built_in.reset(snapshot, seed)
        self._degradation = Sensor(seed, self._built_in.mounting.camera(), self.plan.ego.vehicle.center)
        self._drain()
        with self._session.answering():
            self._clear()
            self._set_weather(self.plan.weather if snapshot.weather is None else snapshot.weather)
            self._spawn_ego(snapshot.entities[0])
            self._mirror(snapshot)
            self._clock, self._frame = 0.0, self._world.tick(self.options.timeout)
            self._look()
            if self.moves_ego:
                self._left_at = _placed(snapshot.entities[0].pose)
                self._give_speed(snapshot.entities[0])
            self._lines.draw_route(self.plan.route, self.network)
            self._follow_with_spectator()

    def _drain(self) -> None:
        for one in (self._images, self._reports):
            while not one.empty():
                one.get_nowait()

    def _spawn_ego(self, state: EntityState) -> None:
        carla, ego = self._carla, self.plan.entities[0]
        blueprint = self._blueprint(ego)
        blueprint.set_attribute("role_name", "hero")
        x, y, z, *turned = carla_from_pose(state.pose, ego.vehicle.center)
        actor = self._world.spawn_actor(
            blueprint, carla.Transform(carla.Location(x, y, z + LIFTED), carla.Rotation(*turned))
        )
        self._actors[0] = actor
        self._numbers[actor.id] = 0
        actor.set_simulate_physics(self.moves_ego)
        actor.set_transform(self._transform(0, state.pose))  # else it would fall while it begins to drive
        if self.moves_ego:
            physics, half = actor.get_physics_control(), actor.bounding_box.extent
            self._max_steer = math.radians(max((wheel.max_steer_angle for wheel in physics.wheels), default=70.0))
            wheels = [(wheel.damping_rate, wheel.radius / 100.0) for wheel in physics.wheels]
            self._slowing = resistance(wheels, physics.drag_coefficient, 4.0 * half.y * half.z, physics.mass)
        self._attach("sensor.other.collision", self._note_collision)
        self._attach("sensor.other.lane_invasion", self._note_lane)
        if self._carla_sees:
            camera = self.plan.camera
            mounted = carla.Transform(
                carla.Location(camera.x, -camera.y, camera.z), carla.Rotation(camera.pitch, -camera.yaw, camera.roll)
            )
            given = {"image_size_x": camera.width, "image_size_y": camera.height, "fov": camera.fov}
            self._attach("sensor.camera.rgb", self._images.put, mounted, given)

    def _attach(self, name: str, listen: Any, mounted: Any = None, given: dict[str, float] | None = None) -> None:
        blueprint = self._library.find(name)
        for key, value in (given or {}).items():
            blueprint.set_attribute(key, str(value))
        where = self._carla.Transform() if mounted is None else mounted
        sensor = self._world.spawn_actor(blueprint, where, attach_to=self._actors[0])
        self._sensors.append(sensor)
        sensor.listen(listen)

    def _note_collision(self, event: Any) -> None:
        if "sidewalk" in event.other_actor.type_id:
            return  # a wheel or the body grazes a kerb
        number = self._numbers.get(event.other_actor.id, 0)
        entity = self.plan.entities[number].id if number > 0 else ""
        self._reports.put((event.frame, WorldEvent("world_collision", 0.0, entity, event.other_actor.type_id)))

    def _note_lane(self, event: Any) -> None:
        kinds = ", ".join(sorted({str(mark.type) for mark in event.crossed_lane_markings}))
        self._reports.put((event.frame, WorldEvent("lane_invasion", 0.0, message=kinds)))

    def _blueprint(self, entity: Entity) -> Any:
        wanted = entity.vehicle.name
        known = {one.id for one in self._library.filter(wanted)}
        if wanted in known:
            return self._library.find(wanted)
        stand_in = STAND_INS[entity.vehicle.category]
        if not self._library.filter(stand_in):
            raise WorldError(f"CARLA's library has neither '{wanted}' nor '{stand_in}'")
        message = f"CARLA's library has no '{wanted}'; '{stand_in}' replaces it"
        if all(one.message != message for one in self.findings):
            self.findings.append(WorldFinding(OTHER_BLUEPRINT, message, f"entities/{entity.id}"))
        return self._library.find(stand_in)

    def _transform(self, number: int, pose: Pose) -> Any:
        """Return CARLA's transform of an entity at a pose; a walker's origin is the middle of its box."""
        entity = self.plan.entities[number]
        up = 0.0
        if entity.vehicle.category == "pedestrian" and number in self._actors:
            up = self._actors[number].bounding_box.extent.z
        x, y, z, *turned = carla_from_pose(pose, entity.vehicle.center, up)
        return self._carla.Transform(self._carla.Location(x, y, z), self._carla.Rotation(*turned))

    def _mirror(self, snapshot: Snapshot) -> None:
        """Move the other entities to the engine's positions; spawn new ones and destroy those that have vanished.

        The first entity has the sensors, so it waits aside while it is absent.
        """
        command, orders = self._carla.command, []
        new = [k for k, one in enumerate(snapshot.entities) if k > 0 and one.shown and k not in self._actors]
        if new:
            self._spawn_others(new)
        for number, state in enumerate(snapshot.entities):
            actor = self._actors.get(number)
            if actor is None:
                continue
            if number > 0 and not state.shown:
                orders.append(command.DestroyActor(self._actors.pop(number)))
                self._lights.pop(number, None)
                continue
            if number > 0 or not self.moves_ego:
                where = self._transform(number, state.pose) if state.shown else self._aside(number)
                orders.append(command.ApplyTransform(actor, where))
            self._switch_lights(number, state, hazard=number == 0 and snapshot.hazard_lights)
        self._client.apply_batch_sync(orders, False)
        self._show_signals(snapshot.signals)

    def _spawn_others(self, numbers: Sequence[int]) -> None:
        command, orders = self._carla.command, []
        for number in numbers:
            blueprint = self._blueprint(self.plan.entities[number])
            if blueprint.has_attribute("role_name"):
                blueprint.set_attribute("role_name", "scenario")
            still = command.SetSimulatePhysics(command.FutureActor, False)
            orders.append(command.SpawnActor(blueprint, self._aside(number)).then(still))
        answers = list(zip(numbers, self._client.apply_batch_sync(orders, False), strict=True))
        for number, answer in answers:
            if not answer.error:
                self._actors[number] = self._world.get_actor(answer.actor_id)
                self._numbers[answer.actor_id] = number
        for number, answer in answers:
            if answer.error:
                raise WorldError(f"CARLA cannot spawn '{self.plan.entities[number].id}': {answer.error}")

    def _aside(self, number: int) -> Any:
        """Return the place of an entity far from the map."""
        at = self._carla.Location(ASIDE + 30.0 * (number % 100), ASIDE + 30.0 * (number // 100), 1.0)
        return self._carla.Transform(at)

    def _switch_lights(self, number: int, state: EntityState, *, hazard: bool) -> None:
        if not self.plan.entities[number].vehicle.name.startswith("vehicle."):
            return
        bits = LIGHTS["brakeLights"] if state.braking else 0
        for name in (*state.lights, *(HAZARD if hazard else ())):
            bits |= LIGHTS.get(name, 0)
        if bits != self._lights.get(number, 0):
            self._lights[number] = bits
            self._actors[number].set_light_state(self._carla.VehicleLightState(bits))

    def _show_signals(self, signals: Sequence[tuple[str, str]]) -> None:
        for name, state in signals:
            known = SIGNALS.get(state.lower())
            if known is None or self._shown.get(name) == known:
                continue
            self._shown[name] = known
            light = self._world.get_traffic_light_from_opendrive_id(name)
            if light is not None:
                light.freeze(True)
                light.set_state(getattr(self._carla.TrafficLightState, known))

    def _set_weather(self, weather: Weather) -> None:
        if weather != self._weather:
            self._weather = weather
            self._world.set_weather(self._carla.WeatherParameters(*weather_numbers(weather)))

    def _give_speed(self, state: EntityState) -> None:
        ahead, speed = self._transform(0, state.pose).get_forward_vector(), state.speed
        self._actors[0].set_target_velocity(self._carla.Vector3D(ahead.x * speed, ahead.y * speed, ahead.z * speed))

    def _teleport(self, state: EntityState) -> None:
        """Put the ego where an action has put it in the engine since the last step."""
        if _placed(state.pose) != self._left_at:
            self._actors[0].set_transform(self._transform(0, state.pose))
            self._give_speed(state)

    def _follow_with_spectator(self) -> None:
        at = self._actors[0].get_transform()
        behind = at.transform(self._carla.Location(x=-8.0, z=4.0))
        self._world.get_spectator().set_transform(
            self._carla.Transform(behind, self._carla.Rotation(-15.0, at.rotation.yaw, 0.0))
        )

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Mirror the others, command the ego, tick, and return the ego's new state."""
        ego = self.plan.entities[0]
        with self._session.answering():
            if snapshot.weather is not None:
                self._set_weather(snapshot.weather)
            if self.moves_ego:
                self._teleport(snapshot.entities[0])
                steer = -command.steer * math.radians(ego.vehicle.max_steer) / self._max_steer
                throttle, brake = self._pedals(ego, snapshot.entities[0].speed, command)
                self._actors[0].apply_control(self._carla.VehicleControl(throttle, min(max(steer, -1.0), 1.0), brake))
            self._mirror(snapshot)
            self._lines.draw_path(snapshot.entities[0].pose, command.path, ONCE * self.plan.step)
            self._clock, before, self._frame = snapshot.t, self._frame, self._world.tick(self.options.timeout)
            if self._frame != before + 1:
                raise WorldError(
                    f"CARLA went from frame {before} to {self._frame} in one step: another client moves its clock"
                )
            self._look()
            self._follow_with_spectator()
            return self._ego_state(ego) if self.moves_ego else None

    def _pedals(self, ego: Entity, speed: float, command: EgoCommand) -> tuple[float, float]:
        """Return throttle and brake that compensate for CARLA's resistances, which the engine does not model."""
        lost = self._slowing.at(speed)
        if command.brake > 0.0:
            return command.throttle, max(command.brake - lost / ego.vehicle.max_deceleration, 0.0)
        return min(command.throttle + lost / ego.vehicle.max_acceleration, 1.0), 0.0

    def _ego_state(self, ego: Entity) -> EgoState:
        actor = self._actors[0]
        at, velocity, control = actor.get_transform(), actor.get_velocity(), actor.get_control()
        place, turned = at.location, at.rotation
        numbers = (place.x, place.y, place.z, turned.pitch, turned.yaw, turned.roll)
        pose = Pose(*pose_from_carla(numbers, ego.vehicle.center))
        ahead = at.get_forward_vector()
        speed = velocity.x * ahead.x + velocity.y * ahead.y + velocity.z * ahead.z
        steering = -math.radians(actor.get_wheel_steer_angle(self._carla.VehicleWheelLocation.FL_Wheel))
        self._left_at = _placed(pose._replace(heading=pose.heading % math.tau))  # as the engine stores it
        return EgoState(pose, speed, steering, control.throttle, control.brake)

    def _look(self) -> None:
        """Take the image of the tick."""
        if not self._carla_sees:
            return
        import numpy as np

        frame = self._world.get_snapshot().frame
        while True:
            try:
                image = self._images.get(timeout=self.options.timeout)
            except queue.Empty:
                raise WorldError(f"CARLA's camera has sent no image of frame {frame}") from None
            if image.frame >= frame:
                break
        pixels = np.frombuffer(image.raw_data, np.uint8).reshape(image.height, image.width, 4)
        self._image = np.ascontiguousarray(pixels[..., :3])

    def observe(self, snapshot: Snapshot) -> SensorData:
        """Return the camera's image: CARLA's last picture with our degradation, or one from the built-in renderer."""
        if self._image is None or self._degradation is None or not self._carla_sees:
            return self._built_in.observe(snapshot)
        wrong = degradation_of(snapshot, self.plan.ego.vehicle.wheelbase)
        image = self._degradation.deliver(self._image.copy(), wrong, snapshot.frame, snapshot.t)
        return SensorData(snapshot.t, image, self._built_in.mounting)

    def picture(self, snapshot: Snapshot) -> NDArray[np.uint8]:
        """Draw the driver's view."""
        return self._built_in.picture(snapshot)

    def events(self) -> Sequence[WorldEvent]:
        """Return the reports of the ego's collision and lane sensors since the last call.

        A report may come after a later tick, because CARLA's client calls the sensors' functions in threads of its own.
        """
        found = []
        while not self._reports.empty():
            frame, event = self._reports.get_nowait()
            found.append(event._replace(t=time_before(self._clock, self.plan.step, self._frame - frame)))
        return found
