"""Memory of a server over many short runs: `python -m tests.benchmarks.memory_figures [COUNT]`.

`study` serves four participants, who drive one after the other; `drive` serves one page. Runs take 0.4 s, so that what
a run leaves behind shows as often as in a long day: eight hours of runs of a minute are 480.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.live import soaking
from tests.live.serving import served
from tests.study.test_server import ordered

PARTICIPANTS = 4


def driven(folder: Path, count: int) -> list[float]:
    """Return the memory after each run of `drive`, MiB."""
    soaking.written(folder, PARTICIPANTS, 1)
    words = ("drive", folder / "conflicts.xml", "--perception", "ideal", "-o", folder / "drives")
    with served(*words) as server:
        return list(soaking.runs(server, count))


def studied(folder: Path, count: int) -> list[float]:
    """Return the memory after each run of a study, MiB."""
    study, each = soaking.written(folder, PARTICIPANTS, count // PARTICIPANTS), count // PARTICIPANTS
    found: list[float] = []
    with served("study", study, "--perception", "ideal", "--size", "640x360", "-o", folder / "data") as server:
        for one in range(1, PARTICIPANTS + 1):
            ordered(server, participant=one, action="start")
            found += soaking.runs(server, each, f"/participant/{one}/socket")
    return found


def main(count: int) -> None:
    """Print the memory after tenths of the runs."""
    with tempfile.TemporaryDirectory() as folder:
        for name, measure in (("drive", driven), ("study", studied)):
            held = measure(Path(folder), count)
            tenth = max(1, len(held) // 10)
            print(name, len(held), "runs:", *(f"{one:.0f}" for one in held[tenth - 1 :: tenth]), "MiB")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 480)
