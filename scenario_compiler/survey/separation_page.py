"""The table of a library's scenarios with four drivers, as a page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from scenario_compiler.files import split_target
from scenario_compiler.survey.separating import ATTENTIVE, DRIVERS, SEED, SLOW, Driven, Separated
from scenario_compiler.vocabulary.sensors import Perception

SEEN_BY: dict[Perception, str] = {
    "ideal": "ideal perception",
    "camera": "the camera",
    "surrogate": "the camera's surrogate",
}
TITLE = "# Drivers that the library separates"
HEAD = (
    "",
    "<!-- written by scenario-compiler library DIR --separation PAGE -->",
    "",
    "Each scenario is run with four drivers in place of its own, with {seen_by} and the seed "
    f"{SEED}, and judged by its own criteria: they are the same for all four, and none is about the takeover time. "
    "`<no_obstruction/>` is broken by a stop in a lane in which nothing ahead holds the car "
    "([after the request](takeover.md#after-the-request)). [library.md](library.md#drivers-with-the-camera) says how "
    "five of them differ between ideal perception and the camera.",
    "",
    "| driver | |",
    "|---|---|",
    f"| attentive | answers after {ATTENTIVE:g} s, the median of the catalog's `study_means` |",
    f"| slow | answers after {SLOW:g} s, the median of drivers who were busy reading (Eriksson and Stanton 2017, as "
    "later works quote it) |",
    "| absent | never answers |",
    "| reference | the fuzzy safety model (Mattas et al. 2020), who answers at once, keeps his lane and brakes. The "
    "careful and competent driver after UN R157 cannot be it: he brakes from 2 s before a collision, which is too late "
    "at any gap from 57 km/h of closing speed on |",
    "",
    "The answer comes at a control step, so that the takeover time may be up to one period longer.",
    "",
)


def separation_page(found: Sequence[Separated], perception: Perception = "ideal") -> str:
    """Return the page of runs with a perception."""
    ran = [one for one in found if not one.fault]
    head = (line.replace("{seen_by}", SEEN_BY[perception]) for line in HEAD)
    lines = [TITLE, *head, _summary(ran), ""]
    silent = [one for one in ran if not one.asks]
    if silent:
        lines += ["These never ask:", "", *(f"- `{one.name}`: {one.summary}" for one in silent), ""]
    for title, group in (
        ("Where the slow or the absent driver fails", [one for one in ran if one.separates]),
        ("Where neither does", [one for one in ran if not one.separates]),
    ):
        lines += [f"## {title}", "", *_table(group), ""]
    faulty = [one for one in found if one.fault]
    if faulty:
        lines += ["## Not run", "", *(f"- `{one.name}`: {one.fault}" for one in faulty), ""]
    return "\n".join(lines)


def _summary(ran: Sequence[Separated]) -> str:
    parts = [
        f"{sum(one.separates for one in ran)} of {len(ran)} scenarios fail for the slow or the absent driver",
        *(
            f"{sum(one.drivers[name].result == 'fail' for one in ran)} for the {name} driver"
            for name in ("attentive", "reference")
        ),
    ]
    return f"**{parts[0]}, {parts[1]} and {parts[2]}.**"


def _table(group: Sequence[Separated]) -> list[str]:
    if not group:
        return ["None."]
    lines = [
        "| scenario | driver | asks for | request, s | takeover time, s | least TTC, s | result | outcome |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for one in group:
        file = Path(split_target(one.target)[0]).stem
        label = f"`{one.name}`" if file == one.name else f"`{file}#{one.name}`"
        lines += [_row(label if name == "attentive" else "", name, one.drivers[name]) for name in DRIVERS]
    return lines


def _row(label: str, name: str, one: Driven) -> str:
    numbers = ("–" if value is None else f"{value:.2f}" for value in (one.request, one.takeover_time, one.minimum_ttc))
    result = f"**{one.result}**: {', '.join(one.broken)}" if one.broken else one.result
    return f"| {' | '.join((label, name, one.cause or '–', *numbers, result, one.outcome))} |"
