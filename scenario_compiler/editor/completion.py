"""Completion: the elements, attributes and values that are possible at a position, by the words' declarations."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Literal
from xml.sax.saxutils import escape

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.editor.analysis import Analysis
from scenario_compiler.editor.cursor import Cursor, cursor_at
from scenario_compiler.editor.draft import Tag
from scenario_compiler.editor.known import Known, Spot, known, parameter_text
from scenario_compiler.editor.words import ROOTS, Meaning, described, meaning_of
from scenario_compiler.expressions import FUNCTIONS, format_value
from scenario_compiler.source.conflict import Part, Use
from scenario_compiler.source.parameters import Declared, parameter_kind
from scenario_compiler.source.templates import template_parameters
from scenario_compiler.vocabulary.grammar import AttributeRule, ChildRule, grammar_of
from scenario_compiler.vocabulary.language_page import holds
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.schema import default_text
from scenario_compiler.vocabulary.word import Word

OfferKind = Literal["element", "attribute", "value", "name", "function", "end"]


@dataclass(frozen=True, slots=True)
class Offer:
    """A completion.

    Attributes:
        label: The displayed text, with which the author's letters are compared.
        kind: Its kind.
        start: Offset of the text that it replaces.
        end: Offset after that text.
        insert: The inserted text; `$1`, `$2` and so on are places for the author to fill in, `$0` is the last.
        detail: A description in a few words.
        text: A description as Markdown.
    """

    label: str
    kind: OfferKind
    start: int
    end: int
    insert: str
    detail: str = ""
    text: str = ""

    @property
    def plain(self) -> str:
        """The inserted text for editors without places to fill in."""
        return re.sub(r"\\([$}\\])|[$]\d", lambda one: one.group(1) or "", self.insert)


def offers(analysis: Analysis, offset: int, maps: Sequence[Path] = ()) -> list[Offer]:
    """Return the completions at an offset, in the order of the declarations."""
    cursor = cursor_at(analysis.draft, offset)
    if cursor is None:
        return []
    if cursor.place == "element":
        return list(_elements(analysis, cursor))
    if cursor.place == "end":
        return [Offer(f"</{cursor.tag.name}>", "end", cursor.start, cursor.end, f"/{cursor.tag.name}>")]
    meaning = meaning_of(cursor.tag)
    if meaning is None:
        return []
    if cursor.place == "attribute":
        return list(_attributes(analysis, cursor, meaning))
    return list(_values(analysis, cursor, meaning, maps))


def _elements(analysis: Analysis, cursor: Cursor) -> Iterator[Offer]:
    """Yield the elements that the order and number of the children allow here."""
    before = "" if cursor.bracket else "<"
    if cursor.tag.parent is None:
        for name, word in ROOTS.items() if analysis.draft.root in (None, cursor.written) else ():
            yield _element_offer(name, word, described(word), before, cursor)
        return
    meaning = meaning_of(cursor.tag)
    if meaning is None:
        return
    for rule in _open_rules(meaning, cursor):
        for name in meaning.tags(rule):
            inner = meaning.child(name)
            if inner is not None:
                yield _element_offer(name, inner.word, inner.text, before, cursor)


def _open_rules(meaning: Meaning, cursor: Cursor) -> Iterator[ChildRule]:
    """Yield the rules whose elements are allowed at the cursor."""
    order = {name: index for index, rule in enumerate(meaning.rules) for name in meaning.tags(rule)}
    others = [one for one in cursor.tag.children if one is not cursor.written and one.name in order]
    least = max((order[one.name] for one in others if one.start < cursor.offset), default=0)
    most = min((order[one.name] for one in others if one.start >= cursor.offset), default=len(meaning.rules))
    for index, rule in enumerate(meaning.rules):
        many = rule.many and (meaning.word is None or not rule.wrapper)
        taken = not many and any(order[one.name] == index for one in others)
        if least <= index <= most and not taken:
            yield rule


def _element_offer(name: str, word: type[Word] | None, text: str, before: str, cursor: Cursor) -> Offer:
    insert = f"{before}{_written(name, word, count(1))}" if not cursor.rest else f"{before}{name}"
    return Offer(name, "element", cursor.start, cursor.end, insert, text.split("\n\n")[0], text)


def _written(name: str, word: type[Word] | None, numbers: Iterator[int]) -> str:
    """Return an element's text after its bracket, with places for its required attributes and for its children.

    Required children are written if there is no choice.
    """
    if word is None:
        return f"{name}>${next(numbers)}</{name}>"
    grammar = grammar_of(word)
    required = [rule for rule in grammar.attributes.values() if rule.required]
    given = [rule.choices[0] if len(rule.choices) == 1 else f"${next(numbers)}" for rule in required]
    attributes = "".join(f' {rule.name}="{value}"' for rule, value in zip(required, given, strict=True))
    if not grammar.children:
        return f"{name}{attributes}/>"
    children = "".join(_required_child(rule, numbers) for rule in grammar.children if rule.required)
    return f"{name}{attributes}>{children or f'${next(numbers)}'}</{name}>"


def _required_child(rule: ChildRule, numbers: Iterator[int]) -> str:
    """Return the text of a required child, or a place for it if there is a choice."""
    only = next(iter(rule.words.items())) if len(rule.words) == 1 else None
    inner = f"${next(numbers)}" if only is None else f"<{_written(*only, numbers)}"
    return f"<{rule.wrapper}>{inner}</{rule.wrapper}>" if rule.wrapper else inner


def _attributes(analysis: Analysis, cursor: Cursor, meaning: Meaning) -> Iterator[Offer]:
    """Yield the attributes that an element does not have yet; for a `<use>` also the template's parameters."""
    taken = {one.name for one in cursor.tag.attributes if one.start != cursor.start}
    end = "" if cursor.rest.startswith("=") else '="$1"'
    for rule in meaning.attributes.values():
        if rule.name not in taken:
            insert = f'{rule.name}="{rule.choices[0]}"' if end and len(rule.choices) == 1 else f"{rule.name}{end}"
            detail = f"{holds(rule)}{', required' if rule.required else ''}".replace("`", "")
            yield Offer(rule.name, "attribute", cursor.start, cursor.end, insert, detail, attribute_text(rule))
    template = analysis.template_of(cursor.tag)
    for parameter in [] if template is None else arguments_of(template).known.values():
        if parameter.name not in taken:
            detail = (
                parameter_kind(parameter) if parameter.default is not None else f"{parameter_kind(parameter)}, required"
            )
            text = parameter_text(parameter)
            yield Offer(parameter.name, "attribute", cursor.start, cursor.end, f"{parameter.name}{end}", detail, text)


def attribute_text(rule: AttributeRule) -> str:
    """Return an attribute's description, unit, limits and default as Markdown."""
    return "\n\n".join(
        part for part in (f"**{rule.name}** ({holds(rule)})", rule.description, default_text(rule)) if part
    )


def arguments_of(template: Part) -> Declared:
    """Return the parameters of a template that a use can set."""
    return template_parameters(template, Diagnostics())


def _values(analysis: Analysis, cursor: Cursor, meaning: Meaning, maps: Sequence[Path]) -> Iterator[Offer]:
    """Yield an attribute's possible values: its choices, names, and parameters after a `$`."""
    rule = meaning.attributes.get(cursor.attribute)
    spot = Spot(analysis, cursor.tag, maps)
    written = analysis.draft.text[cursor.value_start : cursor.offset]
    expression = re.search(r"[$]\{[^{}]*\Z|[$][A-Za-z0-9_.]*\Z", written)
    if expression is not None or (rule is not None and rule.spelling.expression):
        yield from _in_expression(cursor, spot, written, braced=expression is None or "{" in expression.group())
        return
    parameter = _argument(analysis, cursor) if rule is None else None
    if rule is not None and rule.spelling.separated:
        cursor = _token(analysis, cursor)
    for one in _literals(rule, parameter):
        yield _value_offer(one, cursor)
    kind = (
        rule.spelling.names
        if rule is not None
        else ""
        if parameter is None
        else _kind_of(analysis, cursor.tag, parameter)
    )
    for one in known(kind, spot):
        yield _value_offer(one, cursor)
    if (rule is None) != (parameter is None) and not (rule is not None and rule.spelling.defines):
        for one in known("parameter", spot):
            yield _value_offer(replace(one, name=f"${one.name}"), cursor, "name")


def _value_offer(one: Known, cursor: Cursor, kind: OfferKind = "value") -> Offer:
    insert = escape(one.name, {'"': "&quot;"}).replace("\\", "\\\\").replace("$", "\\$").replace("}", "\\}")
    return Offer(one.name, kind, cursor.start, cursor.end, insert, one.detail, one.text)


def _literals(rule: AttributeRule | None, parameter: Parameter | None) -> Iterator[Known]:
    if rule is not None:
        default = default_text(rule).removeprefix("Default: ").removesuffix(".")
        choices = ("true", "false") if rule.kind == "boolean" else rule.choices
        yield from (Known(one, "default" if one == default else "", rule.description) for one in choices)
        if not choices and rule.kind in ("number", "fixed_number", "integer") and default:
            yield Known(default, "default", attribute_text(rule))
    elif parameter is not None:
        choices = ("true", "false") if parameter.type == "boolean" else ()
        yield from (Known(one, parameter.type, parameter_text(parameter)) for one in choices)
        if not choices and parameter.default:
            yield Known(parameter.default, "default", parameter_text(parameter))
        for limit, number in (("least", parameter.min), ("greatest", parameter.max)):
            if isinstance(number, float):
                yield Known(format_value(number), f"{limit} value", parameter_text(parameter))


def _argument(analysis: Analysis, cursor: Cursor) -> Parameter | None:
    """Return the template's parameter that an attribute of a `<use>` sets."""
    template = analysis.template_of(cursor.tag) if cursor.tag.name == Use.tag() else None
    return None if template is None else arguments_of(template).known.get(cursor.attribute)


def _kind_of(analysis: Analysis, use: Tag, parameter: Parameter) -> str:
    """Return the kind of name that a template's parameter has, if an attribute in the template consists of it alone."""
    template = analysis.template_of(use)
    if template is None:
        return ""
    inside = Analysis(template.document.path, template.document.text)
    for part in [] if inside.draft.root is None else inside.draft.root.below():
        if part.name != template.element.tag or inside.draft.text_of(part, "name") != template.name:
            continue
        for tag in part.below():
            meaning = inside.meanings.get(tag.start)
            for attribute in tag.attributes:
                rule = None if meaning is None else meaning.attributes.get(attribute.name)
                if rule is not None and rule.spelling.names and inside.draft.value(attribute) == f"${parameter.name}":
                    return rule.spelling.names
    return ""


def _token(analysis: Analysis, cursor: Cursor) -> Cursor:
    """Return the cursor for the word of a list that contains it."""
    text = analysis.draft.text
    start, end = cursor.offset, cursor.offset
    while start > cursor.value_start and not text[start - 1].isspace():
        start -= 1
    while end < cursor.end and not text[end].isspace():
        end += 1
    return replace(cursor, start=start, end=end)


def _in_expression(cursor: Cursor, spot: Spot, written: str, *, braced: bool) -> Iterator[Offer]:
    """Yield the parameters that an expression can use and, inside brackets, the functions."""
    name = re.search(r"[$]?[A-Za-z0-9_.]*\Z", written)
    start = cursor.offset - (0 if name is None else len(name.group()))
    for one in known("parameter", spot):
        yield Offer(f"${one.name}", "name", start, cursor.offset, f"\\${one.name}", one.detail, one.text)
    for function, (arguments, _) in FUNCTIONS.items() if braced else ():
        places = ", ".join(f"${number}" for number in range(1, (2 if arguments < 0 else arguments) + 1))
        yield Offer(function, "function", start, cursor.offset, f"{function}({places})", "function")
