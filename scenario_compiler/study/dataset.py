"""The data of a study in the format of BIDS 1.9: a folder for each session, and tables with a codebook.

Journals and run folders are the source (`sourcedata`); all tables are made from them, and can be made again. A table is
tab-separated, with `n/a` for missing values. A JSON file beside it, or above it for all tables of its kind, describes
the columns.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from scenario_compiler.batch.codebook import Column
from scenario_compiler.compiler import Compilation
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.store import read_recording
from scenario_compiler.source.study import (
    ChoiceItem,
    NumberItem,
    QuestionnaireElement,
    ScaleItem,
    StudyElement,
    TextItem,
)
from scenario_compiler.study.journal import Record, read_journal, step_reached
from scenario_compiler.study.procedure import Step, Trial, procedure
from scenario_compiler.study.situation import is_right, true_answer
from scenario_compiler.study.tables import write_table
from scenario_compiler.study_plans import StudyCompilation

BIDS_VERSION = "1.9.0"

Row = dict[str, Any]

EVENT_COLUMNS = (
    Column("onset", "number", "s", "Time from the start of the run."),
    Column("duration", "number", "s", "Duration; missing if the event is instantaneous."),
    Column("trial_type", "text", "", "What happened: an event of the run, probe (an answer to a query), search (an "
           "answer in the secondary task) or paused (by the experimenter; the run's clock stands still)."),
    Column("cause", "text", "", "Cause; of a probe the query, of a search `right` or `wrong`.", "if there is no cause"),
    Column("entity", "text", "", "Id of the entity concerned.", "if there is none"),
    Column("message", "text", "", "Message; of a probe the given and the true answer.", "if there is none"),
    Column("value", "number", "", "Number of the event, SI unit; of a search the time until its answer, s.",
           "if there is none"),
)  # fmt: skip

TRIAL_COLUMNS = (
    Column("participant_id", "text", "", "Participant."),
    Column("session_id", "text", "", "Session."),
    Column("run", "integer", "", "Number of the run in the session, in the order of driving."),
    Column("role", "text", "", "trial, practice or foil."),
    Column("condition", "text", "", "Condition; of a practice or foil trial its scenario."),
    Column("scenario", "text", "", "Level of the factor scenario.", "in practice and foil trials"),
    Column("hmi", "text", "", "Level of the factor hmi.", "without this factor; in practice and foil trials"),
    Column("setting", "text", "", "Level of the factor setting.", "without this factor; in practice and foil trials"),
    Column("attempt", "integer", "", "Number of starts of the run: above 1 if the program ended during it."),
    Column("marks", "text", "", "Deviations from the plan: aborted (by the experimenter), person_left (the page was "
           "closed), person_silent (the page sent nothing for 0.5 s), requested (by the experimenter), paused (by the "
           "experimenter, during the run), broken_off.",
           "if there is none"),
    Column("driven_by", "text", "", "person, or model in a pilot."),
    Column("seed", "integer", "", "Seed of the run."),
    Column("plan_digest", "text", "", "Digest of the plan that was run."),
    Column("result", "text", "", "pass, fail (a criterion of the scenario is not met) or error."),
    Column("resolution", "text", "", "How the first request ended."),
    Column("cause", "text", "", "Cause of the first request.", "if there is no request"),
    Column("override_time", "number", "s", "Time of the first takeover without a request, at a warning for example, "
           "from the start of the run. If no request came afterwards, resolution is no_request, and the times from a "
           "request are missing.", "if nobody took over without a request"),
    Column("recording", "text", "", "Folder of the run, relative to the folder of the study."),
    *(Column(one.name, "number", one.unit, one.definition, one.undefined, one.source) for one in MEASURES),
    Column("probe_right", "integer", "", "Number of right answers in the freeze probe.", "without a probe"),
    Column("probe_asked", "integer", "", "Number of queries of the freeze probe.", "without a probe"),
    Column("search_right", "integer", "", "Right answers in the secondary task.", "without the task; in pilots"),
    Column("search_wrong", "integer", "", "Wrong answers in the secondary task.", "without the task; in pilots"),
    Column("search_time", "number", "s", "Mean time of the answers in the secondary task.", "without an answer"),
)  # fmt: skip


@dataclass(frozen=True)
class Seat:
    """A session of a participant, and the place of its files.

    Attributes:
        root: Folder of the study's data.
        participant: Number of the participant.
        session: Number of the session.
    """

    root: Path
    participant: int
    session: int

    @property
    def sub(self) -> str:
        """The participant's id."""
        return f"sub-{self.participant:02d}"

    @property
    def ses(self) -> str:
        """The session's id."""
        return f"ses-{self.session:02d}"

    @property
    def source(self) -> Path:
        """Folder of the journal and of the runs."""
        return self.root / "sourcedata" / self.sub / self.ses

    @property
    def journal(self) -> Path:
        """The journal."""
        return self.source / "journal.jsonl"

    def run_folder(self, run: int, attempt: int) -> Path:
        """Return the folder of a run."""
        return self.source / f"run-{run:02d}_attempt-{attempt}"

    def table(self, task: str, kind: str, run: int | None = None) -> Path:
        """Return the file of a table of the session, or of a run."""
        part = "" if run is None else f"_run-{run:02d}"
        return self.root / self.sub / self.ses / "beh" / f"{self.sub}_{self.ses}_task-{task}{part}_{kind}.tsv"


def seats_of(study: StudyElement, root: Path) -> list[Seat]:
    """Return all seats of a study, by participant and then by session."""
    numbers = itertools.product(range(1, study.participants + 1), range(1, study.sessions + 1))
    return [Seat(root, participant, session) for participant, session in numbers]


def questionnaire_columns(asked: QuestionnaireElement) -> tuple[Column, ...]:
    """Return the columns of a questionnaire's table."""
    found = [*TRIAL_COLUMNS[:2]]
    found.append(
        Column("run", "integer", "", "Number of the run after which it was asked.", "asked before or after all trials")
    )
    when = "Time of asking: before the trials (`before`, the second time `before_2`), after a `trial`, or `after` all."
    found.append(Column("when", "text", "", when))
    for item in asked.items:
        if isinstance(item, ScaleItem):
            scale = asked.scale_of(item)
            ends = "; ".join(f"{one.at}: {one.text}" for one in scale.labels)
            note = f" ({scale.least} to {scale.most}{'; ' + ends if ends else ''})"
            found.append(Column(item.name, "integer", "", item.text + note))
        elif isinstance(item, NumberItem):
            found.append(Column(item.name, "number", item.unit, item.text))
        elif isinstance(item, ChoiceItem):
            choices = "; ".join(f"{one.value}: {one.text}" for one in item.options)
            found.append(Column(item.name, "text", "", f"{item.text} ({choices})"))
        else:
            found.append(Column(item.name, "text", "", item.text, "left empty"))
    for score in asked.scores:
        reverse = [
            one.name for one in asked.items if isinstance(one, ScaleItem) and one.reverse and one.name in score.of
        ]
        note = f", counted from the other end: {', '.join(reverse)}" if reverse else ""
        found.append(Column(score.name, "number", "", f"The {score.by} of {', '.join(score.of)}{note}."))
    return tuple(found)


def scores_of(asked: QuestionnaireElement, answers: Mapping[str, Any]) -> dict[str, float]:
    """Return the scores for answers; a reversed item counts as least + most - answer."""
    counted: dict[str, float] = {}
    for item in asked.items:
        if isinstance(item, ScaleItem):
            scale = asked.scale_of(item)
            given = float(answers[item.name])
            counted[item.name] = scale.least + scale.most - given if item.reverse else given
        elif isinstance(item, NumberItem):
            counted[item.name] = float(answers[item.name])
    found = {}
    for score in asked.scores:
        total = sum(counted[name] for name in score.of)
        found[score.name] = total / len(score.of) if score.by == "mean" else total
    return found


def answer_fault(asked: QuestionnaireElement, answers: Mapping[str, str]) -> str:
    """Return the fault of the answers (texts by item) to a questionnaire; empty if there is none."""
    for item in asked.items:
        given = answers.get(item.name, "")
        if isinstance(item, TextItem):
            if len(given) > LONGEST_TEXT:
                return f"'{item.name}' has more than {LONGEST_TEXT} characters"
        elif isinstance(item, ChoiceItem):
            if given not in {one.value for one in item.options}:
                return f"'{item.name}' has no answer of its options"
        else:
            ranged = item if isinstance(item, NumberItem) else asked.scale_of(item)
            try:
                number = float(given) if isinstance(item, NumberItem) else int(given)
            except ValueError:
                return f"'{item.name}' has no number"
            if not ranged.least <= number <= ranged.most:
                return f"'{item.name}' is not from {ranged.least:g} to {ranged.most:g}"
    return ""


LONGEST_TEXT = 4000
"""Greatest length of a free answer, characters."""


def planned_run(compilation: StudyCompilation, trial: Trial) -> Compilation:
    """Return the plan of a trial, on its map."""
    if trial.role == "trial":
        return compilation.conditions[trial.what][1]
    return compilation.others[trial.what]


def condition_of(compilation: StudyCompilation, step: Step) -> dict[str, str]:
    """Return the level of each factor in a trial; empty for practice and foils."""
    assert step.trial is not None
    return compilation.conditions[step.trial.what][0].levels if step.trial.role == "trial" else {}


class RunTables:
    """The tables of a session's runs: the events of each run, and one row a run.

    The files of a run that has ended do not change any more, so its recording is read once, however often the tables
    are written.
    """

    def __init__(self, compilation: StudyCompilation, seat: Seat) -> None:
        """Prepare the tables of a session; nothing is read yet."""
        self._compilation, self._seat = compilation, seat
        self._rows: dict[int, Row] = {}

    def write(self) -> None:
        """Write the tables from the session's journal and its run folders."""
        study, seat = self._compilation.study, self._seat
        records = read_journal(seat.journal)
        ended = {one["step"]: one for one in reversed(records) if one["kind"] == "driven"}
        for step in procedure(study, seat.participant, seat.session):
            if step.number in ended and step.number not in self._rows:
                own = [one for one in records if one["step"] == step.number]
                self._rows[step.number] = self._row(step, ended[step.number], own)
        write_table(seat.table(study.name, "beh"), TRIAL_COLUMNS, (self._rows[k] for k in sorted(self._rows)))

    def _row(self, step: Step, ended: Record, records: Sequence[Record]) -> Row:
        """Write the events of a run; return its row."""
        assert step.trial is not None
        seat, trial = self._seat, step.trial
        folder = seat.run_folder(trial.number, ended["attempt"])
        own = [one for one in records if one.get("attempt") == ended["attempt"]]
        recording = read_recording(folder / "recording.parquet")
        outcome = Outcome.model_validate_json((folder / "outcome.json").read_text(encoding="utf-8"))
        plan = planned_run(self._compilation, trial).plan
        events, sums = _events(self._compilation.study, plan, recording, own)
        write_table(seat.table(self._compilation.study.name, "events", trial.number), EVENT_COLUMNS, events)
        return {
            "participant_id": seat.sub,
            "session_id": seat.ses,
            "run": trial.number,
            "role": trial.role,
            "condition": trial.what,
            **condition_of(self._compilation, step),
            "attempt": ended["attempt"],
            "marks": " ".join(ended["marks"]) or None,
            "driven_by": ended["driven_by"],
            "seed": trial.seed,
            "plan_digest": outcome.plan_digest,
            "result": outcome.result,
            "resolution": outcome.resolution,
            "cause": outcome.cause or None,
            "override_time": next((one.t for one in recording.events if one.kind == "override"), None),
            "recording": str(folder.relative_to(seat.root)),
            **{name: one.value for name, one in outcome.measures.items()},
            **sums,
        }


def _events(study: StudyElement, plan: Plan, recording: Recording, own: Sequence[Record]) -> tuple[list[Row], Row]:
    """Return the events of a run, ordered by time, and the results of its probe and secondary task."""
    rows: list[Row] = [
        {
            "onset": event.t,
            "trial_type": event.kind,
            "cause": event.cause or None,
            "entity": event.entity or None,
            "message": event.message or None,
            "value": event.value,
        }
        for event in recording.events
    ]
    sums: Row = {}
    queries = {} if study.probe is None else {one.name: one for one in study.probe.queries}
    for record in (one for one in own if one["kind"] == "probe"):
        sums |= {"probe_asked": len(record["answers"]), "probe_right": 0}
        for name, given in record["answers"].items():
            true = true_answer(queries[name].about, plan, recording, record["t"])
            right = is_right(queries[name], given, true)
            sums["probe_right"] += right
            text = f"{given} / {true}"
            rows.append(
                {"onset": record["t"], "trial_type": "probe", "cause": name, "message": text, "value": int(right)}
            )
    rows += [{"onset": one["t"], "trial_type": "paused"} for one in own if one["kind"] == "paused"]
    searches = [one for one in own if one["kind"] == "search"]
    by_person = any(one["kind"] == "driven" and one["driven_by"] == "person" for one in own)
    if study.task is not None and by_person:
        found = sum(one["right"] for one in searches)
        sums |= {"search_right": found, "search_wrong": len(searches) - found}
        if searches:
            sums["search_time"] = sum(one["seconds"] for one in searches) / len(searches)
    for one in searches:
        cause = "right" if one["right"] else "wrong"
        rows.append({"onset": one["t"], "trial_type": "search", "cause": cause, "value": one["seconds"]})
    return sorted(rows, key=lambda row: row["onset"]), sums


def write_dataset(compilation: StudyCompilation, root: Path, *, pilot: bool) -> None:
    """Write everything on the study as a whole: its description, participants, questionnaires, codebook.

    Args:
        compilation: The study.
        root: Folder of the data.
        pilot: Whether the participants are driver models.
    """
    study = compilation.study
    make_folder(root)
    _write_description(study, root, pilot=pilot)
    answers = _write_participants(study, root)
    task = {"TaskName": study.name, "TaskDescription": study.summary or study.name}
    shown = {"SoftwareName": "scenario-compiler", "SoftwareVersion": version("scenario-compiler")}
    events = task | {"StimulusPresentation": shown}
    _write_json(root / f"task-{study.name}_events.json", events | sidecar(EVENT_COLUMNS))
    _write_json(root / f"task-{study.name}_beh.json", task | sidecar(TRIAL_COLUMNS))
    book = [*_book(f"task-{study.name}_beh", TRIAL_COLUMNS), *_book(f"task-{study.name}_events", EVENT_COLUMNS)]
    for file, asked in compilation.file.questionnaires.items():
        own = questionnaire_columns(asked)
        for seat in seats_of(study, root):
            if rows := [row | scores_of(asked, row) for row in answers.get((file, seat), [])]:
                write_table(seat.table(asked.name, "beh"), own, rows)
        term = {"Description": asked.title or asked.name} | ({"TermURL": asked.source} if asked.source else {})
        about = {"TaskName": asked.name, "TaskDescription": asked.instruction or asked.title or asked.name}
        _write_json(root / f"task-{asked.name}_beh.json", about | {"MeasurementToolMetadata": term} | sidecar(own))
        book += _book(f"task-{asked.name}_beh", own)
    write_table(root / "codebook.tsv", BOOK_COLUMNS, book)


def _write_description(study: StudyElement, root: Path, *, pilot: bool) -> None:
    kind = "a pilot by driver models, no data of people" if pilot else "people at the wheel"
    about = {
        "Name": study.summary or study.name,
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "scenario-compiler", "Version": version("scenario-compiler"), "Description": kind}],
    }
    _write_json(root / "dataset_description.json", about)
    write_whole(root / ".bidsignore", "codebook.tsv\nexpected.html\n*.lock\n")
    write_whole(root / "README", README.format(summary=study.summary or study.name, kind=kind))


def _write_participants(study: StudyElement, root: Path) -> dict[tuple[str, Seat], list[Row]]:
    """Write the table of participants; return the rows of answers by questionnaire and session."""
    people: list[Row] = []
    answers: dict[tuple[str, Seat], list[Row]] = {}
    for participant in range(1, study.participants + 1):
        done = 0
        for session in range(1, study.sessions + 1):
            seat = Seat(root, participant, session)
            steps = procedure(study, participant, session)
            records = read_journal(seat.journal)
            done += bool(records) and step_reached(records) >= len(steps) - 1
            for file, row in _answered(seat, steps, records):
                answers.setdefault((file, seat), []).append(row)
        people.append({"participant_id": f"sub-{participant:02d}", "sessions_done": done})
    columns = (TRIAL_COLUMNS[0], Column("sessions_done", "integer", "", "Number of sessions that are finished."))
    write_table(root / "participants.tsv", columns, people)
    _write_json(root / "participants.json", sidecar(columns))
    return answers


def _answered(seat: Seat, steps: Sequence[Step], records: Iterable[Record]) -> Iterable[tuple[str, Row]]:
    """Yield the file and the row of each answered questionnaire of a session."""
    first = next((one.number for one in steps if one.trial is not None and one.trial.role != "practice"), len(steps))
    for one in records:
        step = steps[one["step"]]
        if one["kind"] == "done" and step.kind == "ask":
            run = None if step.about is None else step.about.number
            when = "trial" if step.about is not None else _place_of(step, steps, first)
            seated = {"participant_id": seat.sub, "session_id": seat.ses}
            yield step.file, {**seated, "run": run, "when": when, **one["answers"]}


def _place_of(step: Step, steps: Sequence[Step], first: int) -> str:
    """Return the place of a questionnaire that is not about a trial; if it was asked there before, a number follows.

    Args:
        step: The step that asks it.
        steps: The steps of the session.
        first: Number of the first step that is no longer before the trials.
    """
    place, before = ("before", 0) if step.number < first else ("after", first)
    times = sum(one.kind == "ask" and one.file == step.file for one in steps[before : step.number] if one.about is None)
    return f"{place}_{times + 1}" if times else place


BOOK_COLUMNS = (
    Column("table", "text", "", "The table that has the column."),
    Column("column", "text", "", "Name of the column."),
    Column("kind", "text", "", "Kind of its values."),
    Column("unit", "text", "", "Unit of its values.", "if they have none"),
    Column("definition", "text", "", "Definition."),
    Column("missing", "text", "", "When a value is missing.", "if there is always a value"),
    Column("source", "text", "", "Source of the definition.", "if it is our own"),
)


def _book(table: str, columns: Iterable[Column]) -> list[Row]:
    return [
        {
            "table": table,
            "column": one.column,
            "kind": one.kind,
            "unit": one.unit or None,
            "definition": one.definition,
            "missing": one.empty or None,
            "source": one.source or None,
        }
        for one in columns
    ]


README = """{summary}

Data of {kind}, in the form of BIDS (behavioural experiments).

sub-*/ses-*/beh/*_beh.tsv     of the study's task, one row a run: condition, how the takeover went, measures;
                              of a questionnaire's, one row each time it was answered, with its scores
sub-*/ses-*/beh/*_events.tsv  what happened in a run
codebook.tsv                  what each column of each table holds
sourcedata/                   journals and run folders (plan, recording in Parquet, inputs), which all tables come from
"""


def sidecar(columns: Iterable[Column]) -> dict[str, dict[str, str]]:
    """Return the contents of the JSON file with descriptions of a table's columns."""
    found = {}
    for one in columns:
        described = {"Description": one.definition}
        described |= {"Units": one.unit} if one.unit else {}
        found[one.column] = described | ({"MissingWhen": one.empty} if one.empty else {})
    return found


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    write_whole(path, json.dumps(content, indent=2, ensure_ascii=False) + "\n")
