"""Reports parts of a study that have no effect, or another effect than their author may believe."""

from __future__ import annotations

from collections.abc import Hashable, Iterable

from scenario_compiler.diagnostics import Diagnostics, Related
from scenario_compiler.markup.names import first_at
from scenario_compiler.source.study import (
    EQUAL_LEVELS,
    FOIL_OF_A_TRIAL,
    IDLE_PART,
    LATE_CONSENT,
    WRONG_TOLERANCE,
    Consent,
    Hmi,
    InstructionPage,
    Probe,
    QuestionnaireElement,
    ScaleItem,
    Setting,
    StudyElement,
    StudyScenario,
    conditions_of,
)


def report_idle(study: StudyElement, sink: Diagnostics) -> None:
    """Report equal levels, foils of trials, probes that never come, tolerances without effect, and late consents."""
    _report_equal([(one, one.target) for one in study.scenarios], sink)
    _report_equal([(one, tuple(told.model_dump_json() for told in one.messages)) for one in study.hmis], sink)
    _report_equal(
        [(one, frozenset((value.parameter, value.to) for value in one.values)) for one in study.settings], sink
    )
    _report_foils(study, sink)
    if study.probe is not None:
        _report_probe(study.probe, sink)
    _report_consent(study, sink)


def report_unreached_break(study: StudyElement, sink: Diagnostics) -> None:
    """Report a break that never comes, because a session has too few trials."""
    runs = study.repetitions * len(conditions_of(study)) + sum(foil.count for foil in study.foils)
    if study.pause is not None and study.pause.every >= runs:
        message = f"no break comes: a session has {runs} {'trial' if runs == 1 else 'trials'}"
        sink.add(IDLE_PART, message, study.pause.place_of("every"))


def report_unused(questionnaire: QuestionnaireElement, sink: Diagnostics) -> None:
    """Report scales that no item uses; if an item names an unknown scale, it may mean the one that seems unused."""
    used = {one.scale for one in questionnaire.items if isinstance(one, ScaleItem)}
    if not used <= {one.name for one in questionnaire.scales}:
        return
    for scale in questionnaire.scales:
        if scale.name not in used:
            sink.add(IDLE_PART, f"no item uses the scale '{scale.name}'", scale.place_of("name"))


def _report_equal(levels: Iterable[tuple[StudyScenario | Hmi | Setting, Hashable]], sink: Diagnostics) -> None:
    first: dict[Hashable, StudyScenario | Hmi | Setting] = {}
    for one, content in levels:
        if not one.name:
            continue
        other = first.setdefault(content, one)
        if other is not one:
            message = f"<{one.tag()}> '{one.name}' is the same as '{other.name}'"
            sink.add(EQUAL_LEVELS, message, one.place_of("name"), related=first_at(other.place_of("name")))


def _report_foils(study: StudyElement, sink: Diagnostics) -> None:
    trials = {one.target: one for one in reversed(study.scenarios)}
    for foil in study.foils:
        if foil.target in trials:
            trial = trials[foil.target]
            message = f"the foil runs the scenario of the trials '{trial.name}', so their event happens in it"
            related = (Related("the trials' scenario is here", trial.place_of("target")),)
            sink.add(FOIL_OF_A_TRIAL, message, foil.place_of("target"), related=related)


def _report_probe(probe: Probe, sink: Diagnostics) -> None:
    if probe.share == 0.0:
        sink.add(IDLE_PART, "no probe comes: its share is 0", probe.place_of("share"))
    for query in probe.queries:
        if query.about in ("control", "blocked") and query.tolerance > 0.0:
            message = f"'{query.name}' is answered by a choice, so the tolerance has no effect"
            sink.add(WRONG_TOLERANCE, message, query.place_of("tolerance"))
        elif query.about == "speed" and query.tolerance == 0.0:
            message = f"'{query.name}' has no tolerance: hardly any answer is exact to a tenth of a km/h"
            sink.add(WRONG_TOLERANCE, message, query.place_of("about"))


def _report_consent(study: StudyElement, sink: Diagnostics) -> None:
    steps = () if study.before is None else study.before.steps
    seen: set[str] = set()
    for k, step in enumerate(steps):
        if not isinstance(step, Consent):
            continue
        if step.file in seen:
            sink.add(LATE_CONSENT, f"'{step.file}' is asked for already", step.place_of("file"))
        elif earlier := [one for one in steps[:k] if not isinstance(one, Consent | InstructionPage)]:
            message = f"<{earlier[0].tag()}> is recorded before the participant consents"
            sink.add(LATE_CONSENT, message, step.place_of("file"))
        seen.add(step.file)
