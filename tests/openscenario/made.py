"""Small OpenSCENARIO files, put together from the parts that a test is about."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document
from scenario_compiler.openscenario.expansion import expand_openscenario, read_openscenario
from scenario_compiler.vocabulary.scenario import Scenario

BOX = '<BoundingBox><Center x="1.4" y="0" z="0.7"/><Dimensions length="4.5" width="1.8" height="1.5"/></BoundingBox>'
CAR = f"""
<Vehicle name="car" vehicleCategory="car">
  {BOX}
  <Performance maxSpeed="60" maxAcceleration="5" maxDeceleration="9"/>
  <Axles>
    <FrontAxle maxSteering="0.5" wheelDiameter="0.6" trackWidth="1.6" positionX="2.8" positionZ="0.3"/>
    <RearAxle maxSteering="0" wheelDiameter="0.6" trackWidth="1.6" positionX="0" positionZ="0.3"/>
  </Axles>
</Vehicle>"""
EGO = f'<ScenarioObject name="Ego">{CAR}</ScenarioObject>'
AT_ONE = '<ByValueCondition><SimulationTimeCondition value="1" rule="greaterThan"/></ByValueCondition>'
ACTORS = '<Actors selectTriggeringEntities="false"><EntityRef entityRef="Ego"/></Actors>'


def entity(name: str = "Ego", inside: str = CAR) -> str:
    """Return a <ScenarioObject>."""
    return f'<ScenarioObject name="{name}">{inside}</ScenarioObject>'


def condition(inside: str = AT_ONE, **attributes: str) -> str:
    """Return a <Condition> in its group."""
    written = {"name": "when", "delay": "0", "conditionEdge": "none"} | attributes
    return f"<ConditionGroup><Condition {_attributes(written)}>{inside}</Condition></ConditionGroup>"


def speed(value: str = "0", duration: str = "2") -> str:
    """Return a <PrivateAction> that changes the speed."""
    return f"""
<PrivateAction><LongitudinalAction><SpeedAction>
  <SpeedActionDynamics dynamicsShape="linear" dynamicsDimension="time" value="{duration}"/>
  <SpeedActionTarget><AbsoluteTargetSpeed value="{value}"/></SpeedActionTarget>
</SpeedAction></LongitudinalAction></PrivateAction>"""


def event(name: str = "brake", start: str = "", action: str = "", **attributes: str) -> str:
    """Return an <Event> with one action: the car brakes after a second by default."""
    written = {"name": name, "priority": "override"} | attributes
    inside = (
        f'<Action name="{name} action">{action or speed()}</Action><StartTrigger>{start or condition()}</StartTrigger>'
    )
    return f"<Event {_attributes(written)}>{inside}</Event>"


def story(*events: str, actors: str = ACTORS, maneuver: str = "", declared: str = "") -> str:
    """Return a <Story> of one act, group and maneuver."""
    inside = maneuver or f'<Maneuver name="maneuver">{"".join(events)}</Maneuver>'
    group = f'<ManeuverGroup name="group" maximumExecutionCount="1">{actors}{inside}</ManeuverGroup>'
    return f'<Story name="story">{declared}<Act name="act">{group}<StartTrigger/></Act></Story>'


def declarations(*parameters: str) -> str:
    """Return <ParameterDeclarations> of parameters written as `name:type=value`."""
    parts = [one.replace(":", "=", 1).split("=", 2) for one in parameters]
    return "<ParameterDeclarations>{}</ParameterDeclarations>".format(
        "".join(
            f'<ParameterDeclaration name="{name}" parameterType="{kind}" value="{value}"/>'
            for name, kind, value in parts
        )
    )


def scenario_text(
    *stories: str,
    declared: str = "",
    catalogs: str = "",
    road: str = '<LogicFile filepath="highway_loop"/>',
    entities: str = EGO,
    init: str = "",
    stop: str = "",
    minor: str = "3",
) -> str:
    """Return a file."""
    return f"""<OpenSCENARIO>
<FileHeader revMajor="1" revMinor="{minor}" date="2026-01-01T00:00:00" description="" author=""/>
{declared}
<CatalogLocations>{catalogs}</CatalogLocations>
<RoadNetwork>{road}</RoadNetwork>
<Entities>{entities}</Entities>
<Storyboard><Init><Actions>{init}</Actions></Init>{"".join(stories)}<StopTrigger>{stop}</StopTrigger></Storyboard>
</OpenSCENARIO>"""


def expanded(text: str, path: Path = Path("made.xosc"), **arguments: str) -> tuple[Scenario, list[str]]:
    """Return the scenario that a text is, and the codes of what was found, in the file's order."""
    scenario, sink = found(text, path, arguments)
    return scenario, [one.code.id for one in sink]


def found(text: str, path: Path, arguments: Mapping[str, str]) -> tuple[Scenario, Diagnostics]:
    """Return the scenario that a text is, and the findings."""
    sink = Diagnostics()
    document = parse_document(text.encode(), str(path), sink)
    assert document is not None, list(sink)
    source = read_openscenario(document, sink)
    assert source is not None, list(sink)
    return expand_openscenario(source, path.stem, arguments, sink), sink


def _attributes(written: Mapping[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in written.items())
