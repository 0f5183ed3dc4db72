"""The files of an export: the scenario, its road, and its variation."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.openscenario.export.distribution import export_variation
from scenario_compiler.openscenario.export.document import export_openscenario
from scenario_compiler.openscenario.output import VERSIONS, Output, Version
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.scenario import Scenario, parameter_values


def export_files(
    plan: Plan, network: Network, output: Path, version: Version, sink: Diagnostics, scenario: Scenario | None = None
) -> dict[Path, bytes]:
    """Return the contents of an export's files by their paths; nothing is written.

    The road file keeps its name and is put beside the scenario; a scenario with a variation gets a second file, whose
    name ends in `_variation`.

    Args:
        plan: The plan.
        network: Its map.
        output: Path of the scenario's file.
        version: Version of OpenSCENARIO.
        sink: Receives what OpenSCENARIO cannot express.
        scenario: The scenario from which the plan was made, if available.
    """
    road = output.parent / Path(network.path).name
    element = export_openscenario(plan, network, road.name, version, sink, scenario)
    files = {output: _text(element), road: Path(network.path).read_bytes()}
    if scenario is not None and scenario.vary is not None:
        names = [one.name for one in plan.parameters]
        telling = Output(version, sink, parameter_values(plan.parameters))
        variation = export_variation(scenario.vary, names, output.name, telling)
        if variation is not None:
            files[output.with_name(f"{output.stem}_variation{output.suffix}")] = _text(variation)
    return files


def write_openscenario(
    plan: Plan, network: Network, path: str | Path, version: str = "1.3", scenario: Scenario | None = None
) -> Diagnostics:
    """Write a plan as OpenSCENARIO with its road file, replacing existing files; return what cannot be expressed.

    Args:
        plan: The plan.
        network: Its map.
        path: The scenario's file.
        version: "1.0", "1.1", "1.2" or "1.3"; ValueError for any other.
        scenario: The scenario from which the plan was made; without it, background traffic and the variation are lost.
    """
    known = {"{}.{}".format(*one): one for one in VERSIONS}
    if version not in known:
        raise ValueError(f"OpenSCENARIO is written in {', '.join(known)}, not in '{version}'")
    sink = Diagnostics()
    for file, content in export_files(plan, network, Path(path), known[version], sink, scenario).items():
        make_folder(file.parent)
        write_whole(file, content)
    return sink


def _text(element: etree._Element) -> bytes:
    etree.indent(element)
    return etree.tostring(element, xml_declaration=True, encoding="UTF-8", pretty_print=True)
