"""A person's session without a browser: its steps, what a program that ends leaves, and sessions in a row."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, read_source
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.live.session import Picture, Session
from scenario_compiler.live.web import Door
from scenario_compiler.live.wheel import Told
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.study.attendance import Attendance, OutOfPlaceError, Rules
from scenario_compiler.study.server import StudyServer
from scenario_compiler.study.tables import read_table
from scenario_compiler.study_plans import StudyCompilation, compile_study
from tests.live.serving import waited_for
from tests.study import made

ANSWERS = {"hard": "3", "calm": "5", "first": "sound", "more": ""}


def compiled(folder: Path, **changes: str) -> StudyCompilation:
    study = made.study(folder)
    text = study.read_text(encoding="utf-8")
    for old, new in changes.items():
        text = text.replace(f'{old}="2"', f'{old}="{new}"')
    study.write_text(text.replace('<probe from="0.5" to="1.5">', '<probe from="0.2" to="0.4">'), encoding="utf-8")
    conflicts = folder / "conflicts.xml"
    short = (
        conflicts.read_text(encoding="utf-8")
        .replace('duration="8"', 'duration="0.8"')
        .replace('distance="80"', 'distance="76"')
    )
    conflicts.write_text(short, encoding="utf-8")
    read = read_source(study, Diagnostics())
    assert read is not None
    assert isinstance(read[1], StudyFile)
    done = compile_study(read[1], Diagnostics(), overrides=Overrides(perception="ideal", driven_by="person"))
    assert done is not None
    return done


@pytest.fixture
def rules(tmp_path: Path) -> Rules:
    return Rules(compiled(tmp_path, repetitions="1"), tmp_path / "data", None, (64, 36))


def watching(attendance: Attendance) -> Callable[[Picture], bool]:
    """Return a page that says with each picture that nothing is pressed, and answers its probe at once."""

    def show(picture: Picture) -> bool:
        session = attendance.session
        if session is not None and session.wheel is not None and "t" in picture.about:
            session.wheel.tell(Told(seq=1))
        if picture.about.get("held") == "probe":
            attendance.heard("answers", {"answers": {"speed": "36", "driver": "automation"}, "seconds": 1.5})
        return True

    return show


def run_of(attendance: Attendance, *, taken_over: bool = False) -> Session:
    """Begin the run that an attendance has reached, as its page does, and wait for its end.

    The participant may take over before any request.
    """
    assert attendance.cockpit is not None
    session = attendance.begin_run(attendance.step.number, watching(attendance))
    assert session is not None
    attendance.cockpit.session = session
    if taken_over:
        assert session.wheel is not None
        session.wheel.tell(Told(seq=1, take_over=True))
    session.start()
    session.join()
    return session


def kinds(attendance: Attendance) -> list[str]:
    return [one["kind"] for one in attendance.journal.records]


def test_a_session_goes_step_by_step(rules: Rules) -> None:
    one = Attendance(rules, 1)
    with pytest.raises(OutOfPlaceError):
        one.go_on(0, {"agree": "yes"})
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(0, {"agree": "no"})
    with pytest.raises(OutOfPlaceError):
        one.go_on(2, {})
    one.go_on(1, {})
    assert run_of(one).ended
    for wrong in ({}, ANSWERS | {"hard": "8"}, ANSWERS | {"first": "smell"}, ANSWERS | {"more": "x" * 5000}):
        with pytest.raises(OutOfPlaceError):
            one.go_on(3, wrong)
    one.go_on(3, ANSWERS | {"name": "not asked for"})
    run_of(one, taken_over=True)
    one.go_on(5, ANSWERS)
    assert one.presence == "finished"
    one.close()
    assert "name" not in json.dumps([record for record in one.journal.records if record["kind"] == "done"])
    rows = read_table(one.seat.table("short", "beh"))
    assert [(row["run"], row["probe_right"], row["marks"]) for row in rows] == [("1", "2", "n/a"), ("2", "1", "n/a")]
    overrides = [(row["resolution"], row["override_time"], row["takeover_time"]) for row in rows]
    assert overrides == [("open", "n/a", "n/a"), ("no_request", "0.0", "n/a")]
    assert read_table(rules.root / "participants.tsv")[0]["sessions_done"] == "1"


def test_a_run_that_the_program_ends_is_begun_again(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})

    session = one.begin_run(one.step.number, lambda picture: True)
    assert session is not None
    session.start()
    waited_for(lambda: session.held == "probe")
    one.close()
    assert not session.is_alive()
    assert kinds(one)[-1] == "begun"
    again = Attendance(rules, 1)
    assert (again.step.number, again.presence) == (2, "waiting")
    again.start()
    assert run_of(again).number == 2
    again.close()
    assert [row["attempt"] for row in read_table(again.seat.table("short", "beh"))] == ["2"]


def test_who_has_declined_takes_no_part_when_the_program_starts_again(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "no"})
    one.close()
    again = Attendance(rules, 1)
    assert again.presence == "declined"
    again.start()
    assert again.presence == "declined"
    again.close()


def test_a_server_that_ends_stops_all_runs_before_it_waits_for_one(rules: Rules) -> None:
    """A run that went on meanwhile, without its page, would count as driven."""
    study = StudyServer(rules, Door("127.0.0.1", 0), Door("127.0.0.1", 0))
    sessions: list[Session] = []
    stopped: list[bool] = []

    def show(picture: Picture) -> bool:
        if "end" in picture.about:
            waited_for(lambda: not any(one.held for one in sessions), 60.0)  # a run that still waited was not stopped
            stopped.append(True)
        return True

    for one in study.attendances.values():
        one.start()
        one.go_on(0, {"agree": "yes"})
        one.go_on(1, {})
        session = one.begin_run(2, show)
        assert session is not None
        sessions.append(session)
    for session in sessions:
        session.start()
    waited_for(lambda: all(one.held == "probe" for one in sessions))
    study.close()
    assert stopped == [True, True]
    assert [kinds(one)[-1] for one in study.attendances.values()] == ["begun", "begun"]


def test_a_page_of_an_earlier_step_begins_no_run(tmp_path: Path) -> None:
    """A page that is loaded while the files of a run are written is still one of this run's step."""
    done = compiled(tmp_path, repetitions="1")
    study = done.study.model_copy(update={"before": None, "after_each": None})
    one = Attendance(Rules(replace(done, study=study), tmp_path / "data", None, (64, 36)), 1)
    one.start()
    before = one.cockpit_at("0")
    run_of(one)
    assert one.step.trial is not None
    assert one.begin_run(0, lambda _: True) is None
    assert one.cockpit_at("0") is None
    assert one.cockpit_at("1") is one.cockpit is not before
    one.close()


def test_a_session_that_is_paused_begins_no_run_and_stores_the_answers_on_their_way(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.pause()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})
    assert (one.step.number, one.presence) == (2, "paused")
    assert one.begin_run(2, lambda _: True) is None
    one.close()
    again = Attendance(rules, 1)
    again.start()
    run_of(again)
    again.close()
    last = Attendance(rules, 1)  # the participant's form is still open, the experimenter has not pressed Start again
    last.go_on(3, ANSWERS)
    assert (last.step.number, last.presence) == (4, "waiting")
    last.close()


def test_what_is_done_while_the_files_of_a_run_are_written_does_not_count(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})
    assert one.cockpit is not None
    probed, done = watching(one), []

    def late(picture: Picture) -> bool:
        if picture.about.get("over"):  # its files are still to be written
            shown = one.heard("search", {"number": 0, "chosen": 0, "seconds": 1.0})
            done.append(shown is not None and shown["search"]["number"] == 0)
            one.request()
            one.abort()
        return probed(picture)

    session = one.begin_run(2, late)
    assert session is not None
    one.cockpit.session = session
    session.start()
    session.join()
    one.close()
    assert done == [True]
    assert kinds(one)[-4:] == ["begun", "probe", "driven", "done"]
    assert next(record for record in one.journal.records if record["kind"] == "driven")["marks"] == []


@pytest.mark.parametrize(("byhand", "marks"), [(False, ["requested"]), (True, [])])
def test_a_request_marks_a_run_only_if_the_automation_drove(rules: Rules, byhand: bool, marks: list[str]) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})
    assert one.cockpit is not None
    probed = watching(one)

    def asking(picture: Picture) -> bool:
        if picture.about.get("byHand") is byhand and "request" not in picture.about["state"]:
            one.request()
        return probed(picture)

    session = one.begin_run(2, asking)
    assert session is not None
    assert session.wheel is not None
    one.cockpit.session = session
    if byhand:
        session.wheel.tell(Told(seq=1, take_over=True))
    session.start()
    session.join()
    one.close()
    assert "requested" in kinds(one)
    assert next(record for record in one.journal.records if record["kind"] == "driven")["marks"] == marks


def test_tables_that_are_missing_are_made_when_the_program_starts_again(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})
    run_of(one)
    one.close()
    table = one.seat.table("short", "beh")
    before = table.read_bytes()
    table.unlink()
    Attendance(rules, 1).close()
    assert table.read_bytes() == before


@pytest.mark.slow
def test_a_long_session_reads_each_recording_once(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})
    run_of(one)
    (one.seat.run_folder(1, 1) / "recording.parquet").unlink()
    one.go_on(3, ANSWERS)
    run_of(one)
    one.close()
    assert [row["run"] for row in read_table(one.seat.table("short", "beh"))] == ["1", "2"]


@pytest.mark.slow
def test_who_has_finished_a_session_begins_the_next(tmp_path: Path) -> None:
    done = compiled(tmp_path, repetitions="1")
    study = done.study.model_copy(update={"sessions": 2, "before": None, "after_each": None, "task": None})
    done = StudyCompilation(done.file, study, done.conditions, done.others)
    rules = Rules(done, tmp_path / "data", None, (64, 36))
    one = Attendance(rules, 1)
    for session in (1, 2):
        one.start()
        assert (one.seat.session, one.presence) == (session, "started")
        run_of(one)
        run_of(one)
        assert one.presence == "finished"
    one.start()
    assert (one.seat.session, one.presence) == (2, "finished")
    one.close()
    assert read_table(rules.root / "participants.tsv")[0]["sessions_done"] == "2"


NO_ANSWERS: tuple[dict[str, object], ...] = (
    {"answers": {"speed": "36"}, "seconds": 1.0},
    {"answers": {"speed": "36", "driver": "my cat"}, "seconds": 1.0},
    {"answers": {"speed": "36", "driver": "me"}, "seconds": float("nan")},
    {"answers": [], "seconds": 1.0},
    {},
)


def test_answers_that_are_none_leave_the_run_standing(rules: Rules) -> None:
    one = Attendance(rules, 1)
    one.start()
    one.go_on(0, {"agree": "yes"})
    one.go_on(1, {})
    refused: list[Exception] = []

    def show(picture: Picture) -> bool:
        if picture.about.get("held") == "probe" and len(refused) < len(NO_ANSWERS):
            try:
                one.heard("answers", dict(NO_ANSWERS[len(refused)]))
            except (ValueError, KeyError, TypeError) as error:
                refused.append(error)
        elif picture.about.get("held") == "probe":
            one.abort()
        return True

    session = one.begin_run(one.step.number, show)
    assert session is not None
    assert one.cockpit is not None
    one.cockpit.session = session
    session.start()
    session.join()
    one.close()
    assert len(refused) == len(NO_ANSWERS)
    assert "probe" not in kinds(one)
    assert next(record for record in one.journal.records if record["kind"] == "driven")["marks"] == ["aborted"]
