"""Checks a scenario file against the declarations of the version in its header."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.document import Document, drop_namespace
from scenario_compiler.openscenario.codes import UNKNOWN_VERSION
from scenario_compiler.openscenario.files import read_version
from scenario_compiler.openscenario.structure import codes
from scenario_compiler.openscenario.structure.grammar import FIRST_MINOR, LAST_MINOR, OPENSCENARIO
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.values import is_integer_within
from scenario_compiler.structure.walk import check_elements, local_name

ROOTS = ("OpenSCENARIO", "OpenScenario")
"""Tags of the root element; the schemas also allow the second one."""

Version = tuple[int, int]
"""revMajor and revMinor."""


def check_structure(document: Document, sink: Diagnostics, *, forgiving: bool = False) -> Version | None:
    """Report every fault of a scenario file's structure, for the version in its header.

    Args:
        document: The file.
        sink: Receives the faults; any error among them means that the file is not valid.
        forgiving: Whether faults with an obvious meaning are warnings: words of another version than the header names,
            children in another order, values that only look different, blanks in empty elements, the author, date and
            description of the header, and a header with version 0.9 or one that does not exist.

    Returns:
        The version that the file was checked against, None if it names none.
    """
    findings = Findings(document, sink, _is_mild if forgiving else None)
    namespace = drop_namespace(document.root)
    version = _version(findings, sink, forgiving)
    if namespace and version is not None:
        message = f"the elements are in the namespace '{namespace}', which OpenSCENARIO does not have"
        findings.report(codes.UNKNOWN_ELEMENT, message, document.root, hint="remove xmlns from <OpenSCENARIO>")
    if version is not None:
        check_elements(findings, OPENSCENARIO, version[1])
    return version


def file_version(document: Document) -> Version | None:
    """Return (revMajor, revMinor) of the header, None if they are not numbers."""
    header = document.root.find("{*}FileHeader")
    texts = [] if header is None else [header.get(name, "").strip() for name in ("revMajor", "revMinor")]
    if len(texts) < 2 or not all(is_integer_within(text, 0, 2**16 - 1) for text in texts):
        return None
    return int(texts[0]), int(texts[1])


def _is_mild(code: Code, element: etree._Element) -> bool:
    """Return whether the meaning is obvious despite a fault."""
    if element.tag == "FileHeader" and code in {codes.MISSING_ATTRIBUTE, codes.BAD_VALUE, codes.UNKNOWN_ATTRIBUTE}:
        return True
    return code in {codes.OTHER_VERSION, codes.ELEMENT_ORDER, codes.BLANKS, codes.LOOSE_VALUE}


def _version(findings: Findings, sink: Diagnostics, forgiving: bool) -> Version | None:
    """Return the version to check against; None if the file names no known one."""
    root = findings.document.root
    if local_name(root) not in ROOTS:
        message = f"the root element is <{local_name(root)}>, not <OpenSCENARIO>"
        findings.report(codes.UNKNOWN_ELEMENT, message, root)
        return None
    header = root.find("{*}FileHeader")
    if header is None:
        findings.report(codes.MISSING_ELEMENT, "<OpenSCENARIO> lacks <FileHeader>", root)
        return None
    if forgiving:
        place = findings.document.origin(header, "revMinor")
        return read_version(header.get("revMajor", ""), header.get("revMinor", ""), place, sink)
    return _named_version(findings, header)


def _named_version(findings: Findings, header: etree._Element) -> Version | None:
    for name in ("revMajor", "revMinor"):
        text = header.get(name)
        if text is None:
            findings.report(codes.MISSING_ATTRIBUTE, f"<FileHeader> lacks {name}", header)
        elif not OPENSCENARIO.is_value("UnsignedShort", text, LAST_MINOR):
            message = f"{name} of <FileHeader> is '{text[:40]}', not an integer from 0 to 65535"
            findings.report(codes.BAD_VALUE, message, header, name)
    if findings.total:
        return None
    named = file_version(findings.document)
    if named == (0, 9):
        return _mislabelled(findings, header)
    if named is None or named[0] != 1 or named[1] not in OPENSCENARIO.minors:
        written = f"{header.get('revMajor', '')[:40]}.{header.get('revMinor', '')[:40]}"
        message = f"the header names version {written}; 1.{FIRST_MINOR} to 1.{LAST_MINOR} are known"
        findings.report(UNKNOWN_VERSION, message, header, "revMinor")
        return None
    return named


OLD_FORMAT = "the header names version 0.9, another format, which is not read; 1.0 to 1.3 are known"


def is_of_old_format(document: Document) -> bool:
    """Return whether a file has the format of OpenSCENARIO 0.9, and not only its number in the header."""
    old = ("{*}Catalogs", "{*}RoadNetwork/{*}Logics", "{*}Entities/{*}Object", "{*}ParameterDeclaration")
    return file_version(document) == (0, 9) and any(document.root.find(path) is not None for path in old)


def report_old_format(document: Document, sink: Diagnostics) -> None:
    """Report a file of OpenSCENARIO 0.9 at the version in its header."""
    header = document.root.find("{*}FileHeader")
    if header is not None:
        sink.add(codes.MISLABELLED, OLD_FORMAT, document.origin(header, "revMinor"))


def _mislabelled(findings: Findings, header: etree._Element) -> Version | None:
    """Report a file with 0.9 in its header; return the first version whose structure it has, or 1.0."""
    if is_of_old_format(findings.document):
        findings.report(codes.MISLABELLED, OLD_FORMAT, header, "revMinor")
        return None
    fitting = next((minor for minor in OPENSCENARIO.minors if _has_structure(findings.document, minor)), None)
    minor = FIRST_MINOR if fitting is None else fitting
    what = f"has the elements of 1.{minor}" if fitting is None else f"is valid as 1.{minor}"
    message = f"the header names version 0.9, but the file {what}"
    hint = f'write revMajor="1" revMinor="{minor}"'
    findings.report(codes.MISLABELLED, message, header, "revMinor", hint=hint)
    return 1, minor


def _has_structure(document: Document, minor: int) -> bool:
    findings = Findings(document, Diagnostics())
    check_elements(findings, OPENSCENARIO, minor)
    return findings.total == findings.of(codes.OUT_OF_RANGE)
