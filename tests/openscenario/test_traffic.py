"""Actions on traffic in OpenSCENARIO files: what vehicles are, what has no meaning, and the way out and back in."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.openscenario.export.files import export_files
from scenario_compiler.vocabulary.actions import KeepsVehicles
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.traversal import walk
from tests.openscenario.made import CAR, expanded, found, scenario_text

TARGETS = Path(__file__).parents[1] / "engine" / "traffic_actions.xml"

SWARM = """
<GlobalAction><TrafficAction trafficName="t">
  <TrafficSwarmAction innerRadius="10" numberOfVehicles="8" offset="0" semiMajorAxis="200" semiMinorAxis="50">
    <CentralObject entityRef="Ego"/>{definition}
  </TrafficSwarmAction>
</TrafficAction></GlobalAction>"""

TRUCKS = """
<TrafficDefinition name="d">
  <VehicleCategoryDistribution>
    <VehicleCategoryDistributionEntry category="truck" weight="3"/>
    <VehicleCategoryDistributionEntry category="{other}" weight="1"/>
  </VehicleCategoryDistribution>
  <ControllerDistribution>
    <ControllerDistributionEntry weight="1"><Controller name="traffic_by_rules"><Properties/></Controller>
    </ControllerDistributionEntry>
  </ControllerDistribution>
</TrafficDefinition>"""

DISTRIBUTION = f"""
<TrafficDistribution>
  <TrafficDistributionEntry weight="2">
    <EntityDistribution>
      <EntityDistributionEntry weight="3"><ScenarioObjectTemplate>{CAR}</ScenarioObjectTemplate>
      </EntityDistributionEntry>
      <EntityDistributionEntry weight="1"><ScenarioObjectTemplate>
        <ExternalObjectReference name="x"/>
      </ScenarioObjectTemplate></EntityDistributionEntry>
    </EntityDistribution>
  </TrafficDistributionEntry>
</TrafficDistribution>"""


def read(definition: str) -> tuple[Scenario, list[tuple[str, float]], list[str]]:
    """Return a scenario with a swarm, its kinds and weights, and the codes that are reported."""
    scenario, codes = expanded(scenario_text(init=SWARM.format(definition=definition)))
    actions = [one for one in walk(scenario.storyboard) if isinstance(one, KeepsVehicles)]
    kinds = [(kind.category, kind.weight) for one in actions for kind in one.kinds]
    return scenario, [(str(name), weight) for name, weight in kinds], codes


def test_a_definition_says_which_vehicles_there_are_and_how_often() -> None:
    scenario, kinds, codes = read(TRUCKS.format(other="car"))
    assert kinds == [("truck", 3.0), ("car", 1.0)]
    assert [(one.name, one.category) for one in scenario.vehicles] == [("car", "car"), ("usual truck", "truck")]
    assert codes == []


def test_unsupported_parts_of_traffic_are_reported() -> None:
    _, kinds, codes = read(TRUCKS.format(other="trailer"))
    assert kinds == [("truck", 3.0)]
    assert codes == ["SC785"]


def test_a_distribution_specifies_the_kinds_by_vehicles() -> None:
    _, kinds, codes = read(DISTRIBUTION)
    assert kinds == [("car", 6.0)]
    assert codes == ["SC785"]


def compiled(target: str | Path) -> Compilation:
    """Return a compilation with ideal perception."""
    sink = Diagnostics()
    done = compile_target(target, {}, sink, overrides=Overrides(perception="ideal", duration=20.0))
    assert done is not None, [as_text(one) for one in sink]
    return done


def rows(done: Compilation) -> list[tuple[list[float], list[float], list[int]]]:
    """Return who is where in each row of a run."""
    program = build_program(done.plan, done.network)
    state = new_state(program)
    state.draw[:] = make_draws(1)
    reset(done.network.tables, program, state)
    found = [(state.x[:], state.y[:], state.present[:])]
    while state.stop[0] == 0 and step(done.network.tables, program, state) == 1:
        found.append((state.x[:], state.y[:], state.present[:]))
    return found


@pytest.mark.parametrize("name", ["swarm", "highway"])
def test_what_was_exported_runs_as_before(name: str, tmp_path: Path) -> None:
    done, sink = compiled(f"{TARGETS}#{name}"), Diagnostics()
    path = tmp_path / "exported.xosc"
    files = export_files(done.plan, done.network, path, (1, 3), sink, done.scenario)
    for file, content in files.items():
        file.write_bytes(content)
    before, after = rows(done), rows(compiled(path))
    assert [row[2] for row in before] == [row[2] for row in after]
    for one, other in zip(before, after, strict=True):
        for x, again in zip(one[0] + one[1], other[0] + other[1], strict=True):
            assert x == pytest.approx(again, abs=1e-6)


RANGE = '<InitialSpeedRange lowerLimit="{}" upperLimit="{}"/>'
STOP = '<GlobalAction><TrafficAction trafficName="{}"><TrafficStopAction/></TrafficAction></GlobalAction>'


def places(init: str) -> list[tuple[str, str, int]]:
    """Return the findings on a file with actions on traffic: the code, the severity and the line."""
    _, sink = found(scenario_text(init=init), Path("made.xosc"), {})
    return [(one.code.id, one.severity.value, one.place.line) for one in sink]


@pytest.mark.parametrize(("limits", "reported"), [((9, 5), ["SC263"]), ((5, 5), [])])
def test_a_range_of_speeds_that_ends_below_its_start_is_reported(limits: tuple[int, int], reported: list[str]) -> None:
    findings = places(SWARM.format(definition=RANGE.format(*limits)))
    assert [code for code, _, _ in findings] == reported
    assert all(line > 1 for _, _, line in findings)


@pytest.mark.parametrize(("name", "reported"), [("t", []), ("nobody", [("SC293", "warning")])])
def test_an_end_of_traffic_that_does_not_exist_is_reported(name: str, reported: list[tuple[str, str]]) -> None:
    findings = places(SWARM.format(definition="") + STOP.format(name))
    assert [(code, severity) for code, severity, _ in findings] == reported
