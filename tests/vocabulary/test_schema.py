"""The XSD that is made from the declarations."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.source.form import conflict_xsd
from scenario_compiler.vocabulary.entities import Ego
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.positions import LanePositionWord
from scenario_compiler.vocabulary.schema import default_text, words_below, xsd_of
from scenario_compiler.vocabulary.takeover import Takeover

XS = "{http://www.w3.org/2001/XMLSchema}"


def test_schema_compiles_and_is_the_same_each_time() -> None:
    assert conflict_xsd() == conflict_xsd()
    etree.XMLSchema(etree.fromstring(conflict_xsd().encode()))


def test_every_type_element_and_attribute_is_documented() -> None:
    root = etree.fromstring(conflict_xsd().encode())
    bare = [
        etree.tostring(element)[:80]
        for element in root.iter(f"{XS}attribute", f"{XS}complexType", f"{XS}choice", f"{XS}element")
        if element.get("name") and element.find(f"{XS}annotation/{XS}documentation") is None
        if element.getparent() is not root or element.tag != f"{XS}element"
    ]
    assert bare == []


def test_schema_of_one_word() -> None:
    schema = etree.XMLSchema(etree.fromstring(xsd_of((LanePositionWord,)).encode()))
    assert schema.validate(etree.fromstring('<lane road="1" lane="-1" s="$far"/>'))
    assert schema.validate(etree.fromstring('<lane road="1" lane="${-$n}" s="1e2" turn="90"/>'))
    for wrong in ('<lane road="1" lane="-1" s="-1"/>', '<lane road="1" lane="-1.0" s="1"/>', '<lane lane="-1" s="1"/>'):
        assert not schema.validate(etree.fromstring(wrong)), wrong


def test_words_below_come_once_outermost_first() -> None:
    words = words_below((Ego,))
    assert words[0] is Ego
    assert len(words) == len(set(words))


def test_defaults_are_stated_in_xml_units() -> None:
    rules = grammar_of(Takeover).attributes
    assert default_text(rules["budget"]) == "Default: 7."
    assert default_text(grammar_of(LanePositionWord).attributes["turn"]) == "Default: 0."
    assert default_text(grammar_of(LanePositionWord).attributes["road"]) == ""
