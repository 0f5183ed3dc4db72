"""The notation of tables: the meaning of a declaration in each version, and the findings of its checks."""

from __future__ import annotations

import pytest

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.document import parse_document
from scenario_compiler.openscenario.structure import codes
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.grammar import Faults, Grammar
from scenario_compiler.structure.notation import Declaration, Range, in_versions
from scenario_compiler.structure.values import Kind, is_date_time, is_integer, is_integer_within, is_number
from scenario_compiler.structure.walk import check_elements

TABLE = """
house
    name colour?:colour@1.1- height?1.2-:number
    = door (window | gap@1.2-)*@1.1- roof?1.1-
door
    =@1.0 handle
    =@1.1- & handle lock?@1.2 hinge=metal?
handle
lock
metal
    weight:number@-1.1
    = text:number
window
    by kind@1.2: round=porthole size
porthole
    kind radius:number
gap
roof
"""


def _faults(**more: Code) -> Faults:
    return Faults(
        unknown_element=codes.UNKNOWN_ELEMENT,
        unknown_attribute=codes.UNKNOWN_ATTRIBUTE,
        missing_attribute=codes.MISSING_ATTRIBUTE,
        missing_element=codes.MISSING_ELEMENT,
        bad_value=codes.BAD_VALUE,
        order=codes.ELEMENT_ORDER,
        misplaced=codes.MISPLACED_ELEMENT,
        stray_text=codes.STRAY_TEXT,
        **more,
    )


def _grammar(faults: Faults) -> Grammar:
    return Grammar(
        name="Houses",
        root="house",
        tables=(TABLE,),
        words={"colour": "red | green@1.2-"},
        kinds={"number": Kind("a number", lambda text, _: is_number(text))},
        minors=range(3),
        faults=faults,
    )


HOUSES = _grammar(_faults())
STRICT = _grammar(_faults(blank=codes.BLANKS, other_version=codes.OTHER_VERSION))


def declared(name: str, minor: int) -> Declaration:
    return HOUSES.declaration(name, minor)


@pytest.mark.parametrize(
    ("span", "minors"),
    [("", "0123"), ("1.2", "2"), ("1.1-", "123"), ("-1.1", "01"), ("1.1-1.2", "12"), ("1.0", "0")],
)
def test_spans(span: str, minors: str) -> None:
    assert "".join(str(minor) for minor in range(4) if in_versions(span, minor)) == minors


def test_attributes_by_version() -> None:
    assert {name: a.required for name, a in declared("house", 0).attributes.items()} == {"name": True, "height": True}
    assert {name: a.required for name, a in declared("house", 2).attributes.items()} == {
        "name": True,
        "colour": False,
        "height": False,
    }
    assert declared("house", 1).attributes["colour"].kind == "colour"
    assert HOUSES.words_of("colour", 1) == {"red"}


def test_children_by_version() -> None:
    assert [declared("house", minor).content.tags() for minor in range(3)] == [
        ["door", "roof"],
        ["door", "window", "roof"],
        ["door", "window", "gap", "roof"],
    ]
    assert [declared("door", minor).content.tags() for minor in range(3)] == [
        ["handle"],
        ["handle", "hinge"],
        ["handle", "lock", "hinge"],
    ]
    assert declared("handle", 0).empty
    assert not declared("metal", 0).empty
    assert HOUSES.reachable(0) == {"house", "door", "handle", "roof"}
    assert HOUSES.versions_of("lock") == [2]
    assert HOUSES.versions_of("window", "radius") == [2]
    assert HOUSES.versions_of("house", "colour") == [1, 2]


@pytest.mark.parametrize("table", ["a\n    b c:d:e", "a\n    = b)", "a\n    = b?c"])
def test_a_table_that_is_not_in_the_notation_is_refused(table: str) -> None:
    grammar = Grammar("A", "a", (table,), {}, {}, range(1), _faults())
    with pytest.raises(ValueError, match="bad"):
        grammar.declaration("a", 0)


def found(text: str, minor: int, grammar: Grammar = HOUSES) -> list[tuple[str, str, str]]:
    sink = Diagnostics()
    document = parse_document(text.encode(), "made.xml", sink)
    assert document is not None
    findings = Findings(document, sink)
    check_elements(findings, grammar, minor)
    return [(one.code.id, one.message, one.hint) for one in sink]


HOUSE = '<house name="a" height="3"><door><handle/></door><roof/></house>'


def test_a_valid_file_has_no_finding() -> None:
    assert [found(HOUSE, minor) for minor in range(3)] == [[], [], []]
    assert found('<house name="a"><door><hinge>2</hinge><handle/></door></house>', 2) == []
    assert found(HOUSE.replace("<roof/>", '<window kind="round" radius="1"/><window size="2"/><roof/>'), 2) == []


def test_the_versions_that_have_an_element_are_named() -> None:
    text = HOUSE.replace("<roof/>", '<window size="2"/><roof/>')
    help_text = "it belongs to Houses 1.1, 1.2; the file's version is 1.0"
    assert found(text, 0) == [("SC701", "<window> is not allowed in <house>", help_text)]
    assert found(text, 0, STRICT) == [("SC708", "<window> is not allowed in <house>", help_text)]
    assert [one[0] for one in found('<house name="a"><door><handle/></door></house>', 0, STRICT)] == ["SC708", "SC708"]
    assert [one[0] for one in found('<house name="a"><door><handle/></door></house>', 0)] == ["SC703", "SC706"]


def test_versions_that_lack_nothing_are_named_if_all_children_are_known() -> None:
    text = '<house name="a" height="3"><door><handle/></door></house>'
    help_text = "these children are valid in Houses 1.1, 1.2; the file's version is 1.0"
    assert found(text, 0, STRICT) == [("SC708", "<house> lacks <roof>", help_text)]
    strange = found(text.replace("</house>", "<barn/></house>"), 0, STRICT)
    assert sorted(strange) == [
        ("SC701", "<barn> is not allowed in <house>", "known: door, roof"),
        ("SC706", "<house> lacks <roof>", ""),
    ]


def test_a_child_of_another_version_is_walked_along_that_version() -> None:
    outside = ("SC708", "<window> is not allowed in <house>")
    round_one = HOUSE.replace("<roof/>", '<window kind="round" radius="1"/><roof/>')
    assert [one[:2] for one in found(round_one, 0, STRICT)] == [outside], "1.2 takes it as it is"
    bare = HOUSE.replace("<roof/>", "<window/><roof/>")
    assert sorted(one[:2] for one in found(bare, 0, STRICT)) == [("SC703", "<window> lacks size"), outside]
    assert [one[0] for one in found(bare, 0)] == ["SC701"]


def test_order_and_number() -> None:
    turned = '<house name="a" height="3"><roof/><door><handle/></door></house>'
    assert found(turned, 1) == [
        ("SC710", "<roof> is in the wrong place in <house>", "the order is: door, window, roof")
    ]
    twice = HOUSE.replace("<roof/>", "<roof/><roof/>")
    assert found(twice, 1) == [("SC705", "<roof> occurs too often or too late in <house>", "")]
    assert found(HOUSE.replace("<handle/>", "<handle/><handle/>"), 2) == [
        ("SC705", "<handle> occurs too often or too late in <door>", "allowed here: lock, hinge")
    ]


def test_blanks_and_text() -> None:
    blank = HOUSE.replace("<handle/>", "<handle> </handle>")
    assert found(blank, 0) == []
    assert [one[0] for one in found(blank, 0, STRICT)] == ["SC711"]
    assert [one[0] for one in found(HOUSE.replace("<handle/>", "<handle>x</handle>"), 0, STRICT)] == ["SC707"]
    heavy = HOUSE.replace("<handle/>", "<handle/><hinge>heavy</hinge>").replace(' height="3"', "")
    assert [one[1] for one in found(heavy, 2)] == ["the text of <hinge> is 'heavy', not a number"]


@pytest.mark.parametrize("text", ["1", "-1.", "+.5e-3", "INF", "-INF", "NaN", "1e400"])
def test_numbers(text: str) -> None:
    assert is_number(text)


@pytest.mark.parametrize("text", ["", ".", "1,5", "inf", "nan", "+INF", "1e", "0x1", "1_0", "\u0661", "1 "])
def test_texts_that_are_not_numbers(text: str) -> None:
    assert not is_number(text)
    assert not is_integer(text)


def test_integers_within() -> None:
    assert [text for text in ("0", "-0", "+7", "65535", "00065535") if is_integer_within(text, 0, 65535)] == [
        *("0", "-0", "+7", "65535", "00065535"),
    ]
    assert not any(is_integer_within(text, 0, 65535) for text in ("-1", "65536", "1.0", "", "9" * 5000))
    assert is_integer_within("-2147483648", -(2**31), 2**31 - 1)


@pytest.mark.parametrize(
    "text",
    [
        *("2020-02-29T23:59:59", "2000-02-29T00:00:00Z", "2020-01-01T24:00:00", "2020-01-01T00:00:00.5+01:00"),
        *("-0001-01-01T00:00:00", "12020-01-01T00:00:00", "2020-01-01T00:00:00+14:00"),
    ],
)
def test_dates(text: str) -> None:
    assert is_date_time(text)


@pytest.mark.parametrize(
    "text",
    [
        *("", "2020-01-01", "2021-02-29T00:00:00", "1900-02-29T00:00:00", "2020-13-01T00:00:00", "2020-00-01T00:00:00"),
        *("2020-01-00T00:00:00", "2020-01-01T24:00:01", "2020-01-01T25:00:00", "2020-01-01T00:60:00"),
        *("20-01-01T00:00:00", "2020-01-01T00:00:60", "2020-01-01T00:00:00+15:00", "2020-01-01T00:00:00."),
        *("0000-01-01T00:00:00", "2020-1-1T0:0:0", "012020-01-01T00:00:00", "2020-01-01T00:00:00z"),
    ],
)
def test_texts_that_are_not_dates(text: str) -> None:
    assert not is_date_time(text)


@pytest.mark.parametrize(
    ("text", "inside", "outside", "described"),
    [
        ("[0,inf)", (0.0, 1e300, float("inf")), (-1e-9, float("-inf")), "at least 0"),
        ("(0,inf)", (1e-300,), (0.0, -1.0), "more than 0"),
        ("[-pi,pi]", (-3.1415, 3.1415), (3.1416, 45.0), "at least -pi and at most pi"),
        ("[0,2pi)", (0.0, 6.28), (6.2831853072,), "at least 0 and less than 2pi"),
    ],
)
def test_a_range_contains_its_limits_by_its_brackets(
    text: str, inside: tuple[float, ...], outside: tuple[float, ...], described: str
) -> None:
    numbers = Range(text)
    assert all(numbers.contains(one) for one in inside)
    assert not any(numbers.contains(one) for one in outside)
    assert numbers.described == described
