"""Catalogs: the folders that a scenario lists, and the entry that a <CatalogReference> names."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, did_you_mean
from scenario_compiler.document import Document
from scenario_compiler.source.openscenario.codes import NO_CATALOG_FOLDER, UNKNOWN_CATALOG_ENTRY
from scenario_compiler.source.openscenario.files import beside, is_file, is_folder, read_forgiving, read_version
from scenario_compiler.source.openscenario.node import Node, local_name
from scenario_compiler.source.openscenario.parameters import assigned_parameters, declared_parameters, with_parameters
from scenario_compiler.source.openscenario.reading import Reading

MOST_NESTED = 8
"""Most catalog references that lead to one another."""


@dataclass(frozen=True)
class CatalogFile:
    """A catalog: its file and its entries by name."""

    document: Document
    version: tuple[int, int]
    entries: dict[str, etree._Element]


@dataclass
class CatalogFolders:
    """The catalogs in the folders of a scenario; files are read when the first reference needs them.

    Attributes:
        folders: The folders, in the order in which the scenario lists them.
        read: Catalogs by name, None until they are read.
    """

    folders: list[Path] = field(default_factory=list)
    read: dict[str, CatalogFile] | None = None

    def named(self, sink: Diagnostics) -> dict[str, CatalogFile]:
        """Return all catalogs by name, and by the name of their file where none has that name; the first of each."""
        if self.read is None:
            self.read = {}
            for folder in dict.fromkeys(self.folders):
                for path in [folder] if is_file(folder) else sorted(folder.glob("*.xosc")):
                    _add_catalog(path, self.read, sink)
        return self.read


def _add_catalog(path: Path, known: dict[str, CatalogFile], sink: Diagnostics) -> None:
    found = Diagnostics()
    document = read_forgiving(path, found)
    root = None if document is None else document.root
    catalog = None if root is None else next((one for one in root if local_name(one) == "Catalog"), None)
    if document is None or catalog is None:
        sink.found.extend(found.found)
        return
    name = str(catalog.get("name", ""))
    if name in known:
        return
    sink.found.extend(found.found)
    header = next((one for one in document.root if local_name(one) == "FileHeader"), None)
    major, minor = ("", "") if header is None else (str(header.get("revMajor")), str(header.get("revMinor")))
    version = read_version(major, minor, document.origin(document.root), sink)
    entries: dict[str, etree._Element] = {}
    for entry in catalog.iterchildren(etree.Element):
        entries.setdefault(str(entry.get("name", "")), entry)
    known[name] = CatalogFile(document, version, entries)
    known.setdefault(path.stem, known[name])


def read_catalog_locations(root: Node) -> CatalogFolders:
    """Return the folders that <CatalogLocations> lists; those that are not there are reported."""
    folders = CatalogFolders()
    for locations in root.children("CatalogLocations"):
        for kind in locations.elements():
            for directory in kind.children("Directory"):
                written = directory.text("path")
                found = [one for one in beside(root.reading.folder, written) if is_folder(one) or is_file(one)]
                folders.folders += found[:1]
                if written and not found:
                    directory.report(NO_CATALOG_FOLDER, f"there is no folder '{written}'", "path")
    return folders


def referred(reference: Node) -> Node | None:
    """Return the entry that a <CatalogReference> names, with its parameters in scope; report when there is none."""
    catalog_name, entry_name = reference.text("catalogName"), reference.text("entryName")
    reading = reference.reading
    assigned = assigned_parameters(reference)
    catalogs = {} if reading.known.catalogs is None else reading.known.catalogs.named(reading.sink)
    catalog = catalogs.get(catalog_name)
    if catalog is None:
        hint = did_you_mean(catalog_name, catalogs)
        reference.report(UNKNOWN_CATALOG_ENTRY, f"there is no catalog '{catalog_name}'", "catalogName", hint)
        return None
    element = catalog.entries.get(entry_name)
    if element is None or _depth(reading) > MOST_NESTED:
        hint = did_you_mean(entry_name, catalog.entries)
        reference.report(UNKNOWN_CATALOG_ENTRY, f"'{catalog_name}' has no entry '{entry_name}'", "entryName", hint)
        return None
    within = reading.of(catalog.document, catalog.version, reference.origin)
    entry = Node(element, within, reference.scope)
    return entry.inner(declared_parameters(entry, assigned)).inner(
        {name: value for name, value in assigned.items() if name not in declared_names(entry)}
    )


def declared_names(entry: Node) -> set[str]:
    """Return the names of the parameters that an entry declares."""
    return {
        str(one.element.get("name", "")).lstrip("$")
        for group in entry.children("ParameterDeclarations")
        for one in group.children("ParameterDeclaration")
    }


def given(node: Node, *tags: str) -> Node | None:
    """Return the child of one of these names, or the entry of that kind that a child <CatalogReference> names.

    Either has the parameters in scope that it declares.
    """
    found = node.child(*tags)
    if found is not None:
        return with_parameters(found)
    reference = node.child("CatalogReference")
    entry = None if reference is None else referred(reference)
    if entry is None or reference is None or entry.tag in tags:
        return entry
    expected = " or ".join(f"<{tag}>" for tag in tags)
    reference.report(UNKNOWN_CATALOG_ENTRY, f"the entry is a <{entry.tag}>, not a {expected}", "entryName")
    return None


def _depth(reading: Reading) -> int:
    place, depth = reading.within, 0
    while place is not None:
        place, depth = place.within, depth + 1
    return depth
