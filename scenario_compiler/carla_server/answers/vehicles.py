"""Calls about vehicles and walkers: their control, lights, doors and physics."""

from __future__ import annotations

import math
from typing import Any

from scenario_compiler.carla_server.actors import Car, transform_of
from scenario_compiler.carla_server.answers.actors import car_of, walker_of
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import Host

STEEPEST = 80.0
"""Greatest angle of a wheel that clients may set, degrees."""

DOORS = 6
ALL_DOORS = 6
"""Number of doors, and the number that means all of them."""

EVERY_LIGHT = 0x7FF
"""The bits of CARLA's eleven lights."""


def control(host: Host, number: int, wire: list[Any]) -> None:
    """Drive a vehicle by pedals and wheel; a change of reverse changes the gear, as CARLA's does."""
    car = car_of(host, number)
    _, _, _, _, reverse, manual, gear = wire
    if reverse != car.control[4]:
        car.gear = -1 if reverse else 1
    elif manual:
        car.gear = gear
    elif car.control[5]:
        car.gear = -1 if reverse else 1
    car.control, car.ackermann = wire, None
    host.stage.driving.command(car)


def ackermann(host: Host, number: int, wire: list[float]) -> None:
    """Give a vehicle's Ackermann controller its target: steering angle and speed."""
    car_of(host, number).ackermann = wire


def ackermann_settings(host: Host, number: int) -> list[float]:
    """Answer with the settings of a vehicle's Ackermann controller."""
    return car_of(host, number).tuning


def set_ackermann_settings(host: Host, number: int, wire: list[float]) -> None:
    """Store the settings of a vehicle's Ackermann controller; the vehicle follows the target without them."""
    car_of(host, number).tuning = wire


def walk(host: Host, number: int, wire: list[Any]) -> None:
    """Let a walker walk."""
    walker = walker_of(host, number)
    walker.control = wire
    host.stage.driving.walk(walker)


def walk_state(host: Host, number: int, transform: list[Any], speed: float) -> None:
    """Move a walker to a place and let it walk on at a speed."""
    walker = walker_of(host, number)
    placed = transform_of(transform)
    host.stage.put(walker, placed)
    yaw = math.radians(placed.yaw)
    walker.control = [[math.cos(yaw), math.sin(yaw), 0.0], speed, False]
    host.stage.driving.walk(walker)


def bones(host: Host, number: int) -> list[Any]:
    """Answer with the bones that a client has given a walker: their transforms three times over."""
    return [[[name, one, one, one] for name, one in walker_of(host, number).bones.items()]]


def set_bones(host: Host, number: int, wire: list[Any]) -> None:
    """Keep the transforms of a walker's bones."""
    walker = walker_of(host, number)
    walker.bones.update({name: transform for name, transform in wire[0][:256]})
    if len(walker.bones) > 256:
        walker.bones.clear()


def physics(host: Host, number: int) -> list[Any]:
    """Answer with a vehicle's physics control; in a friction trigger its tires have the trigger's friction.

    That of a vehicle which has been destroyed a moment ago is known too.
    """
    gone = host.stage.gone(number)
    if isinstance(gone, Car):
        return gone.physics_control()
    car = car_of(host, number)
    at = host.stage.transform_of(car)
    told = car.physics_control()
    friction = host.stage.friction_at(at)
    if friction is None:
        return told
    return [*told[:15], [[friction, *wheel[1:]] for wheel in told[15]], *told[16:]]


def set_physics(host: Host, number: int, wire: list[Any]) -> None:
    """Set a vehicle's physics control; wheel angle, mass, friction, damping and drag have an effect."""
    car = car_of(host, number)
    mass, wheels = wire[11], wire[15]
    if not mass > 0.0 or any(not 0.0 <= wheel[2] <= STEEPEST for wheel in wheels):
        raise CallError(f"a mass is positive, and a wheel turns 0 to {STEEPEST:g} degrees")
    if len(wheels) != len(car.physics_control()[15]):
        raise CallError(f"a physics control has {len(car.physics_control()[15])} wheels, not {len(wheels)}")
    car.physics, car.mass = wire, mass
    car.weigh_up()
    host.stage.driving.command(car)


def turn_wheel(host: Host, number: int, wheel: int, angle: float) -> None:
    """Turn a wheel of a vehicle without physics, degrees; with physics, the wheels follow the steering."""
    car = car_of(host, number)
    if not car.simulates:
        car.turned[wheel] = angle


def wheel_angle(host: Host, number: int, wheel: int) -> float:
    """Answer with the angle of a wheel, degrees, positive to the right."""
    car = car_of(host, number)
    if not car.simulates and wheel in car.turned:
        return car.turned[wheel]
    steers = wheel < (1 if car.two_wheeled else 2)
    return -math.degrees(host.stage.simulation.state.steer[car.place]) if steers else 0.0


def lights(host: Host, number: int) -> list[int]:
    """Answer with a vehicle's lights."""
    return [car_of(host, number).lights]


def set_lights(host: Host, number: int, wire: list[int]) -> None:
    """Switch a vehicle's lights; bits that name no light are lost."""
    car_of(host, number).lights = wire[0] & EVERY_LIGHT
    host.note_lights()


def all_lights(host: Host) -> list[list[int]]:
    """Answer with the lights of all vehicles: a Traffic Manager takes one that is missing to have every bit set."""
    return [[body.id, body.lights] for body in host.stage.bodies() if isinstance(body, Car)]


def open_door(host: Host, number: int, door: int) -> None:
    """Open a door, or all."""
    car = car_of(host, number)
    car.doors |= set(range(DOORS)) if door == ALL_DOORS else {door}


def close_door(host: Host, number: int, door: int) -> None:
    """Close a door, or all."""
    car = car_of(host, number)
    car.doors -= set(range(DOORS)) if door == ALL_DOORS else {door}


def telemetry(host: Host, number: int) -> list[Any]:
    """Answer with a vehicle's telemetry: speed, pedals, steering wheel and gear; what the bicycle model lacks is 0."""
    car = car_of(host, number)
    st = host.stage.simulation.state
    throttle, steer, brake, *_ = car.control
    return [st.v[car.place], steer, throttle, brake, 0.0, car.gear, 0.3, []]
