"""Laws for every file: completion offers what its author wrote, and renaming changes no finding."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.editor.analysis import Analysis
from scenario_compiler.editor.completion import offers
from scenario_compiler.editor.draft import Draft
from scenario_compiler.editor.findings import Finding, carried_over, findings, while_written
from scenario_compiler.editor.hover import explained
from scenario_compiler.editor.known import KNOWN
from scenario_compiler.editor.naming import renaming, uses_of
from scenario_compiler.editor.outline import outline
from scenario_compiler.editor.words import ROOTS, meanings
from scenario_compiler.resources import library_folder
from scenario_compiler.validation import validate_file
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.schema import words_below
from tests.editor.recording import analysed, laid_out, renamed, split_cursor

HERE = Path(__file__).resolve().parent
CASES = HERE.parent / "cases"
WORDS = HERE.parent / "source"
LIBRARY = sorted(library_folder().glob("*/*.xml"))
SOME = [one for one in LIBRARY if one.stem in ("obstacle_variants", "cut_out", "work_zone_taper", "drivers")]
EVERY = [WORDS / "every_word.xml", WORDS / "every_entry.xml", *SOME]
MANY = {"obstacle_variants": pytest.mark.slow}
"""Files with many elements, all of whose words are in every_word.xml too."""


def everything_asked(text: str, offset: int) -> int:
    """Ask everything of a text at an offset; return the number of completions."""
    analysis = analysed(text, HERE / "draft.xml")
    offered = offers(analysis, offset)
    for one in offered:
        assert 0 <= one.start <= offset <= max(offset, one.end) <= len(text)
    explained(analysis, offset)
    mention = analysis.mention_at(offset)
    if mention is not None:
        assert 0 <= mention.start <= mention.end <= len(text)
        assert any(True for _ in uses_of(mention.symbol, [analysis]))
    outline(analysis)
    return len(offered)


def short(path: Path) -> str:
    """Return the first scenario or template of a file alone, so that character by character takes little time."""
    text = path.read_text(encoding="utf-8")
    end = re.search(r"</(scenario|template)>", text)
    return text if end is None else text[: end.end()] + "\n</scenarios>\n"


@pytest.mark.parametrize("path", SOME, ids=lambda path: path.stem)
def test_a_file_can_be_written_character_by_character(path: Path) -> None:
    text = short(path)
    assert sum(everything_asked(text[:end], end) for end in range(0, len(text) + 1, 7)) > 100


@pytest.mark.slow
@pytest.mark.parametrize("path", [*sorted(CASES.glob("SC*.xml")), *EVERY], ids=lambda path: path.stem)
def test_every_faulty_file_can_be_written_character_by_character(path: Path) -> None:
    text = path.read_bytes().decode("utf-8", "replace")
    step = 1 + len(text) // 3000
    for end in range(0, len(text) + 1, step):
        everything_asked(text[:end], end)


TEXT = short(SOME[-1])


@given(st.data())
def test_requests_about_damaged_text_are_safe(data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(TEXT)))
    gone = data.draw(st.integers(0, 40))
    put = data.draw(st.text(st.sampled_from("<>/=\"'$%{}&;! \n\tabegou1-]\U0001f697\x00"), max_size=8))
    text = TEXT[:at] + put + TEXT[at + gone :]
    everything_asked(text, data.draw(st.integers(0, len(text))))
    laid_out(text)


@pytest.mark.parametrize("written", ["\nspacing", "sp&#97;cing"])
def test_a_name_is_found_however_it_is_written(written: str) -> None:
    text = TEXT.replace('name="spacing"', f'name="{written}"')
    analysis = analysed(text, HERE / "draft.xml")
    mention = analysis.mention_at(text.index(written))
    assert mention is not None
    assert mention in [one.mention for one in uses_of(mention.symbol, [analysis])]


@given(st.data())
def test_findings_in_damaged_text_have_a_place_in_it(data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(TEXT)))
    text = TEXT[:at] + data.draw(st.sampled_from(["<", '"', "&", ">", "<a>", "${", "\x00"])) + TEXT[at:]
    for one in findings(str(HERE / "draft.xml"), Draft(text)):
        assert 0 <= one.start <= one.end <= len(text)
        assert one.code != "SC117", one.message


@pytest.mark.parametrize(
    "path", [pytest.param(one, marks=MANY.get(one.stem, ())) for one in EVERY], ids=lambda path: path.stem
)
def test_completion_offers_what_the_author_wrote(path: Path) -> None:
    analysis = Analysis(str(path), path.read_text(encoding="utf-8"))
    text, root = analysis.draft.text, analysis.draft.root
    assert root is not None
    missing = []
    for tag, meaning in meanings(root):
        if tag.parent is not None and tag.parent.parent is not None:
            without = text[: tag.start] + "<" + text[max(tag.end, tag.head_end) :]
            if tag.name not in {one.label for one in offers(Analysis(str(path), without), tag.start + 1)}:
                missing.append(f"<{tag.name}> at {tag.start}")
        for one in tag.attributes:
            if ":" in one.name or one.name.startswith("xmlns"):
                continue
            without = text[: one.start] + text[one.value_end + 1 :]
            if one.name not in {offer.label for offer in offers(Analysis(str(path), without), one.start)}:
                missing.append(f"{one.name} of <{tag.name}>")
            rule = meaning.attributes.get(one.name)
            value = analysis.draft.meant(one)
            if rule is None or "$" in value or not (rule.spelling.names or rule.choices) or not value.split():
                continue
            last = value.split()[-1] if rule.spelling.separated else value
            offered = {offer.label for offer in offers(analysis, one.value_end)}
            own = rule.spelling.names in ("scheme", "situation")
            if last not in offered and not own and not re.search(r"[/:]", last) and offered:
                missing.append(f"{one.name}={last!r} of <{tag.name}>")
    assert missing == []


AT_FAULT_IF_OFFERED = {"SC102", "SC105", "SC106", "SC109", "SC110", "SC116"}
"""Codes of elements and attributes that have no place where they stand."""


def filled(insert: str) -> str:
    """Return what a completion writes with something at the places to fill in."""
    return re.sub(r"\\([$}\\])", r"\1", re.sub(r"(?<!\\)[$]\d", "", insert))


@pytest.mark.parametrize(
    "name", ["element_in_a_scenario", "element_before_the_ego", "element_in_a_wrapper", "attribute_of_a_use", "catalog"]
)
def test_every_completion_is_allowed_at_its_place(name: str) -> None:
    text, offset = split_cursor((HERE / "cases" / f"{name}.case").read_text(encoding="utf-8").partition("\n--- ")[0])
    offered = offers(analysed(text, HERE / "draft.xml"), offset)
    assert offered
    for one in offered:
        written = text[: one.start] + filled(one.insert) + text[one.end :]
        codes = {found.code for found in findings(str(HERE / "draft.xml"), Draft(written))}
        assert not codes & AT_FAULT_IF_OFFERED, (one.label, written)


def own_names(path: Path) -> Iterator[tuple[Analysis, int]]:
    """Yield the analysis of a file, and the offset of each name that is given in it."""
    analysis = Analysis(str(path), path.read_text(encoding="utf-8"))
    for mention in analysis.mentions:
        if mention.declares and mention.symbol.kind != "driver":
            yield analysis, mention.start


@pytest.mark.parametrize("name", ["obstacle_variants", "work_zone_taper", "cut_out", "ramp_variants", "in_traffic"])
def test_a_new_name_changes_no_finding(name: str, tmp_path: Path) -> None:
    path = next(one for one in LIBRARY if one.stem == name)
    before = counted(path)
    copy = tmp_path / path.name
    for analysis, offset in own_names(path):
        mention = analysis.mention_at(offset)
        assert mention is not None
        uses = renaming(mention.symbol, "renamed_for_a_test", [analysis])
        stretches = [(one.mention.start, one.mention.end) for one in uses]
        copy.write_text(renamed(analysis.draft.text, stretches, "renamed_for_a_test"), encoding="utf-8")
        assert counted(copy) == before, mention.symbol


def counted(path: Path) -> Counter[str]:
    """Return the codes of what is found in a file."""
    sink = Diagnostics()
    validate_file(path, sink)
    return Counter(one.code.id for one in sink)


@pytest.mark.parametrize("path", sorted(CASES.glob("SC[1-5]*.xml")), ids=lambda path: path.stem)
def test_findings_are_those_of_validate(path: Path) -> None:
    sink = Diagnostics()
    validate_file(path, sink)
    draft = Draft(path.read_bytes().decode("utf-8", "replace"))
    expected = sorted((one.place.line, one.place.column, one.code.id) for one in sink if one.place.column)
    found = [(draft.line_of(one.start) + 1, one.start, one.code) for one in findings(str(path), draft)]
    there = sorted((line, start - draft.line_starts[line - 1] + 1, code) for line, start, code in found)
    assert [one for one in expected if one not in there] == []
    assert len(there) == len(list(sink))


def test_an_unfinished_text_keeps_the_findings_of_its_other_parts() -> None:
    first, second, third = (Finding(start, start + 3, f"SC20{start}", Severity.WARNING, "") for start in (2, 9, 20))
    old, new = "x" * 8 + "old" + "y" * 20, "x" * 8 + "newer" + "y" * 20
    assert [one.start for one in carried_over([first, second, third], old, new)] == [2, 22]
    broken = Finding(0, 1, "SC102", Severity.WARNING, "")
    assert while_written([broken], [first, broken]) == [broken, first]
    assert while_written([second], [first]) == [second]


def test_a_study_and_a_questionnaire_are_completed_explained_and_checked(tmp_path: Path) -> None:
    text = (
        '<study version="1" name="it" participants="2">\n  <scenario name="a" target="obstacle_ahead"/>\n  <\n</study>'
    )
    analysis = Analysis(str(tmp_path / "study.xml"), text)
    assert {"hmi", "setting", "probe"} <= {one.label for one in offers(analysis, text.index("<\n") + 1)}
    shown = explained(analysis, text.index("participants") + 2)
    assert shown is not None
    assert "Number of participants" in shown.text
    asked = '<questionnaire version="1" name="it"><item name="a" text="b" scale="c"/></questionnaire>'
    found = findings(str(tmp_path / "asked.xml"), Draft(asked))
    assert [(one.code, asked[one.start : one.end]) for one in found] == [("SC261", "c")]


def test_everything_that_can_be_named_is_known() -> None:
    rules = [rule for word in words_below(ROOTS.values()) for rule in grammar_of(word).attributes.values()]
    assert {rule.spelling.names for rule in rules if rule.spelling.names} == set(KNOWN)


def test_the_text_of_an_element_is_not_laid_out_whether_it_is_quoted_or_not() -> None:
    for text in ("<a>\n<b>\n x\n</b>\n</a>", "<a>\n<b>\n<![CDATA[ x\n<y>]]>\n</b>\n</a>"):
        assert laid_out(text) == text.replace("<b>", "  <b>")


@pytest.mark.parametrize("path", LIBRARY, ids=lambda path: path.stem)
def test_the_library_is_laid_out(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert laid_out(text) == text
