"""Findings of the checks beyond their place: source lines, uses, and the effect of the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostic_formats import formatted
from scenario_compiler.diagnostics import Diagnostics, Severity, as_text
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.plan.store import read_plan, write_plan
from scenario_compiler.vocabulary.sensors import Perception

EGO = '<ego speed="12"><start><spawn_point name="main_street"/></start>{}</ego>'
OWN = '<controller model="tests.controllers.own:Steering"/>'


def _file(folder: Path, body: str, inside: str = "") -> Path:
    path = folder / "found.xml"
    head = '<scenarios version="1"><scenario name="found" map="town_grid" duration="5">'
    path.write_text(f"{head}\n{EGO.format(inside)}\n{body}\n</scenario></scenarios>", encoding="utf-8")
    return path


def test_a_finding_on_an_element_shows_its_line_and_the_use_that_brought_it_in(tmp_path: Path) -> None:
    uses = '<use template="blocked_lane" distance="30"/>\n<use template="blocked_lane" distance="31"/>'
    sink = Diagnostics()
    compile_target(_file(tmp_path, uses), {}, sink)
    (overlap,) = [one for one in sink if one.code.id == "SC381"]
    text = as_text(overlap).splitlines()
    assert '<static id="blocker"' in text[1]
    assert text[2].strip() == "^^^^^^^"
    assert text[3].endswith("in this use: " + str(tmp_path / "found.xml:4:1"))
    assert text[4].startswith("      = 'blocked_lane1.blocker' is placed here: ")
    assert text[5:] == text[1:3]


@pytest.mark.parametrize("form", ["json", "sarif", "github"])
def test_an_overlap_points_at_the_other_entity_in_every_format(tmp_path: Path, form: str) -> None:
    body = '<static id="a"><at><ahead_of entity="ego" distance="30"/></at></static>'
    sink = Diagnostics()
    compile_target(_file(tmp_path, body + "\n" + body.replace('"a"', '"b"')), {}, sink)
    text = formatted(sink, form)
    if form == "github":
        assert text.startswith("::error file=")
        assert "line=4,col=1" in text
        assert f"'a' is placed here: {tmp_path / 'found.xml'}:3:1" in text
        return
    found = json.loads(text)
    if form == "json":
        (other,) = found[0]["related"]
        assert (other["message"], other["line"], other["column"]) == ("'a' is placed here", 3, 1)
    else:
        (other,) = found["runs"][0]["results"][0]["relatedLocations"]
        assert other["message"]["text"] == "'a' is placed here"
        assert other["physicalLocation"]["region"] == {"startLine": 3, "startColumn": 1, "endColumn": 8}


def test_a_plan_keeps_no_text_of_a_very_long_line(tmp_path: Path) -> None:
    sink = Diagnostics()
    done = compile_target(_file(tmp_path, "", inside=" " * 3000), {}, sink)
    assert done is not None
    assert place_of(done.plan, "entities/ego").column == 1
    assert place_of(done.plan, "entities/ego").source_line == ""


def test_a_stored_plan_knows_the_lines_too(tmp_path: Path) -> None:
    sink = Diagnostics()
    done = compile_target(_file(tmp_path, '<use template="blocked_lane" distance="30"/>'), {}, sink)
    assert done is not None
    write_plan(done.plan, tmp_path / "plan.json")
    stored = read_plan(tmp_path / "plan.json", sink)
    assert stored is not None
    for part in ("entities/ego", "entities/blocked_lane1.blocker", "controller", "scenario"):
        assert place_of(stored, part) == place_of(done.plan, part)
        assert place_of(stored, part).source_line


@pytest.mark.parametrize(("perception", "told"), [("camera", True), ("surrogate", True), ("ideal", False)])
def test_a_lane_change_that_the_automation_does_not_make_is_reported(
    tmp_path: Path, perception: Perception, told: bool
) -> None:
    sink = Diagnostics()
    change = '<when><time after="1"/><do><lane_change by="1" over_time="4"/></do></when>'
    compile_target(_file(tmp_path, "", change), {}, sink, overrides=Overrides(perception))
    assert ("SC530" in {one.code.id for one in sink}) is told


@pytest.mark.parametrize(
    ("perception", "inside", "controller", "told"),
    [
        ("ideal", OWN, None, True),
        ("ideal", "", "tests.controllers.own:Steering", True),
        ("ideal", "", None, False),
        ("ideal", '<controller model="lane_detection"/>', None, False),
        ("camera", OWN, None, False),
    ],
)
def test_a_controller_that_ideal_perception_never_calls_is_reported(
    tmp_path: Path, perception: Perception, inside: str, controller: str | None, told: bool
) -> None:
    sink = Diagnostics()
    compile_target(_file(tmp_path, "", inside), {}, sink, overrides=Overrides(perception, controller))
    found = [one for one in sink if one.code.id == "SC506"]
    assert len(found) == told
    assert not found or found[0].place.file == ("--controller" if controller else str(tmp_path / "found.xml"))


@pytest.mark.parametrize(
    ("inside", "line"),
    [
        ("", None),
        ('<controller><detector model="classical"/></controller>', None),
        ('<controller><detector model="learned"/></controller>', "the detector 'classical', not 'learned'"),
        ('<camera z="1.6"/>', "a camera whose z is 1.3, not 1.6"),
        ('<camera><failure kind="blur" amount="0.2"/></camera>', None),
        ('<camera><failure kind="motion_blur"/></camera>', "failures of the kind 'motion_blur'"),
    ],
)
def test_surrogate_perception_replaces_one_detector_with_one_camera(
    tmp_path: Path, inside: str, line: str | None
) -> None:
    sink = Diagnostics()
    compile_target(_file(tmp_path, "", inside), {}, sink, overrides=Overrides(perception="surrogate"))
    found = [one for one in sink if one.code.id == "SC514"]
    assert len(found) == (line is not None)
    if line is not None:
        assert line in found[0].message
        assert found[0].place.line == 2


def test_surrogate_perception_cannot_replace_a_users_own_controller(tmp_path: Path) -> None:
    sink = Diagnostics()
    file = _file(tmp_path, "", '<controller model="own.py:Steering"/>')
    compile_target(file, {}, sink, overrides=Overrides(perception="surrogate"))
    assert [one.message for one in sink if one.code.id == "SC514"] == [
        "surrogate perception cannot replace the controller 'own.py:Steering'"
    ]


@pytest.mark.parametrize(
    ("step", "message"), [(0.025, ""), (0.02, "0.04 s apart in place of 0.05 s"), (0.03, "0.06 s")]
)
def test_a_time_step_that_does_not_divide_the_time_between_control_steps_is_noted(
    tmp_path: Path, step: float, message: str
) -> None:
    sink = Diagnostics()
    assert compile_target(_file(tmp_path, ""), {}, sink, overrides=Overrides(step=step)) is not None
    found = [one for one in sink if one.code.id == "SC256"]
    assert [message in one.message for one in found] == [True] * bool(message)
    for one in found:
        kept = float(re.findall(r"a time step of (\S+) s keeps", one.hint)[0])
        sink = Diagnostics()
        compile_target(_file(tmp_path, ""), {}, sink, overrides=Overrides(step=kept))
        assert not [other for other in sink if other.code.id == "SC256"]


@pytest.mark.parametrize(
    ("condition", "hint"),
    [
        ('<variable variable="wet" value="1"/>', 'declare it: <variable name="wet" value="0"/>'),
        ('<signal_phase controller="main" phase="go"/>', "declare it with <signal_controller>"),
        ('<time_of_day date_time="noon"/>', "write it as 2026-06-21T18:30:00"),
        (
            '<element_state kind="event" element="brakes" state="endTransition"/>',
            "did you mean 'story::act::ego::ego.whens::brakes'?",
        ),
    ],
)
def test_a_name_that_nothing_has_comes_with_what_to_write(tmp_path: Path, condition: str, hint: str) -> None:
    when = '<when name="brakes"><time after="1"/><do><stop/></do></when>'
    path = _file(tmp_path, f"<when>{condition}<do><stop/></do></when>", when)
    sink = Diagnostics()
    assert compile_target(path, {}, sink) is None
    assert [one.hint for one in sink if one.severity is Severity.ERROR] == [hint]


@pytest.mark.parametrize(
    ("weather", "inside", "blamed"),
    [
        ("HardRainNoon", "", "HardRainNoon"),
        ("ClearNoon", '<camera><failure kind="dropout"/></camera>', "the camera's failure 'dropout'"),
        ("ClearNoon", '<camera sensor_noise="60"/>', "the camera's noise"),
        ("ClearNight", '<camera><failure kind="blackout"/></camera>', "ClearNight and the camera's failure 'blackout'"),
        ("HardRainNoon", '<forward_sensor kind="radar" noise="18"/>', "the sensor's noise"),
        (
            "HardRainNoon",
            '<camera><failure kind="blur" onset="3"/></camera>',
            "HardRainNoon",
        ),
    ],
)
def test_a_short_sight_is_blamed_on_its_cause(tmp_path: Path, weather: str, inside: str, blamed: str) -> None:
    """Causes that do not shorten the sensor's range, such as a failure that begins later, are not named."""
    body = '<takeover budget="9"><cause kind="path_blocked"/></takeover>'
    file = _file(tmp_path, body, inside)
    file.write_text(file.read_text().replace('duration="5"', f'duration="5" weather="{weather}"'))
    sink = Diagnostics()
    compile_target(file, {}, sink)
    (short,) = [one for one in sink if one.code.id == "SC513"]
    assert f"but because of {blamed} the" in short.message


def test_a_dropout_of_some_images_does_not_shorten_the_sight(tmp_path: Path) -> None:
    sink = Diagnostics()
    compile_target(_file(tmp_path, "", '<camera><failure kind="dropout" amount="0.9"/></camera>'), {}, sink)
    assert "SC513" not in [one.code.id for one in sink]
