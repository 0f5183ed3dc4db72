"""Lights of a junction that names no controllers: its controllers, or else its directions, take turns."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.carla_server.signals import Signals
from scenario_compiler.carla_server.traffic_lights import GREEN, RED, YELLOW, groups_of
from scenario_compiler.roads.network import load_network


@pytest.mark.parametrize("controllers", [True, False])
def test_lights_of_a_junction_take_turns(repository: Path, tmp_path: Path, controllers: bool) -> None:
    tree = etree.parse(repository / "maps" / "signal_crossing" / "signal_crossing.xodr")
    for one in tree.getroot().findall("controller"):
        if not controllers:
            tree.getroot().remove(one)
    path = tmp_path / "crossing.xodr"
    tree.write(path)
    network = load_network(path, cache=False)
    (group,) = groups_of(Signals(network))
    assert sorted(light.signal for light in group.lights) == ["11", "12", "21", "22"]
    assert [len(phase) for phase in group.phases] == [2, 2]
    ways = [[math.radians(light.stops[0].yaw) for light in phase] for phase in group.phases]
    for one, other in ways:
        assert math.cos(one - other) < -0.99  # opposite
    assert abs(math.cos(ways[0][0] - ways[1][0])) < 0.01  # across
    seen = set()
    for _ in range(800):
        group.step(0.05)
        shown = tuple(tuple(light.state for light in phase) for phase in group.phases)
        assert all(len(set(states)) == 1 for states in shown)
        assert sum(states[0] != RED for states in shown) <= 1
        seen |= {k for k, states in enumerate(shown) if states[0] == GREEN}
    assert seen == {0, 1}


def test_the_lights_of_a_controller_have_the_same_times(repository: Path) -> None:
    """CARLA's controllers have the times; setting one light's must not be lost because another one leads its phase."""
    network = load_network(repository / "maps" / "signal_crossing" / "signal_crossing.xodr", cache=False)
    (group,) = groups_of(Signals(network))
    first, second = group.phases[0]
    second.times[0] = 1.0
    assert first.times[0] == 1.0
    assert group.phases[1][0].times[0] != 1.0
    group.reset()
    for _ in range(21):
        group.step(0.05)
    assert [light.state for light in group.phases[0]] == [YELLOW, YELLOW]


def test_a_group_that_begins_again_has_shown_its_states_for_no_time(repository: Path) -> None:
    network = load_network(repository / "maps" / "signal_crossing" / "signal_crossing.xodr", cache=False)
    (group,) = groups_of(Signals(network))
    group.step(3.0)
    group.reset()
    assert [light.elapsed for light in group.lights] == [0.0] * 4
