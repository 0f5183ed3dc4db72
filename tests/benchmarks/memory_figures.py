"""Measures memory over many runs: `python -m tests.benchmarks.memory_figures [drive|study|hurried|pilot] [COUNT]`.

`study` serves four participants who drive at the same time, `COUNT` runs each; `drive` serves one page. Their runs take
0.4 s in real time, so that what a run leaves behind shows as often as in a long day: eight hours of runs of a minute
are 480. `hurried` serves four participants too, whose runs take a minute of a clock that is too fast
(tests/live/hurried.py); in `pilot`, driver models take their place. Both make all that belongs to a simulated minute.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from tests.live import soaking
from tests.live.serving import Served, served
from tests.study.test_server import ordered

PARTICIPANTS = 4


def driven(folder: Path, count: int) -> list[float]:
    """Return the memory after each run of `drive`, MiB."""
    soaking.written(folder, PARTICIPANTS, 1)
    words = ("drive", folder / "conflicts.xml", "--perception", "ideal", "-o", folder / "drives")
    with served(*words) as server:
        return list(soaking.runs(server, count))


def studied(
    folder: Path, count: int, conflicts: str = soaking.SHORT, program: str = "scenario_compiler"
) -> list[float]:
    """Return the memory after each run of a study by participants who drive at the same time, MiB."""
    study = soaking.written(folder, PARTICIPANTS, count, conflicts=conflicts)
    found: list[float] = []

    def drive(server: Served, participant: int) -> None:
        for held in soaking.runs(server, count, f"/participant/{participant}/socket?step={{}}"):
            found.append(held)
            if len(found) % 20 == 0:
                print(f"{time.monotonic():.0f} s: {len(found)} runs, {held:.1f} MiB", flush=True)

    words = ("study", study, "--perception", "ideal", "--size", "640x360", "-o", folder / "data")
    with served(*words, program=program) as server:
        people = [threading.Thread(target=drive, args=(server, one)) for one in range(1, PARTICIPANTS + 1)]
        for one in range(1, PARTICIPANTS + 1):
            ordered(server, participant=one, action="start")
        for person in people:
            person.start()
        for person in people:
            person.join()
    return found


def hurried(folder: Path, count: int) -> list[float]:
    """Return the memory after each run of a minute of a study whose clock is too fast, MiB."""
    return studied(folder, count, soaking.LONG, "tests.live.hurried")


def piloted(folder: Path, count: int) -> list[float]:
    """Return the memory of a pilot after each of its runs of a minute, or of those that end at the same time, MiB."""
    study = soaking.written(folder, PARTICIPANTS, count, conflicts=soaking.LONG)
    words = ("study", study, "--pilot", "--perception", "ideal", "-o", folder / "data")
    process = subprocess.Popen([sys.executable, "-m", "scenario_compiler", *map(str, words)], stderr=subprocess.DEVNULL)
    found: list[float] = []
    while process.poll() is None:
        done = len(list((folder / "data" / "sourcedata").glob("sub-*/ses-*/run-*/outcome.json")))
        if done > len(found):
            found += [soaking.resident(process.pid)] * (done - len(found))
        time.sleep(0.5)
    if process.returncode:
        raise SystemExit(f"the pilot ended with {process.returncode}")
    return found


MEASURED = {"drive": driven, "study": studied, "hurried": hurried, "pilot": piloted}


def main() -> None:
    """Print the memory after tenths of the runs, and how long they took."""
    parser = argparse.ArgumentParser(description="Print the memory of a server over many short runs.")
    parser.add_argument("command", choices=MEASURED)
    parser.add_argument("count", type=int, nargs="?", default=480, help="runs, in a study of each participant")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        held = MEASURED[options.command](Path(folder), options.count)
        tenth = max(1, len(held) // 10)
        print(options.command, len(held), "runs:", *(f"{one:.0f}" for one in held[tenth - 1 :: tenth]), "MiB")
        print(f"{(time.monotonic() - begin) / 60.0:.0f} minutes")


if __name__ == "__main__":
    main()
