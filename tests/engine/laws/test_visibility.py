"""VisibilityAction: who reacts to an entity. Its motion and what conditions measure do not change."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Simulation
from tests.engine.laws.told import Actor, Event, of_entity, play, speed

HIDDEN = '<VisibilityAction graphics="false" sensors="false" traffic="false"/>'


@pytest.mark.law("VisibilityAction", "used")
def test_nothing_moves_otherwise_and_conditions_still_see_it(tmp_path: Path) -> None:
    actors = {"A": Actor(s=50.0, speed=10.0), "B": Actor(s=100.0, speed=0.0)}
    touched = of_entity("A", '<CollisionCondition><EntityRef entityRef="B"/></CollisionCondition>')
    slows = Event("A", speed(3.0), touched, name="slow")
    shown = play(tmp_path, actors, [slows])
    hidden = play(tmp_path, actors, [slows, Event("B", HIDDEN, 0.5, name="hide")])
    assert hidden.rows == shown.rows
    assert shown.acts("A", 3.0) == pytest.approx(4.5, abs=0.1)


WRECK = """<dynamic id="wreck" speed="0"><start><lane road="1" lane="-2" s="400"/></start>
<when><time after="0.5"/><do><visibility graphics="true" sensors="{sensors}" traffic="{traffic}"/></do></when>
</dynamic>"""

FILE = """<scenarios version="1"><scenario name="hidden" map="motorway" duration="25">
<ego speed="20"><start><lane road="1" lane="-2" s="100"/></start></ego>{wreck}
<takeover budget="5"><cause kind="path_blocked"/><driver preset="absent"/></takeover>
</scenario></scenarios>"""


def _run(folder: Path, *, sensors: str, traffic: str) -> list[tuple[int, int]]:
    """Return whether the automation requested, and whether it collided, in both forms of the engine."""
    file = folder / "hidden.xml"
    file.write_text(FILE.format(wreck=WRECK.format(sensors=sensors, traffic=traffic)), encoding="utf-8")
    sink = Diagnostics()
    done = compile_target(file, {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, [as_text(one) for one in sink]
    found = []
    for interpreted in (True, False):
        simulation = Simulation(done.network.tables, build_program(done.plan, done.network), interpreted=interpreted)
        simulation.reset(make_draws(1, 0))
        while simulation.step():
            pass
        found.append((simulation.state.requests[0], int(simulation.state.stop[0] == op.STOP_COLLISION)))
    return found


def test_the_forward_sensor_ignores_entities_that_are_hidden_from_sensors(tmp_path: Path) -> None:
    assert _run(tmp_path, sensors="true", traffic="false") == [(1, 0), (1, 0)]
    assert _run(tmp_path, sensors="false", traffic="true") == [(0, 1), (0, 1)]
