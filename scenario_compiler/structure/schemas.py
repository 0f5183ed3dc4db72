"""Uses ASAM's own schemas, if the user has them: finds that of a version, and validates a document.

The schemas are not redistributed with this package. This module uses those in XSD 1.0, through lxml.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import cast

from lxml import etree

from scenario_compiler.document import Document
from scenario_compiler.files import read_file


@dataclass(frozen=True, slots=True)
class Schemas:
    """The source of schemas: a folder, with its subfolders; or None for those in ASAM's installed checkers."""

    folder: Path | None = None


_MINOR = re.compile(r"(?:^|[^0-9])1[._]?([0-9])(?:[^0-9]|$)")


def find_schema(folder: Path, root: str, minor: int) -> Path | None:
    """Return the schema of version 1.`minor` in a folder or below it, the latest revision when there are several.

    A schema is the file that declares the root element; its version follows from its name ("OpenDRIVE_1.4H.xsd",
    "opendrive_16_core.xsd"), else by its folder's ("1.8.1"), else by its first lines ("ASAM OpenDRIVE V1.8.0").
    """
    found = [path for path in sorted(folder.rglob("*.xsd")) if _schema_minor(path, root) == minor]
    return found[-1] if found else None


def _schema_minor(path: Path, root: str) -> int | None:
    try:
        raw = read_file(path)
    except OSError:
        return None
    if re.search(rb"<xsd?:element\s+name=[\"']" + root.encode() + rb"[\"']", raw) is None:
        return None
    for text in (path.stem, path.parent.name, raw[:400].decode("utf-8", "replace")):
        match = _MINOR.search(text)
        if match is not None:
            return int(match.group(1))
    return None


def schema_faults(document: Document, schema: Path) -> Iterator[tuple[etree._Element, str]]:
    """Yield the faults of a document by a schema: the element, and the schema processor's message.

    Raises:
        XMLSchemaError: The schema cannot be used.
        XMLSyntaxError: The same.
    """
    validator = _schema(str(schema), schema.stat().st_mtime_ns)
    if validator.validate(document.root):
        return
    tree = document.root.getroottree()
    for entry in cast(Iterable[etree._LogEntry], validator.error_log):
        found = tree.xpath(entry.path) if entry.path else []
        element = found[0] if isinstance(found, list) and found else None
        yield element if isinstance(element, etree._Element) else document.root, entry.message


@lru_cache(maxsize=8)
def _schema(path: str, _changed: int) -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(path))
