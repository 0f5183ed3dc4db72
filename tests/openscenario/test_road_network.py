"""Controllers of traffic signals, and the road file's name."""

from __future__ import annotations

from scenario_compiler.vocabulary.signals import SignalController, SignalPhase, SignalState
from tests.openscenario.made import expanded, scenario_text

CONTROLLER = """
<TrafficSignals>
  <TrafficSignalController name="crossing" delay="2" reference="other">
    <Phase name="go" duration="10"><TrafficSignalState trafficSignalId="7" state="green"/></Phase>
    <Phase name="stop" duration="INF"/>
  </TrafficSignalController>
</TrafficSignals>"""
ROAD = '<LogicFile filepath="highway_loop"/>'


def test_controllers_have_their_phases() -> None:
    (found,) = expanded(scenario_text(road=ROAD + CONTROLLER))[0].signal_controllers
    states = (SignalState(signal="7", state="green"),)
    assert found == SignalController(
        name="crossing",
        delay=2.0,
        reference="other",
        phases=(SignalPhase(name="go", duration=10.0, states=states), SignalPhase(name="stop", duration=1e10)),
    )


def test_a_controller_is_declared_once() -> None:
    scenario, codes = expanded(scenario_text(road=ROAD + CONTROLLER + CONTROLLER))
    assert "SC216" in codes
    assert len(scenario.signal_controllers) == 1


def test_a_road_file_may_be_named_with_backslashes() -> None:
    road = '<LogicFile filepath="..\\roads\\town_grid.xodr"/><SceneGraphFile filepath="x.osgb"/>'
    scenario, codes = expanded(scenario_text(road=road))
    assert (scenario.map, codes) == ("../roads/town_grid.xodr", [])
