"""The report page: one HTML file with style, pictures and tables, which needs no other file and no network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.report import plots
from scenario_compiler.report.embedding import player_head, player_place, player_start, source_of
from scenario_compiler.report.folding import Folded, folded
from scenario_compiler.report.palette import STATE_COLOURS
from scenario_compiler.report.replay import Picture, pictures_of
from scenario_compiler.report.run import Run
from scenario_compiler.report.templates import page_environment
from scenario_compiler.report.wording import (
    Summary,
    classification,
    command,
    conditions,
    place_words,
    summary_of,
)

TEMPLATE = "report.html.jinja"


@dataclass(frozen=True, slots=True)
class Section:
    """The parts of one run that the template uses."""

    anchor: str
    run: Run
    summary: Summary
    outcome_words: str
    classification: str
    frames: tuple[Picture, ...]
    player: str
    plots: dict[str, str]
    conditions: list[tuple[str, str]]
    command: str
    events: tuple[Folded, ...]

    @property
    def outcome(self) -> Outcome:
        """The run's outcome."""
        return self.run.outcome


@dataclass(frozen=True)
class Report:
    """The page of runs, which a notebook displays: `Report([run])`.

    Attributes:
        runs: The runs, at least one.
        title: Title of the page.
    """

    runs: Sequence[Run]
    title: str = ""

    def _repr_html_(self) -> str:
        """Return the page in a frame of its own, so that neither its style nor its key bindings affect the notebook."""
        page = escape(render(self.runs, title=self.title))
        return f'<iframe srcdoc="{page}" title="Report" style="width: 100%; height: 60rem; border: 0"></iframe>'


def write_report(
    runs: Sequence[Run], folder: str | Path, *, title: str = "", pictures: Sequence[Sequence[Picture]] | None = None
) -> Path:
    """Write report.html to a folder and return its path.

    The page has a section for each run, and a table of the runs if there are several.

    Args:
        runs: The runs.
        folder: The folder, which is created if it does not exist.
        title: Title of the page.
        pictures: First-person pictures of each run, ordered by time; None for those of the recordings.

    Raises:
        ValueError: There is no run to report.
    """
    if not runs:
        raise ValueError("a report needs at least one run")
    make_folder(folder)
    path = Path(folder) / "report.html"
    write_whole(path, render(runs, title=title, pictures=pictures))
    return path


def render(runs: Sequence[Run], *, title: str = "", pictures: Sequence[Sequence[Picture]] | None = None) -> str:
    """Return the page; see `write_report`."""
    environment = page_environment()
    environment.filters["place"] = place_words
    environment.filters["source"] = source_of
    taken = [pictures_of(run) for run in runs] if pictures is None else pictures
    sections = [
        _section(run, shown, f"run-{number}", alone=len(runs) == 1)
        for number, (run, shown) in enumerate(zip(runs, taken, strict=True), start=1)
    ]
    return environment.get_template(TEMPLATE).render(
        title=title or (runs[0].outcome.name if len(runs) == 1 else f"{len(runs)} conflicts"),
        sections=sections,
        state_colours=STATE_COLOURS,
        whole={measure.name for measure in MEASURES if measure.whole},
        player_head=player_head(),
        player_start=player_start(),
    )


def _section(run: Run, pictures: Sequence[Picture], anchor: str, *, alone: bool) -> Section:
    drawn, player, frames = {}, "", _frames(pictures)
    if run.recording.present[:, :1].any():
        drawn = {
            "time": plots.timeline_plot(run, f"{anchor}-time"),
            "near": plots.close_up_map(run, f"{anchor}-near"),
            "map": plots.overview_map(run, f"{anchor}-map"),
        }
        player = player_place([run], [pictures], "" if alone else anchor)
    summary = summary_of(run)
    return Section(
        anchor=anchor,
        run=run,
        summary=summary,
        outcome_words=summary.outcome,
        classification=classification(run),
        frames=frames,
        player=player,
        plots=drawn,
        conditions=conditions(run),
        command=command(run),
        events=folded(run.recording.events),
    )


def _frames(pictures: Sequence[Picture]) -> tuple[Picture, ...]:
    """Return the first picture of each label, by time, without those of a series."""
    first = {one.label: one for one in reversed(pictures) if one.label}
    return tuple(sorted(first.values(), key=lambda one: one.t))
