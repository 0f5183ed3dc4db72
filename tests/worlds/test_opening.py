"""`open_world` opens a world by its name."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler import Overrides, compile_scenario, load_network, open_world
from scenario_compiler.worlds import WorldError

CONFLICT = Path(__file__).parents[2] / "library" / "conflicts" / "obstacle_ahead.xml"


def test_an_unknown_world_is_refused_with_the_name_that_was_probably_meant() -> None:
    plan = compile_scenario(CONFLICT, overrides=Overrides(perception="ideal"))
    with pytest.raises(WorldError, match=r"there is no world 'kinematik' .*did you mean 'kinematic'") as refused:
        open_world("kinematik", plan, load_network(plan.map.file))
    assert refused.value.code.id == "SC533"
