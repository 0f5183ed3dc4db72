"""Checks a scenario file against ASAM's own schema and ASAM's rules, if the user has them.

The schemas are those in a folder, or those that ASAM's checker for OpenSCENARIO XML contains. The checker is an extra
(`pip install 'scenario-compiler[asam]'`), imported only here. It runs in this process: its rules are functions from a
file to a list of issues.
"""

from __future__ import annotations

import importlib.util
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace, Severity
from scenario_compiler.document import Document
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.schemas import Schemas, find_schema, schema_faults

if TYPE_CHECKING:
    from qc_baselib import Result
    from qc_baselib.models.result import IssueType

SCHEMA_FAULT = Code(
    "SC730",
    "scenario-schema-fault",
    "The scenario file is not valid by the ASAM schema of the version that its <FileHeader> names. The message is the "
    "schema processor's:\n\n"
    "    Element 'WorldPosition': The attribute 'y' is required but missing.\n\n"
    "Without --xsd, the same faults have codes and advice of their own (SC701 to SC712).",
)
NO_SCHEMA = Code(
    "SC731",
    "no-scenario-schema",
    "There is no ASAM schema for the version of the scenario file, so it was checked by this program's own rules "
    "(SC701 to SC712). ASAM's checker contains the schemas of 1.0 to 1.3 and additional rules:\n\n"
    "    pip install 'scenario-compiler[asam]'\n"
    "    scenario-compiler validate scenario.xosc --xsd\n\n"
    "It needs a version of lxml below 6.",
    Severity.WARNING,
)
ASAM_RULE = Code(
    "SC732",
    "asam-rule",
    "The scenario file breaks a rule of ASAM's checker for OpenSCENARIO XML. The message begins with the rule's "
    "id, by which ASAM documents it:\n\n"
    "    asam.net:xosc:1.2.0:reference_control.resolvable_entity_references\n\n"
    "The rules go beyond the schema, so the file may still be valid.",
    Severity.WARNING,
)
RULES_FAILED = Code(
    "SC733",
    "asam-checker-failed",
    "ASAM's checker could not apply its rules to the file, because of an error in the checker. The result of the "
    "schema does not depend on it.\n\n"
    "    ASAM's rules could not be checked: UnicodeDecodeError",
    Severity.WARNING,
)

CHECKER = "qc_openscenario"
"""ASAM's checker for OpenSCENARIO XML, an installed package."""

SCHEMA_RULE = "xml.valid_schema"
"""End of the id of the rule for faults of the schema, which are reported here with better places."""


def validate_with_xsd(document: Document, version: tuple[int, int] | None, schemas: Schemas, sink: Diagnostics) -> bool:
    """Check a scenario file against the schema of its version and, if ASAM's checker is installed, its rules.

    Args:
        document: The file.
        version: Its revMajor and revMinor, None if it names none.
        schemas: Where the schema is found.
        sink: Receives the faults with their places.

    Returns:
        Whether a schema was found; if not, that is reported.
    """
    schema = None if version is None or version[0] != 1 else _schema_of(version[1], schemas)
    if schema is None:
        sink.add(NO_SCHEMA, _no_schema(version, schemas), FilePlace(document.path))
        return False
    findings = Findings(document, sink)
    try:
        for element, message in schema_faults(document, schema):
            findings.report(SCHEMA_FAULT, message[:400], element)
    except (etree.XMLSchemaError, etree.XMLSyntaxError) as error:
        sink.add(NO_SCHEMA, f"the schema {schema} cannot be used: {str(error)[:200]}", FilePlace(document.path))
        return False
    if is_installed():
        check_rules(document, sink)
    return True


def is_installed() -> bool:
    """Return whether ASAM's checker is installed."""
    return importlib.util.find_spec(CHECKER) is not None


def _schema_of(minor: int, schemas: Schemas) -> Path | None:
    if schemas.folder is not None:
        return find_schema(schemas.folder, "OpenSCENARIO", minor)
    found = importlib.util.find_spec(CHECKER)
    places = [] if found is None else list(found.submodule_search_locations or [])
    return find_schema(Path(places[0], "schema"), "OpenSCENARIO", minor) if places else None


def _no_schema(version: tuple[int, int] | None, schemas: Schemas) -> str:
    named = "no version" if version is None else f"version {version[0]}.{version[1]}"
    if schemas.folder is not None:
        return f"the header names {named}; there is no schema for it in {schemas.folder}"
    if not is_installed():
        return "ASAM's checker is not installed: pip install 'scenario-compiler[asam]'"
    return f"the header names {named}; ASAM's checker has no schema for it"


def check_rules(document: Document, sink: Diagnostics) -> None:
    """Report where a file violates the rules of ASAM's checker, except that on the schema.

    The checker must be installed. It reads the file, and the road file that it names, by itself.
    """
    findings = Findings(document, sink)
    tree = document.root.getroottree()
    try:
        with _quiet():
            issues = list(_issues(_checked(document.path)))
        for issue in issues:
            if not issue.rule_uid.endswith(SCHEMA_RULE):
                for element, described in _places(issue, tree):
                    findings.report(ASAM_RULE, f"{issue.rule_uid}: {described[:300]}", element)
    except Exception as fault:
        message = f"ASAM's rules could not be checked: {type(fault).__name__}: {str(fault)[:200]}"
        sink.add(RULES_FAILED, message, FilePlace(document.path))


def _checked(path: str) -> Result:
    from qc_baselib import Configuration, Result
    from qc_openscenario import constants
    from qc_openscenario.main import run_checks

    configuration = Configuration()
    configuration.set_config_param("InputFile", path)
    result = Result()
    result.register_checker_bundle(
        name=constants.BUNDLE_NAME, description="", version=constants.BUNDLE_VERSION, summary=""
    )
    run_checks(configuration, result)
    return result


def _issues(result: Result) -> Iterator[IssueType]:
    for bundle in result.get_checker_bundle_names():
        for checker in result.get_checker_ids(bundle):
            yield from result.get_issues(bundle, checker)


def _places(issue: IssueType, tree: etree._ElementTree) -> Iterator[tuple[etree._Element, str]]:
    """Yield the elements that an issue names, each with its description; the root if it names none."""
    root = tree.getroot()
    if not issue.locations:
        yield root, issue.description
    for location in issue.locations:
        for place in location.xml_location:
            found = tree.xpath(place.xpath)
            element = found[0] if isinstance(found, list) and found else None
            yield element if isinstance(element, etree._Element) else root, location.description
        if not location.xml_location:
            yield root, location.description


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the checker's logging, which uses the root logger, off the terminal."""
    silent = logging.NullHandler()
    logging.root.addHandler(silent)
    try:
        yield
    finally:
        logging.root.removeHandler(silent)
