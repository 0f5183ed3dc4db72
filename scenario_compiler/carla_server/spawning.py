"""Makes actors from the blueprints and attributes that clients send."""

from __future__ import annotations

from typing import Any

from scenario_compiler.carla_server.actors import Actor, Body, Car, Sensor, Walker
from scenario_compiler.carla_server.blueprints import Blueprint, library
from scenario_compiler.carla_server.failures import CallError
from scenario_compiler.carla_server.sensors.kinds import INSTRUMENTS, ON_OCCASION, REFUSED
from scenario_compiler.frames import CarlaTransform


def blueprint_of(version: str, name: str) -> Blueprint:
    """Return a blueprint by its id; CallError where the library has none, or none that can be spawned."""
    found = library(version).get(name)
    if found is None:
        raise CallError(f"unable to spawn actor: the blueprint library has no '{name}'")
    if name in REFUSED:
        raise CallError(f"unable to spawn actor: {name} is not served: {REFUSED[name]}")
    return found


def attributes_of(blueprint: Blueprint, description: list[Any]) -> dict[str, str]:
    """Return the attributes of an actor as texts: those of the description, else the blueprint's defaults."""
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
    """Return an actor that is on no stage yet; see `new_body`."""
    blueprint = blueprint_of(version, description[1])
    if blueprint.vehicle is not None:
        return new_body(version, description, transform)
    known = blueprint.name in INSTRUMENTS or blueprint.name in ON_OCCASION
    made = Sensor if known else Actor
    return made(0, blueprint, attributes_of(blueprint, description), description, transform)
