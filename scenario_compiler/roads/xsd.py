"""Checks the structure of a road file with ASAM's own schemas, if the user has them.

Those up to 1.7 are XSD 1.0 (see `structure.schemas`); those of 1.8 need XSD 1.1 and the package xmlschema, which is
imported only here.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, cast

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace, Severity
from scenario_compiler.document import Document
from scenario_compiler.roads.structure import road_version
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.schemas import find_schema, schema_faults

if TYPE_CHECKING:
    from xmlschema import XMLSchema11

SCHEMA_FAULT = Code(
    "SC331",
    "schema-fault",
    "The road file is not valid by the ASAM schema of the version that its header names. The message is the "
    "schema processor's.\n\n"
    "    validate town.xodr --xsd schemas     Element 'lane': This element is not expected.\n\n"
    "Without --xsd the file is checked by this program's own rules, whose messages contain more details.",
)
NO_SCHEMA = Code(
    "SC332",
    "no-road-schema",
    "The folder given with --xsd has no usable schema for the version of the road file. The file was not checked "
    "against a schema."
    "\n\n    validate town.xodr --xsd schemas     no OpenDRIVE schema of version 1.7 in that folder"
    "\n\nUnpack ASAM's schemas of that version into the folder, or leave --xsd out.",
    Severity.WARNING,
)


def validate_with_xsd(document: Document, folder: str | Path, sink: Diagnostics) -> bool | None:
    """Check a road file against the schema of its version.

    Args:
        document: The file.
        folder: Folder with ASAM's schemas, or a parent of it.
        sink: Receives every fault, with its line.

    Returns:
        Whether the file is valid; None if there is no schema for it, which is reported.
    """
    version = road_version(document)
    schema = None if version is None or version[0] != 1 else find_schema(Path(folder), "OpenDRIVE", version[1])
    if version is None or schema is None:
        named = "no version" if version is None else f"version {version[0]}.{version[1]}"
        message = f"the header names {named}; there is no schema for it in {folder}"
        sink.add(NO_SCHEMA, message, FilePlace(document.path))
        return None
    findings = Findings(document, sink)
    try:
        faults = schema_faults(document, schema) if version[1] < 8 else _faults_by_xsd11(document, schema)
        for element, message in faults:
            findings.report(SCHEMA_FAULT, message, element)
    except (etree.XMLSchemaError, etree.XMLSyntaxError) as error:
        message = f"the schema {schema} cannot be used: {error}"
        sink.add(NO_SCHEMA, message, FilePlace(document.path))
        return None
    return findings.total == 0


@lru_cache(maxsize=4)
def _schema11(path: str, _changed: int) -> XMLSchema11:
    import xmlschema

    try:
        return xmlschema.XMLSchema11(path, allow="local", defuse="always")
    except xmlschema.XMLSchemaException as error:
        raise etree.XMLSchemaParseError(str(error)[:200]) from None


def _faults_by_xsd11(document: Document, schema: Path) -> Iterator[tuple[etree._Element, str]]:
    validator = _schema11(str(schema), schema.stat().st_mtime_ns)
    for fault in validator.iter_errors(document.root):
        element = cast("etree._Element | None", fault.elem)
        yield document.root if element is None else element, (fault.reason or "")[:300]
