"""Hands the controls of vehicles and walkers to the engine."""

from __future__ import annotations

import math

from scenario_compiler.carla_server.actors import MAX_STEER, Body, Car, Walker
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.frames import vector_from_carla

FASTEST = 300.0
"""Greatest speed that clients may ask for, m/s."""

STEER_RATE = 3.0
"""Rate at which wheels are turned, rad/s: to the full angle in 0.4 s, as Unreal's wheeled vehicles do by default (not
verified for CARLA's).
"""

FASTEST_WALK = 40.96
"""Greatest speed of a walker, m/s: CARLA's (`AWalkerController::GetMaximumWalkSpeed`)."""

WALKER_GAIN = 3.0
"""Acceleration and deceleration of a walker after an impact, m/s2."""

NEUTRAL = 0
"""The neutral gear."""


class Driving:
    """Hands the controls of bodies to the engine."""

    def __init__(self, simulation: Simulation) -> None:
        """Keep the engine."""
        self._simulation = simulation

    def set_speed(self, body: Body, speed: float) -> None:
        """Give a body a speed along its heading, m/s."""
        self._simulation.state.v[body.place] = min(max(speed, -FASTEST), FASTEST)

    def command(self, car: Car) -> None:
        """Hand a vehicle's control to the engine."""
        throttle, steer, brake, hand, reverse, _, _ = car.control
        brake = 1.0 if hand else min(max(brake, 0.0), 1.0)
        scale = car.steers / MAX_STEER
        self._simulation.command(
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
        wanted = _walking_speed(walker)
        if not walker.simulates:
            self._simulation.let_pose(walker.place, posed=wanted == 0.0)
        if wanted > 0.0:
            dx, dy, _ = vector_from_carla(x * speed, y * speed, 0.0)
            self._simulation.state.h[walker.place] = math.atan2(dy, dx) % math.tau
        self.set_speed(walker, wanted)

    def advance(self, body: Body, dt: float) -> None:
        """Change a body's speed before a step of the engine by its control, its client and resistance."""
        if isinstance(body, Walker):
            self._walk_on(body, dt)
        elif isinstance(body, Car):
            self._drive_on(body, dt)

    def _walk_on(self, walker: Walker, dt: float) -> None:
        """Let a walker that an impact has stopped or pushed walk again as before."""
        wanted, speed = _walking_speed(walker), self._simulation.state.v[walker.place]
        if speed != wanted:
            change = WALKER_GAIN * dt
            self.set_speed(walker, min(max(wanted, speed - change), speed + change))

    def _drive_on(self, car: Car, dt: float) -> None:
        st = self._simulation.state
        if car.ackermann is not None:
            self._follow_target(car, car.ackermann, dt)
        if car.pushed:
            self.set_speed(car, st.v[car.place] + car.pushed)
            car.pushed = 0.0
        if car.constant is not None:
            self.set_speed(car, car.constant)
            self._simulation.command(car.place, 0.0, st.command_steer[car.place], 0.0)
        elif car.simulates:
            speed = st.v[car.place]
            if speed != 0.0:
                lost = car.slowing.at(speed, car.grip) * dt
                st.v[car.place] = math.copysign(max(abs(speed) - lost, 0.0), speed)

    def _follow_target(self, car: Car, target: list[float], dt: float) -> None:
        """Steer and accelerate for an Ackermann controller's target: it sets the vehicle's control, as CARLA's does."""
        steer, steer_speed, speed, acceleration, _ = target
        st, place = self._simulation.state, car.place
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


def _walking_speed(walker: Walker) -> float:
    """Return the speed of a walker's control, m/s: as in CARLA, the length of its direction is a factor.

    `AWalkerController` hands both to `APawn::AddMovementInput`; the Unreal Engine ignores the input's vertical part and
    limits it to the greatest speed.
    """
    (x, y, _), speed, _ = walker.control
    return min(math.hypot(x, y) * abs(float(speed)), FASTEST_WALK)
