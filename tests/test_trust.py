"""Reading a file never runs code that it names; only code that the user names runs, and its faults are reported."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenario_compiler.recording.store import read_recording
from scenario_compiler.trust import CodeName, ConfigurationError, Trust, code_name
from tests.command import call

NAMED = """\
<scenarios version="1">
  <scenario name="named" map="highway_loop" duration="0.4">
    <ego speed="10"><start><spawn_point name="straight"/></start>
      <controller model="{model}">{properties}</controller></ego>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""

MARK = """\
import pathlib
pathlib.Path(__file__).with_name("it_ran").touch()
"""

HOSTILE = MARK + "import sys\nsys.exit(0)\n"

STEERING = (
    MARK
    + """
import pathlib
import pydantic
from scenario_compiler import Control, ControllerModel, ControllerParams

class Mine(ControllerModel):
    class Params(ControllerParams):
        throttle: float = 0.2
        weights: pathlib.Path = pathlib.Path("none")

    def __init__(self, params):
        super().__init__(params)
        if params.weights.name != "none":
            self.text = params.weights.read_text()

    def control(self, sensor_data, speed, vehicle):
        return Control(throttle=self.params.throttle, steer=0.0, brake=0.0)

class Failing(Mine):
    def control(self, sensor_data, speed, vehicle):
        if sensor_data.t > 0.15:
            raise RuntimeError("lost\\nthe lane")
        return super().control(sensor_data, speed, vehicle)

class NotANumber(Mine):
    def control(self, sensor_data, speed, vehicle):
        return Control(throttle=float("nan"), steer=0.0, brake=0.0)

class Silent(Mine):
    def control(self, sensor_data, speed, vehicle):
        return None

class Unfinished(ControllerModel):
    pass

class Hasty(Mine):
    def __init__(self, params):
        pass

class Simple(Mine):
    def control(self, sensor_data):
        return Control(throttle=0.0, steer=0.0, brake=0.0)

class Lost(Mine):
    # It loses the lane at once, so that the automation requests a takeover, which is pictured.
    answer = {}

    def control(self, sensor_data, speed, vehicle):
        return Control(**({"throttle": 0.2, "steer": 0.0, "brake": 0.0, "confidence_left": 0.0,
                           "confidence_right": 0.0, **self.answer}))

class WithoutAPath(Lost):
    answer = {"trajectory": None}

class WithABentPath(Lost):
    answer = {"trajectory": ((1.0, 2.0, 3.0),)}

class WithAPathToNowhere(Lost):
    answer = {"trajectory": ((float("inf"), 0.0),)}

class WithALane(Lost):
    answer = {"lanes": "left"}

class OfATextForANumber(Lost):
    answer = {"steer": "0.1"}

class OfManyNumbers(Lost):
    answer = {"steer": [0.1, 0.2]}

class TooSure(Lost):
    answer = {"confidence_left": 7.0}

class Undecided(Lost):
    def initiate_takeover(self):
        return None

class WithoutLabels(Lost):
    def display_info(self):
        return ["speed 20"]

class WarningOfLetters(Lost):
    def warning_messages(self):
        return "hold the wheel"

class Painter(Lost):
    def overlay_image(self, image):
        return image / 255.0

class Callable(Lost):
    class Answer:
        def __call__(self, *given):
            return None

    control = Answer()

class Talkative(Lost):
    def display_info(self):
        return {"half of a pair": "\\ud800", "lines": "one\\ntwo", "count": 3}

class Moving(Mine):
    def control(self, sensor_data, speed, vehicle):
        import os
        os.chdir("/")
        return super().control(sensor_data, speed, vehicle)

class Plain(Mine):
    class Params:
        throttle = 0.2

class Reading(Mine):
    class Params(ControllerParams, validate_default=True):
        throttle: float = 0.2

        @pydantic.field_validator("throttle", mode="before")
        @classmethod
        def from_file(cls, value):
            return open("no_such_file.txt").read()
"""
)


def written(folder: Path, model: str, properties: str = "", code: str = STEERING) -> Path:
    """Write a scenario that names code, and the code beside it; return the scenario."""
    (folder / "stranger.py").write_text(code, encoding="utf-8")
    file = folder / "named.xml"
    file.write_text(NAMED.format(model=model, properties=properties), encoding="utf-8")
    return file


@pytest.fixture(autouse=True)
def no_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's configuration folder, empty."""
    folder = tmp_path / "configuration"
    for name in [name for name in sys.modules if name.startswith(("stranger", "elsewhere"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(folder))
    return folder


def configure(folder: Path, text: str) -> None:
    """Write the user's configuration file."""
    file = folder / "scenario-compiler" / "config.toml"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


WATCHED = """
import sys
allowed = (sys.prefix, sys.base_prefix, {package!r})
foreign = []

class Watch:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("stranger", "no_such_module_anywhere"):
            foreign.append(name)
        return None

sys.meta_path.insert(0, Watch())
from scenario_compiler.cli import main
for command in sys.argv[1:]:
    try:
        code = main(command.split())
    except SystemExit as end:
        code = end.code
    outside = [name for name, module in sys.modules.items()
               if getattr(module, "__file__", None) and not module.__file__.startswith(allowed)]
    print("EXIT", code, "FOREIGN", foreign, outside, flush=True)
"""


def watched(folder: Path, *commands: str) -> list[tuple[int, str]]:
    """Run commands in a process with the folder's modules importable; return the exit code and the words of each.

    Fails on any import of a module that neither belongs to Python, nor to an installed package, nor to this one.
    """
    package = str(Path(__file__).resolve().parent.parent)
    probe = [sys.executable, "-u", "-c", WATCHED.format(package=package), *commands]
    environment = os.environ | {"PYTHONPATH": str(folder)}
    both = subprocess.STDOUT
    done = subprocess.run(
        probe, stdout=subprocess.PIPE, stderr=both, text=True, timeout=120, env=environment, cwd=folder, check=False
    )
    told = re.split(r"^EXIT (\d+) FOREIGN (.*)\n", done.stdout, flags=re.MULTILINE)
    assert told[2::3] == ["[] []"] * len(commands), done.stdout
    return [(int(code), words) for code, words in zip(told[1::3], told[0::3], strict=False)]


OPENSCENARIO_EGO = """\
<OpenSCENARIO><FileHeader revMajor="1" revMinor="1" date="2026-01-01T00:00:00" description="d" author="a"/>
<ParameterDeclarations/><CatalogLocations/><RoadNetwork><LogicFile filepath="highway_loop.xodr"/></RoadNetwork>
<Entities><ScenarioObject name="ego"><Vehicle name="v" vehicleCategory="car"><ParameterDeclarations/>
<BoundingBox><Center x="1.3" y="0" z="0.7"/><Dimensions width="2" length="4.5" height="1.4"/></BoundingBox>
<Performance maxSpeed="60" maxAcceleration="5" maxDeceleration="9"/>
<Axles><FrontAxle maxSteering="0.5" wheelDiameter="0.6" trackWidth="1.7" positionX="2.7" positionZ="0.3"/>
<RearAxle maxSteering="0" wheelDiameter="0.6" trackWidth="1.7" positionX="0" positionZ="0.3"/></Axles>
<Properties/></Vehicle>
<ObjectController><Controller name="scenario_compiler"><ParameterDeclarations/><Properties>
<Property name="ego/controller/@model" value="stranger:Mine"/><Property name="controller" value="stranger:Mine"/>
</Properties></Controller></ObjectController></ScenarioObject></Entities>
<Storyboard><Init><Actions/></Init><StopTrigger/></Storyboard></OpenSCENARIO>
"""


@pytest.mark.parametrize(
    "model",
    [
        "stranger:Mine",
        pytest.param("stranger.py:Mine", marks=pytest.mark.slow),
        pytest.param("no_such_module_anywhere.x:Y", marks=pytest.mark.slow),
    ],
)
def test_no_command_imports_what_a_file_names(tmp_path: Path, model: str) -> None:
    file = written(tmp_path, model, code=HOSTILE)
    text = file.read_text(encoding="utf-8").replace(
        "    <ego", '    <parameter name="gap" type="length" default="1"/>\n    <ego'
    )
    file.write_text(text, encoding="utf-8")
    codes = {
        f"validate {file}": 0,
        f"compile {file} -o {tmp_path}/plan.json": 0,
        f"export {file} -o {tmp_path}/out.xosc": 0,
        f"preview {file} -o {tmp_path}/out.png": 0,
        f"list {file}": 0,
        f"list {file} --html {tmp_path}/out.html": 0,
        f"run {file}": 1,
        f"run {file} -o {tmp_path}/out": 1,
        f"sweep {file} --vary gap=values(1,2) -o {tmp_path}/swept": 1,
    }
    for (command, code), (left, told) in zip(codes.items(), watched(tmp_path, *codes), strict=True):
        assert left == code, told
        if not command.startswith("list"):
            assert "SC507" in told
            assert "not trusted: its properties were not checked" in told
        if code == 1:
            assert f"--trust {model}" in told
    assert not (tmp_path / "it_ran").exists()


def test_an_openscenario_file_cannot_run_code(tmp_path: Path) -> None:
    (tmp_path / "stranger.py").write_text(HOSTILE, encoding="utf-8")
    file = tmp_path / "named.xosc"
    file.write_text(OPENSCENARIO_EGO, encoding="utf-8")
    watched(tmp_path, f"validate {file}", f"list {file}", f"run {file} --duration 0.1")
    assert not (tmp_path / "it_ran").exists()


def test_an_exported_conflict_cannot_run_code(tmp_path: Path) -> None:
    file = written(tmp_path, "stranger:Mine", code=HOSTILE)
    out = tmp_path / "out.xosc"
    exported, validated, ran = watched(tmp_path, f"export {file} -o {out}", f"validate {out}", f"run {out}")
    assert exported[0] == 0
    assert "stranger:Mine" in out.read_text(encoding="utf-8")
    assert (validated[0], "SC507" in validated[1]) == (0, True)
    assert ran[0] == 1
    assert not (tmp_path / "it_ran").exists()


def test_nothing_is_imported_from_the_current_folder(tmp_path: Path) -> None:
    """`python -m` looks there first, and another author's folder may contain modules of any name."""
    file = written(tmp_path, "lane_detection")
    for name in ("lxml", "pydantic", "numpy", "rich", "tomllib", "difflib", "argparse", "scenario_compiler_data"):
        (tmp_path / f"{name}.py").write_text(HOSTILE, encoding="utf-8")
    command = [sys.executable, "-m", "scenario_compiler", "validate", str(file)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (0, "1 file checked, 0 errors\n"), done.stderr
    assert not (tmp_path / "it_ran").exists()


def test_a_module_that_the_command_line_names_is_found_in_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "elsewhere.py").write_text(STEERING, encoding="utf-8")
    monkeypatch.chdir(tmp_path / "here")
    assert call("run", written(tmp_path, "lane_detection"), "--controller", "elsewhere:Mine") == 0
    assert call("run", written(tmp_path, "elsewhere_else:Mine"), "--trust", tmp_path / "named.xml") == 1


def test_a_plan_cannot_run_code(tmp_path: Path) -> None:
    file = written(tmp_path, "stranger:Mine", code=HOSTILE)
    plan = tmp_path / "plan.json"
    sweep = f"sweep {plan} --vary x=values(1,2) -o {tmp_path}/s"
    compiled, *refused, exported = watched(
        tmp_path, f"compile {file} -o {plan}", f"run {plan}", sweep, f"export {plan} -o {tmp_path}/out.xosc"
    )
    assert (compiled[0], exported[0]) == (0, 0)
    for left, told in refused:
        assert (left, "SC507" in told) == (1, True), told
    content = json.loads(plan.read_text(encoding="utf-8"))
    assert content["controller"]["model"] == "stranger:Mine"


def test_a_plan_in_another_folder_runs_with_the_trusted_file_of_the_same_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = written(tmp_path, "stranger.py:Mine")
    plan = tmp_path / "elsewhere" / "plan.json"
    plan.parent.mkdir()
    assert call("compile", file, "-o", plan) == 0
    monkeypatch.chdir(plan.parent)
    capsys.readouterr()
    assert call("run", "plan.json") == 1
    assert capsys.readouterr().err.startswith("plan.json: error[SC507]")
    for other in ("../other.py", "../stranger.py:Other"):
        assert call("run", "plan.json", "--trust", other) == 1
    assert not (tmp_path / "it_ran").exists()
    assert call("run", "plan.json", "--trust", "../stranger.py:Mine", "-o", "out") == 0
    assert call("run", "plan.json", "--trust", "../stranger.py") == 0
    report = Path("out", "report.html").read_text(encoding="utf-8")
    assert "scenario-compiler run plan.json --seed 1 --trust stranger.py:Mine -o again" in report


def test_wrong_properties_are_found_only_in_trusted_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = written(tmp_path, "stranger:Mine", '<property name="throtle" value="0.5"/>')
    assert call("validate", file) == 0
    assert "SC504" not in capsys.readouterr().err
    assert call("validate", file, "--trust", "stranger:Mine") == 1
    assert "did you mean 'throttle'?" in capsys.readouterr().err


def test_a_missing_property_is_reported_where_the_controller_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = STEERING.replace("throttle: float = 0.2", "throttle: float")
    file = written(tmp_path, "stranger:Mine", code=code)
    assert call("run", file, "--trust", "stranger:Mine") == 1
    told = capsys.readouterr().err
    assert re.search(r"named.xml:\d+:\d+: error\[SC504\]: 'stranger:Mine' needs the property 'throttle'", told)
    assert call("run", file, "--controller", f"{tmp_path / 'stranger.py'}:Mine") == 1
    assert capsys.readouterr().err.startswith("--controller: error[SC504]")


@pytest.mark.parametrize("name", ["stranger:Mine", "stranger", "{folder}/stranger.py:Mine", "{folder}/stranger.py"])
def test_code_that_the_command_line_names_is_found_beside_the_scenario(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    model = "stranger.py:Mine" if ".py" in name else "stranger:Mine"
    file = written(tmp_path, model)
    monkeypatch.chdir("/")
    assert call("run", file, "--trust", name.format(folder=tmp_path)) == 0
    assert (tmp_path / "it_ran").exists()


def test_a_controller_of_the_command_line_is_trusted_and_found_beside_the_scenario(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere.py").write_text(STEERING, encoding="utf-8")
    file = written(tmp_path, "lane_detection")
    monkeypatch.chdir("/")
    assert call("run", file, "--controller", "elsewhere:Mine") == 0
    assert call("run", file, "--controller", "elsewhere.py:Mine") == 0
    assert call("run", file, "--controller", f"{tmp_path}/elsewhere.py:Mine", "--perception", "camera") == 0
    assert call("run", file, "--controller", "nowhere.py:Mine") == 1


def test_a_trusted_scenario_file_does_not_import_modules_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(tmp_path, "stranger_beside:Mine")
    (tmp_path / "stranger_beside.py").write_text(STEERING, encoding="utf-8")
    assert call("run", file, "--trust", file) == 1
    assert "SC503" in capsys.readouterr().err
    monkeypatch.syspath_prepend(str(tmp_path))
    assert call("run", file, "--trust", file) == 0


def test_a_trusted_scenario_file_imports_the_python_file_that_it_names(tmp_path: Path) -> None:
    assert call("run", written(tmp_path, "stranger.py:Mine"), "--trust", tmp_path / "named.xml") == 0


def test_the_users_configuration_trusts_permanently(tmp_path: Path, no_configuration: Path) -> None:
    file = written(tmp_path, "stranger.py:Mine")
    configure(no_configuration, f'trust = ["{tmp_path}/stranger.py"]')
    assert call("run", file) == 0
    configure(no_configuration, 'trust = ["stranger.py", "stranger", "named.xml"]')
    assert call("run", file) == 1
    configure(no_configuration, f'trust = ["{file}"]')
    assert call("run", file) == 1, "a list names code, not scenarios"


def test_a_configuration_beside_the_scenario_is_ignored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = written(tmp_path, "stranger.py:Mine", code=HOSTILE)
    (tmp_path / "config.toml").write_text('trust = ["stranger.py"]', encoding="utf-8")
    configure(tmp_path, f'trust = ["{tmp_path}/stranger.py"]')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", ".")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert call("run", file) == 1
    assert not (tmp_path / "it_ran").exists()


@pytest.mark.parametrize("text", ["trust = [", "trust = 3", "trust = [1]", "\udcff"])
def test_a_configuration_that_cannot_be_read_is_reported(
    tmp_path: Path, no_configuration: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    configure(no_configuration, "")
    (no_configuration / "scenario-compiler" / "config.toml").write_bytes(text.encode(errors="surrogateescape"))
    for command in ("validate", "run"):
        assert call(command, written(tmp_path, "stranger:Mine")) == 2
        assert "config.toml: " in capsys.readouterr().err


def test_a_sweep_runs_trusted_code_in_its_processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = written(tmp_path, "stranger.py:Mine")
    file.write_text(
        file.read_text(encoding="utf-8").replace(
            "    <ego", '    <parameter name="v" type="speed" default="5"/>\n    <ego'
        ),
        encoding="utf-8",
    )
    monkeypatch.chdir("/")
    command = ("sweep", file, "--vary", "v=values(5,6)", "--no-report", "--workers", "1", "--duration", "0.2")
    assert call(*command, "-o", tmp_path / "refused") == 1
    assert call(*command, "-o", tmp_path / "done", "--trust", tmp_path / "stranger.py") == 0


@pytest.mark.parametrize(
    ("code", "line", "said"),
    [
        ("import sys\n\nsys.exit(0)\n", 3, "SystemExit: 0"),
        ("def f():\n    raise ValueError('no')\nf()\n", 2, "ValueError: no"),
        ("x = = 1\n", 1, "SyntaxError"),
        ("import no_such_package_of_mine\n", 1, "No module named 'no_such_package_of_mine'"),
        ("raise BaseException\n", 1, "BaseException"),
    ],
)
@pytest.mark.parametrize("command", ["validate", "run"])
def test_code_that_fails_when_imported_is_a_finding_at_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], code: str, line: int, said: str, command: str
) -> None:
    file = written(tmp_path, "stranger.py:Mine", code=code)
    assert call(command, file, "--trust", file, "--format", "json") == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert (found["code"], found["file"], found["line"]) == ("SC521", str(tmp_path / "stranger.py"), line)
    assert said in found["message"]
    assert "stranger.py:Mine" in found["message"]
    assert [(one["file"], one["line"]) for one in found["related"]] == [(str(file), 4)]


def test_a_path_in_a_property_starts_from_the_scenarios_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(tmp_path, "stranger.py:Mine", '<property name="weights" value="models/net.onnx"/>')
    monkeypatch.chdir("/")
    assert call("run", file, "--trust", file, "--format", "json") == 1
    (found,) = json.loads(capsys.readouterr().out)
    line = STEERING.split("read_text")[0].count("\n") + 1
    assert found["code"] == "SC521"
    assert found["message"].startswith(f"controller 'stranger.py:Mine', stranger.py:{line}: FileNotFoundError")
    assert str(tmp_path / "models" / "net.onnx") in found["message"]
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "net.onnx").write_text("weights", encoding="utf-8")
    assert call("run", file, "--trust", file) == 0


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Failing", "RuntimeError: lost"),
        ("NotANumber", "throttle is nan"),
        ("Silent", "it returned NoneType, which is not a Control"),
        ("WithoutAPath", "trajectory is None, which is not a list of points"),
        ("WithABentPath", "point 0 of trajectory is (1.0, 2.0, 3.0), which is not a pair of numbers"),
        ("WithAPathToNowhere", "point 0 of trajectory is inf"),
        ("WithALane", "lanes is str, which is not a LaneResult"),
        ("OfATextForANumber", "steer is '0.1', which is not a number"),
        ("OfManyNumbers", "steer is [0.1, 0.2], which is not a number"),
        ("TooSure", "confidence_left is 7.0, not from 0 to 1"),
        ("Undecided", "initiate_takeover: it returned None, which is neither True nor False"),
        ("WithoutLabels", "display_info: it returned ['speed 20'], which is not a dict of texts"),
        ("WarningOfLetters", "warning_messages: it returned 'hold the wheel', which is not a list of texts"),
        ("Painter", "overlay_image: it returned an image of float64 of shape"),
    ],
)
def test_a_controller_that_fails_in_a_run_ends_it_and_keeps_the_recording(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, said: str
) -> None:
    file = written(tmp_path, f"stranger.py:{name}")
    options = ("--duration", "2", "--format", "json")
    assert call("run", file, "--trust", file, "-o", tmp_path / "out", *options) == 1
    out, err = capsys.readouterr()
    (found,) = json.loads(out)
    assert (found["code"], found["file"]) == ("SC521", str(file))
    assert found["message"].startswith(f"controller 'stranger.py:{name}', stranger.py:")
    assert said in found["message"]
    assert "broke off" in err
    outcome = json.loads((tmp_path / "out" / "outcome.json").read_text(encoding="utf-8"))
    assert (outcome["result"], outcome["stop_reason"]) == ("error", "controller_failed")
    if name == "Failing":
        assert outcome["duration"] == pytest.approx(0.15)


@pytest.mark.parametrize(
    ("name", "line", "said"),
    [
        ("Unfinished", "class Unfinished(ControllerModel):", "TypeError: Can't instantiate abstract class"),
        ("Hasty", "class Hasty(Mine):", "AttributeError: 'Hasty' object has no attribute 'params'"),
        ("Simple", "    def control(self, sensor_data):", "TypeError: Simple.control() takes 2 positional arguments"),
    ],
)
def test_a_failure_in_no_line_of_the_controller_is_reported_at_its_class_or_method(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, line: str, said: str
) -> None:
    file = written(tmp_path, f"stranger.py:{name}")
    assert call("run", file, "--trust", file, "--format", "json") == 1
    (found,) = json.loads(capsys.readouterr().out)
    number = STEERING.splitlines().index(line) + 1
    assert found["message"].startswith(f"controller 'stranger.py:{name}', stranger.py:{number}: {said}")


@pytest.mark.parametrize("name", ["stranger.py:Gone", "missing.py:Mine", "no.such:Class"])
def test_the_built_in_controllers_are_no_hint_for_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    file = written(tmp_path, name)
    assert call("run", file, "--trust", file, "--format", "json") == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert (found["code"], found["hint"]) == ("SC503", "")


def test_an_answer_of_an_object_without_lines_is_reported_without_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(tmp_path, "stranger.py:Callable")
    assert call("run", file, "--trust", file) == 1
    said = "controller 'stranger.py:Callable': control: it returned NoneType, which is not a Control"
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_texts_of_a_controller_that_cannot_be_drawn_are_drawn_as_escapes(tmp_path: Path) -> None:
    file = written(tmp_path, "stranger.py:Talkative")
    command = [sys.executable, "-m", "scenario_compiler", "run", str(file), "--trust", str(file), "--duration", "2"]
    command += ["-o", str(tmp_path / "out")]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 0
    assert [one.label for one in read_recording(tmp_path / "out" / "recording.parquet").frames][:1] == ["warning"]


def test_the_files_of_a_run_are_together_even_if_its_controller_changes_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = written(tmp_path, "stranger.py:Moving")
    monkeypatch.chdir(tmp_path)
    assert call("run", file, "--trust", file, "-o", "out") == 0
    files = {"plan.json", "map.xodr", "recording.parquet", "events.csv", "outcome.json", "report.html"}
    assert {one.name for one in (tmp_path / "out").iterdir()} == files


@pytest.mark.parametrize("command", ["validate", "run"])
@pytest.mark.parametrize(
    ("name", "code", "said"),
    [
        ("Plain", "SC503", "has a class Params that does not derive from ControllerParams"),
        ("Reading", "SC521", "FileNotFoundError"),
    ],
)
def test_parameters_that_cannot_be_checked_are_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, name: str, code: str, said: str
) -> None:
    file = written(tmp_path, f"stranger.py:{name}")
    assert call(command, file, "--trust", file, "--format", "json") == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert found["code"] == code
    assert said in found["message"]


LANES = """
from dataclasses import replace
from scenario_compiler.perception.detectors import create_detector

class Mine:
    def __init__(self, camera):
        self.inner = create_detector("classical", camera)

    def detect(self, image, prior=None, pitch=None):
        found = self.inner.detect(image, prior, pitch)
        return replace(found, left=replace(found.left, p=0.5))

class Failing(Mine):
    def detect(self, image, prior=None, pitch=None):
        raise RuntimeError("blind")

class Certain(Mine):
    def detect(self, image, prior=None, pitch=None):
        found = super().detect(image, prior, pitch)
        return replace(found, left=replace(found.left, p=2.0))

class Silent(Mine):
    def detect(self, image, prior=None, pitch=None):
        return None

class Bent(Mine):
    change = {}

    def detect(self, image, prior=None, pitch=None):
        found = super().detect(image, prior, pitch)
        return replace(found, left=replace(found.left, **self.change))

class Empty(Bent):
    change = {"y0": None}

class Unranged(Bent):
    change = {"x_range": (5.0, float("nan"))}

class Far(Bent):
    change = {"curvature": 1e300}

class Level(Mine):
    def detect(self, image, prior=None, pitch=None):
        return replace(super().detect(image, prior, pitch), tilt=None)

class Deaf:
    pass
"""
"""Lane detectors of a stranger."""


def with_detector(folder: Path, name: str) -> Path:
    """Write a scenario that names an unknown author's detector, and its code; return the scenario."""
    (folder / "stranger.py").write_text(LANES, encoding="utf-8")
    file = folder / "named.xml"
    text = NAMED.format(model="lane_detection", properties=f'<detector model="{name}"/>')
    file.write_text(text, encoding="utf-8")
    return file


def test_a_detector_in_a_file_runs_only_if_it_is_trusted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = with_detector(tmp_path, "stranger.py:Mine")
    assert call("validate", file) == 0
    capsys.readouterr()
    assert call("run", file, "--duration", "0.2", "--format", "json") == 1
    assert {one["code"] for one in json.loads(capsys.readouterr().out)} == {"SC507"}
    assert str(tmp_path / "stranger.py") not in sys.modules
    assert call("run", file, "--duration", "0.2", "--trust", file, "-o", tmp_path / "out") == 0
    confidence = read_recording(tmp_path / "out" / "recording.parquet").confidence_left
    assert 0.0 < np.nanmax(confidence[1:]) <= 0.5


@pytest.mark.parametrize(
    ("name", "code", "said"),
    [
        ("Failing", "SC521", "RuntimeError: blind"),
        ("Certain", "SC521", "p of the left boundary is 2.0, not from 0 to 1"),
        ("Silent", "SC521", "it returned NoneType, which is not a LaneResult"),
        ("Empty", "SC521", "y0 of the left boundary is None, which is not a number"),
        ("Unranged", "SC521", "x_range of the left boundary is nan"),
        ("Far", "SC521", "curvature of the left boundary is 1e+300"),
        ("Level", "SC521", "tilt is NoneType, which is not a Tilt"),
        ("Deaf", "SC527", "is not a class with a method `detect`"),
        ("Gone", "SC527", "stranger.py has no 'Gone'"),
    ],
)
def test_a_detector_that_fails_is_a_finding_with_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, code: str, said: str
) -> None:
    file = with_detector(tmp_path, f"stranger.py:{name}")
    assert call("run", file, "--duration", "0.2", "--trust", file, "--format", "json") == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert found["code"] == code
    assert said in found["message"]
    assert f"'stranger.py:{name}'" in found["message"]


def test_a_detector_is_ignored_by_a_controller_that_does_not_use_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(tmp_path, "stranger.py:Mine", '<detector model="learned"/>')
    assert call("run", file, "--trust", file, "--format", "json") == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert (found["code"], found["severity"]) == ("SC528", "warning")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("a:B", CodeName("a", "B")),
        ("a.b_c:D9", CodeName("a.b_c", "D9")),
        ("x/y.py:C", CodeName("x/y.py", "C")),
        ("C:\\lab\\y.py:C", CodeName("C:\\lab\\y.py", "C")),
        ("lane_detection", None),
        ("a:b:c", None),
        (":B", None),
        ("a:", None),
        ("a b:C", None),
        ("../a:C", None),
    ],
)
def test_spelling_of_code(text: str, named: CodeName | None) -> None:
    assert code_name(text) == named


def test_a_package_covers_its_modules_and_no_other_names_with_the_same_prefix() -> None:
    lab, labour = CodeName("lab.steering", "Mine"), CodeName("labour", "Mine")
    trust = Trust(("lab",))
    assert trust.allows(lab, "x.xml")
    assert not trust.allows(labour, "x.xml")
    assert not Trust(("lab.steering:Other",)).allows(lab, "x.xml")
    assert not Trust(("",)).allows(lab, "x.xml")


def test_one_name_in_place_of_a_tuple_is_refused() -> None:
    """It would be a tuple of letters, so that nothing was trusted without a reason."""
    name: Any = "lab.steering"
    with pytest.raises(TypeError, match=r"named is a tuple of texts, .* not 'lab.steering'"):
        Trust(name)


def test_a_configuration_is_read_only_where_code_is_named(tmp_path: Path, no_configuration: Path) -> None:
    configure(no_configuration, "not toml")
    assert call("validate", written(tmp_path, "lane_detection")) == 0
    with pytest.raises(ConfigurationError):
        Trust().allows(CodeName("a", "B"), "x.xml")
