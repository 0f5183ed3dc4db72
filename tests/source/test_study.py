"""Files of studies and questionnaires: their contents, their conditions, and an example of every word."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.compiler import Overrides, read_source
from scenario_compiler.diagnostics import Diagnostics, FilePlace
from scenario_compiler.source.form import study_xsd
from scenario_compiler.source.study import STUDIES, conditions_of, located, square_rows
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.source.study_page import read_page
from scenario_compiler.study_plans import compile_study
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.schema import words_below
from scenario_compiler.vocabulary.takeover import Message, Say

FILES = Path(__file__).parent / "study"


def read(path: Path) -> StudyFile:
    sink = Diagnostics()
    found = read_source(path, sink)
    assert found is not None
    assert not sink.found
    assert isinstance(found[1], StudyFile)
    return found[1]


def test_a_study_brings_its_pages_and_questionnaires() -> None:
    found = read(FILES / "every_word.xml")
    assert found.study is not None
    assert found.study.participants == 8
    assert set(found.pages) == {"consent.md", "welcome.md"}
    assert found.questionnaires["questionnaire.xml"].scores[0].of == ("hard", "calm")
    assert read(FILES / "questionnaire.xml").questionnaire == found.questionnaires["questionnaire.xml"]


def page(folder: Path, text: str) -> tuple[str | None, list[tuple[str, int, str]]]:
    """Return a page as HTML, and what is wrong with it: file, line, words."""
    (folder / "page.md").write_text(text, encoding="utf-8")
    sink = Diagnostics()
    found = read_page("page.md", folder, FilePlace("study.xml", 3), sink)
    return found, [(Path(one.place.file).name, one.place.line, one.message) for one in sink]


def test_pictures_become_part_of_their_page(tmp_path: Path) -> None:
    (tmp_path / "the car.png").write_bytes(b"\x89PNG")
    found, wrong = page(tmp_path, "# Welcome\n\nThis is ![the car](<the car.png>).\n")
    assert wrong == []
    assert found is not None
    assert '<img src="data:image/png;base64,iVBORw==" alt="the car"' in found


def test_tables_of_a_page_are_tables(tmp_path: Path) -> None:
    (tmp_path / "key.png").write_bytes(b"\x89PNG")
    found, wrong = page(tmp_path, "| Key | Picture |\n|---|---|\n| Enter | ![it](key.png) |\n| H | ![it](gone.png) |\n")
    assert wrong == [("page.md", 4, "the picture 'gone.png' cannot be read: No such file or directory")]
    assert found is not None
    assert "<th>Key</th>" in found
    assert '<td><img src="data:image/png' in found


def test_pages_that_participants_would_not_see_as_intended_are_reported(tmp_path: Path) -> None:
    text = "# Hi\n\n![a](gone.png)\n\n![b](https://example.org/b.png) ![c](notes.txt)\n\n<script>alert(1)</script>\n"
    found, wrong = page(tmp_path, text)
    assert wrong == [
        ("page.md", 3, "the picture 'gone.png' cannot be read: No such file or directory"),
        ("page.md", 5, "'https://example.org/b.png' is not a file beside the page; pages are shown without a network"),
        ("page.md", 5, "'notes.txt' is not a picture in one of the formats .png, .jpg, .jpeg, .gif, .webp, .svg"),
    ]
    assert "<script>" not in (found or "")
    assert page(tmp_path, " \n") == (None, [("study.xml", 3, "'page.md' is empty")])


def test_comments_of_a_page_are_not_shown_and_other_html_is_text(tmp_path: Path) -> None:
    text = "<!-- consent.md\n-->\n# Hi <!-- a --> you\n\n<b>No</b>\n\n<div>5 > 3</div>\n\n    <!-- code -->\n"
    found, wrong = page(tmp_path, text)
    assert wrong == []
    assert found == (
        "<h1>Hi  you</h1>\n<p>&lt;b&gt;No&lt;/b&gt;</p>\n<p>&lt;div&gt;5 &gt; 3&lt;/div&gt;</p>\n"
        "<pre><code>&lt;!-- code --&gt;\n</code></pre>\n"
    )


def test_conditions_are_all_combinations_of_the_factors() -> None:
    study = read(FILES / "every_word.xml").study
    assert study is not None
    names = [one.name for one in conditions_of(study)]
    assert names[:3] == ["blocked-tone-near", "blocked-tone-far", "blocked-speech-near"]
    assert len(set(names)) == 8
    assert conditions_of(study)[0].levels == {"scenario": "blocked", "hmi": "tone", "setting": "near"}
    alone = study.model_copy(update={"hmis": (), "settings": ()})
    assert [(one.name, one.levels) for one in conditions_of(alone)] == [
        ("blocked", {"scenario": "blocked"}),
        ("narrow", {"scenario": "narrow"}),
    ]


@pytest.mark.parametrize(("conditions", "rows"), [(1, 1), (2, 2), (3, 6), (4, 4), (5, 10)])
def test_rows_of_a_balanced_square(conditions: int, rows: int) -> None:
    assert square_rows(conditions) == rows


def test_a_condition_compiles_with_its_messages_and_parameters() -> None:
    sink = Diagnostics()
    done = compile_study(read(FILES / "every_word.xml"), sink, overrides=Overrides(perception="ideal"))
    assert done is not None
    assert list(done.others) == ["obstacle_ahead", "markings_missing"]
    _, near = done.conditions["blocked-tone-near"]
    _, far = done.conditions["blocked-speech-far"]
    assert [one.modality for one in near.plan.takeover.messages] == [("tone",)]
    assert [one.modality for one in far.plan.takeover.messages] == [("text", "speech")]
    assert near.plan.digest != far.plan.digest
    assert [one.default for one in near.scenario.parameters if one.name == "distance"] == ["120"]


def test_a_bare_name_is_that_of_a_conflict_of_the_library(tmp_path: Path) -> None:
    assert located("obstacle_ahead", tmp_path).endswith("conflicts/obstacle_ahead.xml#obstacle_ahead")
    assert located("own.xml#it", tmp_path) == f"{tmp_path}/own.xml#it"
    assert located("nowhere", tmp_path) == f"{tmp_path}/nowhere#nowhere"


def test_every_word_and_attribute_is_shown_by_an_example() -> None:
    used: dict[str, set[str]] = {}
    for name in ("every_word.xml", "questionnaire.xml"):
        for element in etree.parse(FILES / name).iter(etree.Element):
            used.setdefault(str(element.tag), set()).update(map(str, element.attrib))
    elsewhere = {Message, Say}  # every attribute of theirs stands in the conflict language's files
    words = [word for word in words_below(STUDIES) if word not in elsewhere]
    missing = {word.tag(): set(grammar_of(word).attributes) - used.get(word.tag(), set()) for word in words}
    assert {tag: names for tag, names in missing.items() if names} == {}


def test_the_schema_accepts_what_the_reader_accepts() -> None:
    schema = etree.XMLSchema(etree.fromstring(study_xsd().encode()))
    for name in ("every_word.xml", "questionnaire.xml"):
        schema.assertValid(etree.parse(FILES / name))
