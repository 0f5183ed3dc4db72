"""Every word is declared, described and reachable, and occurs with all its attributes in a file that is read."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.source import aisa
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement, Use
from scenario_compiler.source.study import STUDIES
from scenario_compiler.vocabulary.entities import Ego
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.markings import Markings
from scenario_compiler.vocabulary.schema import words_below
from scenario_compiler.vocabulary.storyboard import When
from scenario_compiler.vocabulary.takeover import Message
from scenario_compiler.vocabulary.word import QUANTITIES, Word

WORDS = words_below((LibraryElement, CatalogElement))
FOLDER = Path(__file__).resolve().parent.parent / "source"

WITHOUT_ELEMENT = {
    "AnyOfPosition": "what <random_spawn_point> is bound to",
    "NumberLimit": "what a <parameter> with limits becomes in a plan",
    "Scenario": "what <scenario> is expanded to",
    aisa.Waypoint.__name__: "the AISA toolkit's own",
}
"""Words with a tag that the conflict language's files do not hold, and why."""


def _subclasses(word: type[Word]) -> set[type[Word]]:
    return {word}.union(*(_subclasses(one) for one in word.__subclasses__()))


def test_every_word_with_a_tag_can_stand_in_a_file() -> None:
    tagged = {word for word in _subclasses(Word) if word.tag() and "tests" not in word.__module__}
    assert {word.__name__ for word in tagged - {*WORDS, *words_below(STUDIES)}} == set(WITHOUT_ELEMENT)


def _used_in_the_file_of_every_word() -> dict[tuple[str, str], set[str]]:
    """Return the attributes that stand in the three files, by tag and parent's tag."""
    used: dict[tuple[str, str], set[str]] = {}
    for name in ("every_word.xml", "every_action.xml", "every_entry.xml"):
        for element in etree.parse(str(FOLDER / name)).getroot().iter(etree.Element):
            parent = element.getparent()
            key = str(element.tag), "" if parent is None else str(parent.tag)
            used.setdefault(key, set()).update(map(str, element.attrib))
    return used


def test_every_word_and_attribute_stands_in_the_file_of_every_word() -> None:
    used = _used_in_the_file_of_every_word()
    missing = []
    for word in WORDS:
        found = [used[key] for key in used if key[0] == word.tag()]
        attributes = set().union(*found)
        if not found:
            missing.append(f"<{word.tag()}>")
        missing += [f"<{word.tag()} {name}>" for name in set(grammar_of(word).attributes) - attributes]
    assert missing == []


@pytest.mark.parametrize("word", WORDS, ids=lambda word: word.__name__)
def test_word_is_described(word: type[Word]) -> None:
    assert (word.__doc__ or "").rstrip().endswith(".")
    grammar = grammar_of(word)
    for rule in grammar.attributes.values():
        assert rule.description.endswith("."), rule.name
        assert not rule.spelling.quantity or rule.spelling.quantity in QUANTITIES
    for child in grammar.children:
        assert child.description.endswith("."), child.field
        assert all(child.words), child.field


def test_kinds_of_attributes() -> None:
    kinds = {name: rule.kind for name, rule in grammar_of(Ego).attributes.items()}
    assert kinds == {"id": "text", "model": "text", "speed": "number", "desired_speed": "number"}
    assert grammar_of(Message).attributes["content"].choices == ("what", "why", "next")


def test_spelling_differs_from_field() -> None:
    rules = grammar_of(Markings).attributes
    assert rules["from"].field == "s_from"
    assert not rules["quality_to"].required


def test_children_are_required_and_many_as_declared() -> None:
    start, destination, *_, whens = grammar_of(Ego).children
    assert (start.wrapper, start.required, start.many) == ("start", True, False)
    assert (destination.required, whens.many) == (False, True)
    assert [rule.required for rule in grammar_of(When).children] == [True, True]


def test_other_attributes_are_collected() -> None:
    assert grammar_of(Use).others == "arguments"
    assert grammar_of(Ego).others == ""
