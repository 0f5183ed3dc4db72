"""Actors that were destroyed a moment ago.

Clients ask for the boxes and the physics of the actors that they see in the last snapshot. A Traffic Manager does so in
a thread, where an error ends the client.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scenario_compiler.carla_server.actors import Actor

REMEMBERED = 10.0
"""Time for which they are remembered, s."""


@dataclass(frozen=True)
class Gone:
    """A destroyed actor, its box on the wire, and the time until which it is remembered, s."""

    actor: Actor
    box: list[Any]
    until: float


class Departed:
    """The actors that have been destroyed and are still remembered, at most so many at once."""

    def __init__(self, most: int) -> None:
        """Begin without any."""
        self._most = most
        self._gone: dict[int, Gone] = {}

    def add(self, actor: Actor, box: list[Any], time: float) -> None:
        """Remember an actor that is destroyed at a time, s, and its box on the wire."""
        if len(self._gone) < self._most:
            self._gone[actor.id] = Gone(actor, box, time + REMEMBERED)

    def get(self, number: int) -> Gone | None:
        """Return the remembered data of an actor; None if it is not remembered."""
        return self._gone.get(number)

    def forget(self, time: float) -> None:
        """Forget the actors whose time is over at a time, s."""
        self._gone = {number: one for number, one in self._gone.items() if one.until > time}
