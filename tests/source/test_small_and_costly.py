"""Small files whose expansion would be huge: each is checked with little work and a short output."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.validation import validate_file
from tests.work import counted

MOST_LINES = 40_000_000
"""Lines of Python that may be run for one file: 14 million for the costliest."""

EGO = '<ego speed="12"><start><spawn_point name="main_street"/></start></ego>'
CAR = '<static id="s{0}"><at><ahead_of entity="{1}" distance="30"/></at></static>'


def _file(items: str, *, before: str = "", templates: str = "") -> str:
    head = f'<scenarios version="1">{templates}<scenario name="a" map="town_grid" duration="5">'
    return f"{head}{before}{EGO}{items}</scenario></scenarios>"


def _nested_templates() -> str:
    """Return templates each of which uses the next ten times."""
    uses = "".join(
        f'<template name="t{i}"><repeat count="10"><use template="t{i + 1}"/></repeat></template>' for i in range(12)
    )
    return uses + f'<template name="t12">{CAR.format("", "ego")}</template>'


def _nested_ifs() -> str:
    """Return branches each of which holds the next, behind many items that are read again with each."""
    tests = "".join(f'<if test="${{$p{i} > 0}}">' for i in range(60))
    return f'<repeat count="1000">{CAR.format("", "ego")}</repeat>{tests}{CAR.format("", "ego")}{"</if>" * 60}'


def _doubling(kind: str, value: str) -> str:
    """Return templates each of which gives the next twice what it is given."""
    parameter = f'<parameter name="n" type="{kind}"/>'
    templates = "".join(
        f'<template name="t{i}">{parameter}<use template="t{i + 1}" n="${{$n + $n}}"/></template>' for i in range(40)
    )
    last = f'<template name="t40">{parameter}{CAR.format("", "ego")}</template>'
    head = f'<scenarios version="1">{templates}{last}<scenario name="a" map="town_grid" duration="5">'
    use = f'<use template="t0" n="{value}"/>'
    return f'{head}<parameter name="q" type="length" default="1"/>{EGO}{use}</scenario></scenarios>'


def _chain(length: int) -> str:
    """Return templates each of which uses the next."""
    uses = "".join(f'<template name="t{i}"><use template="t{i + 1}"/></template>' for i in range(length))
    return uses + f'<template name="t{length}">{CAR.format("", "ego")}</template>'


FILES = {
    "expressions that double": (_doubling("length", "$q"), 2),
    "texts that double": (_doubling("text", "a" * 2048), 2),
    "a long chain of templates": (_file('<use template="t0"/>', templates=_chain(2000)), 1),
    "nested loops": (_file(f'<repeat count="1000"><repeat count="1000">{CAR.format("", "ego")}</repeat></repeat>'), 1),
    "loops around nothing": (_file('<repeat count="1000"><repeat count="1000"/></repeat>'), 0),
    "templates of templates": (_file('<use template="t0"/>', templates=_nested_templates()), 1),
    "many uses of one template": (
        _file('<use template="t" x="1"/>' * 2000, templates=f'<template name="t">{CAR.format("", "ego")}</template>'),
        2000,
    ),
    "branches in branches": (
        _file(_nested_ifs(), before="".join(f'<parameter name="p{i}" type="length" default="1"/>' for i in range(60))),
        1000,
    ),
    "many names that nobody has": (_file("".join(CAR.format(i, f"x{i}") for i in range(3000))), 3000),
    "a long line with many faults": (_file('<static id="s" at=""/>' * 3000), 6000),
}
"""Files, and how many findings each has, of one kind or two, of which 100 are kept and the rest is counted."""


SLOW = {
    name: pytest.mark.slow
    for name in (
        "templates of templates",
        "a long chain of templates",
        "nested loops",
        "many names that nobody has",
    )
}
"""Files that take long to count; loops around nothing, branches and many uses of a template reach the same bounds."""


def _told(file: Path, sink: Diagnostics) -> int:
    """Return the length of what is said of a file."""
    validate_file(file, sink)
    return sum(len(as_text(one)) for one in sink)


@pytest.mark.parametrize("name", [pytest.param(name, marks=SLOW.get(name, ())) for name in FILES])
def test_it_is_checked_with_little_work(tmp_path: Path, name: str) -> None:
    text, findings = FILES[name]
    file = tmp_path / "costly.xml"
    file.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    told, lines = counted(lambda: _told(file, sink))
    kept = len(list(sink))
    assert lines < MOST_LINES
    assert sink.reported == findings
    assert kept == min(findings, 202 if findings == 6000 else 101)
    assert told < 20_000 + 1000 * kept


def test_a_template_that_is_large_on_its_own_is_not_a_fault(tmp_path: Path) -> None:
    """It is looked at in part only, and so nothing is said of what it names beyond that."""
    file = tmp_path / "large.xml"
    row = f'<repeat count="900" id="row">{CAR.format("a", "ego")}{CAR.format("b", "ego")}</repeat>'
    last = CAR.format("c", "row.900.sb")
    file.write_text(f'<scenarios version="1"><template name="t">{row}{last}</template></scenarios>', encoding="utf-8")
    sink = Diagnostics()
    validate_file(file, sink)
    assert list(sink) == []
