"""A file with one fault gives findings on its line, and none anywhere else."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.resources import library_folder
from scenario_compiler.validation import validate_file, validate_files

HERE = Path(__file__).resolve().parent
CONFLICTS = sorted((library_folder() / "conflicts").glob("*.xml"))
FILES = [
    *(path for path in CONFLICTS if path.read_text(encoding="utf-8").count("</scenario>") == 1),
    HERE / "every_word.xml",
]

FREE = {"text", "summary", "source", "scheme", "situation", "urgency", "response", "predictability", "criticality"}
"""Attributes that hold any text."""

ELSEWHERE = {
    ("template", "default"),
    ("scenario", "name"),
    ("use", "road"),
    ("driver_model", "name"),
    ("driver_model", ""),
}
"""Element and attribute whose wrong value is right in itself: what depends on it is wrong, or nothing is."""


EVERY = [12, pytest.param(1, marks=pytest.mark.slow)]
"""Which of the faults are tried: every twelfth, and all."""


@dataclass(frozen=True)
class Mutant:
    """A file with one fault: what was changed, the text, and the line."""

    name: str
    text: str
    line: int


def _mutants(text: str) -> Iterator[Mutant]:
    """Yield the file with each attribute's value spoiled and each attribute's name misspelt, in turn."""
    body = re.sub(r"<!--.*?-->", lambda found: " " * len(found.group()), text, flags=re.DOTALL)
    for tag in re.finditer(r"<([a-z_]+)(?: [^<>]*)?>", body):
        inside_template = body.rfind("<template", 0, tag.start()) > body.rfind("</template", 0, tag.start())
        for found in re.finditer(r'(?<=\s)([a-z_]+)="([^"]*)"', body[tag.start() : tag.end()]):
            name, value = found.groups()
            start = tag.start() + found.start()
            line = text.count("\n", 0, start) + 1
            label = f"line {line}: {tag.group(1)} {name}"
            yield Mutant(f"{label} misspelt", f"{text[:start]}{name}q{text[start + len(name) :]}", line)
            kind = "template" if inside_template and tag.group(1) == "parameter" else tag.group(1)
            if name not in FREE and (kind, name) not in ELSEWHERE:
                at = tag.start() + found.end(2)
                spoiled = "x" if re.fullmatch(r"-?[\d.]+", value) else "!"
                yield Mutant(f"{label} spoiled", f"{text[:at]}{spoiled}{text[at:]}", line)


def _misspelt_elements(text: str) -> Iterator[Mutant]:
    """Yield the file with the name of each element but the first misspelt, in its start tag and its end tag."""
    body = re.sub(r"<!--.*?-->", lambda found: " " * len(found.group()), text, flags=re.DOTALL)
    for tag in re.finditer(r"<([a-z_]+)(?=[ />\n])", body):
        name, line = tag.group(1), text.count("\n", 0, tag.start()) + 1
        same = re.compile(rf"<(/?){name}(?=[ />\n])[^<>]*?(/?)>")
        depth = 0
        for found in same.finditer(body, tag.start()):
            depth += -1 if found.group(1) else 0 if found.group(2) else 1
            if depth == 0:
                end = found.end() - 1
                middle = text[tag.end() : end] if found.group(1) else text[tag.end() : tag.end()]
                rest = f"q{text[end:]}" if found.group(1) else text[tag.end() :]
                if name not in ("scenarios", "allow"):
                    yield Mutant(f"line {line}: <{name}> misspelt", f"{text[: tag.end()]}q{middle}{rest}", line)
                break


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.parametrize("every", EVERY)
def test_one_misspelt_element_gives_findings_on_its_line_only(path: Path, every: int, tmp_path: Path) -> None:
    shutil.copy(HERE / "every_entry.xml", tmp_path)
    wrong = []
    mutants = list(_misspelt_elements(path.read_text(encoding="utf-8")))
    for mutant in mutants[::every]:
        (tmp_path / path.name).write_text(mutant.text, encoding="utf-8")
        (found,) = validate_files([tmp_path / path.name])
        if {one.place.line for one in found} != {mutant.line}:
            wrong.append(f"{mutant.name}: {[as_text(one) for one in found]}")
    assert len(mutants) > 10
    assert wrong == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.parametrize("every", EVERY)
def test_one_fault_gives_findings_on_its_line_only(path: Path, every: int, tmp_path: Path) -> None:
    shutil.copy(HERE / "every_entry.xml", tmp_path)
    wrong = []
    mutants = list(_mutants(path.read_text(encoding="utf-8")))
    for mutant in mutants[::every]:
        (tmp_path / path.name).write_text(mutant.text, encoding="utf-8")
        sink = Diagnostics()
        validate_file(tmp_path / path.name, sink)
        found = list(sink)
        if {one.place.line for one in found} != {mutant.line} or len(found) > 2:
            wrong.append(f"{mutant.name}: {[as_text(one) for one in found]}")
    assert len(mutants) > 50
    assert wrong == []
