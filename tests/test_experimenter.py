"""The experimenter decides when the automation requests, warns and takes back, and how it drives before and after."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Outcome, Recording
from tests.studies.study import compiled, row_at, runs, time_of

CONFLICT = """<scenarios version="1"><scenario name="button" map="motorway" duration="{duration}" control_every="2">
<ego speed="20"><start><spawn_point name="middle_lane"/></start>
    <forward_sensor range="300"/></ego>{body}</scenario></scenarios>"""


def played(folder: Path, body: str, duration: float = 12.0) -> tuple[Recording, Outcome]:
    return next(runs(compiled(folder, CONFLICT.format(body=body, duration=duration)), range(1, 2)))


def test_a_request_a_warning_and_a_hand_back_come_when_their_triggers_say(tmp_path: Path) -> None:
    buttons = "".join(
        f'<when><time after="{at}"/><do>{what}</do></when>'
        for at, what in ((1, "<warn/>"), (3, "<request/>"), (8, "<hand_back/>"))
    )
    recording, outcome = played(tmp_path, buttons + '<takeover><driver takeover_time="2"/></takeover>')
    times = {event.kind: event.t for event in reversed(recording.events)}
    assert outcome.cause == "scheduled"
    assert times["warning"] == pytest.approx(1.0, abs=0.1501)
    assert times["request"] == pytest.approx(3.0, abs=0.1501)
    assert times["response"] == pytest.approx(times["request"] + 2.0, abs=0.1001)
    assert times["hand_back"] == pytest.approx(8.0, abs=0.1501)
    assert times["activation"] == pytest.approx(times["hand_back"] + 0.1, abs=1e-6)


def test_a_request_may_have_any_cause_whether_enabled_or_not(tmp_path: Path) -> None:
    body = (
        '<when><time after="2"/><do><request cause="sensor_health"/></do></when>'
        '<takeover><cause kind="path_blocked"/><driver takeover_time="2"/></takeover>'
        '<criteria><requested cause="sensor_health"/></criteria>'
    )
    _, outcome = played(tmp_path, body, 4.0)
    assert (outcome.cause, outcome.result) == ("sensor_health", "pass")


def test_buttons_have_no_effect_where_they_have_no_meaning(tmp_path: Path) -> None:
    body = (
        '<when><time after="1"/><do><hand_back/></do></when><when><time after="2"/><do><request/></do></when>'
        '<when><time after="6"/><do><request/><warn/></do></when><takeover><driver takeover_time="2"/></takeover>'
    )
    recording, _ = played(tmp_path, body, 9.0)
    kinds = [event.kind for event in recording.events]
    assert kinds.count("request") == 1
    assert "hand_back" not in kinds
    assert "warning" not in kinds


@pytest.mark.parametrize("buttons", ["<hand_back/><request/>", "<hand_back/>", "<request/>"])
def test_a_request_while_control_is_handed_back_comes_when_the_automation_drives(buttons: str, tmp_path: Path) -> None:
    body = (
        '<when><time after="1"/><do><request/></do></when>'
        '<when><time after="6"/><do>{}</do></when><when><time after="6.1"/><do>{}</do></when>'
        '<takeover {}><driver takeover_time="2"/></takeover>'
    )
    first, second, handing = {
        "<hand_back/><request/>": (buttons, "<warn/>", ""),
        "<hand_back/>": (buttons, "<request/>", ""),
        "<request/>": ("<warn/>", buttons, 'hand_back_after="3"'),
    }[buttons]
    recording, outcome = played(tmp_path, body.format(first, second, handing), 12.0)
    activation = time_of(recording, "activation")
    assert [one.number for one in outcome.takeovers] == [1, 2]
    assert outcome.takeovers[1].request_time == pytest.approx(activation + 0.1, abs=1e-6)


AHEAD = '<dynamic id="slow" speed="12"><start><ahead_of entity="ego" distance="70"/></start></dynamic>'
BLOCKED = '<static id="parked"><at><ahead_of entity="ego" distance="{}"/></at></static>'
POLICY = """<when><time after="4"/><do><request/></do></when>
<takeover budget="5" minimum_risk_after="30"><driver preset="absent"/>{}</takeover>"""


@pytest.mark.parametrize(
    ("automation", "before", "after"),
    [
        ("", "slower", "slower"),
        ('<automation before="hold_speed"/>', "same", "slower"),
        ('<automation before="hold_speed" after="hold_speed"/>', "same", "same"),
        ('<automation before="hold_speed" after="slow_down" deceleration="1.5"/>', "same", "slower"),
    ],
)
def test_what_the_automation_does_before_and_after_a_request(
    automation: str, before: str, after: str, tmp_path: Path
) -> None:
    recording, _ = played(tmp_path, AHEAD + POLICY.format(automation), 7.0)
    v = recording.v[:, 0]
    asked = row_at(recording, time_of(recording, "request"))
    assert {"same": abs(v[asked] - 20.0) < 0.2, "slower": v[asked] < 19.0}[before]
    assert {"same": abs(v[-1] - v[asked]) < 0.2, "slower": v[-1] < v[asked] - 0.5}[after]


def test_without_a_minimum_risk_manoeuvre_the_car_drives_on_until_somebody_responds(tmp_path: Path) -> None:
    policy = '<takeover budget="4"{}><driver {}/><automation after="hold_speed"/></takeover>'
    for switch, kinds in (("", {"request", "minimum_risk"}), (' minimum_risk="false"', {"request", "collision"})):
        body = BLOCKED.format(200) + policy.format(switch, 'preset="absent"')
        recording, outcome = played(tmp_path, body, 30.0)
        assert kinds == {one.kind for one in recording.events} & {"request", "minimum_risk", "collision"}
    assert outcome.resolution == "unanswered"
    _, outcome = played(tmp_path, BLOCKED.format(200) + policy.format(switch, 'takeover_time="1"'), 30.0)
    assert (outcome.resolution, outcome.collision_with) == ("driver", None)


def test_after_let_go_the_automation_neither_steers_nor_brakes(tmp_path: Path) -> None:
    """On the right-hand curve of the motorway, 800 m radius, the car goes on straight at once."""
    curve = CONFLICT.replace('<spawn_point name="middle_lane"/>', '<lane road="2" lane="-2" s="900"/>')
    body = """<when><time after="2"/><do><request/></do></when>
    <takeover minimum_risk_after="1"><driver takeover_time="{}"/><automation after="let_go"/></takeover>"""
    found = compiled(tmp_path, curve.format(body=body.format(4), duration=12.0))
    recording, _ = next(runs(found, range(1, 2)))
    asked, answered = (row_at(recording, time_of(recording, kind)) for kind in ("request", "response"))
    assert time_of(recording, "minimum_risk") == float("inf")
    assert np.abs(recording.steer[asked + 20 : answered, 0]).max() < 1e-9
    assert recording.v[asked, 0] - recording.v[answered, 0] == pytest.approx(0.4 * 4.0, rel=0.1)
    assert np.abs(recording.off[asked:answered, 0]).max() > 0.5 or np.unique(recording.lane[asked:answered, 0]).size > 1


def test_slowing_down_has_the_deceleration_that_is_given(tmp_path: Path) -> None:
    recording, _ = played(tmp_path, POLICY.format('<automation after="slow_down" deceleration="1.5"/>'), 8.0)
    at = [row_at(recording, time) for time in (5.0, 7.0)]
    assert np.diff(recording.v[at, 0])[0] / 2.0 == pytest.approx(-1.5, rel=0.05)


@pytest.mark.parametrize("budget", [4.0, 6.0])
def test_budgets_are_times_to_the_limit_at_unchanged_speed(budget: float, tmp_path: Path) -> None:
    body = BLOCKED.format(250) + (
        f'<takeover><cause kind="path_blocked" budget="{budget}" warning_budget="{budget + 3}"/>'
        '<driver preset="absent"/></takeover>'
    )
    recording, outcome = played(tmp_path, body, 14.0)
    assert outcome.measures["time_budget"].value == pytest.approx(budget, abs=0.1001)
    assert recording.v[row_at(recording, time_of(recording, "request")), 0] == pytest.approx(20.0, rel=0.01)
    assert time_of(recording, "request") - time_of(recording, "warning") == pytest.approx(3.0, abs=0.1001)
