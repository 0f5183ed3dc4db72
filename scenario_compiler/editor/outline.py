"""The outline of a file: a tree of its named things, and the positions of its scenarios."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from scenario_compiler.editor.analysis import Analysis
from scenario_compiler.editor.draft import MOST_DEPTH, Attribute, Tag
from scenario_compiler.source.conflict import ScenarioElement, Use


@dataclass(frozen=True, slots=True)
class Entry:
    """An element with a name.

    Attributes:
        kind: Kind of its name: scenario, template, parameter, entity, ...
        name: Its name.
        detail: A description in a few words.
        start: Offset of the element.
        end: Offset after it.
        name_start: Offset of the name.
        name_end: Offset after it.
        children: Named elements inside it.
    """

    kind: str
    name: str
    detail: str
    start: int
    end: int
    name_start: int
    name_end: int
    children: tuple[Entry, ...] = ()


def outline(analysis: Analysis) -> tuple[Entry, ...]:
    """Return the named elements of a file, in the order of the file."""
    root = analysis.draft.root
    return () if root is None else tuple(_entries(analysis, root, 0))


def _entries(analysis: Analysis, tag: Tag, depth: int) -> Iterator[Entry]:
    for child in tag.children if depth < MOST_DEPTH else ():
        inner = tuple(_entries(analysis, child, depth + 1))
        named = _named(analysis, child)
        if named is None:
            yield from inner
            continue
        kind, attribute = named
        detail = analysis.draft.text_of(child, "summary") or f"<{child.name}>"
        where = (child.start, max(child.end, child.head_end), attribute.value_start, attribute.value_end)
        yield Entry(kind, analysis.draft.meant(attribute), detail, *where, inner)


def _named(analysis: Analysis, tag: Tag) -> tuple[str, Attribute] | None:
    """Return the kind and the attribute of an element's name; for a use without an id, those of its template's name."""
    meaning = analysis.meanings.get(tag.start)
    for name, rule in {} if meaning is None else meaning.attributes.items():
        attribute = tag.attribute(name)
        if rule.spelling.defines and attribute is not None and analysis.draft.value(attribute).strip():
            return rule.spelling.defines, attribute
    template = tag.attribute("template") if tag.name == Use.tag() else None
    return None if template is None or not template.has_value else ("part", template)


def scenarios(analysis: Analysis) -> Iterator[tuple[str, Tag]]:
    """Yield the name and the element of each scenario of a file."""
    root = analysis.draft.root
    for tag in () if root is None else root.children:
        name = analysis.draft.text_of(tag, "name") if tag.name == ScenarioElement.tag() else ""
        if name:
            yield name, tag
