"""The vehicles of traffic actions: entities that are absent until their action makes them appear.

In the plan they are consecutive. Their ids are `<name>.<k>`, or `<name>#<n>.<k>` from the second action of a name on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import ceil

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.model import Entity
from scenario_compiler.plan.traffic import TIME_GAPS
from scenario_compiler.randomness import uniform
from scenario_compiler.vocabulary.actions import KeepsVehicles, SpeedRange, TrafficKind, TrafficSourceAction
from scenario_compiler.vocabulary.entities import Follow, Vehicle
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import Number

NAME_TAKEN = Code(
    "SC287",
    "traffic-name-taken",
    "An action on traffic has the same name as another part of the scenario, so their vehicles would have the same "
    "names.\n\n"
    '    <traffic id="flow" vehicles="20"/>\n'
    '    <do><traffic_swarm traffic="flow" .../></do>     give one of them another name',
)
NO_VEHICLE = Code(
    "SC288",
    "no-vehicle-of-category",
    "Traffic has a category for which the scenario has no vehicle. A file uses the vehicles of the library's "
    "catalogs; a scenario built in Python must include them.\n\n"
    '    <traffic_swarm ...><kind category="bus"/></traffic_swarm>     no catalog has a bus',
)

LESS_TRAFFIC = Code(
    "SC289",
    "less-traffic-than-asked",
    "A swarm has more vehicles than the limit, or a source creates none. The greatest swarm has 500 vehicles.\n\n"
    '    <TrafficSwarmAction numberOfVehicles="5000" .../>     the limit is 500\n'
    '    <TrafficSourceAction rate="0" .../>     write the number of vehicles per second',
    Severity.WARNING,
)

MOST_OF_SOURCE = 100
"""Greatest number of a source's vehicles that are present at once."""

MOST_OF_SWARM = 500
"""Greatest number of vehicles of a swarm."""

UNNAMED = "traffic"
"""Name used in the ids for actions without a name."""

SHARES = (0.85, 1.1)
"""Least and greatest share of the speed limit that drivers aim for: the defaults of `vocabulary.entities.Traffic`."""

NO_LIMIT = 1.0e6
"""Share of the speed limit for drivers with a desired speed of their own."""


def vehicles_of(action: KeepsVehicles, duration: float) -> int:
    """Return the number of vehicles of an action in a run of `duration` s."""
    if isinstance(action, TrafficSourceAction):
        return ceil(min(float(MOST_OF_SOURCE), max(action.rate, 0.0) * duration))
    return min(max(action.vehicles, 0), MOST_OF_SWARM)


def group_name(action: KeepsVehicles, numbers: Counter[str]) -> str:
    """Return the part of the ids of an action's vehicles before the point; `numbers` counts the actions by name."""
    name = action.traffic or UNNAMED
    numbers[name] += 1
    return name if numbers[name] == 1 else f"{name}#{numbers[name]}"


def kept_entities(
    storyboard: Storyboard, vehicles: Sequence[Vehicle], taken: Sequence[Entity], duration: float, sink: Diagnostics
) -> Iterator[Entity]:
    """Yield the vehicles of a storyboard's traffic actions, in the order of the actions.

    Args:
        storyboard: The storyboard.
        vehicles: The scenario's vehicles.
        taken: The scenario's other entities; an action whose vehicles would have one of their ids is reported.
        duration: Greatest duration of the run, s.
        sink: The sink for these reports, and for those of vehicle categories that no vehicle has.
    """
    numbers: Counter[str] = Counter()
    for action in walk(storyboard):
        if not isinstance(action, KeepsVehicles):
            continue
        group = group_name(action, numbers)
        if any(one.id.rpartition(".")[0] == group for one in taken):
            message = f"there are entities '{group}.1' and so on already, as those of this action would be called"
            sink.add(NAME_TAKEN, message, action.place_of("traffic"), hint=f'name it: traffic="{group}_2"')
            continue
        models = _models(action.kinds, vehicles)
        if not models:
            sink.add(NO_VEHICLE, "no vehicle belongs to one of the categories", action.origin)
            continue
        count = vehicles_of(action, duration)
        asked = count if isinstance(action, TrafficSourceAction) else action.vehicles
        if count < asked or (count == 0 and isinstance(action, TrafficSourceAction)):
            sink.add(LESS_TRAFFIC, f"the action gets {count} vehicles", action.origin)
        for k in range(count):
            yield _entity(action, f"{group}.{k + 1}", k, models)


def _entity(action: KeepsVehicles, name: str, k: int, models: Mapping[float, Sequence[Vehicle]]) -> Entity:
    part, model, share, gap, pace = (
        uniform(0, k, f"{name.rpartition('.')[0]}/{stream}") for stream in ("kind", "model", "share", "gap", "speed")
    )
    some = next(one for limit, one in models.items() if part <= limit)
    vehicle = some[int(model * len(some))]
    speed = _speed(action, pace)
    low, high = SHARES
    return Entity.model_construct(
        id=name,
        kind="traffic",
        vehicle=vehicle,
        speed=vehicle.max_speed if speed is None else speed,
        desired_speed=vehicle.max_speed if speed is None else speed,
        follow=Follow(time_gap=TIME_GAPS[0] + (TIME_GAPS[1] - TIME_GAPS[0]) * gap),
        share=low + (high - low) * share if speed is None else NO_LIMIT,
    )


def _speed(action: KeepsVehicles, draw: float) -> Number | None:
    speeds = getattr(action, "speeds", None)
    if isinstance(speeds, SpeedRange):
        return speeds.low + (speeds.high - speeds.low) * draw
    return action.speed


def _models(kinds: Sequence[TrafficKind], vehicles: Sequence[Vehicle]) -> dict[float, list[Vehicle]]:
    """Return the vehicles of each kind by the cumulative share of the kinds, up to 1.

    Vehicles with a coupler are left out, because they are towed.
    """
    wanted = kinds or (TrafficKind(category="car"),)
    found = [(one, [v for v in vehicles if v.category == one.category and v.coupler is None]) for one in wanted]
    usable = [(kind.weight, some) for kind, some in found if some and kind.weight > 0.0]
    total = sum(weight for weight, _ in usable)
    shares: dict[float, list[Vehicle]] = {}
    reached = 0.0
    for weight, some in usable:
        reached += weight
        shares[1.0 if some is usable[-1][1] else reached / total] = some
    return shares
