"""Checks a road file against the declarations of the version in its header."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, drop_namespace
from scenario_compiler.roads.structure import codes
from scenario_compiler.roads.structure.grammar import FIRST_MINOR, LAST_MINOR, OPENDRIVE, may_have_namespace
from scenario_compiler.roads.structure.keys import check_keys
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.walk import check_elements, local_name


def road_version(document: Document) -> tuple[int, int] | None:
    """Return (revMajor, revMinor) of the header, None if it does not state them."""
    header = document.root.find("{*}header")
    try:
        if header is not None:
            return int(header.get("revMajor", "")), int(header.get("revMinor", ""))
    except ValueError:
        pass
    return None


def check_structure(document: Document, sink: Diagnostics) -> bool:
    """Report every fault of a road file's structure, for the version in its header.

    Returns:
        True if the structure is valid. A file of an unknown version counts as valid unless its root is not <OpenDRIVE>,
        because nothing else is known about it.
    """
    findings = Findings(document, sink)
    namespace = drop_namespace(document.root)
    minor = _minor(findings, document.root)
    if minor is not None:
        if not may_have_namespace(namespace, minor):
            message = f"the elements are in the namespace '{namespace}', which OpenDRIVE 1.{minor} does not have"
            findings.report(codes.UNKNOWN_ELEMENT, message, document.root, hint="remove xmlns from <OpenDRIVE>")
        check_elements(findings, OPENDRIVE, minor)
        check_keys(findings, document.root, minor)
    return findings.total == findings.of(codes.UNKNOWN_VERSION)


def _minor(findings: Findings, root: etree._Element) -> int | None:
    """Return the minor version of the header; report it if it is unknown, and return None."""
    if local_name(root) != OPENDRIVE.root:
        message = f"the root element is <{local_name(root)}>, not <OpenDRIVE>"
        findings.report(codes.UNKNOWN_ELEMENT, message, root)
        return None
    version = road_version(findings.document)
    header = root.find("{*}header")
    if header is None:
        findings.report(codes.MISSING_ELEMENT, "<OpenDRIVE> lacks <header>", root)
        return None
    if version is None or version[0] != 1 or version[1] not in OPENDRIVE.minors:
        named = "no version" if version is None else f"version {version[0]}.{version[1]}"
        message = f"the header names {named}; 1.{FIRST_MINOR} to 1.{LAST_MINOR} are known"
        findings.report(codes.MISSING_ATTRIBUTE if version is None else codes.UNKNOWN_VERSION, message, header)
        return None
    return version[1]
