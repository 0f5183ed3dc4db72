"""Runs five conflicts, one for each row of the AISA paper's table, and writes one report.

python examples/demo.py [FOLDER]          (FOLDER is build/demo unless given)
"""

from __future__ import annotations

import sys
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path

from rich import box
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from scenario_compiler import (
    Run,
    compile_scenario,
    judge,
    library_folder,
    load_network,
    open_world,
    run,
    summary_of,
    write_report,
    write_run_folder,
)

CONFLICTS = ("sensor_failure", "ramp_blocked", "road_narrows", "obstacle_ahead", "markings_missing")


def run_conflict(name: str, seed: int, folder: Path) -> Run:
    """Compile and run one conflict of the library and write its run folder."""
    plan = compile_scenario(library_folder() / "conflicts" / f"{name}.xml")
    network = load_network(plan.map.file)
    world = open_world("kinematic", plan, network)
    recording = run(plan, world, seed=seed)
    world.close()
    finished = Run(plan, network, recording, judge(plan, recording))
    write_run_folder(finished, folder / name)
    return finished


def run_all(folder: Path, console: Console) -> list[Run]:
    """Run all conflicts, two at a time, with a progress bar."""
    with Progress(console=console) as progress, ProcessPoolExecutor(2) as pool:
        bar = progress.add_task("running five conflicts", total=len(CONFLICTS))
        pending: list[Future[Run]] = []
        for seed, name in enumerate(CONFLICTS, start=1):
            pending.append(pool.submit(run_conflict, name, seed, folder))
            pending[-1].add_done_callback(lambda _: progress.advance(bar))
        return [future.result() for future in pending]


def main() -> None:
    """Run the demo."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "build/demo")
    console = Console() if sys.stdout.isatty() else Console(width=120)
    runs = run_all(folder, console)
    write_report(runs, folder)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("conflict", "Gold", "urgency", "cause", "request", "takeover", "min TTC", "outcome"):
        table.add_column(heading, no_wrap=heading != "outcome", overflow="fold")
    for one in map(summary_of, runs):
        times = (
            text if text == "–" else f"{text} s" for text in (one.request_time, one.takeover_time, one.minimum_ttc)
        )
        table.add_row(one.name, one.number, one.urgency, one.cause, *times, one.outcome)
    console.print(table)
    console.print(f"report: {folder / 'report.html'}", soft_wrap=True)


if __name__ == "__main__":
    main()
