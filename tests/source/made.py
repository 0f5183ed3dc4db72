"""Scenario files made from parts, and what expanding them gives."""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.document import parse_document
from scenario_compiler.languages import Source, expand, parse
from scenario_compiler.vocabulary.scenario import Scenario

EGO = '<ego speed="10"><start><lane road="1" lane="-1" s="20"/></start></ego>'


def library_text(items: str = "", *, head: str = "", parameters: str = "", ego: str = EGO, attributes: str = "") -> str:
    """Return a file with one scenario, `case`, that holds these items; `head` stands before it."""
    return (
        f'<scenarios version="1">{head}<scenario name="case" map="town_grid" duration="10" {attributes}>'
        f"{parameters}{ego}{items}</scenario></scenarios>"
    )


def parsed(text: str, sink: Diagnostics, name: str = "made.xml") -> Source:
    """Parse a file's text."""
    document = parse_document(text.encode(), name, sink)
    assert document is not None
    source = parse(document, sink)
    assert source is not None
    return source


def expanded(text: str, path: Path | str = "made.xml", name: str | None = None, **arguments: str) -> Scenario:
    """Return the scenario of a file that has no fault."""
    sink = Diagnostics()
    scenario = expand(parsed(text, sink, str(path)), name, arguments, sink)
    assert [as_text(one) for one in sink] == []
    assert scenario is not None
    return scenario


def codes_of(text: str, path: Path | str = "made.xml", **arguments: str) -> list[str]:
    """Return the codes of what is wrong with a file's only scenario."""
    sink = Diagnostics()
    expand(parsed(text, sink, str(path)), None, arguments, sink)
    return [one.code.id for one in sink]
