"""The run folder: plan.json, map.xodr, recording.parquet, events.csv, outcome.json, report.html.

It contains everything that its report needs, so `report DIR` works from any folder and on another machine.
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


def write_run_folder(run: Run, folder: Path, *, report: bool = True) -> None:
    """Write all files of a run; create the folder if it does not exist. Identical runs give identical bytes.

    If the map has changed or is missing since it was read, map.xodr is left out, so that the result of a long run is
    not lost.

    Args:
        run: The run.
        folder: Its folder.
        report: Whether to write report.html.

    Raises:
        OSError: The files cannot be written.
    """
    make_folder(folder)
    write_plan(run.plan, folder / "plan.json")
    content = _map_of(run)
    if content is not None:
        write_whole(folder / MAP_OF_RUN, content)
    write_recording(run.recording, folder / "recording.parquet")
    write_events(run.recording.events, folder / "events.csv")
    write_outcome(run.outcome, folder / "outcome.json")
    if report:
        write_report([run], folder)


def _map_of(run: Run) -> bytes | None:
    """Return the contents of the run's map; None if the file has changed or is missing."""
    try:
        content = read_file(run.network.path, MAX_BYTES)
    except OSError:
        return None
    return content if hashlib.sha256(content).hexdigest() == run.network.sha256 else None
