"""Combines the results for all scenarios of a library: what it covers and what it lacks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.files import files_in
from scenario_compiler.languages import parse, read_scenario_document
from scenario_compiler.listing import SUFFIXES, list_library, list_templates
from scenario_compiler.recording.resolution import WITHOUT_REQUEST
from scenario_compiler.source.conflict import Library, Use
from scenario_compiler.survey.duplicates import differences
from scenario_compiler.survey.examining import Examined, examine_all
from scenario_compiler.survey.odd import TERMS
from scenario_compiler.vocabulary.taxonomies import TAXONOMIES


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True)


class Situation(_Part):
    """A situation of a taxonomy, and the scenarios that show it."""

    place: str = Field(description="Its number or name in the taxonomy.")
    meaning: str = Field(
        description="Description; empty for a situation that the taxonomy's public part does not have."
    )
    scenarios: tuple[str, ...] = Field(description="FILE#name of the scenarios that show it.")


class TaxonomyCoverage(_Part):
    """The part of a taxonomy that a library shows."""

    scheme: str = Field(description="Short name of the taxonomy.")
    title: str = Field(description="Its name.")
    source: str = Field(description="Publication that defines its situations.")
    whole: bool = Field(description="All its situations are here; else the publication has more.")
    situations: tuple[Situation, ...] = Field(description="Its situations, those that no scenario shows among them.")


class ConditionCoverage(_Part):
    """A condition of the operational design domain, and where it occurs."""

    tag: str = Field(description="OpenLABEL's tag.")
    words: str = Field(description="The condition in words.")
    group: tuple[str, ...] = Field(description="Its place in the tree, outermost first.")
    scenarios: tuple[str, ...] = Field(description="FILE#name of the scenarios with it.")
    values: dict[str, tuple[float, float]] = Field(description="Least and greatest value of what belongs to it.")


class Alike(_Part):
    """Scenarios whose plans differ only in numbers."""

    scenarios: tuple[str, ...] = Field(description="FILE#name of each.")
    differ: dict[str, dict[str, float]] = Field(description="Numbers that differ, with their value in each scenario.")


class Survey(_Part):
    """The coverage of a library."""

    format: Literal["scenario-compiler/library/1"] = Field(
        default="scenario-compiler/library/1", description="Version of this format."
    )
    folder: str = Field(description="The library.")
    runs: int = Field(description="Number of runs of each scenario, with ideal perception.")
    scenarios: tuple[Examined, ...] = Field(description="Its scenarios.")
    taxonomies: tuple[TaxonomyCoverage, ...] = Field(description="Its situations by taxonomy.")
    conditions: tuple[ConditionCoverage, ...] = Field(description="Its conditions.")
    alike: tuple[Alike, ...] = Field(description="Near-duplicates.")
    never_ask: tuple[str, ...] = Field(description="Scenarios in none of whose runs the automation asked.")
    never_fail: tuple[str, ...] = Field(description="Scenarios all of whose runs passed.")
    broken: tuple[str, ...] = Field(description="Scenarios that cannot be compiled, or of whose runs one broke off.")
    templates: dict[str, tuple[str, ...]] = Field(description="Templates and the scenarios' files that use each.")
    missing: tuple[str, ...] = Field(description="Missing parts, in words.")


def survey(
    folder: Path,
    sink: Diagnostics,
    *,
    runs: int = 0,
    processes: int = 1,
    maps: Sequence[Path] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Survey:
    """Return the coverage of the library in a folder, or of a file; files that cannot be read are reported.

    Args:
        folder: The library.
        sink: Where faults go.
        runs: Number of runs of each scenario, with ideal perception and the seeds from 1 on.
        processes: Number of processes that the scenarios are spread over.
        maps: Folders in which maps are looked for first.
        progress: Called with how many scenarios are done, and of how many.
    """
    targets = [one.target for one in list_library(folder, sink) if one.kind == "conflict"]
    examined = tuple(examine_all(targets, runs=runs, processes=processes, maps=maps, progress=progress))
    templates = used_templates(folder)
    taxonomies, conditions = tuple(_taxonomies(examined)), tuple(_conditions(examined))
    broken = tuple(one.target for one in examined if one.fault or any(ran.result == "error" for ran in one.runs))
    sound = [one for one in examined if one.runs and one.target not in broken]
    found = Survey(
        folder=str(folder),
        runs=runs,
        scenarios=examined,
        taxonomies=taxonomies,
        conditions=conditions,
        alike=tuple(_alike(examined)),
        never_ask=tuple(
            one.target for one in sound if one.automated and all(ran.resolution in WITHOUT_REQUEST for ran in one.runs)
        ),
        never_fail=tuple(one.target for one in sound if one.judged and all(ran.result == "pass" for ran in one.runs)),
        broken=broken,
        templates=templates,
        missing=(),
    )
    return found.model_copy(update={"missing": tuple(missing(found))})


def used_templates(folder: Path) -> dict[str, tuple[str, ...]]:
    """Return the templates that can be named and those in the files, each with the files that use it.

    A template that is used by another one counts as used by that one's files.
    """
    quiet = Diagnostics()
    uses: dict[str, set[str]] = {}
    inner: dict[str, set[str]] = {}
    names = {one.name for one in list_templates(quiet)}
    paths = files_in(folder, *SUFFIXES, deep=True) if folder.is_dir() else [folder]
    for path in paths:
        document = read_scenario_document(path, quiet)
        source = None if document is None else parse(document, quiet)
        if not isinstance(source, Library):
            continue
        names.update(name for name in source.templates if name)
        for name, part in source.templates.items():
            inner[name] = {str(one.get("template", "")) for one in part.element.iter(Use.tag())}
        for part in source.scenarios.values():
            for use in part.element.iter(Use.tag()):
                uses.setdefault(str(use.get("template", "")), set()).add(str(path))
    for _ in inner:
        for name, further in inner.items():
            for one in further:
                uses.setdefault(one, set()).update(uses.get(name, ()))
    return {name: tuple(sorted(uses.get(name, ()))) for name in sorted(names)}


def _taxonomies(examined: Sequence[Examined]) -> Iterator[TaxonomyCoverage]:
    named = dict.fromkeys(scheme for one in examined for scheme, _ in one.places)
    for scheme in dict.fromkeys((*TAXONOMIES, *named)):
        taxonomy = TAXONOMIES.get(scheme)
        known = {} if taxonomy is None else taxonomy.situations
        shown: dict[str, list[str]] = {place: [] for place in known}
        for one in examined:
            for place in (place for where, place in one.places if where == scheme):
                shown.setdefault(place or "not named", []).append(one.target)
        yield TaxonomyCoverage(
            scheme=scheme,
            title=scheme if taxonomy is None else taxonomy.title,
            source="named by the scenarios" if taxonomy is None else taxonomy.source,
            whole=taxonomy is not None and taxonomy.whole,
            situations=tuple(
                Situation(place=place, meaning=known.get(place, ""), scenarios=tuple(dict.fromkeys(targets)))
                for place, targets in shown.items()
            ),
        )


def _conditions(examined: Sequence[Examined]) -> Iterator[ConditionCoverage]:
    for term in TERMS:
        having = [one for one in examined if term.tag in one.tags]
        values: dict[str, list[float]] = {}
        for one in having:
            for name, value in one.tags[term.tag]:
                values.setdefault(name, []).append(float(value))
        ranges = {name: (min(some), max(some)) for name, some in values.items()}
        targets = tuple(one.target for one in having)
        yield ConditionCoverage(tag=term.tag, words=term.words, group=term.group, scenarios=targets, values=ranges)


def _alike(examined: Iterable[Examined]) -> Iterator[Alike]:
    groups: dict[str, list[Examined]] = {}
    for one in examined:
        if one.likeness:
            groups.setdefault(one.likeness, []).append(one)
    for group in groups.values():
        if len(group) > 1:
            targets = tuple(one.target for one in group)
            yield Alike(scenarios=targets, differ=differences({one.target: one.numbers for one in group}))


def missing(found: Survey) -> Iterator[str]:
    """Yield a sentence for each gap of a library."""
    for taxonomy in found.taxonomies:
        absent = [f"{one.place} ({one.meaning})" for one in taxonomy.situations if not one.scenarios]
        if len(absent) == len(taxonomy.situations):
            yield f"No scenario names a situation of {taxonomy.title}."
        elif absent:
            yield f"No scenario shows these situations of {taxonomy.title}: {', '.join(absent)}."
    placed = [one.target for one in found.scenarios if not one.places]
    if placed:
        yield f"{_count(placed)} no <classification>: {', '.join(placed)}."
    groups = dict.fromkeys(one.group for one in found.conditions)
    for group in groups:
        absent = [one.words for one in found.conditions if one.group == group and not one.scenarios]
        if absent:
            yield f"No scenario has these conditions ({', '.join(group)}): {', '.join(absent)}."
    unused = [name for name, files in found.templates.items() if not files]
    if unused:
        yield f"No scenario uses the templates {', '.join(unused)}."
    unjudged = [one.target for one in found.scenarios if not one.fault and not one.judged]
    if unjudged:
        yield f"{_count(unjudged)} no criteria, so that nothing tells good from bad: {', '.join(unjudged)}."


def _count(some: Sequence[str]) -> str:
    return "1 scenario has" if len(some) == 1 else f"{len(some)} scenarios have"
