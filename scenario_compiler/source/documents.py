"""Scenario files: read as real ones need it, and where they name the map."""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics, Place
from scenario_compiler.document import Document, read_document
from scenario_compiler.vocabulary.scenario import Scenario


def read_scenario_document(path: str | Path, sink: Diagnostics) -> Document | None:
    """Read a scenario file; in one of OpenSCENARIO comments with two hyphens are mended, with a warning."""
    if Path(path).suffix == ".xosc":
        from scenario_compiler.source.openscenario.files import read_forgiving

        return read_forgiving(path, sink)
    return read_document(path, sink)


def map_place(scenario: Scenario, document: Document) -> Place:
    """Return where a scenario's file names the map."""
    logic = document.root.find("{*}RoadNetwork/{*}LogicFile")
    return scenario.place_of("map") if logic is None else document.origin(logic, "filepath")
