"""The scenario's own spawn points."""

from typing import Literal

from scenario_compiler.vocabulary.positions.routes import Point
from scenario_compiler.vocabulary.word import ENTITY_ID, Word, attribute, child


class NamedPosition(Word):
    """A spawn point of the scenario."""

    word: Literal["point"] = "point"

    name: str = attribute("Its name.", defines="spawn_point", pattern=ENTITY_ID)
    position: Point = child("Position.")


class SpawnPoints(Word):
    """The scenario's own list of spawn points."""

    word: Literal["spawn_points"] = "spawn_points"

    points: tuple[NamedPosition, ...] = child("The spawn points, numbered from 0.")
