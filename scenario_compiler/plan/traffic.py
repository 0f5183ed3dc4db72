"""Background traffic as entities: their number, models and drivers; their starts are drawn in each run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from scenario_compiler.plan.model import Entity
from scenario_compiler.plan.places import spans_of
from scenario_compiler.randomness import uniform
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.entities import Follow, Traffic, Vehicle
from scenario_compiler.vocabulary.positions import RandomPosition

START_SPEED = 8.0
"""Greatest speed at the start, m/s; at this speed a vehicle can stop before the next junction or vehicle."""

WALKING_SPEED = 1.34
"""Speed of pedestrians, m/s: the mean of free walking (Weidmann 1993, Transporttechnik der Fussgaenger)."""

WALKERS_CLEAR = 3.0
"""Least distance between pedestrians at the start, m."""

TIME_GAPS = (1.0, 1.8)
"""Least and greatest desired time gap of the drivers, s.

The least is that of Treiber and Kesting 2013, table 11.2; the greatest is the rule of thumb taught in Germany, half the
speedometer's reading in metres.
"""


def traffic_entities(traffic: Traffic, vehicles: Mapping[str, Vehicle], network: Network) -> Iterator[Entity]:
    """Yield the entities of background traffic: the vehicles, then the pedestrians."""
    start = RandomPosition(roads=traffic.roads, clear=traffic.clear, seed=traffic.seed).written_at(traffic.origin)
    kilometres = sum(span.s_to - span.s_from for span in spans_of(network, start)) / 1000.0
    count = traffic.vehicles + round(traffic.density * kilometres)
    seed = traffic.seed or 0
    for k in range(count):
        draws = [uniform(seed, k, f"{traffic.id}/{stream}") for stream in ("model", "share", "gap")]
        low, high = TIME_GAPS
        yield Entity(
            id=f"{traffic.id}.{k + 1}",
            kind="traffic",
            vehicle=vehicles[_pick(traffic.types, draws[0])],
            start=start,
            speed=START_SPEED,
            desired_speed=vehicles[_pick(traffic.types, draws[0])].max_speed,
            follow=Follow(time_gap=low + (high - low) * draws[2]),
            share=traffic.slowest + (traffic.fastest - traffic.slowest) * draws[1],
            seed=traffic.seed,
        )
    walk = RandomPosition(on="sidewalk", roads=traffic.roads, clear=WALKERS_CLEAR, seed=traffic.seed)
    for k in range(count, count + traffic.pedestrians):
        model = _pick(traffic.pedestrian_types, uniform(seed, k, f"{traffic.id}/model"))
        yield Entity(
            id=f"{traffic.id}.{k + 1}",
            kind="walker",
            vehicle=vehicles[model],
            start=walk,
            speed=WALKING_SPEED,
            desired_speed=WALKING_SPEED,
            seed=traffic.seed,
        )


def _pick(models: tuple[str, ...], draw: float) -> str:
    return models[int(draw * len(models))]
