"""Takes driver models through a study: the same steps and the same files as for people.

The driver of each trial is drawn again, without properties of a person that persist from one trial to the next. Answers
to questionnaires and probes are drawn uniformly, so that tables have their form; they have no meaning. A model does no
secondary task.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from scenario_compiler.randomness import hash_bits, uniform
from scenario_compiler.recording.outcome import judge
from scenario_compiler.report.folder import write_run_folder
from scenario_compiler.report.run import Run
from scenario_compiler.runtime import open_world, run
from scenario_compiler.source.study import ChoiceItem, NumberItem, Query, QuestionnaireElement, ScaleItem
from scenario_compiler.study.dataset import RunTables, Seat, planned_run, seats_of, write_dataset
from scenario_compiler.study.journal import Journal, step_reached
from scenario_compiler.study.procedure import Step, procedure
from scenario_compiler.study.situation import CHOICES
from scenario_compiler.study_plans import StudyCompilation
from scenario_compiler.trust import Trust


def run_pilot(
    compilation: StudyCompilation,
    root: Path,
    *,
    trust: Trust | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Take driver models through a study, and write its data; existing data are not made again.

    Args:
        compilation: The study, whose plans must have a driver model.
        root: Folder of the data.
        trust: The user's own code that plans may use.
        progress: Called with the number of finished sessions, and of all.
    """
    study = compilation.study
    seats = seats_of(study, root)
    for count, seat in enumerate(seats, 1):
        journal = Journal(seat.journal)
        try:
            for step in procedure(study, seat.participant, seat.session)[step_reached(journal.records) : -1]:
                _go_through(compilation, seat, step, journal, trust)
        finally:
            journal.close()
        RunTables(compilation, seat).write()
        if progress is not None:
            progress(count, len(seats))
    write_dataset(compilation, root, pilot=True)


def _go_through(compilation: StudyCompilation, seat: Seat, step: Step, journal: Journal, trust: Trust | None) -> None:
    study = compilation.study
    stream = f"pilot/{seat.session}/{step.number}"
    if step.trial is None:
        asked = compilation.file.questionnaires[step.file] if step.kind == "ask" else None
        answers = {} if asked is None else _answers(asked, study.seed, seat.participant, stream)
        journal.add("done", step.number, answers=answers)
        return
    trial = step.trial
    planned = planned_run(compilation, trial)
    folder = seat.run_folder(trial.number, 1)
    with open_world("kinematic", planned.plan, planned.network) as world:
        recording = run(planned.plan, world, trial.seed, trust=trust)
    outcome = judge(planned.plan, recording)
    write_run_folder(Run(planned.plan, planned.network, recording, outcome), folder, report=False)
    if trial.probe_at is not None and study.probe is not None and trial.probe_at <= outcome.duration:
        given = {one.name: _guess(one, study.seed, seat.participant, stream) for one in study.probe.queries}
        journal.add("probe", step.number, attempt=1, t=trial.probe_at, answers=given)
    marks = ["broken_off"] if outcome.result == "error" else []
    journal.add("driven", step.number, attempt=1, marks=marks, driven_by="model")
    journal.add("done", step.number)


def _answers(asked: QuestionnaireElement, seed: int, participant: int, stream: str) -> dict[str, int | float | str]:
    """Return uniformly drawn answers; free texts are left out."""
    found: dict[str, int | float | str] = {}
    for item in asked.items:
        share = uniform(seed, participant, f"{stream}/{item.name}")
        if isinstance(item, ScaleItem):
            scale = asked.scale_of(item)
            found[item.name] = scale.least + int(share * (scale.most - scale.least + 1))
        elif isinstance(item, NumberItem):
            found[item.name] = round(item.least + share * (item.most - item.least), 1)
        elif isinstance(item, ChoiceItem):
            found[item.name] = item.options[int(share * len(item.options))].value
        else:
            found[item.name] = ""
    return found


def _guess(query: Query, seed: int, participant: int, stream: str) -> str:
    drawn = hash_bits(seed, participant, f"{stream}/{query.name}")
    choices = CHOICES.get(query.about)
    if choices is not None:
        return choices[drawn % len(choices)]
    return str(drawn % (80 if query.about == "speed" else 6))
