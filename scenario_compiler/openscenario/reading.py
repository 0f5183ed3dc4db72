"""What the elements of an OpenSCENARIO file are read with: the sink, the version, what is known by name."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place
from scenario_compiler.document import Document, Origin

if TYPE_CHECKING:
    from scenario_compiler.openscenario.catalogs import CatalogFolders
    from scenario_compiler.openscenario.node import Node

ObjectType = Literal["vehicle", "pedestrian", "miscellaneous", "external"]


@dataclass
class Known:
    """What names of one scenario mean; filled as the file is read, top to bottom.

    Attributes:
        entities: Type of each entity, in document order.
        selections: Members of each EntitySelection.
        catalogs: The catalogs in the folders that the scenario lists.
        entries: The entries of catalogs that references led to.
        places: Where each entity and each selection is named.
    """

    entities: dict[str, ObjectType] = field(default_factory=dict)
    selections: dict[str, tuple[str, ...]] = field(default_factory=dict)
    catalogs: CatalogFolders | None = None
    entries: dict[etree._Element, Node] = field(default_factory=dict)
    places: dict[str, Place] = field(default_factory=dict)


@dataclass(frozen=True)
class Reading:
    """What the elements of one file are read with.

    Attributes:
        document: The file.
        sink: Where faults go.
        version: revMajor and revMinor of the file.
        known: What names mean.
        used: Attributes that were asked for, by element; an element that is no key was never looked at.
        within: The catalog reference that brought the file in.
    """

    document: Document
    sink: Diagnostics
    version: tuple[int, int]
    known: Known = field(default_factory=Known)
    used: dict[etree._Element, set[str]] = field(default_factory=dict)
    within: Place | None = None

    @property
    def folder(self) -> Path:
        """Folder that relative paths in the file start from."""
        return self.document.folder

    def origin(self, element: etree._Element, attribute: str | None = None) -> Origin:
        """Return the place of an element or attribute."""
        return self.document.origin(element, attribute, self.within)

    def of(self, document: Document, version: tuple[int, int], within: Place | None) -> Reading:
        """Return what the elements of another file, brought in by this one, are read with."""
        return replace(self, document=document, version=version, within=within)
