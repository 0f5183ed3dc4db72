"""The contents of <if>, <repeat> and <for>: which of them are inserted, how often, and with which ids."""

from __future__ import annotations

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.languages import check_source, expand
from scenario_compiler.vocabulary.entities import Static
from scenario_compiler.vocabulary.positions import RelativeLanePosition
from tests.source.made import codes_of, expanded, library_text, parsed

LANES = '<parameter name="lanes" type="integer" default="2" min="0" max="9"/>'


def _static(name: str, distance: str = "50", of: str = "ego") -> str:
    return f'<static id="{name}"><at><ahead_of entity="{of}" distance="{distance}"/></at></static>'


def _ids(text: str, **arguments: str) -> list[str]:
    return [actor.id for actor in expanded(text, **arguments).actors]


def _distances(text: str, **arguments: str) -> list[object]:
    found: list[object] = []
    for actor in expanded(text, **arguments).actors:
        assert isinstance(actor, Static)
        assert isinstance(actor.at, RelativeLanePosition)
        found.append(actor.at.distance)
    return found


def test_the_test_decides_which_branch_is_inserted() -> None:
    branches = f'<if test="${{$lanes >= 2}}">{_static("wide")}<else>{_static("narrow")}</else></if>'
    text = library_text(branches, parameters=LANES)
    assert _ids(text) == ["wide"]
    assert _ids(text, lanes="1") == ["narrow"]


def test_a_branch_that_is_not_taken_need_not_have_values() -> None:
    branches = f'<if test="${{$lanes != 0}}">{_static("far", "${100 / $lanes}")}<else>{_static("far", "0")}</else></if>'
    text = library_text(branches, parameters=LANES)
    assert _distances(text, lanes="0") == [0.0]
    assert _distances(text) == [50.0]


def test_faults_that_do_not_depend_on_values_are_reported_in_untaken_branches() -> None:
    wrong = '<static id="a"><at><ahead_of entity="ego" distnce="1"/></at></static>'
    nested = f'<if test="false"><repeat count="2" as="k">{_static("a", "$k")}{_static("b", "$q")}</repeat></if>'
    assert codes_of(library_text(f'<if test="false">{wrong}</if>')) == ["SC107", "SC106"]
    assert codes_of(library_text(nested)) == ["SC210"]


def test_ids_in_a_branch_are_those_of_its_surroundings() -> None:
    text = library_text(f'<if test="true">{_static("a")}</if>{_static("b", "9", "a")}')
    assert _ids(text) == ["a", "b"]


def test_each_round_has_its_number_and_ids_of_its_own() -> None:
    inside = _static("a", "${10 + 5 * $k}") + _static("b", "3", "a")
    text = library_text(f'<repeat count="3" as="k" id="queue">{inside}</repeat>' + _static("c", "1", "queue.2.b"))
    assert _ids(text) == ["queue.1.a", "queue.1.b", "queue.2.a", "queue.2.b", "queue.3.a", "queue.3.b", "c"]
    assert _distances(text) == [10.0, 3.0, 15.0, 3.0, 20.0, 3.0, 1.0]
    actors = expanded(text).actors
    assert isinstance(actors[3], Static)
    assert isinstance(actors[3].at, RelativeLanePosition)
    assert actors[3].at.entity == "queue.2.a"


def test_numbers_in_a_round_stay_open() -> None:
    gap = '<parameter name="gap" type="length" default="7"/>'
    first, second = _distances(
        library_text(f'<repeat count="2">{_static("a", "${$gap * $index}")}</repeat>', parameters=gap)
    )
    assert str(getattr(second, "text", "")) == "($gap * 1)"
    assert str(getattr(first, "text", "")) == "($gap * 0)"


def test_a_count_of_nothing_brings_nothing() -> None:
    assert _ids(library_text(f'<repeat count="$lanes">{_static("a")}</repeat>', parameters=LANES), lanes="0") == []


def test_a_loop_goes_over_numbers_and_names() -> None:
    text = library_text(f'<for each="far" in="30 40.5">{_static("a", "$far")}</for>')
    assert _distances(text) == [30.0, 40.5]
    named = '<static id="a" model="$kind"><at><ahead_of entity="ego" distance="40"/></at></static>'
    names = library_text(f'<for each="kind" in="vehicle.audi.a2 vehicle.audi.tt">{named}</for>')
    assert [actor.model for actor in expanded(names).actors] == ["vehicle.audi.a2", "vehicle.audi.tt"]


def test_loops_without_an_id_are_numbered() -> None:
    loop = f'<repeat count="1">{_static("a")}</repeat>'
    assert _ids(library_text(loop + loop)) == ["repeat1.1.a", "repeat2.1.a"]


def test_loops_hold_loops_and_uses() -> None:
    template = f'<template name="one">{_static("a")}</template>'
    inner = '<if test="${$i != $j}"><use template="one"/></if>'
    text = library_text(
        f'<repeat count="2" as="i" id="x"><repeat count="2" as="j" id="y">{inner}</repeat></repeat>', head=template
    )
    assert _ids(text) == ["x.1.y.2.one1.a", "x.2.y.1.one1.a"]


@pytest.mark.parametrize(
    ("items", "codes"),
    [
        ('<repeat count="-1"/>', ["SC112"]),
        ('<repeat count="1001"/>', ["SC112"]),
        ('<repeat count="1.5"/>', ["SC111"]),
        ('<if test="$lanes"/>', ["SC111"]),
        ('<if test="${$lanes > }"/>', ["SC113"]),
        ('<for each="k" in=""/>', ["SC111"]),
        ('<for each="2k" in="1"/>', ["SC111"]),
        ('<else/>', ["SC105"]),
        ('<repeat count="2" id="a"/><repeat count="2" id="a"/>', ["SC216"]),
    ],
)  # fmt: skip
def test_faulty_loops_are_reported(items: str, codes: list[str]) -> None:
    assert codes_of(library_text(items, parameters=LANES)) == codes


def test_a_hostile_loop_is_one_finding() -> None:
    bomb = f'<repeat count="1000"><repeat count="1000"><repeat count="1000">{_static("a")}</repeat></repeat></repeat>'
    sink = Diagnostics()
    assert expand(parsed(library_text(bomb), sink), None, {}, sink) is None
    assert [one.code.id for one in sink] == ["SC223"]


def test_a_template_is_read_although_its_test_is_open() -> None:
    head = (
        '<template name="t"><parameter name="n" type="integer"/><repeat count="$n"><static id="a" modl="x"/></repeat>'
        f'<if test="${{$n > 1}}">{_static("b")}</if>{_static("c", "1", "b")}</template>'
    )
    sink = Diagnostics()
    check_source(parsed(library_text(head=head), sink), sink)
    assert {one.code.id for one in sink} == {"SC106", "SC108"}


def test_a_fault_in_a_round_names_the_use_that_brought_it_in() -> None:
    head = '<template name="t">\n<repeat count="3"><static id="a"/></repeat>\n</template>'
    sink = Diagnostics()
    expand(parsed(library_text('\n\n<use template="t"/>', head=head), sink), None, {}, sink)
    (one,) = sink
    assert (one.place.line, [use.line for use in one.chain()]) == (2, [5])
