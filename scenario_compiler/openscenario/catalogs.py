"""Catalogs: the folders that a scenario lists, and the entry to which a <CatalogReference> refers."""

from __future__ import annotations

from scenario_compiler.diagnostics import Severity, did_you_mean
from scenario_compiler.expressions import names_in
from scenario_compiler.files import is_file, is_folder
from scenario_compiler.markup.names import UNKNOWN_ARGUMENT
from scenario_compiler.openscenario.catalog_files import CatalogFolders
from scenario_compiler.openscenario.codes import NO_CATALOG_FOLDER, UNKNOWN_CATALOG_ENTRY
from scenario_compiler.openscenario.files import beside
from scenario_compiler.openscenario.node import FileContext, Node
from scenario_compiler.openscenario.parameters import (
    assigned_name,
    assigned_parameters,
    declared_name,
    with_parameters,
)

MOST_NESTED = 8
"""Greatest depth of nested catalog references."""


def read_catalog_locations(root: Node) -> CatalogFolders:
    """Return the folders that <CatalogLocations> lists; those that do not exist are reported."""
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


def referred(reference: Node, severity: Severity | None = None) -> Node | None:
    """Return the entry to which a <CatalogReference> refers, with its parameters in scope.

    A reference without an entry is reported as an error, or with `severity` if given.
    """
    catalog_name, entry_name = reference.text("catalogName"), reference.text("entryName")
    reading = reference.reading
    assigned = assigned_parameters(reference)
    folders = reading.known.catalogs or CatalogFolders()
    fitting = folders.named(catalog_name, reading.sink)
    if not fitting:
        hint = did_you_mean(catalog_name, [name for one in folders.all(reading.sink) for name in one.names])
        message = f"there is no catalog '{catalog_name}'"
        reference.report(UNKNOWN_CATALOG_ENTRY, message, "catalogName", hint, severity)
        return None
    catalog = next((one for one in fitting if entry_name in one.entries), fitting[0])
    element = catalog.entries.get(entry_name)
    if element is None or _depth(reading) > MOST_NESTED:
        hint = did_you_mean(entry_name, catalog.entries)
        message = f"'{catalog_name}' has no entry '{entry_name}'"
        reference.report(UNKNOWN_CATALOG_ENTRY, message, "entryName", hint, severity)
        return None
    within = reading.of(catalog.document, catalog.version, reference.origin)
    entry = Node(element, within, reference.scope)
    reading.known.entries.setdefault(element, entry)
    _report_idle_assignments(reference, entry)
    return with_parameters(entry.inner(assigned), assigned)


def _report_idle_assignments(reference: Node, entry: Node) -> None:
    """Report values that are assigned to parameters which the entry neither declares nor uses."""
    declared = [declared_name(one) for group in entry.children("ParameterDeclarations") for one in group.elements()]
    texts = [str(text) for element in entry.element.iter() for text in element.attrib.values() if "$" in str(text)]
    used = {name for text in texts for name, _ in names_in(text)}
    for group in reference.children("ParameterAssignments"):
        for one in group.children("ParameterAssignment"):
            name = assigned_name(one)
            if name not in declared and name not in used:
                hint = did_you_mean(name, declared)
                message = f"the entry has no parameter '{name}', so this value has no effect"
                one.report(UNKNOWN_ARGUMENT, message, "parameterRef", hint, Severity.WARNING)


def given(node: Node, *tags: str, severity: Severity | None = None) -> Node | None:
    """Return the child with one of these names, or the entry to which a child <CatalogReference> refers.

    In both cases the element's own parameters are in scope. A reference without an entry is reported as by `referred`.
    """
    found = node.child(*tags)
    if found is not None:
        return with_parameters(found)
    reference = node.child("CatalogReference")
    return None if reference is None else entry_of(reference, *tags, severity=severity)


def entry_of(reference: Node, *tags: str, severity: Severity | None = None) -> Node | None:
    """Return the entry to which a <CatalogReference> refers, as `referred` does; report an entry with another tag."""
    entry = referred(reference, severity)
    if entry is None or entry.tag in tags:
        return entry
    entry.read_whole()
    expected = " or ".join(f"<{tag}>" for tag in tags)
    reference.report(UNKNOWN_CATALOG_ENTRY, f"the entry is a <{entry.tag}>, not a {expected}", "entryName")
    return None


def _depth(reading: FileContext) -> int:
    place, depth = reading.within, 0
    while place is not None:
        place, depth = place.within, depth + 1
    return depth
