"""The catalogs in the folders that a scenario lists; their files are read at the first reference."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document
from scenario_compiler.files import files_in, is_file
from scenario_compiler.openscenario.files import VERSIONS, read_forgiving, read_version
from scenario_compiler.structure.walk import local_name


@dataclass(frozen=True)
class CatalogFile:
    """A catalog: its file, the names under which it is known, and its entries by name."""

    document: Document
    version: tuple[int, int]
    names: tuple[str, str]
    entries: dict[str, etree._Element]


@dataclass
class CatalogFolders:
    """The catalogs in the folders of a scenario; their files are read at the first reference.

    Attributes:
        folders: The folders, in the order in which the scenario lists them.
        read: The catalogs, None until they are read.
    """

    folders: list[Path] = field(default_factory=list)
    read: list[CatalogFile] | None = None

    def named(self, name: str, sink: Diagnostics) -> list[CatalogFile]:
        """Return the catalogs of a name: first those whose file has it, then those whose <Catalog> element has it."""
        catalogs = self.all(sink)
        by_file = [one for one in catalogs if one.names[0] == name]
        return by_file + [one for one in catalogs if one.names[1] == name and one.names[0] != name]

    def all(self, sink: Diagnostics) -> list[CatalogFile]:
        """Return all catalogs, in the order of the folders and of the files' names."""
        if self.read is None:
            folders = dict.fromkeys(self.folders)
            files = [path for one in folders for path in ([one] if is_file(one) else files_in(one, ".xosc"))]
            found = [_catalog_file(path, sink) for path in files]
            self.read = [one for one in found if one is not None]
        return self.read


def _catalog_file(path: Path, sink: Diagnostics) -> CatalogFile | None:
    document = read_forgiving(path, sink)
    catalog = None if document is None else _child(document.root, "Catalog")
    if document is None or catalog is None:
        return None
    header = _child(document.root, "FileHeader")
    version = VERSIONS[-1]
    if header is not None:
        place = document.origin(header, "revMinor")
        version = read_version(header.get("revMajor", ""), header.get("revMinor", ""), place, sink)
    entries: dict[str, etree._Element] = {}
    for entry in catalog.iterchildren(etree.Element):
        entries.setdefault(str(entry.get("name", "")), entry)
    return CatalogFile(document, version, (path.stem, str(catalog.get("name", ""))), entries)


def _child(element: etree._Element, tag: str) -> etree._Element | None:
    return next((one for one in element.iterchildren(etree.Element) if local_name(one) == tag), None)
