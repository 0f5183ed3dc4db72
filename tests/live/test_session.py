"""A run in step with the clock: what gives way where the machine is slow, and what stands still."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.live.session import SLOWEST, Drive, Given, Picture, Session
from scenario_compiler.recording.events import EventRow
from scenario_compiler.report.run import Run
from scenario_compiler.worlds import WorldError
from scenario_compiler.worlds.kinematic import KinematicWorld
from tests.live.scenarios import OPEN, SOON


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Compilation:
    file = tmp_path_factory.mktemp("session") / "open.xml"
    file.write_text(OPEN, encoding="utf-8")
    overrides = Overrides(perception="ideal", step=0.02, duration=1.0)
    done = compile_target(file, {}, Diagnostics(), overrides=overrides)
    assert done is not None
    return done


def drive(compiled: Compilation) -> Drive:
    return Drive(compiled.plan, compiled.network, size=(64, 36))


def test_a_run_that_is_behind_leaves_out_pictures_but_not_all(compiled: Compilation) -> None:
    times: list[float] = []

    def slowly(picture: Picture) -> bool:
        if "t" in picture.about:
            times.append(picture.about["t"])
            time.sleep(0.15)  # longer than from one picture to the next
        return True

    session = Session(drive(compiled), slowly)
    session.run()
    figures = session.figures()
    assert figures["pictures_lost"] > 0
    assert figures["pictures_shown"] == len(times)
    assert figures["pictures_shown"] + figures["pictures_lost"] == 26  # one each 0.04 s of 1 s, and the first
    gaps = [later - earlier for earlier, later in pairwise(times)]
    assert max(gaps) <= SLOWEST + 1e-6


def test_a_run_stands_still_for_its_probe_and_shows_nothing_meanwhile(compiled: Compilation) -> None:
    shown: list[tuple[str, float, int]] = []

    def show(picture: Picture) -> bool:
        shown.append((picture.about.get("held", ""), picture.about.get("t", math.nan), len(picture.ahead)))
        if [why for why, _, _ in shown].count("probe") == 3:
            session.go_on()
        return True

    runs: list[Run] = []
    session = Session(drive(compiled), show, probe_at=0.5, kept=lambda _, run: runs.append(run))
    session.run()
    held = [row for row, (why, _, _) in enumerate(shown) if why == "probe"]
    assert len(held) == 3
    assert held == list(range(held[0], held[0] + 3))
    before, after = (shown[row][1] for row in (held[0] - 1, held[-1] + 1))
    assert 0.5 - SLOWEST <= before < 0.5 < after <= 0.5 + SLOWEST  # a machine that is behind leaves out pictures
    assert all(size == 0 for why, _, size in shown if why == "probe")
    assert [run.recording.t[-1] for run in runs] == [pytest.approx(1.0)]


def test_the_page_learns_that_a_run_is_over_before_its_files_are_written(compiled: Compilation) -> None:
    told: list[str] = []

    def show(picture: Picture) -> bool:
        told.extend(one for one in ("over", "end") if one in picture.about)
        return True

    Session(drive(compiled), show, kept=lambda *_: told.append("written")).run()
    assert told == ["over", "written", "end"]


def test_what_happens_while_the_files_are_written_does_not_belong_to_the_run(compiled: Compilation) -> None:
    """The page may be loaded again, and the experimenter may press a button, before they know that the run is over."""
    runs: list[Run] = []

    def afterwards(_: object) -> None:
        session.leave()
        session.come_back()
        session.request()
        session.give(Given(modality="tone", by="file"))
        session.abort()

    chosen = replace(drive(compiled), found=afterwards)
    session = Session(chosen, lambda _: True, kept=lambda _, run: runs.append(run))
    assert session.wheel is not None
    session.run()
    assert session.marks == set()
    assert not session.going
    (run,) = runs
    assert run.recording.stop_reason == "duration"
    assert {one.kind for one in run.recording.events}.isdisjoint({"person_left", "person_back", "message_given"})


def test_the_page_and_the_program_learn_why_a_run_broke_off(
    compiled: Compilation, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(*_: object) -> None:
        raise WorldError("the server does not answer")

    monkeypatch.setattr(KinematicWorld, "step", lost)
    texts: list[str] = []
    runs: list[Run] = []

    def show(picture: Picture) -> bool:
        texts.extend([picture.about["end"]] if "end" in picture.about else [])
        return True

    session = Session(drive(compiled), show, kept=lambda _, run: runs.append(run))
    session.run()
    assert texts == [session.ended] == ["the run broke off: the server does not answer"]
    assert session.fault == "the server does not answer"
    assert [run.recording.stop_reason for run in runs] == ["world_lost"]


def test_a_run_that_is_aborted_is_kept_and_marked(compiled: Compilation, tmp_path: Path) -> None:
    kept: list[tuple[set[str], str]] = []

    def keep(one: Session, run: Run) -> None:
        kept.append((set(one.marks), run.recording.stop_reason))

    def show(picture: Picture) -> bool:
        if picture.about.get("t", 0.0) > 0.3:
            session.abort()
        return True

    folder = tmp_path / "run"
    chosen = Drive(compiled.plan, compiled.network, folder=folder, size=(64, 36))
    session = Session(chosen, show, kept=keep)
    session.run()
    assert kept == [({"aborted"}, "user")]
    assert (folder / "recording.parquet").is_file()


def test_each_event_of_a_run_is_passed_on_also_those_of_its_end(compiled: Compilation) -> None:
    passed_on: list[EventRow] = []
    runs: list[Run] = []

    def show(picture: Picture) -> bool:
        if picture.about.get("t", 0.0) > 0.3:
            session.leave()
            session.abort()
        return True

    session = Session(drive(compiled), show, kept=lambda _, run: runs.append(run), happened=passed_on.append)
    session.run()
    assert passed_on == [event for run in runs for event in run.recording.events]
    assert [event.kind for event in passed_on[-2:]] == ["person_left", "stop"]


def test_a_watched_run_is_the_variant_that_was_asked_for(compiled: Compilation) -> None:
    runs: list[Run] = []
    chosen = replace(drive(compiled), variant=17, interpreted=True)
    Session(chosen, lambda picture: True, kept=lambda _, run: runs.append(run)).run()
    assert [run.recording.header.variant for run in runs] == [17]


def test_the_page_counts_down_to_the_minimum_risk_manoeuvre_of_the_cause(tmp_path: Path) -> None:
    file = tmp_path / "soon.xml"
    file.write_text(
        SOON.replace('kind="path_blocked"', 'kind="path_blocked" minimum_risk_after="20"'), encoding="utf-8"
    )
    overrides = Overrides(perception="ideal", duration=1.0)
    done = compile_target(file, {}, Diagnostics(), overrides=overrides)
    assert done is not None
    left: list[tuple[float, float]] = []

    def show(picture: Picture) -> bool:
        if picture.about.get("left") is not None:
            left.append((picture.about["t"], picture.about["left"]))
        return True

    runs: list[Run] = []
    Session(drive(done), show, kept=lambda _, run: runs.append(run)).run()
    (request,) = (event.t for run in runs for event in run.recording.events if event.kind == "request")
    assert left
    assert all(seconds == pytest.approx(request + 20.0 - t, abs=0.051) for t, seconds in left)
