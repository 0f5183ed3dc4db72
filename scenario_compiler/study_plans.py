"""Compiles a study: the plans of all its trials, with faults of its scenarios at the study's own places."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostic, Diagnostics, Place
from scenario_compiler.files import is_file, split_target
from scenario_compiler.languages import ScenarioNameNeededError
from scenario_compiler.markup.names import UNKNOWN_ARGUMENT, UNKNOWN_SCENARIO
from scenario_compiler.resources import ConflictNotFoundError
from scenario_compiler.source.study import (
    LATE_PROBE,
    NOBODY_TAKES_OVER,
    UNREADABLE_PART,
    Condition,
    Foil,
    Practice,
    Probe,
    SetParameter,
    StudyElement,
    StudyScenario,
    conditions_of,
    located,
)
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.takeover import Message


@dataclass(frozen=True)
class StudyCompilation:
    """A study with the plans of all its trials.

    Attributes:
        file: The study, with its pages and questionnaires.
        study: The study itself.
        conditions: The conditions by name, each with its compilation.
        others: The compilations of practice and foil trials, by their names in the study.
    """

    file: StudyFile
    study: StudyElement
    conditions: Mapping[str, tuple[Condition, Compilation]]
    others: Mapping[str, Compilation]


SILENT = (Message.model_construct(modality=("none",)),)
"""Messages of an interface variant without messages: with an empty list, pages would show their default texts."""


def compile_study(
    source: StudyFile,
    sink: Diagnostics,
    *,
    maps: Sequence[Path] = (),
    overrides: Overrides | None = None,
    trust: Trust | None = None,
) -> StudyCompilation | None:
    """Compile every trial of a study; return None if the sink has errors.

    Faults in a scenario's file are reported there, and only once.

    Args:
        source: The study's file.
        sink: Receives the diagnostics.
        maps: Folders in which maps are looked for first.
        overrides: Values that replace those of the scenarios.
        trust: Code that the user trusts.

    Raises:
        ConfigurationError: The user's configuration file cannot be read.
    """
    study = source.study
    if study is None:
        return None
    compiler = _StudyCompiler(source.document.folder, sink, maps, overrides or Overrides(), trust)
    conditions: dict[str, tuple[Condition, Compilation]] = {}
    for condition in conditions_of(study):
        done = compiler.compiled(condition.scenario, condition)
        if done is not None:
            conditions[condition.name] = condition, done
    if study.probe is not None:
        durations = {one.scenario.name or one.scenario.target: done.plan.duration for one, done in conditions.values()}
        _report_late_probe(study.probe, durations, sink)
    practices = () if study.before is None else study.before.steps
    others: dict[str, Compilation] = {}
    for word in (*practices, *study.foils):
        if isinstance(word, Practice | Foil) and word.target not in others:
            done = compiler.compiled(word)
            if done is not None:
                others[word.target] = done
    return None if sink.has_errors else StudyCompilation(source, study, conditions, others)


@dataclass(frozen=True)
class _StudyCompiler:
    """Compiles the scenarios that a study names, and reports their faults at the study's places."""

    folder: Path
    sink: Diagnostics
    maps: Sequence[Path]
    settings: Overrides
    trust: Trust | None

    def compiled(self, word: StudyScenario | Practice | Foil, condition: Condition | None = None) -> Compilation | None:
        """Compile the scenario that a word names, with the values and messages of a condition; None if that fails."""
        target, place = located(word.target, self.folder), word.place_of("target")
        if not is_file(Path(split_target(target)[0])):
            self._report_missing(word.target, target, place)
            return None
        values = () if condition is None or condition.setting is None else condition.setting.values
        hmi = None if condition is None else condition.hmi
        changed = self.settings if hmi is None else replace(self.settings, messages=hmi.messages or SILENT)
        given, inner = {one.parameter: one.to for one in values}, Diagnostics(insisted=self.sink.insisted)
        try:
            done = compile_target(target, given, inner, maps=self.maps, overrides=changed, trust=self.trust)
        except ScenarioNameNeededError as needed:
            message = f"'{word.target}' has several scenarios"
            self.sink.add(UNREADABLE_PART, message, place, hint=f"name one as FILE#name: {', '.join(needed.names)}")
            return None
        known = {one.identity for one in self.sink.found}
        found = [_in_study(one, place, values) for one in inner.found]
        self.sink.take(one for one in found if one.identity not in known)
        if done is not None and done.plan.controller is None:
            self.sink.add(NOBODY_TAKES_OVER, f"nobody can take over in '{word.target}'", place)
        return done

    def _report_missing(self, name: str, target: str, place: Place) -> None:
        """Report a scenario without a file, by the name that the study gives and by the target for this name."""
        if name == target.rpartition("#")[2]:
            missing = ConflictNotFoundError(name)
            self.sink.add(UNREADABLE_PART, str(missing), place, hint=missing.hint)
        else:
            self.sink.add(UNREADABLE_PART, f"there is no file '{split_target(target)[0]}'", place)


def _report_late_probe(probe: Probe, durations: Mapping[str, float], sink: Diagnostics) -> None:
    """Report a probe that may come after the end of a scenario, by the durations of the scenarios, s."""
    for name, duration in durations.items():
        if max(probe.earliest, probe.latest) >= duration:
            bound, time = ("earliest", probe.earliest) if probe.earliest >= duration else ("latest", probe.latest)
            message = f"the probe comes at {time:g} s at the {bound}, but '{name}' lasts {duration:g} s"
            sink.add(LATE_PROBE, message, probe.place_of("from" if bound == "earliest" else "to"))


def _in_study(one: Diagnostic, target: Place, values: Iterable[SetParameter]) -> Diagnostic:
    """Return a finding on a scenario at the study's own place where the study is at fault: a name or a value in it."""
    if one.code is UNKNOWN_SCENARIO:
        return replace(one, place=target)
    if one.place.file != "--set":
        return one
    named = set(re.findall(r"\w+", one.message))
    meant = next((value for value in values if value.parameter in named), None)
    if meant is None:
        return replace(one, place=target)
    return replace(one, place=meant.place_of("parameter" if one.code is UNKNOWN_ARGUMENT else "to"))
