"""The program with a clock that goes 100 000 times too fast: its runs are as fast as the machine can make them.

`python -m tests.live.hurried study ...`: a run in real time is always behind such a clock. It gives up time, and still
sends a picture every 0.2 s of the run, takes inputs in each step, and writes all its files. Timeouts of pages are real.
"""

from __future__ import annotations

import time

FASTER = 100_000.0


def main() -> None:
    """Replace the clock of runs, and start the program."""
    counted = time.perf_counter
    time.perf_counter = lambda: FASTER * counted()

    from scenario_compiler.__main__ import main as start  # after the clock, which modules may import by name

    start()


if __name__ == "__main__":
    main()
