"""The person at the wheel as the page tells of them: what takes over, when buttons have been heeded, what is kept."""

from __future__ import annotations

import itertools
import json
import math
import threading
from pathlib import Path

import pytest
from pydantic import ValidationError

from scenario_compiler.controllers.person import PersonInput
from scenario_compiler.live.wheel import KEPT_EVERY, InputFile, Told, Wheel
from tests.live.serving import waited_for
from tests.report import made

MAX_STEER = math.radians(40.0)
CAR = made.plan().entities[0].vehicle.model_copy(update={"max_steer": 40.0})
PLAN = made.plan().model_copy(update={"entities": (made.plan().entities[0].model_copy(update={"vehicle": CAR}),)})


@pytest.mark.parametrize(
    ("told", "wish"),
    [
        (Told(seq=1, brake=0.1), "take_over"),
        (Told(seq=1, brake=0.09), ""),
        (Told(seq=1, steer=math.radians(2.1) / 16 / MAX_STEER), "take_over"),
        (Told(seq=1, steer=-math.radians(2.1) / 16 / MAX_STEER), "take_over"),
        (Told(seq=1, steer=math.radians(1.9) / 16 / MAX_STEER), ""),
        (Told(seq=1, throttle=1.0), ""),
        (Told(seq=1, take_over=True), "take_over"),
    ],
)
def test_braking_steering_and_the_button_take_over(told: Told, wish: str) -> None:
    wheel = Wheel(PLAN)
    wheel.tell(told)
    assert wheel.act(0.0, "request").wish == wish


def test_a_button_counts_until_it_has_been_heeded() -> None:
    wheel = Wheel(PLAN)
    wheel.tell(Told(seq=1, take_over=True))
    wheel.tell(Told(seq=2))
    assert [wheel.act(t, "request").wish for t in (0.0, 0.02)] == ["take_over", "take_over"]
    assert wheel.act(0.04, "manual").wish == ""
    assert wheel.act(0.06, "manual").wish == ""
    wheel.tell(Told(seq=3, hand_back=True))
    assert wheel.act(0.08, "manual").wish == "hand_back"
    assert wheel.act(0.10, "automated").wish == ""


def test_a_refused_wish_to_hand_back_is_not_repeated() -> None:
    wheel = Wheel(PLAN.model_copy(update={"control_every": 5}))
    wheel.tell(Told(seq=1, hand_back=True))
    wheel.tell(Told(seq=2))
    wishes = [wheel.act(0.02 * k, "manual").wish for k in range(8)]
    assert wishes == ["hand_back"] * 5 + [""] * 3
    wheel.tell(Told(seq=3, hand_back=True))
    assert [wheel.act(0.2 + 0.02 * k, "manual").wish for k in range(6)] == ["hand_back"] * 5 + [""]
    wheel.tell(Told(seq=4, hand_back=True))
    assert [wheel.act(0.4 + 0.02 * k, state).wish for k, state in enumerate(("automated", "manual"))] == ["", ""]


def test_who_leaves_lets_the_vehicle_stop_and_may_come_back() -> None:
    wheel = Wheel(PLAN)
    wheel.tell(Told(seq=7, throttle=0.5))
    wheel.leave()
    gone = wheel.act(0.0, "manual")
    assert (gone.wish, gone.throttle) == ("leave", 0.0)
    assert wheel.act(0.02, "minimum_risk").wish == ""
    wheel.come_back()
    wheel.tell(Told(seq=1, brake=0.5))
    assert wheel.act(0.04, "minimum_risk").wish == "take_over"
    assert wheel.applied == 1


def test_a_request_is_wanted_until_it_has_come_and_of_the_automation_alone() -> None:
    wheel = Wheel(PLAN)
    wheel.request()
    states = ("automated", "warning", "request", "automated")
    assert [wheel.act(0.02 * k, state).wish for k, state in enumerate(states)] == ["request", "request", "", ""]
    wheel.request()
    assert [wheel.act(t, state).wish for t, state in ((0.1, "manual"), (0.12, "automated"))] == ["", ""]


def test_a_person_who_comes_back_at_once_has_left_nevertheless() -> None:
    wheel = Wheel(PLAN)
    wheel.leave()
    wheel.come_back()
    wheel.tell(Told(seq=1, throttle=0.5))
    assert [wheel.act(0.02 * k, "manual").wish for k in range(2)] == ["leave", "leave"]
    assert wheel.act(0.04, "minimum_risk").wish == ""
    wheel.tell(Told(seq=2, take_over=True))
    assert wheel.act(0.06, "minimum_risk").wish == "take_over"
    assert wheel.act(0.08, "manual").wish == ""


def test_inputs_of_a_page_that_is_silent_count_as_released_and_then_the_vehicle_stops() -> None:
    """A page may say nothing before the person's first input, and for as long as the run stands still."""
    wheel = Wheel(PLAN)
    assert not [k for k in range(200) if (wheel.act(0.02 * k, "manual").wish, wheel.silent) != ("", False)]
    wheel.tell(Told(seq=1, throttle=0.7, steer=0.2))
    inputs = [wheel.act(4.0 + 0.1 * k, "manual") for k in range(23)]
    assert [(one.throttle, one.steer) for one in inputs] == [(0.7, 0.2)] * 6 + [(0.0, 0.0)] * 17
    assert [one.wish for one in inputs] == [""] * 21 + ["leave"] * 2
    wheel.tell(Told(seq=2, brake=1.0))
    released = wheel.act(6.3, "minimum_risk")
    assert (released.brake, released.wish, wheel.silent) == (0.0, "", True)  # a single message may be an old one
    wheel.tell(Told(seq=3, brake=1.0))
    assert wheel.act(6.4, "minimum_risk") == PersonInput(brake=1.0, wish="take_over")
    assert not wheel.silent


def test_a_page_that_speaks_once_a_second_is_silent_but_not_gone() -> None:
    """Browsers let a page in a hidden tab speak that often."""
    wheel = Wheel(PLAN)
    for second in range(5):
        wheel.tell(Told(seq=second + 1, throttle=0.7))
        inputs = [wheel.act(second + 0.1 * k, "manual") for k in range(10)]
        assert [one.throttle for one in inputs] == [0.7 if second == 0 and k < 6 else 0.0 for k in range(10)]
        assert {one.wish for one in inputs} == {""}


def test_inputs_are_written_as_they_happen(tmp_path: Path) -> None:
    file = tmp_path / "inputs.jsonl"
    wheel = Wheel(PLAN, file)
    wheel.tell(Told(seq=1, throttle=0.25))
    steps = int(1.0 / 0.02) + 1
    for k in range(steps):
        wheel.act(k * 0.02, "manual")
    on_disk = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    assert on_disk[-1]["t"] >= 1.0 - KEPT_EVERY
    wheel.close()
    kept = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    assert len(kept) == steps
    assert kept[3] == {"t": 0.06, "throttle": 0.25, "brake": 0.0, "steer": 0.0, "wish": ""}


def test_a_run_does_not_wait_for_a_disk_that_is_busy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    busy, free = threading.Event(), threading.Event()

    def sync(file: int) -> None:
        busy.set()
        free.wait()

    monkeypatch.setattr("scenario_compiler.live.wheel.os.fsync", sync)
    wheel = Wheel(PLAN, tmp_path / "inputs.jsonl")
    wheel.act(KEPT_EVERY, "manual")
    busy.wait()
    for k in range(1, 101):
        wheel.act(KEPT_EVERY + k * 0.02, "manual")
    free.set()
    wheel.close()
    assert len((tmp_path / "inputs.jsonl").read_text(encoding="utf-8").splitlines()) == 101


def acted_for_ever(wheel: Wheel) -> None:
    for k in itertools.count(1):
        wheel.act(KEPT_EVERY + k * 0.02, "manual")


def test_a_disk_that_takes_nothing_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def sync(file: int) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as broken:
        broken.setattr("scenario_compiler.live.wheel.os.fsync", sync)
        wheel = Wheel(PLAN, tmp_path / "inputs.jsonl")
        wheel.act(KEPT_EVERY, "manual")
        with pytest.raises(OSError, match="No space left"):
            acted_for_ever(wheel)
    wheel.close()


@pytest.mark.parametrize(
    "message",
    [
        {"seq": 1, "throttle": 1.2},
        {"seq": 1, "steer": float("nan")},
        {"seq": -1},
        {"seq": 1, "honk": True},
        {"throttle": 0.2},
    ],
)
def test_messages_beyond_the_limits_are_refused(message: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Told.model_validate(message)


class ClosedMeanwhile(threading.Event):
    """The event of a file that is closed just when its thread has seen that there is something to store."""

    def __init__(self, file: InputFile) -> None:
        super().__init__()
        self.closing = threading.Thread(target=file.close, daemon=True)
        self._asked = threading.Event()

    def set(self) -> None:
        """Set it, and let the thread of the file go on if the file is being closed."""
        super().set()
        if threading.current_thread() is self.closing:
            self._asked.set()

    def clear(self) -> None:
        """Clear it after the file has asked its thread to end."""
        if self.closing.ident is None:
            self.closing.start()
            assert self._asked.wait(60.0)
        super().clear()


def test_a_file_that_is_closed_while_it_is_stored_is_closed(tmp_path: Path) -> None:
    file = InputFile(tmp_path / "inputs.jsonl")
    file._due = due = ClosedMeanwhile(file)
    file.write(b"{}")
    file.keep()
    waited_for(lambda: due.closing.ident is not None)
    due.closing.join(60.0)
    assert not due.closing.is_alive()
    assert (tmp_path / "inputs.jsonl").read_bytes() == b"{}\n"
