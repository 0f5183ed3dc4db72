"""Explanations of the thing at a position: an element, an attribute with unit and limits, or a named thing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.editor.analysis import Analysis, parameters_named
from scenario_compiler.editor.completion import arguments_of, attribute_text
from scenario_compiler.editor.draft import Attribute, Tag
from scenario_compiler.editor.known import Spot, known, parameter_text
from scenario_compiler.editor.words import Meaning, meaning_of
from scenario_compiler.vocabulary.grammar import AttributeRule


@dataclass(frozen=True, slots=True)
class Explained:
    """A part of a text and its explanation as Markdown."""

    start: int
    end: int
    text: str


def explained(analysis: Analysis, offset: int, maps: Sequence[Path] = ()) -> Explained | None:
    """Return the explanation at an offset; None if there is none."""
    if any(start <= offset < end for start, end in analysis.draft.passed_over):
        return None
    tag = analysis.draft.innermost(offset) if offset < len(analysis.draft.text) else analysis.draft.whole
    meaning = meaning_of(tag) if tag.parent is not None else None
    if meaning is None:
        return None
    name_end = tag.start + 1 + len(tag.name)
    if offset <= name_end or tag.end_start < offset < tag.end:
        start = tag.start + 1 if offset <= name_end else tag.end_start + 2
        return Explained(start, start + len(tag.name), f"**<{tag.name}>** {meaning.text}")
    for attribute in tag.attributes:
        rule = meaning.attributes.get(attribute.name)
        if attribute.start <= offset <= attribute.start + len(attribute.name):
            return _explained_name(analysis, tag, attribute, rule)
        if attribute.has_value and attribute.value_start <= offset <= attribute.value_end:
            return _explained_value(analysis, tag, attribute, meaning, offset, maps)
    return None


def _explained_name(analysis: Analysis, tag: Tag, attribute: Attribute, rule: AttributeRule | None) -> Explained | None:
    text = _argument_text(analysis, tag, attribute) if rule is None else attribute_text(rule)
    return Explained(attribute.start, attribute.start + len(attribute.name), text) if text else None


def _argument_text(analysis: Analysis, tag: Tag, attribute: Attribute) -> str:
    """Return the explanation of an attribute of a `<use>`, which is a parameter of its template."""
    template = analysis.template_of(tag)
    parameter = None if template is None else arguments_of(template).known.get(attribute.name)
    return "" if parameter is None else parameter_text(parameter)


def _explained_value(
    analysis: Analysis, tag: Tag, attribute: Attribute, meaning: Meaning, offset: int, maps: Sequence[Path]
) -> Explained | None:
    """Return the explanation of the parameter at an offset, else of the thing named there, else of the attribute."""
    rule, value = meaning.attributes.get(attribute.name), analysis.draft.value(attribute)
    whole = rule is not None and rule.spelling.expression
    spot = Spot(analysis, tag, maps)
    for name, at in parameters_named(value, whole=whole):
        start = attribute.value_start + at
        text = next((one.text for one in known("parameter", spot) if one.name == name), "")
        if start - 1 <= offset <= start + len(name) and text:
            return Explained(start, start + len(name), text)
    if rule is None:
        text = _argument_text(analysis, tag, attribute)
        return Explained(attribute.value_start, attribute.value_end, text) if text else None
    start, end = _word_at(value, offset - attribute.value_start) if rule.spelling.separated else (0, len(value))
    named = value[start:end].strip()
    kind = rule.spelling.names or rule.spelling.defines
    found = next((one for one in known(kind, spot) if one.name == named), None)
    start, end = attribute.value_start + start, attribute.value_start + end
    if found is None or not (found.text or found.detail):
        return Explained(start, end, attribute_text(rule))
    return Explained(start, end, found.text or f"**{found.name}** ({found.detail})")


def _word_at(value: str, at: int) -> tuple[int, int]:
    start, end = at, at
    while start > 0 and not value[start - 1].isspace():
        start -= 1
    while end < len(value) and not value[end].isspace():
        end += 1
    return start, end
