"""What a library holds: its conflicts and templates, one row each, read without expanding anything."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.source import parse
from scenario_compiler.source.aisa import KNOWN
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.conflict import Library, Part
from scenario_compiler.source.templates import template_parameters
from scenario_compiler.vocabulary.scenario import Parameter


@dataclass(frozen=True, slots=True)
class Listed:
    """A conflict or a template of a library.

    Attributes:
        kind: Which of the two.
        target: FILE#name as `run` takes it, or a template's name as `<use>` takes it.
        name: Its name.
        summary: One sentence: what happens.
        source: Where the situation comes from.
        map: Name of the map; empty for a template.
        gold: Number of the situation in Gold et al. 2018, empty for none.
        parameters: What `--set`, or a use, can set.
    """

    kind: Literal["conflict", "template"]
    target: str
    name: str
    summary: str
    source: str
    map: str
    gold: str
    parameters: tuple[Parameter, ...]


def list_library(folder: Path, sink: Diagnostics) -> Iterator[Listed]:
    """Yield what stands in the files below a folder, or in one file: sorted by path, in document order.

    Files that cannot be read are reported and passed over; so are catalogs, without a word.
    """
    paths = sorted(folder.rglob("*.xml")) if folder.is_dir() else [folder]
    for path in paths:
        document = read_document(path, sink)
        source = None if document is None else parse(document, sink)
        if isinstance(source, Library):
            for name in source.own_templates:
                yield _listed("template", name, name, source.templates[name])
            for name, part in source.scenarios.items():
                yield _listed("conflict", f"{path}#{name}", name, part)
        elif isinstance(source, AisaConfig):
            for name, element in source.scenarios.items():
                summary = KNOWN[name].summary if name in KNOWN else ""
                town = element.get("town", "")
                yield Listed("conflict", f"{path}#{name}", name, summary, "AISA toolkit", town, "", ())


def _listed(kind: Literal["conflict", "template"], target: str, name: str, part: Part) -> Listed:
    element = part.element
    place = element.find("classification")
    gold = place.get("number", "") if place is not None and place.get("scheme") == "gold2018" else ""
    known = template_parameters(part, Diagnostics()).known
    return Listed(
        kind=kind,
        target=target,
        name=name,
        summary=element.get("summary", ""),
        source=element.get("source", ""),
        map=element.get("map", ""),
        gold=gold,
        parameters=tuple(known.values()),
    )
