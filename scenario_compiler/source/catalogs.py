"""Catalogs: files of vehicles and drivers that scenarios name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Literal

from scenario_compiler.diagnostics import Diagnostic, Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.markup import names
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import place_children, read_attributes, read_word
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.vocabulary.takeover import DriverModel
from scenario_compiler.vocabulary.word import Word, attribute, child


class CatalogElement(Word):
    """A file of vehicles and drivers."""

    word: Literal["catalog"] = "catalog"

    version: Literal["1"] = attribute("Version of the language.")
    summary: str = attribute("What the catalog holds.", default="")
    entries: tuple[Vehicle | DriverModel, ...] = child("Its vehicles and drivers.", default=())


@dataclass(frozen=True)
class Catalogs:
    """Vehicles and drivers by name.

    Attributes:
        vehicles: Vehicles by name.
        drivers: Drivers by name.
        complete: Everything could be read; else what is not known may well be there.
    """

    vehicles: Mapping[str, Vehicle] = field(default_factory=dict)
    drivers: Mapping[str, DriverModel] = field(default_factory=dict)
    complete: bool = True

    def extended(self, other: Catalogs) -> Catalogs:
        """Return these with the other's entries added; the other's win where both have a name."""
        return Catalogs(
            {**self.vehicles, **other.vehicles},
            {**self.drivers, **other.drivers},
            self.complete and other.complete,
        )

    def with_a_gap(self) -> Catalogs:
        """Return these, knowing that some could not be read."""
        return replace(self, complete=False)


def read_catalog(reading: ReadingContext) -> Catalogs:
    """Return what a `<catalog>` file holds; report entries that have a name twice."""
    root = reading.document.root
    read_attributes(root, CatalogElement, reading)
    complete = True
    vehicles: dict[str, Vehicle] = {}
    drivers: dict[str, DriverModel] = {}
    elements = [
        (rule.words[str(element.tag)], element)
        for rule, elements in place_children(root, CatalogElement, reading)
        for element in elements
    ]
    for word, element in elements:
        entry = read_word(element, word, reading)
        if not isinstance(entry, Vehicle | DriverModel):
            complete = False
            continue
        if entry.name in (vehicles if isinstance(entry, Vehicle) else drivers):
            reading.sink.add(
                names.DUPLICATE_NAME,
                f"the catalog has '{entry.name}' already",
                entry.place_of("name"),
                related=names.first_at((vehicles | drivers)[entry.name].place_of("name")),
            )
        elif isinstance(entry, Vehicle):
            vehicles[entry.name] = entry
        else:
            drivers[entry.name] = entry
    return Catalogs(vehicles, drivers, complete)


def load_catalogs(folder: Path, sink: Diagnostics) -> Catalogs:
    """Return the catalogs of a folder's XML files, read once a process; report what is wrong in them."""
    catalogs, faults = catalogs_in(folder)
    sink.take(faults)
    return catalogs


@cache
def catalogs_in(folder: Path) -> tuple[Catalogs, tuple[Diagnostic, ...]]:
    """Return the catalogs of a folder's XML files, and what is wrong with these; read once a process."""
    sink = Diagnostics()
    catalogs = Catalogs()
    for path in sorted(folder.glob("*.xml")):
        document = read_document(path, sink)
        if document is not None:
            catalogs = catalogs.extended(read_catalog(ReadingContext(document, sink, Environment())))
    return catalogs, tuple(sink.found)
