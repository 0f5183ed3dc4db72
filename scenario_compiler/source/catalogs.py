"""Catalogs: files with the vehicles and drivers that scenarios name, and with effects on a driver's takeover time."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple, TypeVar

from scenario_compiler.diagnostics import Diagnostic, Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.files import files_in
from scenario_compiler.markup import names
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import place_children, read_attributes, read_word
from scenario_compiler.vocabulary.driver import DriverModel, Effect, EffectKind
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.vocabulary.word import Word, attribute, child

Name = TypeVar("Name", bound=str)
Entry = TypeVar("Entry", bound=Word)


class CatalogElement(Word):
    """A file of vehicles, drivers and effects on drivers."""

    word: Literal["catalog"] = "catalog"

    version: Literal["1"] = attribute("Version of the language.")
    summary: str = attribute("Contents of the catalog.", default="")
    entries: tuple[Vehicle | DriverModel | Effect, ...] = child("Its vehicles, drivers and effects.", default=())


class Catalogs(NamedTuple):
    """Vehicles and drivers by name, effects by kind.

    Attributes:
        vehicles: Vehicles by name.
        drivers: Drivers by name.
        effects: Effects on a driver's takeover time by kind.
        complete: Whether everything could be read; otherwise an unknown name is not reported.
    """

    vehicles: Mapping[str, Vehicle] = MappingProxyType({})
    drivers: Mapping[str, DriverModel] = MappingProxyType({})
    effects: Mapping[EffectKind, Effect] = MappingProxyType({})
    complete: bool = True

    def extended(self, other: Catalogs) -> Catalogs:
        """Return these catalogs with the other's entries, which take precedence."""
        return Catalogs(
            {**self.vehicles, **other.vehicles},
            {**self.drivers, **other.drivers},
            {**self.effects, **other.effects},
            self.complete and other.complete,
        )

    def with_a_gap(self) -> Catalogs:
        """Return these catalogs, marked as incomplete."""
        return self._replace(complete=False)


def read_catalog(reading: ReadingContext) -> Catalogs:
    """Return the entries of a `<catalog>` file; report repeated names."""
    root = reading.document.root
    read_attributes(root, CatalogElement, reading)
    complete = True
    vehicles: dict[str, Vehicle] = {}
    drivers: dict[str, DriverModel] = {}
    effects: dict[EffectKind, Effect] = {}
    elements = [
        (rule.words[str(element.tag)], element)
        for rule, elements in place_children(root, CatalogElement, reading)
        for element in elements
    ]
    for word, element in elements:
        entry = read_word(element, word, reading)
        if isinstance(entry, Vehicle):
            _enter(vehicles, entry.name, entry, "name", reading)
        elif isinstance(entry, DriverModel):
            _enter(drivers, entry.name, entry, "name", reading)
        elif isinstance(entry, Effect):
            _enter(effects, entry.of, entry, "of", reading)
        else:
            complete = False
    return Catalogs(vehicles, drivers, effects, complete)


def _enter(entries: dict[Name, Entry], name: Name, entry: Entry, attribute: str, reading: ReadingContext) -> None:
    """Register an entry under its name, which is in an attribute; report a repeated name."""
    if name in entries:
        reading.sink.add(
            names.DUPLICATE_NAME,
            f"the catalog has '{name}' already",
            entry.place_of(attribute),
            related=names.first_at(entries[name].place_of(attribute)),
        )
    else:
        entries[name] = entry


def load_catalogs(folder: Path, sink: Diagnostics) -> Catalogs:
    """Return the catalogs of a folder's XML files, read once per process; report their faults."""
    catalogs, faults = catalogs_in(folder)
    sink.take(faults)
    return catalogs


@cache
def catalogs_in(folder: Path) -> tuple[Catalogs, tuple[Diagnostic, ...]]:
    """Return the catalogs of a folder's XML files, and their faults; read once per process."""
    sink = Diagnostics()
    catalogs = Catalogs()
    for path in files_in(folder, ".xml"):
        document = read_document(path, sink)
        if document is not None:
            catalogs = catalogs.extended(read_catalog(ReadingContext(document, sink, Environment())))
    return catalogs, tuple(sink.found)
