"""The page that compares two runs, with a player that has one clock for both, and the page that compares two sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.comparison import Comparison
from scenario_compiler.report.embedding import player_head, player_place, player_start
from scenario_compiler.report.replay import Picture
from scenario_compiler.report.run import Run
from scenario_compiler.report.templates import page_environment
from scenario_compiler.report.wording import summary_of

TEMPLATE = "compare.html.jinja"
TABLES = "compare_tables.html.jinja"


def write_comparison(
    runs: tuple[Run, Run],
    names: tuple[str, str],
    found: Comparison,
    verdict: Sequence[str],
    pictures: Sequence[Sequence[Picture]],
    path: Path,
) -> None:
    """Write the page: one file without external resources.

    Args:
        runs: The runs, each with at least one row.
        names: Names of the runs, such as those of their folders.
        found: Their differences.
        verdict: The conclusion, in sentences.
        pictures: The first-person pictures of each, ordered by time.
        path: Path of the page.
    """
    environment = page_environment()
    page = environment.get_template(TEMPLATE).render(
        names=names,
        summaries=[summary_of(run) for run in runs],
        found=found,
        verdict=verdict,
        player_head=player_head(),
        player=player_place(runs, pictures, names=names),
        player_start=player_start(),
    )
    write_whole(path, page)


def write_tables(
    names: tuple[str, str],
    verdict: Sequence[str],
    tables: Sequence[tuple[str, Sequence[str], Sequence[Sequence[str]], int]],
    path: Path,
) -> None:
    """Write the page that compares two sweeps: one file without external resources.

    Args:
        names: Names of the sweeps, such as those of their folders.
        verdict: The conclusion, in sentences.
        tables: Each with its title, headings, rows, and number of further rows that are left out.
        path: Path of the page.
    """
    write_whole(path, page_environment().get_template(TABLES).render(names=names, verdict=verdict, tables=tables))
