"""The run folder: plan.json, recording.parquet, events.csv, outcome.json, report.html."""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.outputs import make_folder
from scenario_compiler.plan.store import write_plan
from scenario_compiler.recording.events import write_events
from scenario_compiler.recording.outcome import write_outcome
from scenario_compiler.recording.store import write_recording
from scenario_compiler.report.html import write_report
from scenario_compiler.report.run import Run

RUN_FILES = ("plan.json", "recording.parquet", "events.csv", "outcome.json", "report.html")


def write_run_folder(run: Run, folder: Path) -> None:
    """Write all files of a run, making the folder when there is none; equal runs give equal bytes."""
    make_folder(folder)
    write_plan(run.plan, folder / "plan.json")
    write_recording(run.recording, folder / "recording.parquet")
    write_events(run.recording.events, folder / "events.csv")
    write_outcome(run.outcome, folder / "outcome.json")
    write_report([run], folder)
