"""The recipe for a new action: `<honk duration>` needs four declarations, and leaving out any of them fails a test.

Each try copies the project, adds the word to the copy, and runs there what `make test` would run.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Part:
    """Text that the recipe adds to a file, each behind a line that is there."""

    file: str
    added: tuple[tuple[str, str], ...]


WORD = Part(
    "scenario_compiler/vocabulary/actions/control.py",
    (
        (
            '    mode: Literal["off", "on", "flashing"] = attribute("State of the light.")\n',
            '''

class HonkAction(Word):
    """Sound the horn."""

    word: Literal["honk"] = "honk"

    duration: Number = attribute("How long it sounds.", quantity="time", minimum=0)
''',
        ),
    ),
)
UNION = Part(
    "scenario_compiler/vocabulary/actions/__init__.py",
    (
        ("    ControllerProperty,\n", "    HonkAction,\n"),
        ("    | LightAction\n", "    | HonkAction\n"),
        ('    "FollowTrajectoryAction",\n', '    "HonkAction",\n'),
    ),
)
ENTRY = Part(
    "scenario_compiler/engine/moves/appearance.py",
    (
        (
            'LIGHT = Entry(("light",), light_row, start_light, told=Told("light", LOGGED, '
            "lambda word: (word.type, word.mode)))\n",
            """HONK = Entry(
    ("honk",),
    lambda draft, word, actor: ActionRow((0.0, word.duration)),
    step=step_animation,
    told=Told("honk", "`entity` sounds its horn."),
)
""",
        ),
    ),
)
FORM = Part(
    "scenario_compiler/openscenario/actions/__init__.py",
    (
        (
            '    "message": "OpenSCENARIO has no messages to the driver",\n',
            '    "honk": "the standard has no horns",\n',
        ),
    ),
)
PARTS = (WORD, UNION, ENTRY, FORM)

SCENARIO = """<?xml version="1.0" encoding="UTF-8"?>
<scenarios version="1">
  <scenario name="honking" map="highway_loop" duration="4" step="0.05">
    <ego speed="20"><start><spawn_point name="straight"/></start></ego>
    <dynamic id="first" speed="20"><start><ahead_of entity="ego" distance="40"/></start></dynamic>
    <dynamic id="second" speed="20"><start><ahead_of entity="ego" distance="80"/></start>
      <when name="sounds"><time after="1"/><do><honk duration="1.5"/></do></when>
    </dynamic>
  </scenario>
</scenarios>
"""

PROOF = """
from pathlib import Path
import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.runtime import open_world, run

@pytest.mark.parametrize("interpreted", [True, False])
def test_it_sounds_for_its_time_and_the_log_says_who(interpreted):
    ideal = Overrides(perception="ideal")
    done = compile_target(Path(__file__).with_name("honk.xml"), {}, Diagnostics(), overrides=ideal)
    with open_world("kinematic", done.plan, done.network) as world:
        recording = run(done.plan, world, 1, interpreted=interpreted)
    told = {event.kind: event for event in recording.events}
    assert told["honk"].entity == "second"
    assert told["honk"].t == pytest.approx(1.0, abs=0.06)
    assert told["storyboard_end"].t - told["honk"].t == pytest.approx(1.5, abs=0.06)
"""

CHECKS = ("tests/test_coverage.py", "tests/openscenario/test_words.py::test_every_word_has_a_form_or_a_reason")


def _copy_with(parts: tuple[Part, ...], repository: Path, folder: Path) -> None:
    """Copy the project and add parts of the recipe, and a scenario that uses the word."""
    shutil.copytree(
        repository,
        folder,
        ignore=shutil.ignore_patterns(".git", ".venv", "__pycache__", ".*_cache", "node_modules", "build", "out"),
    )
    for part in parts:
        file = folder / part.file
        text = file.read_text(encoding="utf-8")
        for line, added in part.added:
            assert text.count(line) == 1, (part.file, line)
            text = text.replace(line, line + added)
        file.write_text(text, encoding="utf-8")
    (folder / "tests" / "honk.xml").write_text(SCENARIO, encoding="utf-8")
    (folder / "tests" / "test_honk.py").write_text(PROOF, encoding="utf-8")
    subprocess.run(
        [sys.executable, "-m", "scenario_compiler.forms.making"], cwd=folder, capture_output=True, check=False
    )


def _tested(folder: Path, *checks: str) -> subprocess.CompletedProcess[str]:
    program = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *checks]
    return subprocess.run(program, cwd=folder, capture_output=True, text=True, check=False)


def test_a_word_is_four_declarations_in_four_files(repository: Path, tmp_path: Path) -> None:
    _copy_with(PARTS, repository, tmp_path / "whole")
    done = _tested(tmp_path / "whole", *CHECKS, "tests/test_honk.py")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("forgotten", PARTS, ids=lambda part: Path(part.file).parts[1])
def test_each_forgotten_part_fails_a_test(forgotten: Part, repository: Path, tmp_path: Path) -> None:
    _copy_with(tuple(part for part in PARTS if part is not forgotten), repository, tmp_path / "partly")
    assert _tested(tmp_path / "partly", *CHECKS).returncode != 0
