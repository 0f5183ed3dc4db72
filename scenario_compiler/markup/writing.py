"""Writes words as XML, from the same declarations as the reader."""

from __future__ import annotations

import re
from typing import Any

from lxml import etree

from scenario_compiler.expressions import Expression
from scenario_compiler.vocabulary.grammar import AttributeRule, ChildRule, grammar_of
from scenario_compiler.vocabulary.word import QUANTITIES, Word


def write_word(word: Word) -> etree._Element:
    """Return the element of a word, with the attributes and children that differ from their defaults."""
    element = etree.Element(word.tag())
    grammar = grammar_of(type(word))
    for rule in grammar.attributes.values():
        value = getattr(word, rule.field)
        if rule.required or value != rule.default:
            element.set(rule.name, written_value(value, rule))
    if grammar.others:
        for name, text in getattr(word, grammar.others).items():
            element.set(name, text)
    for child in grammar.children:
        _write_children(element, word, child)
    return element


def _write_children(element: etree._Element, word: Word, rule: ChildRule) -> None:
    value = getattr(word, rule.field)
    words = () if value is None else value if isinstance(value, tuple) else (value,)
    if not rule.required and words and value == type(word).model_fields[rule.field].get_default():
        return
    if not words:
        return
    parent = etree.SubElement(element, rule.wrapper) if rule.wrapper else element
    for one in words:
        parent.append(write_word(one))


def written_value(value: Any, rule: AttributeRule) -> str:
    """Return the text of an attribute's value, with numbers in XML's unit."""
    if isinstance(value, tuple):
        return " ".join(written_value(one, rule) for one in value)
    if isinstance(value, bool):
        return "true" if value else "false"
    quantity = QUANTITIES.get(rule.spelling.quantity)
    factor = quantity.factor if quantity else 1.0
    if isinstance(value, Expression):
        converted = re.fullmatch(r"radians\((.*)\)", value.text)
        return f"${{{converted.group(1) if converted and factor != 1.0 else value.text}}}"
    if isinstance(value, float):
        return written_number(value, factor)
    return str(value)


def written_number(value: float, factor: float = 1.0) -> str:
    """Return the shortest text of a number that is read back as the same number, in the unit with the given factor."""
    for digits in range(6, 18):
        text = f"{value / factor:.{digits}g}"
        if float(text) * factor == value:
            break
    return text
