"""Traffic lights of a map as CARLA has them: actors in groups that switch in turn.

A light is a signal of type 1000001 in the OpenDRIVE file. The lights of one controller of the file show the same; the
controllers of a junction take turns: green, yellow, then red for all before the next one's green. Controllers that no
junction names belong to the one that their lights lead to; lights without a controller take turns there by the
directions from which traffic comes, opposite ones together. Times are CARLA's defaults and can be set. A vehicle is at
a light while its box touches the area before the stop line, which is found from where the signal, or a reference to it
on another road, lies.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from scenario_compiler.carla_server.areas import Box, area_before
from scenario_compiler.carla_server.signals import LIGHT, Signals, stands
from scenario_compiler.frames import CarlaTransform, carla_from_pose
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.model import Signal

RED, YELLOW, GREEN = 0, 1, 2
"""Numbers of the states in CARLA; 3 is off and 4 unknown."""

GREEN_TIME, YELLOW_TIME, RED_TIME = 10.0, 3.0, 2.0
"""CARLA's default times, s."""

BOX = (1.5, 1.5, 2.0)
"""Half extents of the box about a point on the stop line: along the line, across it and up, m."""


@dataclass(eq=False)
class Light:
    """A traffic light.

    Attributes:
        signal: Id of its signal.
        transform: Its transform, CARLA's axes.
        stops: Points before stop lines at which vehicles wait for it, CARLA's axes.
        areas: Areas before its stop lines in which it applies to a vehicle.
        group: The lights of its junction, it among them.
        actor: Id of its actor.
        pole: Its number in the group.
        state: RED, YELLOW or GREEN.
        times: Green, yellow and red time, s; one list for all lights of a controller, which has them in CARLA.
        elapsed: How long it has had its state, s.
        frozen: Whether it keeps it.
    """

    signal: str
    transform: CarlaTransform
    stops: tuple[CarlaTransform, ...]
    areas: tuple[Box, ...]
    group: Group = field(repr=False)
    times: list[float]
    actor: int = 0
    pole: int = 0
    state: int = RED
    elapsed: float = 0.0
    frozen: bool = False

    def trigger(self) -> tuple[list[float], list[float]]:
        """Return the middle, in its own axes, and the half extents of the box about its stop line, m."""
        if not self.stops:
            return [0.0, 0.0, 0.0], list(BOX)
        yaw = math.radians(self.transform.yaw)
        c, s = math.cos(yaw), math.sin(yaw)
        away = [[at - own for at, own in zip(stop[:3], self.transform[:3], strict=True)] for stop in self.stops]
        x, y, z = ([x * c + y * s for x, y, _ in away], [y * c - x * s for x, y, _ in away], [one[2] for one in away])
        middle = [0.5 * (min(one) + max(one)) for one in (x, y, z)]
        return middle, [0.5 * (max(one) - min(one)) + half for one, half in zip((x, y, z), BOX, strict=True)]


@dataclass(eq=False)
class Group:
    """The lights of a junction: phases take turns, each the lights of one controller.

    Attributes:
        phases: The lights of each phase.
        phase: Index of the present phase.
        stage: State of its lights: GREEN, YELLOW or RED. The lights of the other phases are red.
        since: Time for which they have been in this state, s.
    """

    phases: list[list[Light]] = field(default_factory=list)
    phase: int = 0
    stage: int = GREEN
    since: float = 0.0

    @property
    def lights(self) -> list[Light]:
        """All of them."""
        return [light for phase in self.phases for light in phase]

    def reset(self) -> None:
        """Begin again with the first phase's green; each light has its state from now on."""
        self.phase, self.stage, self.since = 0, GREEN, 0.0
        for light in self.lights:
            light.elapsed = 0.0
        self._show()

    def step(self, dt: float) -> None:
        """Let time pass; a group with a frozen light keeps its states."""
        phase = self.phases[self.phase]
        if any(light.frozen for light in self.lights):
            return
        self.since += dt
        for light in self.lights:
            light.elapsed += dt
        first = phase[0]
        lasts = {GREEN: first.times[0], YELLOW: first.times[1], RED: first.times[2]}[self.stage]
        if self.since < lasts - 1e-9:
            return
        self.since = 0.0
        if self.stage == RED:
            self.phase = (self.phase + 1) % len(self.phases)
        self.stage = {GREEN: YELLOW, YELLOW: RED, RED: GREEN}[self.stage]
        self._show()

    def _show(self) -> None:
        for number, phase in enumerate(self.phases):
            for light in phase:
                self.put(light, self.stage if number == self.phase else RED)

    def put(self, light: Light, state: int) -> None:
        """Let a light show a state."""
        if light.state != state:
            light.state, light.elapsed = state, 0.0


def groups_of(signals: Signals) -> list[Group]:
    """Return the groups of a map's lights, each with its first phase green."""
    model = signals.network.model()
    controllers = {group.id: [signal for signal, _ in group.controls] for group in model.controllers}
    left = {one.id: one for one in signals.own if one.type == LIGHT}
    groups = []
    for junction in model.junctions:
        phases = [[left.pop(one) for one in controllers.get(name, ()) if one in left] for name in junction.controllers]
        groups.append([phase for phase in phases if phase])
    free: dict[int, list[list[Signal]]] = {}
    for members in controllers.values():
        phase = [left.pop(one) for one in members if one in left]
        if phase:
            free.setdefault(_junction_of(signals, phase[0]), []).append(phase)
    for leads_to, ones in _by_junction(signals, left.values()).items():
        phases = _by_direction(signals, ones) if leads_to >= 0 else [[one] for one in ones]
        free.setdefault(leads_to, []).extend(phases)
    alone = free.pop(-1, [])
    groups += [*free.values(), *([phase] for phase in alone)]
    made = []
    for phases in groups:
        if not any(phases):
            continue
        group = Group()
        for phase in phases:
            times = [GREEN_TIME, YELLOW_TIME, RED_TIME]
            group.phases.append([_light(signals, one, group, times) for one in phase])
        for pole, light in enumerate(group.lights):
            light.pole = pole
        group.reset()
        made.append(group)
    return made


def _junction_of(signals: Signals, light: Signal) -> int:
    """Return the index of the junction to which a light's lane leads; -1 if there is none."""
    stop = next(signals.stop_lines(light), None)
    if stop is None:
        return -1
    n, road = signals.network.tables, signals.network.road_index(stop.road)
    return n.road_end_junction[road] if lane_direction(n, road, stop.lane, stop.s) > 0 else n.road_start_junction[road]


def _by_junction(signals: Signals, lights: Iterable[Signal]) -> dict[int, list[Signal]]:
    found: dict[int, list[Signal]] = {}
    for light in lights:
        found.setdefault(_junction_of(signals, light), []).append(light)
    return found


def _by_direction(signals: Signals, lights: Sequence[Signal]) -> list[list[Signal]]:
    """Return the phases of lights: those along the first one's direction, and those across it."""
    headings = []
    for light in lights:
        stop = next(signals.stop_lines(light), None)
        headings.append(0.0 if stop is None else signals.network.lane_pose(stop.road, stop.lane, stop.s).heading)
    across = [abs(math.sin(heading - headings[0])) > math.sqrt(0.5) for heading in headings]
    phases = [[one for one, crosses in zip(lights, across, strict=True) if crosses is side] for side in (False, True)]
    return [phase for phase in phases if phase]


def _light(signals: Signals, signal: Signal, group: Group, times: list[float]) -> Light:
    network = signals.network
    stops: list[CarlaTransform] = []
    areas: list[Box] = []
    for stop in signals.stop_lines(signal):
        pose = network.lane_pose(stop.road, stop.lane, stop.s)
        road = network.road_index(stop.road)
        turned = 0.0 if lane_direction(network.tables, road, stop.lane, stop.s) > 0 else math.pi
        stops.append(carla_from_pose(pose._replace(heading=(pose.heading + turned) % math.tau)))
        areas.append(area_before(network, stop))
    return Light(signal.id, stands(network, signal), tuple(stops), tuple(areas), group, times)
