"""Converts the AISA toolkit's file to the conflict language, with the additions of the toolkit's code."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.expressions import parse_expression
from scenario_compiler.markup import names
from scenario_compiler.markup.writing import write_word
from scenario_compiler.resources import library_folder
from scenario_compiler.source.aisa import filed_scenario, report_off_map
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.catalogs import Catalogs, load_catalogs
from scenario_compiler.source.conflict import EntityWhen, ScenarioElement
from scenario_compiler.vocabulary.driver import Driver, DriverModel
from scenario_compiler.vocabulary.positions import WorldPosition
from scenario_compiler.vocabulary.scenario import Parameter, Scenario
from scenario_compiler.vocabulary.storyboard import Do

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<!-- Converted from a file of the AISA toolkit. Obstacles that the toolkit's code keeps by a scenario's name stand here;
     positions are in CARLA's axes, m and degrees. -->
"""


START = WorldPosition(
    frame="carla",
    x=parse_expression("$start_x"),
    y=parse_expression("$start_y"),
    yaw=parse_expression("radians($start_yaw)"),
)
"""Start of a converted scenario whose original has none."""

START_PARAMETERS = (
    Parameter.model_construct(name="start_x", type="length", summary="x of the start in CARLA's axes, m."),
    Parameter.model_construct(name="start_y", type="length", summary="y of the start in CARLA's axes, m."),
    Parameter.model_construct(name="start_yaw", type="angle", summary="Heading at the start in CARLA's axes, degrees."),
)
"""The parameters that must give it."""


def convert_aisa(source: AisaConfig, sink: Diagnostics) -> str:
    """Return a file of the toolkit in the conflict language.

    A scenario without a start gets parameters for it, which must be given as `--set start=...` must in the original; a
    warning says so. One that cannot be read becomes a comment, and its faults are reported.
    """
    root = etree.Element("scenarios", version="1")
    catalogs = load_catalogs(library_folder() / "catalogs", sink)
    for name in source.scenarios:
        root.extend(_converted(source, name, catalogs, sink))
    etree.indent(root)
    return HEAD + etree.tostring(root, encoding="unicode") + "\n"


def _converted(source: AisaConfig, name: str, catalogs: Catalogs, sink: Diagnostics) -> Iterator[etree._Element]:
    found = Diagnostics()
    scenario = filed_scenario(source, name, {}, found, catalogs, usual_start=START)
    if scenario is not None and scenario.ego is not None and scenario.ego.start == START:
        scenario = scenario.model_copy(update={"parameters": (*scenario.parameters, *START_PARAMETERS)})
        message = f"the scenario '{name}' has no waypoint named 'start'; the conflict needs a start"
        hint = "--set start_x=X --set start_y=Y --set start_yaw=YAW, in CARLA's axes"
        found.add(names.NO_START, message, scenario.origin, hint=hint, severity=Severity.WARNING)
    report_off_map(source, name, {}, found, Severity.WARNING)
    for one in found:
        sink.take((one,))
        yield _comment(f"{name}: {one.message}")
    for element in source.scenarios[name].iterfind("object"):
        attributes = " ".join(f'{key}="{element.get(key)}"' for key in map(str, element.attrib))
        yield _comment(f"{name}: not executed: object {attributes}")
    if scenario is not None and not found.has_errors:
        yield write_word(scenario_element(scenario))


def _comment(text: str) -> etree._Element:
    return etree.Comment(f" {re.sub('-(?=-)', '- ', text)} ")


def scenario_element(scenario: Scenario) -> ScenarioElement:
    """Return the element of the conflict language that expands to a scenario, with one `<when>` for each event.

    Raises:
        ValueError: The scenario has no automated vehicle.
    """
    if scenario.ego is None:
        raise ValueError(f"'{scenario.name}' has no automated vehicle")
    takeover = scenario.takeover
    if isinstance(takeover.driver, DriverModel):
        takeover = takeover.model_copy(update={"driver": Driver(preset=takeover.driver.name)})
    return ScenarioElement(
        name=scenario.name,
        summary=scenario.summary,
        source=scenario.source,
        map=scenario.map,
        weather=scenario.weather.preset,
        duration=scenario.duration,
        step=scenario.step,
        control_every=scenario.control_every,
        parameters=scenario.parameters,
        classifications=scenario.classifications,
        ego=scenario.ego,
        items=(*scenario.actors, *scenario.markings, *scenario.secondary_markings, *_whens(scenario)),
        takeover=takeover,
        criteria=scenario.criteria,
    )


def _whens(scenario: Scenario) -> Iterator[EntityWhen]:
    for group, event in scenario.storyboard.events():
        conditions = event.start.groups[0].conditions if event.start is not None else ()
        yield EntityWhen(
            entity=group.actors[0],
            conditions=tuple(one.condition for one in conditions),
            do=Do(actions=tuple(one.action for one in event.actions)),
        )
