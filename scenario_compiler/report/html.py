"""The report page: one file of HTML with its style, pictures and tables inside, which needs nothing from outside."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import jinja2

from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.recording import Frame
from scenario_compiler.report import plots
from scenario_compiler.report.palette import STATE_COLOURS, WORDS
from scenario_compiler.report.run import Run
from scenario_compiler.report.wording import (
    Summary,
    classification,
    command,
    conditions,
    fixed,
    place_words,
    summary_of,
    unit_words,
)

TEMPLATE = "report.html.jinja"


@dataclass(frozen=True, slots=True)
class Section:
    """What the template shows of one run."""

    anchor: str
    run: Run
    summary: Summary
    outcome_words: str
    classification: str
    frames: tuple[Frame, ...]
    plots: dict[str, str]
    conditions: list[tuple[str, str]]
    command: str
    events: tuple[EventRow, ...]

    @property
    def outcome(self) -> Outcome:
        """The run's outcome."""
        return self.run.outcome


def write_report(runs: Sequence[Run], folder: Path, *, title: str = "") -> Path:
    """Write report.html into a folder and return its path: a section a run, and a table over several.

    Raises:
        ValueError: When there is no run to report.
    """
    if not runs:
        raise ValueError("a report needs at least one run")
    make_folder(folder)
    path = folder / "report.html"
    write_whole(path, render(runs, title=title))
    return path


def render(runs: Sequence[Run], *, title: str = "") -> str:
    """Return the page."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = fixed
    environment.filters["place"] = place_words
    environment.filters["unit"] = unit_words
    environment.filters["png"] = lambda data: "data:image/png;base64," + base64.b64encode(data).decode()
    environment.filters["words"] = lambda name: WORDS.get(name, name.replace("_", " "))
    sections = [_section(run, f"run-{number}") for number, run in enumerate(runs, start=1)]
    return environment.get_template(TEMPLATE).render(
        title=title or (runs[0].outcome.name if len(runs) == 1 else f"{len(runs)} conflicts"),
        sections=sections,
        state_colours=STATE_COLOURS,
    )


def _section(run: Run, anchor: str) -> Section:
    drawn = {}
    if run.recording.present[:, :1].any():
        drawn = {
            "time": plots.timeline_plot(run, f"{anchor}-time"),
            "near": plots.close_up_map(run, f"{anchor}-near"),
            "map": plots.overview_map(run, f"{anchor}-map"),
        }
    summary = summary_of(run)
    return Section(
        anchor=anchor,
        run=run,
        summary=summary,
        outcome_words=summary.outcome,
        classification=classification(run),
        frames=_frames(run.recording.frames),
        plots=drawn,
        conditions=conditions(run),
        command=command(run),
        events=run.recording.events,
    )


def _frames(frames: tuple[Frame, ...]) -> tuple[Frame, ...]:
    """Return the first picture of each label, by time."""
    first = {frame.label: frame for frame in reversed(frames)}
    return tuple(sorted(first.values(), key=lambda frame: frame.t))
