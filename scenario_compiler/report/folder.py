"""The run folder: plan.json, map.xodr, recording.parquet, events.csv, outcome.json, report.html.

It holds all that its report is written from, so that `report DIR` works from any folder and on another machine.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from scenario_compiler.files import MAX_BYTES, read_file
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.plan.maps import MAP_OF_RUN
from scenario_compiler.plan.store import write_plan
from scenario_compiler.recording.events import write_events
from scenario_compiler.recording.outcome import write_outcome
from scenario_compiler.recording.store import write_recording
from scenario_compiler.report.html import write_report
from scenario_compiler.report.run import Run

RUN_FILES = ("plan.json", MAP_OF_RUN, "recording.parquet", "events.csv", "outcome.json", "report.html")


def write_run_folder(run: Run, folder: Path, *, report: bool = True) -> None:
    """Write all files of a run, making the folder when there is none; equal runs give equal bytes.

    Args:
        run: The run.
        folder: Its folder.
        report: Write report.html too.

    Raises:
        OSError: They cannot be written, or the map has changed or gone since it was read.
    """
    make_folder(folder)
    write_plan(run.plan, folder / "plan.json")
    write_whole(folder / MAP_OF_RUN, _map_of(run))
    write_recording(run.recording, folder / "recording.parquet")
    write_events(run.recording.events, folder / "events.csv")
    write_outcome(run.outcome, folder / "outcome.json")
    if report:
        write_report([run], folder)


def _map_of(run: Run) -> bytes:
    """Return the content of the map that the run took place on."""
    content = read_file(run.network.path, MAX_BYTES)
    if hashlib.sha256(content).hexdigest() != run.network.sha256:
        raise OSError(0, "the map has changed since it was read", str(run.network.path))
    return content
