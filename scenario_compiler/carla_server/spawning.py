"""Makes actors from the blueprints and attributes that clients send."""

from __future__ import annotations

from typing import Any

from scenario_compiler.carla_server.actors import Actor, Body, Car, Sensor, Walker, channels_of
from scenario_compiler.carla_server.blueprints import KINDS, Blueprint, first_kind, library
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.sensors.kinds import INSTRUMENTS, ON_OCCASION, REFUSED
from scenario_compiler.frames import CarlaTransform

BOOLS = ("true", "false")
"""Texts that clients read as true or false."""

MOST_PIXELS = 4096 * 4096
"""Greatest number of pixels of an image."""

LARGEST = 1e30
LIMITS = {
    "image_size_x": (1, 32_766),
    "image_size_y": (1, 32_766),
    "fov": (1e-3, 170.0),
    "channels": (1, 1024),
    "range": (0.0, LARGEST),
    "points_per_second": (0.0, 1e7),
}
"""Greatest magnitude of a sensor's numbers, and the bounds of some: pixels as OpenCV can draw them, degrees, m, 1/s."""


def check_attributes(version: str, description: list[Any]) -> None:
    """Refuse attributes that clients cannot read: each client that asked for the world's actors would get an error.

    Raises:
        CallError: An attribute has an unknown type, or a text that is not of its type.
    """
    for name, number, text in description[2]:
        place = number - first_kind(version)
        if not 0 <= place < len(KINDS):
            raise CallError(f"unable to spawn actor: its attribute '{name}' has the unknown type {number}")
        if not _is_readable(KINDS[place], text):
            raise CallError(f"unable to spawn actor: its attribute '{name}' is '{text}', not a {KINDS[place]}")


def _is_readable(kind: str, text: str) -> bool:
    if kind == "bool":
        return text.lower() in BOOLS
    return kind != "colour" or channels_of(text) is not None


def blueprint_of(version: str, name: str) -> Blueprint:
    """Return a blueprint by its id; raise CallError if there is none, or if it cannot be spawned."""
    found = library(version).get(name)
    if found is None:
        raise CallError(f"unable to spawn actor: the blueprint library has no '{name}'")
    if name in REFUSED:
        raise CallError(f"unable to spawn actor: {name} is not served: {REFUSED[name]}")
    return found


def attributes_of(blueprint: Blueprint, description: list[Any]) -> dict[str, str]:
    """Return the attributes of an actor as texts: those of the description, or the blueprint's defaults."""
    given = {name: value for name, _, value in description[2]}
    return {**blueprint.defaults, **given}


def new_body(version: str, description: list[Any], transform: CarlaTransform) -> Body:
    """Return a vehicle, walker or prop that is on no stage yet.

    Raises:
        CallError: There is no such blueprint, or it has no box.
    """
    blueprint = blueprint_of(version, description[1])
    if blueprint.vehicle is None:
        raise CallError(f"unable to spawn actor: {blueprint.name} has no box")
    kinds: dict[str, type[Body]] = {"vehicle": Car, "walker": Walker}
    made = kinds.get(blueprint.kind, Body)
    return made(0, blueprint, attributes_of(blueprint, description), description, transform, shape=blueprint.vehicle)


def new_actor(version: str, description: list[Any], transform: CarlaTransform) -> Actor:
    """Return an actor that is on no stage yet; see `new_body`.

    Raises:
        CallError: As there, or a sensor cannot work with one of its attributes.
    """
    blueprint = blueprint_of(version, description[1])
    if blueprint.vehicle is not None:
        return new_body(version, description, transform)
    attributes = attributes_of(blueprint, description)
    if blueprint.name not in INSTRUMENTS and blueprint.name not in ON_OCCASION:
        return Actor(0, blueprint, attributes, description, transform)
    sensor = Sensor(0, blueprint, attributes, description, transform)
    _check_numbers(sensor)
    return sensor


def _check_numbers(sensor: Sensor) -> None:
    """Refuse numbers with which a sensor could not measure, or not in any useful time."""
    for name in sensor.attributes:
        value, (least, most) = sensor.number(name), LIMITS.get(name, (-LARGEST, LARGEST))
        if not least <= value <= most:
            raise CallError(f"unable to spawn actor: its attribute '{name}' is {value:g}, not {least:g} to {most:g}")
    if sensor.number("image_size_x") * sensor.number("image_size_y") > MOST_PIXELS:
        raise CallError(f"unable to spawn actor: an image has at most {MOST_PIXELS} pixels")
