"""What happens in a study reaches a listener of the Lab Streaming Layer, as it stands in the journal."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, read_source
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.study.attendance import Attendance, Rules
from scenario_compiler.study_plans import compile_study
from tests.study import made

pylsl = pytest.importorskip("pylsl", reason="needs the extra lsl", exc_type=ImportError)


def test_a_listener_hears_the_journal(tmp_path: Path) -> None:
    from scenario_compiler.study.outlet import MarkerOutlet

    read = read_source(made.study(tmp_path), Diagnostics())
    assert read is not None
    assert isinstance(read[1], StudyFile)
    overrides = Overrides(perception="ideal", driven_by="person")
    compilation = compile_study(read[1], Diagnostics(), overrides=overrides)
    assert compilation is not None
    name = f"test{os.getpid()}"
    rules = Rules(compilation, tmp_path / "data", None, (64, 36), mark=MarkerOutlet(name).mark)
    found = pylsl.resolve_byprop("name", name, timeout=60)
    if not found:
        pytest.skip("this machine's network carries no multicast")
    listener = pylsl.StreamInlet(found[0])
    listener.open_stream(timeout=60)
    attendance = Attendance(rules, 1)
    attendance.start()
    attendance.go_on(0, {"agree": "yes"})
    attendance.note("all well: äöü")
    attendance.close()
    heard = [json.loads(listener.pull_sample(timeout=60)[0][0]) for _ in attendance.journal.records]
    assert [{"participant": "sub-01", "session": "ses-01", **one} for one in attendance.journal.records] == heard
