"""The command line as a user sees it: the written files, the output on both streams, and the exit codes."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from scenario_compiler.cli import GROUPS, Parser, make_parser
from scenario_compiler.worlds import WORLDS
from tests.command import call
from tests.roads.make import network, road

CONFLICT = """\
<scenarios version="1">
  <scenario name="fade" map="highway_loop" duration="2">
    <parameter name="speed" type="speed" default="20" min="5" max="40"/>
    <ego speed="$speed"><start><spawn_point name="straight"/></start></ego>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""

TWO = CONFLICT.replace("</scenarios>", "") + CONFLICT[CONFLICT.index("  <scenario ") :].replace('"fade"', '"other"')

RUN_FOLDER = ["events.csv", "map.xodr", "outcome.json", "plan.json", "recording.parquet", "report.html"]


@pytest.fixture
def conflict(tmp_path: Path) -> Path:
    file = tmp_path / "mine.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    return file


def test_run_writes_the_run_folder(conflict: Path, tmp_path: Path) -> None:
    assert call("run", conflict, "--perception", "ideal", "-o", tmp_path / "out") == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == RUN_FOLDER


def test_run_without_a_folder_writes_nothing(conflict: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert call("run", conflict, "--perception", "ideal") == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.xml"]


def test_run_keeps_a_folder_that_is_not_empty(conflict: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine", encoding="utf-8")
    assert call("run", conflict, "--perception", "ideal", "-o", folder) == 2
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]
    assert call("run", conflict, "--perception", "ideal", "-o", folder, "--force") == 0


@pytest.mark.parametrize("name", ["plan.json", "PLAN.JSON"])
def test_a_plan_runs_as_its_scenario_does(conflict: Path, tmp_path: Path, name: str) -> None:
    assert call("compile", conflict, "--perception", "ideal", "--set", "speed=30", "-o", tmp_path / name) == 0
    assert call("run", tmp_path / name, "--trajectory", tmp_path / "plan.csv") == 0
    direct = ("run", conflict, "--perception", "ideal", "--set", "speed=30", "--trajectory", tmp_path / "direct.csv")
    assert call(*direct) == 0
    assert (tmp_path / "plan.csv").read_bytes() == (tmp_path / "direct.csv").read_bytes()


def test_trajectory_has_the_contracts_columns_and_rows(conflict: Path, tmp_path: Path) -> None:
    call("run", conflict, "--perception", "ideal", "--trajectory", tmp_path / "out.csv", "--dt", "0.1")
    rows = list(csv.DictReader((tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()))
    assert list(rows[0]) == ["t", "name", "x", "y", "h", "v", "road", "lane", "s", "off"]
    assert [row["t"] for row in rows[:2]] == ["0", "0.1"]
    assert float(rows[-1]["t"]) >= 2.0 - 1e-6
    assert float(rows[-2]["t"]) < 2.0 - 1e-6


def test_a_report_is_written_again_from_its_folder(conflict: Path, tmp_path: Path) -> None:
    call("run", conflict, "--perception", "ideal", "-o", tmp_path / "out")
    report = tmp_path / "out" / "report.html"
    first = report.read_bytes()
    report.unlink()
    assert call("report", tmp_path / "out") == 0
    assert report.read_bytes() == first


def test_a_name_that_is_missing_after_the_mark_is_reported(conflict: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("run", f"{conflict}#") == 1
    assert "the name of the scenario after the '#' is missing" in capsys.readouterr().err


def test_several_scenarios_need_a_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "two.xml"
    file.write_text(TWO, encoding="utf-8")
    assert call("run", file, "--perception", "ideal") == 2
    assert "fade, other" in capsys.readouterr().err
    assert call("run", f"{file}#other", "--perception", "ideal") == 0


def test_a_folder_does_not_hide_a_conflict_of_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = ("run", "obstacle_ahead", "--perception", "ideal", "--duration", "1", "-o", "obstacle_ahead", "--force")
    assert [call(*run), call(*run)] == [0, 0]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--set", "speed"], "NAME=VALUE"),
        (["--maps", "no_such_maps"], "argument --maps: there is no folder 'no_such_maps'"),
        (["--set", "speed=10", "--set", "speed=20"], "the parameter 'speed' is given twice"),
        (["--world", "moon"], "no world 'moon'"),
        (["--dt", "0"], "not between 0.001 and 1 s"),
        (["--perception", "dreams"], "invalid choice"),
    ],
)
def test_wrong_use_exits_with_2(
    conflict: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    assert call("run", conflict, *arguments) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("command", "option", "why"),
    [
        ("run obstacle_ahead", "--port 8001", "only with --watch"),
        ("run obstacle_ahead", "--host 0.0.0.0", "only with --watch"),
        ("run obstacle_ahead --watch", "--inputs out", "not with --watch"),
        ("run obstacle_ahead", "--video-shows map", "only with --video"),
        ("report out", "--video-shows map", "only with --video"),
        ("report out --video", "--camera", "not with --video"),
        ("compare one two", "--camera", "only with --html"),
        ("library conflicts", "--perception camera", "only with --separation"),
        ("sweep obstacle_ahead -o out --samples 3", "--tolerance 2", "only with --boundary"),
        ("sweep obstacle_ahead -o out --boundary collision", "--evaluations 9", "only with --minimise"),
        ("sweep obstacle_ahead -o out --boundary collision", "--pass-rate 0.9", "not with --boundary and --minimise"),
        ("sweep obstacle_ahead -o out --minimise final_speed", "--samples 9", "not with --boundary and --minimise"),
        ("sweep obstacle_ahead -o out --minimise final_speed", "--no-report", "not with --boundary and --minimise"),
        ("study plan study.xml", "-o plan.csv", "not with `study plan`"),
        ("study export data -o table.csv", "--pilot", "not with `study export`"),
        ("study study.xml -o data --pilot", "--lsl", "not with --pilot"),
    ],
)
def test_an_option_that_would_be_ignored_is_wrong_use(
    capsys: pytest.CaptureFixture[str], command: str, option: str, why: str
) -> None:
    assert call(*command.split(), *option.split()) == 2
    assert f"{option.split()[0]}: {why}" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        "calibrate -o out --workers 0",
        "library . --workers -3",
        "validate . --workers none",
        "drive obstacle_ahead --port 65536",
        "serve-carla --port 65535",
        "run obstacle_ahead --world carla --carla-port 0",
        "run obstacle_ahead --variant -1",
        "sweep obstacle_ahead -o out --workers 0",
        "sweep obstacle_ahead -o out --samples -1",
        "sweep obstacle_ahead -o out --minimise minimum_distance --evaluations 0",
    ],
)
def test_a_number_outside_its_limits_is_wrong_use(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    *_, option, value = words.split()
    assert call(*words.split()) == 2
    assert f"argument {option}: {value} is not a whole number from " in capsys.readouterr().err


def test_an_empty_argument_is_not_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for words in (("validate", ""), ("run", "obstacle_ahead", "-o", "", "--force"), ("report", "")):
        assert call(*words) == 2
        assert "an argument is empty" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_faulty_input_exits_with_1_and_writes_nothing(
    conflict: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    conflict.write_text(
        CONFLICT.replace("highway_loop", "highway_lop").replace("<no_collision/>", "<no_colision/>"), encoding="utf-8"
    )
    assert call("run", conflict, "-o", tmp_path / "out") == 1
    said = capsys.readouterr().err
    assert "mine.xml:2:" in said
    assert "did you mean 'highway_loop'? Or give its folder" in said
    assert "mine.xml:5:" in said
    assert not (tmp_path / "out").exists()


def test_a_criterion_that_fails_exits_with_3_when_strict(conflict: Path) -> None:
    conflict.write_text(
        CONFLICT.replace("<no_collision/></criteria>", "<reach_destination/></criteria>").replace(
            "</ego>", '<destination><lane road="1" lane="-2" s="900"/></destination></ego>'
        ),
        encoding="utf-8",
    )
    assert call("run", conflict, "--perception", "ideal") == 0
    assert call("run", conflict, "--perception", "ideal", "--strict") == 3


@pytest.mark.parametrize("form", ["json", "sarif", "github"])
def test_diagnostics_for_programs_go_to_stdout(conflict: Path, capsys: pytest.CaptureFixture[str], form: str) -> None:
    conflict.write_text(CONFLICT.replace("$speed", "$sped"), encoding="utf-8")
    assert call("validate", conflict, "--format", form) == 1
    out = capsys.readouterr().out
    if form == "github":
        assert out.startswith("::error file=")
    elif form == "json":
        assert json.loads(out)[0]["line"] == 4
    else:
        assert json.loads(out)["runs"][0]["results"][0]["level"] == "error"


@pytest.mark.parametrize(
    ("command", "told"),
    [
        ("run it.xml --perception ideal -o out", "report: out"),
        ("report out", "report: out"),
        ("compile it.xml -o plan.json", ""),
        ("preview it.xml -o it.png", ""),
        ("list it.xml", "fade"),
        ("list it.xml --html gallery.html", "gallery: gallery.html"),
        ("new mine --from cut_in", "mine.xml"),
        ("export it.xml -o out.xosc", "out.xosc"),
        ("map info highway_loop", "lanes"),
        ("map check highway_loop", ""),
        ("map plot highway_loop -o map.svg", ""),
        ("map export highway_loop --mesh -o map.obj", ""),
        (
            "sweep it.xml --perception ideal --vary speed=values(10,20) --no-report -o swept",
            "2 variants: 2 passed, 0 failed, 0 broken off",
        ),
        ("sweep it.xml --perception ideal --vary speed=uniform(9,20) --minimise final_speed -o least", "least final"),
    ],
)
def test_stdout_is_one_document_for_programs_and_people_read_stderr(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str, told: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("it.xml").write_text(CONFLICT, encoding="utf-8")
    if command == "report out":
        call("run", "it.xml", "--perception", "ideal", "-o", "out")
        capsys.readouterr()
    assert call(*command.split(), "--format", "json") == 0
    out, err = capsys.readouterr()
    assert isinstance(json.loads(out), list)
    assert told in err


@pytest.mark.parametrize("command", ["export mine.xml -o o.xosc", "map export highway_loop --for carla -o {}"])
def test_a_conflict_is_as_valid_after_an_export_beside_it(
    conflict: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    copy = tmp_path / "highway_loop.xodr"
    monkeypatch.chdir(tmp_path)
    assert call(*command.format(copy).split()) == 0
    assert copy.is_file()
    assert call("validate", conflict) == 0
    assert call("run", conflict, "--perception", "ideal") == 0
    copy.write_bytes(copy.read_bytes() + b"\n")
    assert call("validate", conflict) == 1
    assert f"the map has no spawn points (the map is {copy})" in capsys.readouterr().err


def test_an_unknown_spawn_point_of_a_map_with_many_is_reported_with_their_number(
    conflict: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = conflict.read_text(encoding="utf-8")
    conflict.write_text(text.replace('<spawn_point name="straight"/>', '<spawn_point name="zz"/>'), encoding="utf-8")
    assert call("validate", conflict) == 1
    assert "there are 13, such as 'acceleration_lane' (the map is" in capsys.readouterr().err


def test_a_scenario_of_a_file_cannot_be_validated_alone(conflict: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("validate", f"{conflict}#fade") == 2
    assert f"files are checked as a whole: write {conflict} without #fade" in capsys.readouterr().err


def test_warnings_can_be_allowed_or_made_errors(conflict: Path) -> None:
    conflict.write_text(CONFLICT.replace(' duration="2"', ""), encoding="utf-8")
    assert call("validate", conflict) == 0
    assert call("validate", conflict, "--strict") == 1
    assert call("validate", conflict, "--error", "SC601") == 1
    assert call("validate", conflict, "--error", "all", "--allow", "SC601") == 0


@pytest.mark.parametrize("module", GROUPS)
def test_a_module_declares_the_commands_that_are_listed_for_it(module: str) -> None:
    commands = Parser(prog="program").add_subparsers()
    import_module(f"scenario_compiler.cli.{module}").add(commands)
    assert tuple(commands.choices) == GROUPS[module]


@pytest.mark.parametrize("command", ["--help", "explian", ""])
def test_a_line_without_a_command_is_parsed_by_all_commands(command: str) -> None:
    assert make_parser(command).format_help() == make_parser().format_help()
    assert "serve-carla" in make_parser().format_help()


def test_a_command_makes_no_parser_of_other_modules() -> None:
    shown = make_parser("run").format_help()
    assert "run a scenario or a plan" in shown
    assert "sweep" not in shown


def test_every_code_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("explain", "sc601") == 0
    assert "60 s" in capsys.readouterr().out
    assert call("explain", "SC000") == 2


@pytest.mark.parametrize(
    ("option", "code", "hint"),
    [
        ("--error", "nonsense", "there is no code 'nonsense'"),
        ("--error", "SC40", "did you mean 'SC"),
        ("--allow", "SC999", "there is no code 'SC999'"),
        ("--allow", "all", "there is no code 'all'"),
    ],
)
def test_an_unknown_code_is_wrong_use(
    conflict: Path, capsys: pytest.CaptureFixture[str], option: str, code: str, hint: str
) -> None:
    assert call("validate", conflict, option, code) == 2
    assert hint in capsys.readouterr().err


def test_a_code_may_be_written_in_lower_case() -> None:
    late = Path(__file__).parent / "cases" / "SC402_after_the_end.xml"
    assert call("validate", late) == 0
    assert call("validate", late, "--error", "sc402") == 1


@pytest.mark.slow
def test_the_library_is_valid() -> None:
    assert call("validate", Path(__file__).parent.parent / "library") == 0


def test_equal_runs_give_equal_files_in_another_process_with_another_hash_seed(conflict: Path, tmp_path: Path) -> None:
    run = ("run", conflict, "--duration", "0.2", "-o")
    assert call(*run, tmp_path / "here") == 0
    other = str(int(os.environ.get("PYTHONHASHSEED", "random") == "1") + 1)
    command = [sys.executable, "-m", "scenario_compiler", *map(str, run), str(tmp_path / "there")]
    environment = os.environ | {"PYTHONHASHSEED": other}
    subprocess.run(command, check=True, env=environment, capture_output=True, timeout=120)
    for name in RUN_FOLDER:
        assert (tmp_path / "here" / name).read_bytes() == (tmp_path / "there" / name).read_bytes(), name


def test_running_a_plan_never_imports_a_front_end(conflict: Path, tmp_path: Path) -> None:
    call("compile", conflict, "--perception", "ideal", "-o", tmp_path / "plan.json")
    probe = (
        "import sys; from scenario_compiler.cli import main\n"
        "try: main(sys.argv[1:])\n"
        "except SystemExit: pass\n"
        "assert not [m for m in sys.modules if m.startswith('scenario_compiler.source')]\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", probe, "run", str(tmp_path / "plan.json")], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr


def test_a_warning_that_the_file_allows_is_an_error_where_it_is_named(conflict: Path) -> None:
    allowing = CONFLICT.replace(' duration="2"', "").replace('version="1">', 'version="1"><allow code="SC601"/>', 1)
    conflict.write_text(allowing, encoding="utf-8")
    assert call("validate", conflict, "--error", "all") == 0
    assert call("validate", conflict, "--error", "SC601") == 1
    assert call("compile", conflict, "-o", conflict.with_suffix(".json"), "--error", "SC601") == 1
    assert call("compile", conflict, "-o", conflict.with_suffix(".json")) == 0


def test_run_says_which_criterion_is_broken_when_and_where(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("it.xml").write_text(
        """<scenarios version="1"><scenario name="it" map="town_grid" duration="4">
      <ego speed="12"><start><lane road="1" lane="-1" s="20"/></start></ego>
      <static id="parked"><at><ahead_of entity="ego" distance="12"/></at></static>
      <takeover><driver preset="absent"/></takeover>
      <criteria><no_collision/><stay_on_road/><minimum_time_to_collision at_least="1"/></criteria>
    </scenario></scenarios>""",
        encoding="utf-8",
    )
    assert call("run", "it.xml", "--perception", "ideal", "-o", "out") == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("broken: ")]
    outcome = json.loads(Path("out/outcome.json").read_text(encoding="utf-8"))
    broken = {one["criterion"]: one for one in outcome["criteria"] if not one["passed"]}
    assert list(broken) == ["no_collision", "minimum_time_to_collision"]
    for line, (name, one) in zip(lines, broken.items(), strict=True):
        place = one["where"]
        assert (place["road"], place["lane"]) == ("1", -1)
        told = f"at {one['when']:.2f} s, road 1, lane -1, s {place['s']:.2f} m: {one['why']}"
        assert line.split(maxsplit=2) == ["broken:", name, told]


def test_commands_that_run_for_hours_collect_garbage_as_python_does() -> None:
    steps = (
        "import gc; before = gc.get_threshold()",
        "from scenario_compiler.__main__ import start_lightly; start_lightly()",
        "assert gc.get_threshold() != before",
        "from scenario_compiler.cli import live; live.stay_small()",
        "assert gc.get_threshold() == before",
    )
    subprocess.run([sys.executable, "-c", "\n".join(steps)], check=True)


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="Linux alone lists the threads of a process there")
def test_commands_start_no_threads_for_linear_algebra() -> None:
    steps = (
        "from scenario_compiler.__main__ import start_lightly; start_lightly()",
        "import os, numpy, scipy.linalg",
        "numpy.ones((500, 500)) @ numpy.ones((500, 500))",
        "assert len(os.listdir('/proc/self/task')) == 1",
    )
    fresh = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    subprocess.run([sys.executable, "-c", "\n".join(steps)], check=True, env=fresh)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            "run fade.xml --forse",
            "scenario-compiler run: error: there is no option '--forse' (did you mean '--force'?)",
        ),
        ("run fade.xml --sede=3", "scenario-compiler run: error: there is no option '--sede' (did you mean '--seed'?)"),
        ("map info a.xodr --vrbose", "scenario-compiler map info: error: there is no option '--vrbose'"),
        ("calibrate -o out --jobs 2", "scenario-compiler calibrate: error: there is no option '--jobs'"),
        ("run fade.xml other.xml", "scenario-compiler run: error: unrecognized arguments: other.xml"),
        ("--vrsion list", "scenario-compiler: error: there is no option '--vrsion' (did you mean '--version'?)"),
    ],
)
def test_an_unknown_option_is_an_error_of_its_command(
    words: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(*words.split()) == 2
    assert capsys.readouterr().err.splitlines()[-1] == said


def test_a_maps_speed_limits_are_rounded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """30 km/h were 8.333333333333334 m/s."""
    limits = ('max="30" unit="km/h"', 'max="no limit"')
    types = (f'<type s="{50 * k}" type="town"><speed {one}/></type>' for k, one in enumerate(limits))
    network(tmp_path, road(more="".join(types)))
    assert call("map", "info", next(tmp_path.glob("*.xodr"))) == 0
    assert "speed limits              8.33: 1, inf: 1\n" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["run", "drive", "study"])
def test_the_help_names_every_world(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(command, "--help") == 0
    text = " ".join(capsys.readouterr().out.split())
    described = text.partition("--world NAME ")[2].partition(" --")[0]
    assert [name for name in WORLDS if name not in described] == []
