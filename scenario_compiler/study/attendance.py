"""A participant's current session: its step, the possible actions, and its journal."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Literal

from scenario_compiler.live.cockpit import Cockpit
from scenario_compiler.live.session import Drive, Picture, Session
from scenario_compiler.outputs import make_folder
from scenario_compiler.recording.events import EventRow
from scenario_compiler.report.run import Run
from scenario_compiler.source.study import NumberItem, QuestionnaireElement, ScaleItem, SearchTask
from scenario_compiler.study.dataset import RunTables, Seat, answer_fault, planned_run, write_dataset
from scenario_compiler.study.journal import Journal, Record, attempts_at, read_journal, step_reached
from scenario_compiler.study.procedure import Step, Trial, procedure
from scenario_compiler.study.searching import search_picture
from scenario_compiler.study.situation import CHOICES
from scenario_compiler.study.tables import read_table
from scenario_compiler.study_plans import StudyCompilation
from scenario_compiler.trust import Trust

Presence = Literal["waiting", "started", "paused", "declined", "finished"]

LONGEST_NOTE = 2000
"""Greatest length of a note, or of an answer to a query, characters."""


class OutOfPlaceError(ValueError):
    """Something was sent that does not fit the participant's present step; the message says what."""


@dataclass(frozen=True)
class Rules:
    """The common settings of all participants.

    Attributes:
        compilation: The study.
        root: Folder of its data.
        trust: The user's own code that plans may use.
        size: Width and height of the view ahead, pixels.
        world: Name of the world.
        options: Options of the world.
        mark: Receives the events of all participants at once; None if they are not streamed.
        writing: Lock for writing tables of all participants.
    """

    compilation: StudyCompilation
    root: Path
    trust: Trust | None
    size: tuple[int, int]
    world: str = "kinematic"
    options: Mapping[str, object] = field(default_factory=dict)
    mark: Callable[[dict[str, Any]], None] | None = None
    writing: threading.Lock = field(default_factory=threading.Lock)


class Attendance:
    """A participant's session.

    Attributes:
        participant: Number of the participant.
        seat: The session, and the place of its files.
        steps: Its steps.
        journal: Its journal.
        presence: Whether it waits for the experimenter, is going on, or is over.
        cockpit: The wheel of the present step's run; None at other steps.
    """

    def __init__(self, rules: Rules, participant: int) -> None:
        """Continue where the journals of the participant end."""
        self.rules, self.participant = rules, participant
        self.cockpit: Cockpit | None = None
        self._lock = threading.RLock()
        self._closing = False
        self._last: Session | None = None
        self._unwritten = ""
        self._run: dict[str, Any] = {}
        self._open()

    def _open(self) -> None:
        """Open the first session that is not finished, or the last one."""
        study = self.rules.compilation.study
        for session in range(1, study.sessions + 1):
            self.seat = Seat(self.rules.root, self.participant, session)
            self.steps = procedure(study, self.participant, session)
            if step_reached(read_journal(self.seat.journal)) < len(self.steps) - 1:
                break
        self.journal = Journal(self.seat.journal, self._mark)
        self._tables = RunTables(self.rules.compilation, self.seat)
        declined = any(one["kind"] == "declined" for one in self.journal.records)
        self.presence: Presence = "declined" if declined else "waiting"
        self._settle()
        driven = sum(one["kind"] == "driven" for one in self.journal.records)
        if driven != len(read_table(self.seat.table(study.name, "beh"))):  # the program ended before it wrote them
            self._write()

    @property
    def step(self) -> Step:
        """The first step that is not done."""
        return self.steps[step_reached(self.journal.records)]

    @property
    def _admitted(self) -> bool:
        """Whether the experimenter has let the session begin, perhaps before the program was started again."""
        return any(one["kind"] == "started" for one in self.journal.records)

    @property
    def token(self) -> str:
        """A text that changes whenever the participant's page must change."""
        return f"{self.step.number}/{self.presence}"

    @property
    def fault(self) -> str:
        """Why the last run broke off or the last record was not written; empty if neither is the case."""
        return self._unwritten or ("" if self._last is None else self._last.fault)

    @property
    def session(self) -> Session | None:
        """The run under way."""
        cockpit = self.cockpit
        found = None if cockpit is None else cockpit.session
        return found if found is not None and found.is_alive() else None

    def cockpit_at(self, step: str) -> Cockpit | None:
        """Return the wheel of a step's run; None if the session is at another step."""
        with self._lock:
            return self.cockpit if str(self.step.number) == step else None

    def stop(self) -> None:
        """End the current run, which is repeated when the participant continues."""
        self._closing = True
        if self._last is not None:
            self._last.stop()

    def close(self) -> None:
        """End the current run, wait for its files, and close the journal."""
        self.stop()
        if self._last is not None and self._last.is_alive():
            self._last.join(timeout=60.0)
        self.journal.close()

    # What the experimenter does.

    def start(self) -> None:
        """Let the participant begin or continue; after a finished session the next one begins."""
        with self._lock:
            if self.presence == "finished" and self.seat.session < self.rules.compilation.study.sessions:
                self.journal.close()
                self._open()
            if self.presence in ("waiting", "paused"):
                self.journal.add("started", self.step.number)
                self.presence = "started"
            session = self.session
            if session is not None:
                session.resume()

    def pause(self) -> None:
        """Stop the current run, and let the participant wait."""
        with self._lock:
            session = self.session
            if self.presence == "started":
                run = {} if session is None else {"attempt": self._run["attempt"], "t": session.now}
                self.journal.add("paused", self.step.number, **run)
                self.presence = "paused"
            if session is not None:
                session.pause()

    def abort(self) -> None:
        """End and mark the current run; the next step follows."""
        with self._lock:
            session = self.session
            if session is not None and session.going:
                self.journal.add("aborted", self.step.number, t=session.now)
                session.abort()

    def request(self) -> None:
        """Let the automation of the current run request a takeover now."""
        with self._lock:
            session = self.session
            if session is not None and session.going:
                self.journal.add("requested", self.step.number, t=session.now)
                session.request()

    def note(self, text: str) -> None:
        """Write a note of the experimenter."""
        if not text.strip() or len(text) > LONGEST_NOTE:
            raise OutOfPlaceError(f"a note has 1 to {LONGEST_NOTE} characters")
        with self._lock:
            session = self.session
            self.journal.add("note", self.step.number, text=text, t=None if session is None else session.now)

    # What the participant does.

    def go_on(self, number: int, answers: Mapping[str, str]) -> None:
        """Store the answers of a step's page; answers to an earlier step have no effect.

        Answers that arrive when the experimenter has just paused the session, or from a page that was open when the
        program was started again, are stored as well.

        Raises:
            OutOfPlaceError: They do not belong to the step, or an answer is missing or wrong.
        """
        with self._lock:
            step = self.step
            if number < step.number:
                return
            closed = self.presence == "declined" or not self._admitted
            if number > step.number or step.kind in ("drive", "end") or closed:
                raise OutOfPlaceError("this step has not been reached")
            if step.kind == "consent" and answers.get("agree") != "yes":
                self.journal.add("declined", step.number)
                self.presence = "declined"
                return
            kept: dict[str, Any] = {}
            if step.kind == "ask":
                asked = self.rules.compilation.file.questionnaires[step.file]
                fault = answer_fault(asked, answers)
                if fault:
                    raise OutOfPlaceError(fault)
                kept = {"answers": _typed(asked, answers)}
            self.journal.add("done", step.number, **kept)
            self._settle()
        if step.kind == "ask":
            self._write()

    def heard(self, kind: str, message: dict[str, Any]) -> dict[str, Any] | None:
        """Process a message of the driving page that does not concern driving; ValueError for an invalid one.

        The reply to an answer in the secondary task is the next picture. Answers that cannot be written are not taken.
        """
        with contextlib.suppress(OSError), self.writing():
            return self._heard(kind, message)
        return None

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Keep the reason why something cannot be written for the experimenter's page; it is raised nevertheless."""
        try:
            yield
        except OSError as error:
            self._unwritten = str(error)
            raise

    def _heard(self, kind: str, message: dict[str, Any]) -> dict[str, Any] | None:
        if kind == "answers":
            self._answer(message)
            return None
        task, trial = self.rules.compilation.study.task, self.step.trial
        if kind == "search" and task is not None and trial is not None:
            return {"search": self._searched(message, task, trial)}
        return None

    def _answer(self, message: Mapping[str, Any]) -> None:
        probe = self.rules.compilation.study.probe
        with self._lock:
            session = self.session
            if probe is None or session is None or session.held != "probe" or self._run["probed"]:
                return
            answers = {}
            for query in probe.queries:
                given = str(message["answers"][query.name])
                if len(given) > LONGEST_NOTE or given not in CHOICES.get(query.about, (given,)):
                    raise OutOfPlaceError(f"'{query.name}' has no answer of its choices")
                answers[query.name] = given
            attempt, seconds = self._run["attempt"], _seconds(message)
            t = session.now
            self.journal.add("probe", self.step.number, attempt=attempt, t=t, answers=answers, seconds=seconds)
            self._run["probed"] = True
            session.go_on()

    def _searched(self, message: Mapping[str, Any], task: SearchTask, trial: Trial) -> dict[str, Any]:
        """Write an answer to the present picture of the secondary task, if it is one; return the picture to show."""
        with self._lock:
            session, number = self.session, self._run.get("number", 0)
            if session is not None and session.going and message.get("number") == number:
                shown, chosen = search_picture(task, trial.seed, number), int(message["chosen"])
                self.journal.add(
                    "search",
                    self.step.number,
                    attempt=self._run["attempt"],
                    t=session.now,
                    number=number,
                    right=chosen == shown.target,
                    seconds=_seconds(message),
                )
                number = self._run["number"] = number + 1
            return {"number": number, "circles": search_picture(task, trial.seed, number).circles}

    # Runs.

    def _settle(self) -> None:
        """Create the cockpit for the step, or remove it if the step needs none."""
        step = self.step
        self.cockpit = None
        self._run = {}
        if step.kind == "end":
            self.presence = "finished"
        elif step.trial is not None:
            self.cockpit = Cockpit(partial(self.begin_run, step.number), may_stop=False, heard=self.heard)

    def drive(self, trial: Trial) -> Drive:
        """Return the settings of a trial's run."""
        planned, attempt = planned_run(self.rules.compilation, trial), self._run.get("attempt", 1)
        folder = self.seat.run_folder(trial.number, attempt)
        plan, network = planned.plan, planned.network
        return Drive(
            plan,
            network,
            self.rules.world,
            seed=trial.seed,
            trust=self.rules.trust,
            folder=folder,
            size=self.rules.size,
            plain=True,
            options=self.rules.options,
            otherwise=self.rules.compilation.study.language,
        )

    def begin_run(self, number: int, show: Callable[[Picture], bool]) -> Session | None:
        """Return a new run of a step, with files of its own; a run after a crash is another attempt.

        There is none while the session is paused, and none for a page of an earlier step.

        Args:
            number: Number of the step.
            show: Receives the pictures, as of a `Session`.
        """
        with self._lock:
            step = self.step
            if step.trial is None or step.number != number or self.presence != "started":
                return None
            attempt = attempts_at(self.journal.records, step.number) + 1
            self._run = {"attempt": attempt, "number": 0, "probed": False}
            drive = self.drive(step.trial)
            assert drive.folder is not None
            probe_at = step.trial.probe_at
            with self.writing():
                make_folder(drive.folder)
                self.journal.add("begun", step.number, attempt=attempt)
                self._last = Session(drive, show, attempt, probe_at=probe_at, kept=self._keep, happened=self._tell)
            return self._last

    def _mark(self, record: Record) -> None:
        self._unwritten = ""
        if self.rules.mark is not None:
            self.rules.mark({"participant": self.seat.sub, "session": self.seat.ses, **record})

    def _tell(self, event: EventRow) -> None:
        self._mark({"step": self.step.number, **event.model_dump(exclude_defaults=True)})

    def _keep(self, session: Session, run: Run) -> None:
        """Record that a run has ended; called in its thread, before the page is informed."""
        if self._closing:
            return
        with self._lock:
            step = self.step
            broken = run.outcome.result == "error"
            marks = sorted({*session.marks, *(("broken_off",) if broken else ())})
            self.journal.add("driven", step.number, attempt=session.number, marks=marks, driven_by="person")
            self.journal.add("done", step.number)
            self._settle()
        self._write()

    def _write(self) -> None:
        with self.rules.writing:
            self._tables.write()
            write_dataset(self.rules.compilation, self.rules.root, pilot=False)


def _seconds(message: Mapping[str, Any]) -> float:
    """Return the duration in a message, s."""
    found = float(message["seconds"])
    if not 0.0 <= found < 86_400.0:
        raise OutOfPlaceError("a duration is from 0 s to a day")
    return round(found, 3)


def _typed(asked: QuestionnaireElement, answers: Mapping[str, str]) -> dict[str, int | float | str]:
    """Return the answers to the items, with their own types; anything else is left out."""
    found: dict[str, int | float | str] = {}
    for item in asked.items:
        given = answers.get(item.name, "")
        number = int(given) if isinstance(item, ScaleItem) else given
        found[item.name] = float(given) if isinstance(item, NumberItem) else number
    return found
