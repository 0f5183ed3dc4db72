"""The server's answers agree with the recorded ones: completions, explanations, findings and changes.

A case is a file in tests/editor/cases: the text with `|` where the cursor is, then parts that begin with `--- REQUEST`,
each with the answer. `pytest --update` writes the answers again.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.editor.recording import ANSWERS, analysed, split_cursor

FOLDER = Path(__file__).with_name("cases")
CASES = sorted(FOLDER.glob("*.case"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_answers_are_those_recorded(path: Path, request: pytest.FixtureRequest) -> None:
    recorded = path.read_text(encoding="utf-8")
    written, *parts = recorded.split("\n--- ")
    text, offset = split_cursor(written)
    assert parts, "a case asks for something"
    answers = []
    for part in parts:
        asked = part.partition("\n")[0]
        kind, _, argument = asked.partition(" ")
        answer = "\n".join(ANSWERS[kind](analysed(text, FOLDER / "draft.xml"), offset, argument))
        answers.append(f"{asked}\n{answer}" if answer else asked)
    new = "\n--- ".join([written, *answers]).rstrip("\n") + "\n"
    if request.config.getoption("--update"):
        path.write_text(new, encoding="utf-8")
    assert new == recorded, "pytest --update records the answers again; look at what has changed"


def test_every_request_has_cases() -> None:
    asked = {
        part.partition("\n")[0].partition(" ")[0]
        for path in CASES
        for part in path.read_text(encoding="utf-8").split("\n--- ")[1:]
    }
    assert asked == set(ANSWERS)
