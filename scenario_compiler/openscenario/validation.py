"""Validates an OpenSCENARIO file: whether it is well-formed and has the structure of its version."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.document import FORBIDDEN, MALFORMED, UNREADABLE, Document
from scenario_compiler.openscenario.codes import MENDED_COMMENT, UNKNOWN_VERSION
from scenario_compiler.openscenario.files import read_forgiving
from scenario_compiler.openscenario.structure import check_structure, file_version
from scenario_compiler.structure.schemas import Schemas


def validate_openscenario(path: Path, sink: Diagnostics, schemas: Schemas | None = None) -> None:
    """Report every fault of a scenario file; an error means that it is not valid.

    Args:
        path: The file.
        sink: Receives the faults.
        schemas: Where ASAM's schema is found; None to check only against the tables of `structure`.
    """
    document = _read(path, sink)
    if document is not None and not (schemas is not None and _by_schema(document, schemas, sink)):
        check_structure(document, sink)


def add_meaning(meaning: Diagnostics, sink: Diagnostics) -> None:
    """Add findings on a file's meaning as warnings; faults of its structure must have been reported before."""
    told = {(one.place.file, one.place.line, one.place.column) for one in sink.found}
    for one in meaning:
        if one.code not in _OF_STRUCTURE and (one.place.file, one.place.line, one.place.column) not in told:
            severity = Severity.WARNING if one.severity is Severity.ERROR else one.severity
            sink.take((replace(one, severity=severity),))


_OF_STRUCTURE = (UNREADABLE, MALFORMED, FORBIDDEN, MENDED_COMMENT, UNKNOWN_VERSION)


def _read(path: Path, sink: Diagnostics) -> Document | None:
    """Read the file; if only two hyphens in a comment make it ill-formed, report an error and read the rest."""
    read = Diagnostics()
    document = read_forgiving(path, read)
    for one in read.found:
        sink.take((replace(one, severity=Severity.ERROR) if one.code is MENDED_COMMENT else one,))
    return document


def _by_schema(document: Document, schemas: Schemas, sink: Diagnostics) -> bool:
    from scenario_compiler.openscenario.xsd import validate_with_xsd

    return validate_with_xsd(document, file_version(document), schemas, sink)
