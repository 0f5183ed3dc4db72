"""The library of the engine: complete or absent, never older than its sources, and absent without a compiler."""

from __future__ import annotations

import ast
import inspect
import os
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

from scenario_compiler.forms.language import FunctionSource, marked_functions
from scenario_compiler.forms.machine_code import library, why_interpreted
from scenario_compiler.forms.making import BuildError, NoCompilerError, build, compiler
from scenario_compiler.forms.note import PACKAGE, Note, source_names


def test_the_tests_run_with_the_machine_code() -> None:
    made = library()
    assert made is not None, why_interpreted()
    assert why_interpreted() == ""
    assert made.made_by


def test_a_library_is_made_of_all_marked_modules() -> None:
    note = Note.read()
    assert note is not None
    assert set(note.sources) == set(source_names())
    assert {"engine/story/step.py", "roads/locate.py", "forms/engine.h", "randomness.py"} <= set(note.sources)


def test_a_library_depends_on_every_module_that_a_marked_function_names() -> None:
    """Its numbers are written into the C, so a change in one of these modules makes the library stale."""
    used: dict[Path, set[str]] = defaultdict(set)
    for function in marked_functions():
        tree = FunctionSource.of(function).tree
        used[Path(inspect.getfile(function))] |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    named = set()
    for home, names in used.items():
        for node in ast.walk(ast.parse(home.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and names & {one.asname or one.name for one in node.names}:
                named.add(str(node.module))
    ours = {name.partition(".")[2].replace(".", "/") for name in named if name.startswith(f"{PACKAGE.name}.")}
    sources = set(source_names())
    assert "vocabulary/horizon" in ours
    assert [name for name in sorted(ours) if not {f"{name}.py", f"{name}/__init__.py"} & sources] == []


def test_a_changed_source_makes_a_library_stale() -> None:
    note = Note.read()
    assert note is not None
    changed = "engine/story/step.py"
    size, time, digest = note.sources[changed]
    assert note.is_fresh
    assert Note(note.made_by, note.entries, {**note.sources, changed: (size, time + 1, digest)}).is_fresh
    assert not Note(note.made_by, note.entries, {**note.sources, changed: (size + 1, time, digest)}).is_fresh
    assert not Note(note.made_by, note.entries, {**note.sources, changed: (size, 1, "0")}).is_fresh
    assert not Note(note.made_by, note.entries, {**note.sources, "engine/gone.py": (1, 1, "0")}).is_fresh
    assert Note(note.made_by, note.entries, {}).is_fresh


def test_faulty_c_leaves_no_library(tmp_path: Path) -> None:
    with pytest.raises(BuildError, match=r"engine\.c"):
        build("int broken(", tmp_path / "engine.so")
    assert list(tmp_path.iterdir()) == []


def test_without_a_compiler_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    with pytest.raises(NoCompilerError, match="install gcc or clang, or `pip install ziglang`"):
        compiler()


def test_the_chosen_compiler_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine = tmp_path / "mycc"
    mine.write_text("#!/bin/sh\n", encoding="utf-8")
    mine.chmod(0o755)
    monkeypatch.setenv("CC", str(mine))
    assert compiler() == [str(mine)]


@pytest.fixture
def copy(repository: Path, tmp_path: Path) -> Path:
    """A copy of the checkout without machine code."""
    copy = tmp_path / "copy"
    for name in ("scenario_compiler", "schemas", "library", "maps"):
        shutil.copytree(repository / name, copy / name, ignore=shutil.ignore_patterns("engine.library", "__pycache__"))
    return copy


@pytest.mark.slow
def test_a_compiler_that_fails_is_reported_without_a_traceback(copy: Path, tmp_path: Path) -> None:
    """A machine has gcc, but not the headers of the C library, as small images of containers do."""
    mine = tmp_path / "mycc"
    mine.write_text("#!/bin/sh\necho 'fatal error: math.h: No such file' >&2\nexit 1\n", encoding="utf-8")
    mine.chmod(0o755)
    command = [sys.executable, "-m", "scenario_compiler.forms.making"]
    environment = {**os.environ, "CC": str(mine)}
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 1
    assert done.stderr == f"the engine cannot be built: {mine} failed:\nfatal error: math.h: No such file\n\n"


def test_the_interpreted_form_serves_without_a_library(copy: Path) -> None:
    command = [sys.executable, "-m", "scenario_compiler", "run", str(copy / "library/conflicts/obstacle_ahead.xml")]
    command += ["--perception", "ideal", "--duration", "1"]
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=True, env={**os.environ})
    assert "the engine's machine code has not been built" in done.stderr


@pytest.mark.skipif("gcc" not in compiler(), reason="only gcc is guided by sweeps")
@pytest.mark.slow
def test_sweeps_guide_gcc_and_a_library_is_made_without_them_where_they_fail(copy: Path) -> None:
    """They fail where the build has no numpy, or no library of conflicts."""
    making = [sys.executable, "-m", "scenario_compiler.forms.making"]

    def stderr_of(*arguments: str) -> str:
        return subprocess.run([*making, *arguments], cwd=copy, capture_output=True, text=True, check=True).stderr

    sweeps = "scenario_compiler.batch.typical_sweeps"
    (copy / "library").rename(copy / "elsewhere")
    assert "guided" not in stderr_of(sweeps)
    (copy / "elsewhere").rename(copy / "library")
    assert "guided" not in stderr_of()
    assert stderr_of(sweeps).endswith(", guided by typical sweeps\n")
    assert stderr_of().endswith(", guided by typical sweeps\n")


SANITIZERS = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@pytest.mark.parametrize(
    "sanitizers",
    [pytest.param((), id="the engine's own checks"), pytest.param(SANITIZERS, id="sanitizers", marks=pytest.mark.slow)],
)
def test_no_index_leaves_its_column_and_nothing_is_undefined(
    repository: Path, tmp_path: Path, sanitizers: tuple[str, ...]
) -> None:
    """The engine itself checks indices and overflows; the sanitizers check addresses and all that C leaves open."""
    done = subprocess.run(
        [sys.executable, str(repository / "tests" / "forms" / "sanitized.py"), str(tmp_path), *sanitizers],
        capture_output=True,
        text=True,
        check=False,
        cwd=repository,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert "36 of 36 variants are the same" in done.stdout
