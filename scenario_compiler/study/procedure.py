"""The steps of each session, which depend only on the study, the participant and the session."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scenario_compiler.randomness import hash_bits, uniform
from scenario_compiler.source.study import (
    AfterEach,
    Ask,
    Before,
    Consent,
    InstructionPage,
    Practice,
    StudyElement,
    conditions_of,
    square_rows,
)

Role = Literal["trial", "practice", "foil"]

StepKind = Literal["consent", "page", "ask", "break", "drive", "end"]


@dataclass(frozen=True)
class Trial:
    """A run that a participant drives.

    Attributes:
        number: Its number among the runs of the session, from 1; `run` of BIDS.
        role: Whether it is a trial, a practice or a foil.
        what: Name of the condition, or the target of a practice or foil.
        seed: Seed of the run.
        probe_at: Time at which it is frozen for questions, s; None if it is not.
    """

    number: int
    role: Role
    what: str
    seed: int
    probe_at: float | None = None


@dataclass(frozen=True)
class Step:
    """A step of a session.

    Attributes:
        number: Its number in the session, from 0.
        kind: Its kind.
        file: File of its page or questionnaire.
        trial: Its run.
        about: The trial after which a questionnaire is asked; None before and after all trials.
        least: Least duration, s.
    """

    number: int
    kind: StepKind
    file: str = ""
    trial: Trial | None = None
    about: Trial | None = None
    least: float = 0.0


def square_row(count: int, row: int) -> list[int]:
    """Return a row of the balanced Latin square for a number of conditions, as their indices (Williams 1949).

    Each condition is in each position once, and follows each other one equally often: with an even number in `count`
    rows, with an odd one in twice as many, of which the second half is the first one reversed.
    """
    shift = row % square_rows(count)
    first = [(k + 1) // 2 if k % 2 else (count - k // 2) % count for k in range(count)]
    found = [(one + shift) % count for one in first]
    return found[::-1] if shift >= count else found


def order_of(study: StudyElement, participant: int, session: int) -> list[str]:
    """Return the names of the conditions in the order of a participant's session.

    Args:
        study: The study.
        participant: Number of the participant, from 1.
        session: Number of the session, from 1.
    """
    names = [one.name for one in conditions_of(study)]
    found: list[str] = []
    for k in range(study.repetitions):
        block = (session - 1) * study.repetitions + k
        if study.order == "latin_square":
            found += [names[i] for i in square_row(len(names), participant - 1 + block)]
        else:
            found += sorted(names, key=lambda one: hash_bits(study.seed, participant, f"order/{block}/{one}"))
    return found


def driven(study: StudyElement, participant: int, session: int) -> list[tuple[Role, str]]:
    """Return the trials and foils of a session, in order; a foil never comes first."""
    found: list[tuple[Role, str]] = [("trial", one) for one in order_of(study, participant, session)]
    foils = [foil.target for foil in study.foils for _ in range(foil.count)]
    for k, target in enumerate(foils):
        place = 1 + int(uniform(study.seed, participant, f"foil/{session}/{k}") * len(found))
        found.insert(place, ("foil", target))
    return found


class _Steps:
    """Collects the steps of a session."""

    def __init__(self, study: StudyElement, participant: int, session: int) -> None:
        self.study, self.participant, self.session = study, participant, session
        self.steps: list[Step] = []
        self.runs = 0

    def add(self, kind: StepKind, file: str = "", *, about: Trial | None = None, least: float = 0.0) -> None:
        self.steps.append(Step(len(self.steps), kind, file, about=about, least=least))

    def drive(self, role: Role, what: str) -> Trial:
        self.runs += 1
        stream = f"{self.session}/{self.runs}"
        seed = hash_bits(self.study.seed, self.participant, f"trial/{stream}") % 2**31
        trial = Trial(self.runs, role, what, seed, None if role == "practice" else self._probed_at(stream))
        self.steps.append(Step(len(self.steps), "drive", trial=trial))
        return trial

    def _probed_at(self, stream: str) -> float | None:
        probe = self.study.probe
        if probe is None or uniform(self.study.seed, self.participant, f"probed/{stream}") >= probe.share:
            return None
        drawn = uniform(self.study.seed, self.participant, f"probe/{stream}")
        return round(probe.earliest + drawn * (probe.latest - probe.earliest), 2)

    def ask(self, part: Before | AfterEach | None, about: Trial | None = None) -> None:
        for one in () if part is None else part.steps:
            if isinstance(one, Practice):
                self.drive("practice", one.target)
            elif isinstance(one, Ask):
                self.add("ask", one.file, about=about)
            else:
                self.add("consent" if isinstance(one, Consent) else "page", one.file)


def procedure(study: StudyElement, participant: int, session: int) -> tuple[Step, ...]:
    """Return the steps of a participant's session; the last one is its end.

    Args:
        study: The study.
        participant: Number of the participant, from 1.
        session: Number of the session, from 1.
    """
    found = _Steps(study, participant, session)
    found.ask(study.before)
    runs = driven(study, participant, session)
    for k, (role, what) in enumerate(runs, 1):
        trial = found.drive(role, what)
        if role == "trial":
            found.ask(study.after_each, trial)
        pause = study.pause
        if pause is not None and k % pause.every == 0 and k < len(runs):
            found.add("break", pause.file, least=pause.least)
    for one in () if study.after is None else study.after.steps:
        found.add("page" if isinstance(one, InstructionPage) else "ask", one.file)
    found.add("end")
    return tuple(found.steps)
