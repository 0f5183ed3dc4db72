"""Validating many files: findings come in the files' order, and no heavy package is loaded."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from scenario_compiler.cli.validate import summary
from scenario_compiler.diagnostics import Diagnostic, Diagnostics, FilePlace, Severity
from scenario_compiler.document import UNREADABLE
from scenario_compiler.files import SCENARIO_BYTES
from scenario_compiler.resources import library_folder
from scenario_compiler.validation import (
    checked_by_processes,
    files_below,
    validate_file,
    validate_files,
)

HEAVY = ("numpy", "cv2", "scipy", "matplotlib", "pyarrow", "jinja2", "rich", "concurrent.futures.process")
OBSTACLE = library_folder() / "conflicts" / "obstacle_ahead.xml"
MOST_LINES = 3_200_000
"""Lines of Python that may be run to check one file, imports included: 1.6 million with Python 3.11, 0.35 s."""


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=120, check=False)


def test_nothing_heavy_is_loaded() -> None:
    program = (
        "import sys\nfrom scenario_compiler.cli import main\n"
        f"sys.argv = ['scenario-compiler', 'validate', {str(OBSTACLE)!r}]\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = _run("-c", program)
    assert done.stdout.splitlines()[-1] == "[]", done.stdout + done.stderr


def test_one_file_needs_little_work() -> None:
    program = (
        "import sys\nfrom tests.work import counted\n"
        "def check():\n    from scenario_compiler.cli import main\n"
        f"    sys.argv = ['scenario-compiler', 'validate', {str(OBSTACLE)!r}]\n"
        "    try:\n        main()\n    except SystemExit as end:\n        assert not end.code\n"
        "print(counted(check)[1])"
    )
    done = _run("-c", program)
    assert int(done.stdout.splitlines()[-1]) < MOST_LINES, done.stdout + done.stderr


def _hostile(folder: Path) -> list[Path]:
    """Write files that are damaged, huge or hostile; return them with a good one after each."""
    good = OBSTACLE.read_text(encoding="utf-8")
    contents = {
        "cut.xml": good[: len(good) // 2].encode(),
        "binary.xml": bytes(range(256)) * 40,
        "empty.xml": b"",
        "bomb.xml": b'<!DOCTYPE a [<!ENTITY b "bbbb"><!ENTITY c "&b;&b;">]><scenarios>&c;</scenarios>',
        "deep.xml": b'<scenarios version="1">' + b"<template>" * 5000,
        "huge.xml": b'<scenarios version="1">' + b" " * SCENARIO_BYTES + b"</scenarios>",
        "road.xodr": b"<OpenDRIVE><header/>",
    }
    for name, content in contents.items():
        (folder / name).write_bytes(content)
        (folder / f"{name}.good.xml").write_text(good, encoding="utf-8")
    return files_below(folder)


@pytest.mark.parametrize("processes", [1, 2])
def test_a_hostile_file_is_one_finding_and_the_rest_goes_on(tmp_path: Path, processes: int) -> None:
    files = _hostile(tmp_path) * 3
    found = list(validate_files(files, processes=processes))
    assert [len(some) for some in found] == [0 if file.name.endswith("good.xml") else 1 for file in files]
    assert all(one.place.file == str(file) for file, some in zip(files, found, strict=True) for one in some)


def test_unreadable_files_of_a_folder_are_reported(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.xml")
    os.mkfifo(tmp_path / "pipe.xodr")
    (tmp_path / "dangling.xosc").symlink_to("nowhere")
    (tmp_path / "loop.xml").symlink_to("loop.xml")
    (tmp_path / "endless.xml").symlink_to("/dev/zero")
    (tmp_path / "folder.xml").mkdir()
    files = files_below(tmp_path)
    found = [
        (file.name, [one.code.id for one in some]) for file, some in zip(files, validate_files(files), strict=True)
    ]
    names = ("dangling.xosc", "endless.xml", "loop.xml", "pipe.xml", "pipe.xodr")
    assert found == [(name, ["SC101"]) for name in names]


@pytest.mark.parametrize(("name", "code"), [("cut.XML", "SC102"), ("cut.Xosc", "SC102"), ("ROAD.XODR", "SC102")])
def test_the_case_of_a_suffix_does_not_count(tmp_path: Path, name: str, code: str) -> None:
    (tmp_path / name).write_text("<OpenDRIVE", encoding="utf-8")
    (tmp_path / "notes.TXT").write_text("", encoding="utf-8")
    files = files_below(tmp_path)
    assert [file.name for file in files] == [name]
    assert [one.code.id for some in validate_files(files) for one in some] == [code]


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is hidden from the administrator")
def test_a_folder_that_cannot_be_read_is_reported(tmp_path: Path) -> None:
    hidden = tmp_path / "hidden"
    hidden.mkdir(mode=0)
    (found,) = validate_files(files_below(tmp_path))
    assert [(one.code.id, one.place.file) for one in found] == [("SC101", str(hidden))]


def _deadly(files: Sequence[Path]) -> list[list[Diagnostic]]:
    """Find one note in each file; `deadly` ends the process each time, `unlucky` the first time."""
    for file in files:
        first_time = file.name == "unlucky.xml" and not file.exists()
        file.touch()
        if first_time or file.name == "deadly.xml":
            os.kill(os.getpid(), signal.SIGKILL)
    return [[Diagnostic(UNREADABLE, "checked", FilePlace(str(file)))] for file in files]


def test_a_process_that_dies_costs_only_the_file_that_ends_it(tmp_path: Path) -> None:
    names = [f"{number}.xml" for number in range(12)]
    names[4], names[10] = "deadly.xml", "unlucky.xml"
    files = [tmp_path / name for name in names]
    tasks = [files[at : at + 3] for at in range(0, len(files), 3)]
    found = list(checked_by_processes(tasks, 2, _deadly))
    assert [one.place.file for some in found for one in some] == [str(file) for file in files]
    assert [one.place.file for some in found for one in some if one.code.id == "SC117"] == [str(files[4])]


def test_a_fault_of_the_program_is_a_finding_too(tmp_path: Path) -> None:
    strange = tmp_path / ("x" * 300)
    (found,) = validate_files([strange, OBSTACLE][:1])
    assert {one.code.id for one in found} <= {"SC101", "SC117"}
    assert len(found) == 1


def test_a_road_file_fails_only_for_its_structure(tmp_path: Path) -> None:
    road = tmp_path / "road.xodr"
    header = '<header revMajor="1" revMinor="4"/>'
    road.write_text(f"<OpenDRIVE>{header}</OpenDRIVE>", encoding="utf-8")
    sink = Diagnostics()
    validate_file(road, sink)
    structural = [one for one in sink if one.severity is Severity.ERROR]
    road.write_text(f"<OpenDRIVE>{header}<raod/></OpenDRIVE>", encoding="utf-8")
    worse = Diagnostics()
    validate_file(road, worse)
    assert len([one for one in worse if one.severity is Severity.ERROR]) > len(structural)


def test_warnings_are_allowed_in_the_file(tmp_path: Path) -> None:
    case = Path(__file__).parent / "cases" / "SC401_never_fires.xml"
    text = case.read_text(encoding="utf-8")
    file = tmp_path / "quiet.xml"
    file.write_text(text.replace('version="1">', 'version="1"><allow code="SC401"/>', 1), encoding="utf-8")
    sink = Diagnostics()
    validate_file(file, sink)
    assert list(sink) == []
    done = _run("-m", "scenario_compiler", "validate", "--error", "SC401", str(case))
    assert done.returncode == 1


def test_a_fault_in_a_file_that_another_names_is_reported_once(tmp_path: Path) -> None:
    study, asked = tmp_path / "study.xml", tmp_path / "effort.xml"
    study.write_text(
        '<study version="1" name="one" participants="1"><scenario name="a" target="obstacle_ahead"/>'
        '<after_each><ask file="effort.xml"/></after_each></study>',
        encoding="utf-8",
    )
    asked.write_text(
        '<questionnaire version="1" name="effort"><text_item name="more"/></questionnaire>', encoding="utf-8"
    )
    done = _run("-m", "scenario_compiler", "validate", str(study), str(asked))
    assert done.stderr.count("SC107") == 1
    assert done.stdout == "2 files checked, 1 error, 1 file at fault\n"


def test_the_summary_counts() -> None:
    assert summary(1, []) == "1 file checked, 0 errors"
    sink = Diagnostics()
    validate_file(Path("missing.xml"), sink)
    assert summary(3, list(sink)) == "3 files checked, 1 error, 1 file at fault"
