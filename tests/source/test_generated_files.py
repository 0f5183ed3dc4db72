"""The reader and the XSD accept the same files: shown on whole files made up from the declarations.

Each file holds templates and scenarios of words drawn from the grammar, to its full depth, and is valid; then one fault
is put into it at a time. Faults one at a time show the most: a file with two is refused whatever becomes of either.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, MutableSequence, Sequence
from functools import cache
from typing import Protocol, TypeVar

from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.coverage.uses import words_in
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement, ScenarioElement, TemplateElement
from scenario_compiler.vocabulary.grammar import AttributeRule, ChildRule, grammar_of
from scenario_compiler.vocabulary.schema import words_below
from scenario_compiler.vocabulary.word import Word
from tests.source.test_form import VALUES, disagreement, faults

FILES, FAULTS = 20, 8
"""Files that are made up, and faults that are tried in each."""

DEEPEST = 7
"""Depth from which on an element holds as little as it may."""

TEXTS = ("a", "b_1", "Z-9", "SC401", "1", "with space", "\u00e9")
JUNK = (*VALUES, "-1e30", "1e30", "1 -1 x", "text  tone", "a,b", "true false", "\u00a07", "1\n2")


T = TypeVar("T")


class Dice(Protocol):
    """What is asked of a source of random choices."""

    def random(self) -> float:
        """Return a number in [0, 1)."""

    def randint(self, a: int, b: int) -> int:
        """Return a whole number, both ends included."""

    def choice(self, seq: Sequence[T]) -> T:
        """Return one of the items."""

    def shuffle(self, x: MutableSequence[T]) -> None:
        """Put the items in another order."""


@cache
def height(word: type[Word]) -> int:
    """Return how deep an element of a word is at the least."""
    heights = dict.fromkeys(words_below((word,)), 1000)
    for _ in heights:
        for one in heights:
            needed = [min(heights[w] for w in rule.words.values()) for rule in _needed(one)]
            heights[one] = min(heights[one], 1 + max(needed, default=0))
    return heights[word]


def _needed(word: type[Word]) -> list[ChildRule]:
    return [rule for rule in grammar_of(word).children if rule.required]


def made_up(word: type[Word], tag: str, dice: Dice, depth: int = 0) -> etree._Element:
    """Return a valid element of a word."""
    element = etree.Element(tag)
    grammar = grammar_of(word)
    names = list(grammar.attributes)
    dice.shuffle(names)
    for rule in (grammar.attributes[name] for name in names):
        if rule.required or dice.random() < 0.4:
            element.set(rule.name, literal(rule, dice))
    if grammar.others and dice.random() < 0.5:
        element.set("of_the_template", dice.choice(VALUES))
    for child in grammar.children:
        forced = {ScenarioElement, TemplateElement} & set(child.words.values())
        if not (forced or child.required) and (depth >= DEEPEST or dice.random() < 0.5):
            continue
        home = etree.SubElement(element, child.wrapper) if child.wrapper else element
        for _ in range(dice.randint(1, 4) if child.many and depth < DEEPEST else 1):
            inner, kind = chosen(child, dice, depth)
            home.append(made_up(kind, inner, dice, depth + 1))
    return element


def chosen(child: ChildRule, dice: Dice, depth: int) -> tuple[str, type[Word]]:
    """Return one of the words that are allowed somewhere; deep down, one that needs little below it."""
    words = list(child.words.items())
    least = min(height(word) for _, word in words)
    return dice.choice([pair for pair in words if depth < DEEPEST or height(pair[1]) == least])


def literal(rule: AttributeRule, dice: Dice) -> str:
    """Return a right text for an attribute: at and between its limits for a number, a list where one is allowed."""
    plain = rule.kind == "text" and not rule.spelling.pattern and not rule.spelling.separated
    if not plain and dice.random() < 0.1:
        return dice.choice(("$name", "${1 + $name}"))
    count = dice.randint(1, 3) if rule.spelling.separated else 1
    return " ".join(single(rule, dice) for _ in range(count))


def single(rule: AttributeRule, dice: Dice) -> str:
    """Return a right value for an attribute."""
    if rule.kind == "choice":
        return dice.choice(rule.choices)
    if rule.kind == "boolean":
        return dice.choice(("true", "false"))
    if rule.kind == "text":
        return dice.choice([text for text in TEXTS if re.fullmatch(rule.spelling.pattern or ".+", text)])
    return dice.choice(numbers(rule)[0])


def numbers(rule: AttributeRule) -> tuple[list[str], list[str]]:
    """Return texts of numbers within the limits of an attribute, and outside of them."""
    low, high = rule.spelling.minimum, rule.spelling.maximum
    least, most = -5.0 if low is None else low, (0.0 if low is None else low) + 10.0 if high is None else high
    inside, outside = [0.5 * (least + most), most], []
    if low is not None:
        outside += [low - 1.0]
        (outside if rule.spelling.exclusive else inside).append(low)
    if high is not None:
        outside.append(high + 1.0)
    if rule.kind == "integer":
        return [str(int(number)) for number in inside], [str(int(number)) for number in outside]
    return [repr(float(number)) for number in inside], [repr(float(number)) for number in outside]


def _element(root: etree._Element, dice: Dice) -> etree._Element:
    return dice.choice(list(root.iter(etree.Element)))


def _word_of(element: etree._Element) -> type[Word] | None:
    """Return the word that an element spells; None for one that only wraps others."""
    parent = element.getparent()
    if parent is None:
        return CatalogElement if element.tag == "catalog" else LibraryElement
    above, wrapper = _word_of(parent), ""
    holder = parent.getparent()
    if above is None and holder is not None:
        above, wrapper = _word_of(holder), str(parent.tag)
    assert above is not None
    rules = (rule for rule in grammar_of(above).children if rule.wrapper == wrapper)
    return next((rule.words[str(element.tag)] for rule in rules if element.tag in rule.words), None)


def _changed_value(root: etree._Element, dice: Dice) -> None:
    """Set an attribute that the element may have to a number beyond its limits, or to junk."""
    element = _element(root, dice)
    word = _word_of(element)
    rules = [] if word is None else list(grammar_of(word).attributes.values())
    if rules:
        rule = dice.choice(rules)
        beyond = numbers(rule)[1] if rule.kind in ("number", "fixed_number", "integer") else []
        element.set(rule.name, dice.choice(beyond if beyond and dice.random() < 0.5 else list(JUNK)))


def _dropped_attribute(root: etree._Element, dice: Dice) -> None:
    element = _element(root, dice)
    if element.attrib:
        del element.attrib[dice.choice(list(element.attrib))]


def _unknown_attribute(root: etree._Element, dice: Dice) -> None:
    _element(root, dice).set(dice.choice(("surprise", "Id", "xmlns_x", "{urn:other}id")), "1")


def _shuffled(root: etree._Element, dice: Dice) -> None:
    element = _element(root, dice)
    children = list(element)
    dice.shuffle(children)
    element[:] = children


def _removed(root: etree._Element, dice: Dice) -> None:
    element = _element(root, dice)
    if len(element):
        element.remove(dice.choice(list(element)))


def _doubled(root: etree._Element, dice: Dice) -> None:
    element = _element(root, dice)
    if len(element):
        child = dice.choice(list(element))
        child.addnext(copy.deepcopy(child))


def _transplanted(root: etree._Element, dice: Dice) -> None:
    """Put a copy of one element into another."""
    element = copy.deepcopy(_element(root, dice))
    _element(root, dice).insert(0, element)


def _stray_text(root: etree._Element, dice: Dice) -> None:
    _element(root, dice).text = dice.choice(("stray", "\n  ", "\u00a0"))


CHANGES: tuple[Callable[[etree._Element, Dice], None], ...] = (
    _changed_value,
    _changed_value,
    _changed_value,
    _dropped_attribute,
    _unknown_attribute,
    _shuffled,
    _removed,
    _doubled,
    _transplanted,
    _stray_text,
)

SIZES: list[int] = []
REFUSED: list[bool] = []
SPELT: set[type[Word]] = set()


@settings(max_examples=FILES, deadline=None)
@given(dice=st.randoms(use_true_random=True), root=st.sampled_from((*[LibraryElement] * 4, CatalogElement)))
def check_files(dice: Dice, root: type[Word]) -> None:
    """Make up a file and try faults in it."""
    document = made_up(root, root.tag(), dice)
    assert faults(document) == []
    assert disagreement(document) == ""
    SPELT.update(words_in(document, root))
    SIZES.append(sum(1 for _ in document.iter()))
    for _ in range(FAULTS):
        mutant = copy.deepcopy(document)
        dice.choice(CHANGES)(mutant, dice)
        assert disagreement(mutant) == ""
        REFUSED.append(bool(faults(mutant)))


def test_both_judges_agree_on_files_made_up_from_the_declarations() -> None:
    check_files()
    assert len(SPELT) > 0.95 * len(words_below((LibraryElement, CatalogElement)))
    assert sum(SIZES) > 30 * FILES
    assert max(SIZES) > 100
    assert sum(REFUSED) > len(REFUSED) / 4
