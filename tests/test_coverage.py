"""Every word names the code that executes it, and the code exists."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from scenario_compiler.coverage import TABLES, table_of
from scenario_compiler.coverage.conflict import EXECUTION, conflict_table, conflict_words
from scenario_compiler.coverage.uses import files_with
from scenario_compiler.engine.columns import opcodes
from scenario_compiler.engine.moves.table import NUMBERS as ACTION_NUMBERS
from scenario_compiler.engine.story.table import NUMBERS as CONDITION_NUMBERS
from scenario_compiler.openscenario.structure.elements import elements
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.vocabulary.actions import Action
from scenario_compiler.vocabulary.conditions import Condition
from scenario_compiler.vocabulary.word import Word

WORDS = conflict_words()


def test_every_word_names_the_code_that_executes_it() -> None:
    assert set(WORDS) <= set(EXECUTION)


@pytest.mark.parametrize("word", EXECUTION, ids=lambda word: word.__name__)
def test_the_code_that_executes_a_word_exists(repository: Path, word: type[Word]) -> None:
    execution = EXECUTION[word]
    home = repository.joinpath("scenario_compiler", *execution.module.split("."))
    assert home.is_dir() or home.with_suffix(".py").is_file()
    sources = (repository / "scenario_compiler" / "engine").rglob("*.py")
    engine = "".join(file.read_text(encoding="utf-8") for file in sources)
    for code in execution.opcodes:
        assert hasattr(opcodes, code)
        assert f"op.{code}" in engine


def test_every_entry_of_the_engine_belongs_to_a_word_of_the_language() -> None:
    known = {word.tag() for word in WORDS}
    assert {word.tag() for word in get_args(Action)} <= set(ACTION_NUMBERS) <= known
    assert {word.tag() for word in get_args(Condition)} <= set(CONDITION_NUMBERS) <= known


def test_every_word_is_used_by_the_library_or_a_test(repository: Path) -> None:
    files = [file for folder in ("library", "tests") for file in (repository / folder).rglob("*.xml")]
    uses = files_with(files, (LibraryElement, CatalogElement))
    assert [word.__name__ for word in WORDS if not uses[word]] == []


def test_exported_elements_belong_to_the_standard() -> None:
    known = {tag for element in elements().values() for tag in element.tags}
    for row in conflict_table().records():
        for tag in re.findall(r"<(\w+)>", row["exported"]):
            assert tag in known, (row["word"], tag)


def test_a_table_has_a_text_in_every_cell() -> None:
    table = conflict_table()
    assert len(table.rows) == len(WORDS)
    assert all(len(row) == len(table.columns) for row in table.rows)
    assert all(cell for row in table.rows for cell in row[2:])


@pytest.mark.parametrize("language", TABLES)
def test_a_language_is_found_by_its_name(language: str) -> None:
    assert table_of(language).language == language


def test_the_command_prints_json_and_loads_little(repository: Path) -> None:
    program = (
        "import sys; from scenario_compiler.cli import make_parser\n"
        "options = make_parser().parse_args(['coverage', 'conflict', '--format', 'json'])\n"
        "options.command(options)\n"
        "heavy = {'numpy', 'matplotlib', 'rich', 'cv2', 'scipy'}\n"
        "print(*sorted(heavy & set(sys.modules)), file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=repository)
    rows = json.loads(done.stdout)["conflict"]
    assert next(row for row in rows if row["word"] == "<lane_change>")["executed"] == (
        "engine: engine.moves.lane_changes"
    )
    assert done.stderr.strip() == ""
