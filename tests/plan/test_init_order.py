"""Actions of the init are executed after those that they depend on, whatever their order in the file."""

from __future__ import annotations

from itertools import pairwise

import pytest

from scenario_compiler.plan.init_order import circular, in_order
from scenario_compiler.randomness import hash_bits
from scenario_compiler.vocabulary.actions import LaneOffsetAction, RelativeSpeedAction, SpeedAction, TeleportAction
from scenario_compiler.vocabulary.positions import FreePosition, RelativeObjectPosition
from scenario_compiler.vocabulary.storyboard import InitAction


def at(entity: str, x: float = 0.0) -> InitAction:
    return InitAction(entity=entity, action=TeleportAction(position=FreePosition(x=x, y=0.0)))


def behind(entity: str, other: str) -> InitAction:
    return InitAction(
        entity=entity, action=TeleportAction(position=RelativeObjectPosition(entity=other, dx=-10.0, dy=0.0))
    )


def faster(entity: str, other: str) -> InitAction:
    return InitAction(entity=entity, action=RelativeSpeedAction(to=other, value=2.0))


def drives(entity: str) -> InitAction:
    return InitAction(entity=entity, action=SpeedAction(to=5.0))


def aside(entity: str) -> InitAction:
    return InitAction(entity=entity, action=LaneOffsetAction(to=1.0, over_time=0.0))


def test_the_order_of_the_file_is_kept_where_nothing_depends_on_what_follows() -> None:
    written = (at("a"), drives("a"), behind("b", "a"), faster("b", "a"), aside("a"), at("a", 5.0), behind("c", "a"))
    assert in_order(written, ()) == written
    assert list(circular(written, ())) == []


def test_an_action_follows_those_that_it_depends_on() -> None:
    written = (behind("a", "b"), aside("a"), faster("a", "b"), behind("b", "c"), at("c"), drives("c"), faster("b", "c"))
    assert in_order(written, ()) == (
        *(at("c"), behind("b", "c"), behind("a", "b"), aside("a")),
        *(drives("c"), faster("b", "c"), faster("a", "b")),
    )


def test_an_entity_that_has_a_start_is_not_waited_for() -> None:
    written = (behind("a", "b"), at("b"))
    assert in_order(written, {"b"}) == written
    assert list(circular(written, {"b"})) == []


@pytest.mark.parametrize("seed", range(5))
def test_every_order_of_a_long_queue_gives_the_same_places(seed: int) -> None:
    """Each vehicle stands behind the next; the order of the file is random, or from the last to the first."""
    names = [f"car{k}" for k in range(3000)]
    written = [behind(one, other) for one, other in pairwise(names)] + [at(names[-1])]
    if seed:
        written.sort(key=lambda one: hash_bits(seed, int(one.entity[3:]), "order"))
    ordered = in_order(written, ())
    assert sorted(one.entity for one in ordered) == sorted(names)
    assert list(circular(ordered, ())) == []


def test_a_circle_is_broken_in_the_order_of_the_file_and_found() -> None:
    written = (faster("a", "b"), faster("b", "c"), faster("c", "a"))
    ordered = in_order(written, ())
    assert ordered == (faster("c", "a"), faster("b", "c"), faster("a", "b"))
    assert list(circular(ordered, ())) == [(ordered[0], ordered[2])]
