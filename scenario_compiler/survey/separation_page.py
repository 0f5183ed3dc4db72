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
    f"{SEED}. The runs are judged by the scenario's criteria, which are the same for all four drivers and do not "
    "depend on the takeover time. A stop in a lane breaks `<no_obstruction/>` unless something ahead holds the car "
    "([after the request](takeover.md#after-the-request)). [library.md](library.md#drivers-with-the-camera) shows, for "
    "five of the scenarios, how the results with the camera differ from those with ideal perception.",
    "",
    "| driver | behaviour |",
    "|---|---|",
    f"| attentive | responds after {ATTENTIVE:g} s, the median of the catalog's `study_means` |",
    f"| slow | responds after {SLOW:g} s, the median of drivers who were busy reading (Eriksson and Stanton 2017, as "
    "later works quote it) |",
    "| absent | never responds |",
    "| reference | the fuzzy safety model (Mattas et al. 2020), which responds at once, keeps its lane and brakes. The "
    "careful and competent driver after UN R157 is not used here: it brakes from 2 s before a collision on, which is "
    "too late at any gap if the closing speed is 57 km/h or more |",
    "",
    "The response takes effect at a control step, so the takeover time may be up to one control period longer.",
    "",
)


def separation_page(found: Sequence[Separated], perception: Perception = "ideal") -> str:
    """Return the page for the runs of a library with the four drivers."""
    ran = [one for one in found if not one.fault]
    head = (line.replace("{seen_by}", SEEN_BY[perception]) for line in HEAD)
    lines = [TITLE, *head, _summary(ran), ""]
    silent = [one for one in ran if not one.asks]
    if silent:
        lines += ["Without a takeover request:", "", *(f"- `{one.name}`: {one.summary}" for one in silent), ""]
    for title, group in (
        ("Scenarios in which the slow or the absent driver fails", [one for one in ran if one.separates]),
        ("Scenarios in which neither of them fails", [one for one in ran if not one.separates]),
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
        "| scenario | driver | cause of the request | request, s "
        "| takeover time, s | least TTC, s | result | outcome |",
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
