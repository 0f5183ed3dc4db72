"""Checks road files for faults beyond their structure: `CHECKS` has one function for each family of rules.

In: a document and the network that was read from it. Out: diagnostics with places (`check_network`), which are all
warnings or notes, because the rest of the file can be used. Each check receives the file as written (`filed.Filed`) and
reports to `Findings`. Imports the hall and the modules of `roads` that read files and evaluate geometry.

Sources of the rules: the ASAM quality checker for OpenDRIVE and openMSL's, named by their rule UIDs in the codes'
explanations.
"""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.diagnostics import Diagnostic, Diagnostics
from scenario_compiler.document import Document, drop_namespace, read_document
from scenario_compiler.files import MAX_BYTES
from scenario_compiler.roads.check.filed import read_filed
from scenario_compiler.roads.check.joints import check_joints
from scenario_compiler.roads.check.junctions import check_junctions
from scenario_compiler.roads.check.links import check_lane_links, check_road_links
from scenario_compiler.roads.check.objects import check_objects
from scenario_compiler.roads.check.shapes import check_shapes
from scenario_compiler.roads.check.traffic import check_traffic
from scenario_compiler.roads.check.unread import Unread, unread
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.roads.reading import BAD_NUMBER
from scenario_compiler.roads.structure import check_structure
from scenario_compiler.roads.structure.codes import BAD_VALUE
from scenario_compiler.structure.findings import Findings

CHECKS = (
    check_road_links,
    check_lane_links,
    check_junctions,
    check_shapes,
    check_joints,
    check_traffic,
    check_objects,
)
"""The checks in the order of their execution; the sink sorts their findings."""

__all__ = ["CHECKS", "Unread", "check_file", "check_network", "unread"]


def check_network(document: Document, network: Network | None, sink: Diagnostics) -> None:
    """Report the faults of a road file beyond its structure and beyond those that reading it reports.

    Args:
        document: The file, its elements without namespace (`document.drop_namespace`).
        network: The network that was read from it; None if there is none, then only the file itself is checked.
        sink: Receives the findings.
    """
    filed = read_filed(document, network)
    findings = Findings(document, sink)
    for check in CHECKS:
        check(filed, findings)


def check_file(path: str | Path, sink: Diagnostics) -> None:
    """Report all faults of a road file: form, structure, those found by reading it, and `CHECKS`.

    A value that the structure forbids is reported once, and not again by the reader that cannot use it.
    """
    document = read_document(path, sink, MAX_BYTES)
    if document is None:
        return
    structure, reading = Diagnostics(), Diagnostics()
    check_structure(document, structure)
    drop_namespace(document.root)
    network = load_network(path, cache=False, sink=reading)
    told = {_spot(one) for one in structure.found if one.code is BAD_VALUE}
    reading.retain(lambda one: one.code is not BAD_NUMBER or _spot(one) not in told)
    sink.absorb(structure)
    sink.absorb(reading)
    check_network(document, network, sink)


def _spot(one: Diagnostic) -> tuple[int, int]:
    return one.place.line, one.place.column
