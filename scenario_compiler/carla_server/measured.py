"""The measured states of all actors, as the rows of a snapshot: transforms, velocities, controls, lights."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.carla_server.actors import Actor, Body, Car, LightActor, SignActor, Walker
from scenario_compiler.carla_server.falling import Fall
from scenario_compiler.carla_server.snapshot import ACTIVE, LIGHT, SIGN, VEHICLE, WALKER, Rows
from scenario_compiler.engine.motion.watching import LEAP
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.frames import CarlaTransform, carla_rows
from scenario_compiler.roads import Network

DEFAULT_LIMIT = 30.0
"""CARLA's speed limit of a road without one in the map, km/h."""

NO_FAILURE = 0
"""No failure of a vehicle."""

POSE = ("x", "y", "z", "h", "pitch", "roll")
"""Columns of the engine with the pose of a reference point."""


class Measured:
    """The rows of all actors.

    Attributes:
        rows: Their states when they were measured last.
    """

    def __init__(
        self, simulation: Simulation, network: Network, transform_of: Callable[[Actor], CarlaTransform]
    ) -> None:
        """Begin without an actor; `transform_of` returns the present transform of one."""
        self.rows = Rows(0)
        self._simulation, self._network, self._transform_of = simulation, network, transform_of
        self._limits: dict[tuple[int, int], float] = {}
        self._leapt: set[int] = set()
        self._before = np.zeros((len(simulation.column("x")), len(POSE)))
        self.arrange({})

    def arrange(self, actors: Mapping[int, Actor]) -> None:
        """Assign new rows to the actors, by their ids; actors that had rows keep the contents."""
        before, self.rows = self.rows, Rows(len(actors))
        for row, actor in enumerate(actors.values()):
            if actor.row >= 0:
                self.rows.copy_row(row, before, actor.row)
            actor.row = row
        self.rows.every["id"] = list(actors)
        self.rows.every["state"] = ACTIVE
        for actor in actors.values():
            if not isinstance(actor, Body):
                self.rows.every["transform"][actor.row] = self._transform_of(actor)
            if isinstance(actor, SignActor):
                self.rows.put(SIGN, actor.row, actor.sign.signal.encode()[:31])
        self._attached = [actor for actor in actors.values() if actor.parent and not isinstance(actor, Body)]
        self._lights = [actor for actor in actors.values() if isinstance(actor, LightActor)]
        self._bodies = [actor for actor in actors.values() if isinstance(actor, Body)]
        self._place = np.array([body.place for body in self._bodies], np.intp)
        self._index = {body.place: index for index, body in enumerate(self._bodies)}
        self._row = np.array([body.row for body in self._bodies], np.intp)
        self._center = np.array([body.shape.center for body in self._bodies])
        self._up = np.array([body.up for body in self._bodies])

    def put(self, actor: Actor) -> None:
        """Write the transform to which an actor without a body was put."""
        self.rows.every["transform"][actor.row] = self._transform_of(actor)

    def leap(self, place: int) -> None:
        """Note that a body is put somewhere else: its speed has not caused the next change of its place."""
        self._leapt.add(place)

    def measure(self, dt: float, time: float, falling: dict[int, Fall]) -> None:
        """Write every actor's state into its row, `dt` s after the last time.

        Args:
            dt: Time since the last measurement, s.
            time: The present time, s.
            falling: The falls of vehicles by their places; those that are over are removed.
        """
        if self._bodies:
            self._measure_bodies(dt, time, falling)
            self._measure_controls()
        for actor in self._attached:
            self.put(actor)
        for actor in self._lights:
            light = actor.light
            name = light.signal.encode()[:31]
            self.rows.put(LIGHT, actor.row, name, *light.times, light.elapsed, light.pole, light.frozen, light.state)

    def _measure_bodies(self, dt: float, time: float, falling: dict[int, Fall]) -> None:
        every, place, row = self.rows.every, self._place, self._row
        column = self._simulation.column
        pose = [column(name)[place] for name in POSE]
        for one, fall in list(falling.items()):
            index = self._index[one]
            if fall.is_over(pose[2][index], time):
                del falling[one]
                continue
            pose[2][index] = max(pose[2][index], fall.height(time))
            pose[4][index], pose[5][index] = fall.begin.pitch, fall.begin.roll
        now = carla_rows(np.stack(pose), self._center, self._up)
        before = self._before[place]
        self._before[place] = now
        speed, ahead = column("v")[place], _ahead(now)
        moved = now[:, :3] - before[:, :3]
        turned = (now[:, 4] - before[:, 4] + 180.0) % 360.0 - 180.0
        leapt = np.sqrt((moved * moved).sum(axis=1)) > LEAP * np.abs(speed) * dt + 1.0
        leapt[[self._index[one] for one in falling]] = False
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

    def _measure_controls(self) -> None:
        st, rows = self._simulation.state, self.rows
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
        limit = self._network.speed_limit(self._network.road_ids[road], lane, s)
        return DEFAULT_LIMIT if limit is None or not math.isfinite(limit) else limit * 3.6


def _ahead(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the directions in which transforms of CARLA's face."""
    pitch, yaw = np.radians(rows[:, 3]), np.radians(rows[:, 4])
    level = np.cos(pitch)
    return np.stack([level * np.cos(yaw), level * np.sin(yaw), np.sin(pitch)], axis=1)
