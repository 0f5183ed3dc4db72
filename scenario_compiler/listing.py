"""Lists the conflicts and templates of a library, with one row for each, without expanding anything."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Literal

from scenario_compiler.compiler import read_source
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.files import files_in
from scenario_compiler.markup.environment import Environment
from scenario_compiler.markup.reading import read_word
from scenario_compiler.openscenario.contents import OpenScenario
from scenario_compiler.resources import template_folders
from scenario_compiler.source.aisa import KNOWN
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.conflict import Library, Part
from scenario_compiler.source.templates import template_parameters, templates_by_name, templates_in
from scenario_compiler.vocabulary.scenario import Classification, Parameter
from scenario_compiler.vocabulary.variation import Vary

SUFFIXES = (".xml", ".xosc")
"""Suffixes of the files that are looked for in a folder."""


@dataclass(frozen=True, slots=True)
class Listed:
    """A conflict or a template of a library.

    Attributes:
        kind: Conflict or template.
        target: FILE#name as `run` takes it, or a template's name as `<use>` takes it.
        file: The file that contains it.
        name: Its name.
        summary: One sentence on what happens.
        source: Origin of the situation.
        map: Name of the map; empty for a template.
        gold: Number of the situation in Gold et al. 2018; empty if it has none.
        parameters: Parameters that `--set`, or a use, can set.
        varied: Parameters that a sweep varies if no `--vary` is given, each with its values.
    """

    kind: Literal["conflict", "template"]
    target: str
    file: Path
    name: str
    summary: str
    source: str
    map: str
    gold: str
    parameters: tuple[Parameter, ...] = ()
    varied: tuple[tuple[str, str], ...] = ()


def list_library(folder: Path, sink: Diagnostics) -> Iterator[Listed]:
    """Yield the conflicts and templates of the files below a folder, or of one file: by path, in document order.

    Files that cannot be read are reported and skipped; catalogs are skipped without a diagnostic.
    """
    paths = files_in(folder, *SUFFIXES, deep=True) if folder.is_dir() else [folder]
    for path in paths:
        read = read_source(path, sink)
        source = None if read is None else read[1]
        if isinstance(source, Library):
            for name in source.own_templates:
                yield _listed("template", name, path, name, source.templates[name])
            for name, part in source.scenarios.items():
                yield _listed("conflict", f"{path}#{name}", path, name, part)
        elif isinstance(source, AisaConfig):
            for name, element in source.scenarios.items():
                summary = KNOWN[name].summary if name in KNOWN else ""
                town = element.get("town", "")
                yield Listed("conflict", f"{path}#{name}", path, name, summary, "AISA toolkit", town, "")
        elif isinstance(source, OpenScenario):
            yield from (_openscenario(path, name, source) for name in source.scenarios)


def list_templates(sink: Diagnostics) -> Iterator[Listed]:
    """Yield the templates that a `<use>` can name without an include, by name; faults of their files are reported."""
    for folder in template_folders():
        sink.take(templates_in(folder).faults)
    for name, part in sorted(templates_by_name().items()):
        if name:
            yield _listed("template", name, Path(part.document.path), name, part)


def _openscenario(path: Path, name: str, source: OpenScenario) -> Listed:
    """Return the scenario of a file; for a file of parameter values, its scenario with these values."""
    root, variation = source.document.root, source.variation
    header = root.find("{*}FileHeader")
    logic = root.find("{*}RoadNetwork/{*}LogicFile")
    described = "" if header is None else header.get("description", "")
    return Listed(
        kind="conflict",
        target=str(path),
        file=path,
        name=name,
        summary=described if variation is None else f"varies {Path(source.document.path).name}",
        source="" if header is None else header.get("author", ""),
        map="" if logic is None else PurePosixPath(logic.get("filepath", "")).stem,
        gold="",
        varied=() if variation is None else tuple(_varied(variation.vary, variation.sets)),
    )


def _varied(vary: Vary, sets: Mapping[str, Sequence[Mapping[str, str]]]) -> Iterator[tuple[str, str]]:
    """Yield each varied parameter with its values; for sets of values, each set with the number that chooses it."""
    for axis in vary.axes:
        if axis.parameter in sets:
            for number, values in enumerate(sets[axis.parameter]):
                text = ", ".join(f"{name} = {value}" for name, value in values.items())
                yield f"{axis.parameter} {number}", text
        else:
            yield axis.parameter, axis.spelling().partition("=")[2]


def _listed(kind: Literal["conflict", "template"], target: str, file: Path, name: str, part: Part) -> Listed:
    element = part.element
    placed = (one for one in element.iterchildren(Classification.tag()) if one.get("scheme") == "gold2018")
    gold = next((str(one.get("number", "")) for one in placed), "")
    known = template_parameters(part, Diagnostics()).known
    written = element.find(Vary.tag())
    vary = None if written is None else read_word(written, Vary, part.reading(Diagnostics(), Environment()))
    return Listed(
        kind=kind,
        target=target,
        file=file,
        name=name,
        summary=element.get("summary", ""),
        source=element.get("source", ""),
        map=element.get("map", ""),
        gold=gold,
        parameters=tuple(known.values()),
        varied=() if vary is None else tuple(_varied(vary, {})),
    )
