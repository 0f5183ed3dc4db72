"""Actors that have been destroyed a moment ago.

Clients ask for the boxes and the physics of the actors that they see in the last snapshot. A Traffic Manager does so in
a thread, where an error ends the client.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scenario_compiler.carla_server.actors import Actor

REMEMBERED = 10.0
"""For how long they are known, s."""


@dataclass(frozen=True)
class Gone:
    """An actor that has been destroyed, its box on the wire, and until when it is remembered, s."""

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
        """Return what is remembered of an actor, None if nothing is."""
        return self._gone.get(number)

    def forget(self, time: float) -> None:
        """Forget those that have been remembered long enough at a time, s."""
        self._gone = {number: one for number, one in self._gone.items() if one.until > time}
