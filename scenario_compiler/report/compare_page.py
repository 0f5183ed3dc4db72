"""The page that compares two runs: a player with one clock for both, and tables of differences."""

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
