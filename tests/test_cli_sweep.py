"""`sweep` as a user sees it: early refusals, failures, and the correctness of its page."""

from __future__ import annotations

import csv
import html
import json
import math
import re
import shlex
import shutil
from pathlib import Path

import pytest

from scenario_compiler.batch.distributions import DISTRIBUTIONS
from scenario_compiler.batch.finished import read_results
from scenario_compiler.recording.cells import text_cell
from tests.command import call

CONFLICT = """\
<scenarios version="1">
  <scenario name="short" map="town_grid" duration="0.5">
    <parameter name="speed" type="speed" default="12" max="30"/>
    <parameter name="number" type="integer" default="2"/>
    <parameter name="model" type="text" default="vehicle.audi.tt"/>
    <parameter name="busy" type="boolean" default="true"/>
    {}
    <ego speed="$speed" model="$model"><start><lane road="1" lane="-1" s="20"/></start></ego>
    <repeat count="$number" as="i">
      <if test="$busy"><static id="parked"><at><lane road="1" lane="-1" s="${{100 + 10 * $i}}"/></at></static></if>
    </repeat>
  </scenario>
</scenarios>
"""

VALUES = """\
<OpenSCENARIO>
  <FileHeader revMajor="1" revMinor="2" date="2024-01-01T00:00:00" author="a" description="d"/>
  <ParameterValueDistribution>
    <ScenarioFile filepath="varied.xosc"/>
    <Stochastic numberOfTestRuns="3" randomSeed="1">
      <StochasticDistribution parameterName="{}">
        <UniformDistribution><Range lowerLimit="5" upperLimit="9"/></UniformDistribution>
      </StochasticDistribution>
    </Stochastic>
  </ParameterValueDistribution>
</OpenSCENARIO>
"""

SCENARIO = """\
<OpenSCENARIO>
  <FileHeader revMajor="1" revMinor="2" date="2024-01-01T00:00:00" author="a" description="d"/>
  <ParameterDeclarations>
    <ParameterDeclaration name="Speed" parameterType="double" value="7"/>
    <ParameterDeclaration name="Number" parameterType="integer" value="7"/>
    <ParameterDeclaration name="Name" parameterType="string" value="7"/>
  </ParameterDeclarations>
  <CatalogLocations/>
  <RoadNetwork><LogicFile filepath="town_grid"/></RoadNetwork>
  <Entities/>
  <Storyboard><Init><Actions/></Init><StopTrigger/></Storyboard>
</OpenSCENARIO>
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with a scenario that has a parameter of each kind."""
    monkeypatch.chdir(tmp_path)
    Path("it.xml").write_text(CONFLICT.format(""), encoding="utf-8")
    return tmp_path


def sweep(*options: object, target: str = "it.xml") -> int:
    """Return the exit code of a sweep into `out`, without a report."""
    return call("sweep", target, "--perception", "ideal", "--no-report", *options, "-o", "out")


@pytest.mark.parametrize(
    ("vary", "fitting"),
    [
        ("number=uniform(1, 5)", "whole numbers"),
        ("number=choice(1, 1.5)", "whole numbers"),
        ("model=uniform(1, 2)", "choice(value, value, ...)"),
        ("busy=poisson(2)", "choice(true, false)"),
        ("speed=choice(fast, slow)", "numbers"),
    ],
)
def test_distributions_that_do_not_fit_the_type_are_refused(
    vary: str, fitting: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sweep("--vary", vary, "--samples", 3) == 2
    name, _, _ = vary.partition("=")
    err = capsys.readouterr().err
    assert f"'{name}' is of the type " in err
    assert fitting in err
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("distribution", "value"),
    [
        ("uniform(1, 90)", "90"),
        ("triangular(1, 2, 31)", "31"),
        ("histogram(1, 2, 20, 3, 90)", "90"),
        ("normal(10, 2, 5, 31)", "31"),
        ("lognormal(1, 2, 5, 31)", "31"),
        ("choice(10, 40, 20)", "40"),
        ("weighted(10, 1, 40, 2)", "40"),
        ("values(10, 40)", "40"),
        ("grid(10, 40, 4)", "40"),
    ],
)
def test_values_beyond_the_limits_are_refused(
    distribution: str, value: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sweep("--vary", f"speed={distribution}", "--where", "number < 3") == 2
    assert f"with {distribution}, speed may become {value}, but must be at most 30" in capsys.readouterr().err
    assert not Path("out").exists()


@pytest.mark.parametrize(
    "distribution",
    ["normal(10, 1)", "lognormal(1, 0.1)", "histogram(1, 1, 20, 0, 90)", "weighted(10, 1, 40, 0)", "grid(30, 90, 1)"],
)
def test_values_that_may_keep_to_the_limits_are_run(distribution: str) -> None:
    assert sweep("--vary", f"speed={distribution}") == 0


@pytest.mark.parametrize(("option", "other"), [("--vary", "--set"), ("--set", "--vary")])
def test_an_unknown_parameter_is_reported_at_its_option(
    option: str, other: str, capsys: pytest.CaptureFixture[str]
) -> None:
    written = {"--vary": "speed=uniform(5, 10)", "--set": "number=1", option: "sped=choice(1)"}
    assert sweep(*(part for pair in written.items() for part in pair)) == 1
    err = capsys.readouterr().err
    assert f"{option}: error[SC211]: there is no parameter 'sped' to set" in err
    assert other not in err


@pytest.mark.parametrize("vary", ["number=grid(0, 1, 2)", "busy=values(true, false)", "model=choice(vehicle.audi.a2)"])
def test_distributions_that_fit_the_type_are_run(vary: str) -> None:
    assert sweep("--vary", vary) == 0


def test_a_faulty_variation_in_the_scenario_is_reported_there(capsys: pytest.CaptureFixture[str]) -> None:
    Path("it.xml").write_text(
        CONFLICT.format('<vary><uniform parameter="number" least="1" greatest="5"/></vary>'), encoding="utf-8"
    )
    assert sweep() == 1
    assert "error[SC250]" in capsys.readouterr().err


@pytest.mark.parametrize(("name", "refused"), [("Number", True), ("Name", True), ("Speed", False)])
def test_values_of_openscenario_are_checked_too(name: str, refused: bool, capsys: pytest.CaptureFixture[str]) -> None:
    Path("varied.xosc").write_text(SCENARIO, encoding="utf-8")
    Path("values.xosc").write_text(VALUES.format(name), encoding="utf-8")
    sweep("--duration", "0.5", target="values.xosc")
    assert (f"'{name}' is of the type " in capsys.readouterr().err) == refused


@pytest.mark.parametrize("vary", [[], ["--vary", "speed=uniform(5, 10)"]])
def test_an_unknown_scenario_is_reported(vary: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep(*vary, target="it.xml#zzz") == 1
    assert "there is no scenario 'zzz'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--samples", "0"),
        ("--repeat", "-1"),
        ("--workers", "0"),
        ("--minimise=minimum_time_to_collision --evaluations", "0"),
    ],
)
def test_counts_below_one_are_refused(option: str, value: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--vary", "speed=uniform(5, 10)", *option.split(), value) == 2
    assert f"{option.split()[-1]}: {value} is not a whole number from 1 to " in capsys.readouterr().err


@pytest.mark.parametrize("seed", [2**63, -(2**70)])
def test_a_seed_that_no_table_can_contain_is_refused(seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--vary", "speed=uniform(5, 10)", "--seed", str(seed)) == 2
    assert "seed is from " in capsys.readouterr().err
    assert not Path("out").exists()


def test_points_that_constraints_leave_out_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--vary", "speed=uniform(0, 10)", "--method", "latin", "--samples", "10", "--where", "speed < 5") == 0
    assert "5 variants" in (told := capsys.readouterr().err)
    assert "5 of 10 points meet the constraints" in told


def test_a_sweep_of_which_all_variants_fail_is_at_fault(capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--vary", "speed=values(40, 50, 60)", "--where", "speed > 1") == 1
    out, err = capsys.readouterr()
    assert "3 variants: 0 passed, 0 failed, 3 broken off; 0 without a request: " in out
    assert "all variants broke off; the most frequent reason: speed is 40, but must be at most 30" in err


def test_a_sweep_of_which_some_variants_fail_tells_their_number(capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--vary", "speed=values(10, 20, 60)", "--where", "speed > 1") == 0
    err = capsys.readouterr().err
    assert "1 of 3 variants broke off; the most frequent reason: speed is 60, but must be at most 30" in err


def test_the_summary_agrees_with_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    Path("it.xml").write_text(
        CONFLICT.format("").replace(
            "</scenario>",
            """
      <criteria><minimum_time_to_collision at_least="10"/></criteria></scenario>""",
        ),
        encoding="utf-8",
    )
    assert sweep("--vary", "speed=values(5, 20, 25, 60)", "--where", "speed > 1", "--samples", 2) == 0
    rows, _ = read_results(Path("out"))
    counts = [rows["result"].count(kind) for kind in ("pass", "fail", "error")]
    assert counts == [2, 4, 2]
    told = capsys.readouterr().out
    unasked = sum(end == "no_request" for end in rows["resolution"])
    short = sum(time is not None and not math.isnan(time) for time in rows["short_start_time"])
    assert f"8 variants: 2 passed, 4 failed, 2 broken off; {unasked} without a request; {short} that begin " in told


@pytest.mark.parametrize("target", ["it.xml", "varied.xosc"])
def test_requests_are_counted_for_automated_vehicles_only(target: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("varied.xosc").write_text(SCENARIO, encoding="utf-8")
    name = "speed" if target == "it.xml" else "Speed"
    assert sweep("--vary", f"{name}=values(5, 6)", "--duration", "0.2", target=target) == 0
    assert ("without a request" in capsys.readouterr().out) == (target == "it.xml")


def test_every_draw_and_point_is_run_with_the_given_number_of_seeds() -> None:
    assert sweep("--vary", "speed=values(5, 20)", "--vary", "number=choice(1, 2)", "--samples", 3, "--repeat", 2) == 0
    rows, _ = read_results(Path("out"))
    assert rows["seed"] == [1, 2] * 6
    assert rows["parameter.speed"] == [5.0, 5.0, 20.0, 20.0] * 3
    assert rows["parameter.number"][::2] == rows["parameter.number"][1::2]


def test_a_repeat_s_command_runs_it_again() -> None:
    assert sweep("--vary", "speed=values(5, 20)", "--repeat", 3, "--seed", 7, "--traces", "all") == 0
    folders = sorted(Path("out/traces").iterdir())
    assert len(folders) == 6
    headers = [json.loads((folder / "outcome.json").read_text(encoding="utf-8")) for folder in folders]
    assert [(one["seed"], one["variant"]) for one in headers] == [(7 + k % 3, k) for k in range(6)]
    assert (
        call("run", "it.xml", "--perception", "ideal", "--set", "speed=20", "--seed", 9, "--variant", 5, "-o", "5") == 0
    )
    again = json.loads(Path("5/outcome.json").read_text(encoding="utf-8"))
    assert again["trajectory_hash"] == headers[5]["trajectory_hash"]


def test_the_values_beside_a_boundary_are_printed_as_they_were_run(capsys: pytest.CaptureFixture[str]) -> None:
    vary = ("--vary", "speed=uniform(5, 20.1)")
    search = ("--perception", "ideal", "--boundary", "final_speed > 12", "--tolerance", "1e-9", "-o", "out")
    assert call("sweep", "it.xml", *vary, *search) == 0
    below, above = map(float, re.findall(r"speed = ([0-9.]+)", capsys.readouterr().out))
    assert 0.0 < above - below <= 1e-9
    rows, _ = read_results(Path("out"))
    assert {below, above} <= {*rows["parameter.speed"]}


def test_another_weighing_of_warnings_does_not_resume_a_sweep(capsys: pytest.CaptureFixture[str]) -> None:
    """A warning that is an error makes the variants of a structure rows with an error."""
    vary = ("--vary", "model=values(vehicle.audi.tt, vehicle.tesla.model3)")
    assert sweep(*vary) == 0
    assert sweep(*vary, "--resume", "--error", "SC513") == 2
    assert "holds another sweep: it differs in --error\n" in capsys.readouterr().err
    assert sweep(*vary, "--resume") == 0


STEERED = """\
<scenarios version="1">
  <scenario name="steered" map="town_grid" duration="0.2">
    <parameter name="who" type="text" default="lane_detection"/>
    <ego speed="9"><start><lane road="1" lane="-1" s="20"/></start><controller model="$who"/></ego>
  </scenario>
</scenarios>
"""

STRAIGHT = """\
from scenario_compiler import Control, ControllerModel


class Straight(ControllerModel):
    def control(self, sensor_data, speed, vehicle):
        return Control(throttle=0.0, steer=0.0, brake=0.0)
"""


@pytest.mark.slow
def test_another_trust_does_not_resume_a_sweep(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A variant whose code is not trusted is a row with an error."""
    Path("steered.xml").write_text(STEERED, encoding="utf-8")
    Path("straight.py").write_text(STRAIGHT, encoding="utf-8")
    vary = ("--vary", "who=values(lane_detection, straight.py:Straight)", "--no-report")
    assert call("sweep", "steered.xml", *vary, "-o", "untrusted") == 0
    assert "1 passed, 0 failed, 1 broken off" in capsys.readouterr().out
    trusted = ("--trust", "straight.py", "--resume")
    assert call("sweep", "steered.xml", *vary, *trusted, "-o", "untrusted") == 2
    assert "holds another sweep: it differs in --trust\n" in capsys.readouterr().err
    assert call("sweep", "steered.xml", *vary, *trusted, "-o", "trusted") == 0
    assert "2 passed, 0 failed, 0 broken off" in capsys.readouterr().out
    Path("elsewhere").mkdir()
    monkeypatch.chdir("elsewhere")
    elsewhere = ("--trust", "../straight.py", "--resume")
    assert call("sweep", "../steered.xml", *vary, *elsewhere, "-o", "../trusted") == 0


def test_a_lost_codebook_of_a_finished_sweep_is_written_again() -> None:
    vary = ("--vary", "speed=values(8, 12)")
    assert sweep(*vary) == 0
    codebook = Path("out/codebook.csv")
    before = codebook.read_bytes()
    codebook.unlink()
    assert sweep(*vary, "--resume") == 0
    assert codebook.read_bytes() == before


@pytest.mark.slow
def test_the_commands_of_a_report_name_the_folders_of_maps_and_templates(repository: Path) -> None:
    shutil.copytree(repository / "maps" / "town_grid", "places/my_town")
    for file in Path("places/my_town").iterdir():
        file.rename(file.with_name(file.name.replace("town_grid", "my_town")))
    about = Path("places/my_town/map.toml")
    about.write_text(about.read_text(encoding="utf-8").replace("town_grid", "my_town"), encoding="utf-8")
    Path("pieces").mkdir()
    template = (repository / "library" / "templates" / "blocked_lane.xml").read_text(encoding="utf-8")
    Path("pieces/my_lane.xml").write_text(template.replace("blocked_lane", "my_lane"), encoding="utf-8")
    text = CONFLICT.format("").replace("town_grid", "my_town").replace("<repeat", '<use template="my_lane"/><repeat')
    Path("it.xml").write_text(text, encoding="utf-8")
    folders = ("--maps", "places", "--templates", "pieces")
    varied = ("--vary", "speed=uniform(5, 20)", "--samples", 3, "--perception", "ideal", "--error", "SC301")
    assert call("sweep", "it.xml", *varied, *folders, "-o", "out") == 0
    page = html.unescape(Path("out/report.html").read_text(encoding="utf-8"))
    commands = [shlex.split(line)[1:] for line in re.findall(r"scenario-compiler (?:run|sweep) it.xml[^<]*", page)]
    assert [one[0] for one in commands] == ["run"] * 3 + ["sweep"]
    for one in commands:
        assert call(*one) == 0
    assert read_results(Path("sweep")) == read_results(Path("out"))


def test_a_row_with_an_integer_parameter_is_repeated_by_copying_its_values() -> None:
    assert sweep("--vary", "number=poisson(3)", "--vary", "speed=choice(10, 12)", "--samples", 4) == 0
    rows, _ = read_results(Path("out"))
    lines = Path("out/codebook.csv").read_text(encoding="utf-8").splitlines()
    codebook = {row["column"]: row["kind"] for row in csv.DictReader(lines)}
    assert codebook["parameter.number"] == "integer"
    assert codebook["parameter.speed"] == "number"
    copied = [f"{name}={rows[f'parameter.{name}'][2]}" for name in ("number", "speed")]
    assert re.fullmatch(r"number=\d+", copied[0])
    options = [word for text in copied for word in ("--set", text)]
    seed, variant = rows["seed"][2], rows["variant"][2]
    assert call("run", "it.xml", "--perception", "ideal", *options, "--seed", seed, "--variant", variant) == 0


@pytest.mark.parametrize("vary", ["number=choice(1, 1e300)", "number=grid(1, 1e16, 2)"])
def test_integers_that_cannot_be_written_without_an_exponent_are_refused(
    vary: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sweep("--vary", vary, "--samples", 1) == 2
    assert "'number' is of the type integer" in capsys.readouterr().err


def test_the_codebook_has_every_column_of_the_table() -> None:
    Path("it.xml").write_text(
        CONFLICT.format("").replace('max="30"', 'max="30" summary="How fast it begins."'), encoding="utf-8"
    )
    assert sweep("--vary", "speed=uniform(5, 20)", "--vary", "busy=choice(true, false)", "--samples", 3) == 0
    rows, about = read_results(Path("out"))
    with Path("out/codebook.csv").open(encoding="utf-8", newline="") as file:
        book = {row.pop("column"): row for row in csv.DictReader(file) if row["table"] == "results.parquet"}
    assert list(book) == list(rows)
    assert all(one["definition"].endswith(".") for one in book.values())
    assert (book["takeover_time"]["unit"], book["takeover_time"]["kind"]) == ("s", "number")
    assert book["parameter.speed"]["unit"] == "m/s"
    assert "How fast it begins" in book["parameter.speed"]["definition"]
    assert "uniform(5, 20)" in book["parameter.speed"]["definition"]
    assert (book["parameter.busy"]["unit"], book["parameter.busy"]["kind"]) == ("", "boolean")
    for one in about["columns"]:
        written = book[one["column"]]
        assert {name: text_cell(value) for name, value in one.items() if name != "column"} == {
            name: value for name, value in written.items() if name != "table"
        }
    empty = {name for name, values in rows.items() if None in values}
    assert {name for name in empty if not book[name]["empty"]} == set()


@pytest.mark.parametrize("address", ["banana", "http://here:1"])
def test_a_faulty_address_leaves_no_folder(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--vary", "speed=uniform(5, 10)", "--scheduler", address) == 2
    assert f"'{address}' is not an address such as tcp://" in capsys.readouterr().err
    assert not Path("out").exists()
    assert sweep("--vary", "speed=uniform(5, 10)") == 0


def test_the_page_has_all_distributions(repository: Path) -> None:
    page = (repository / "docs" / "sweeps.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `")]
    assert {name for row in rows for name in re.findall(r"`(\w+)\(", row)} == set(DISTRIBUTIONS)


def test_the_page_names_all_options_of_its_own(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Options that `run` also has are not on the page."""
    own, shared = ({*re.findall(r"--[a-z-]+", _help(command, capsys))} for command in ("sweep", "run"))
    page = (repository / "docs" / "sweeps.md").read_text(encoding="utf-8")
    assert own - shared <= {*re.findall(r"--[a-z-]+", page)}


def test_the_page_s_searches_find_what_it_says(
    repository: Path, monkeypatch: pytest.MonkeyPatch, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (repository / "docs" / "sweeps.md").read_text(encoding="utf-8")
    searching = page[page.index("## Searching") : page.index("## A cluster")].replace("\\\n", "")
    commands = [shlex.split(line)[1:] for line in searching.splitlines() if line.startswith("    scenario-compiler ")]
    assert len(commands) == 2
    monkeypatch.chdir(repository)
    for k, command in enumerate(commands):
        assert call(*command[:-1], folder / str(k)) == 0
    out = capsys.readouterr().out
    assert re.findall(r"prints `(.*?)`", searching)[0] in out
    assert "least minimum_time_to_collision" in out


def _help(command: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert call(command, "--help") == 0
    return capsys.readouterr().out


def test_surrogate_perception_says_which_variants_leave_its_domain(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--vary", "sigma=values(10, 200)", "--perception", "surrogate", "--no-report", "-o", "out")
    assert call("sweep", "sensor_failure", *options) == 0
    out = capsys.readouterr().out
    assert "1 outside the domain of surrogate perception" in out
    rows, _ = read_results(Path("out"))
    left = rows["outside_domain_time"]
    assert [time is None or math.isnan(time) for time in left] == [True, False]


def test_a_sweep_says_which_variants_begin_within_the_time_budget(capsys: pytest.CaptureFixture[str]) -> None:
    """At 13.9 m/s the budget of 7 s is 97 m; the table alone shows only that their time budgets are smaller."""
    options = ("--vary", "distance=values(60, 90, 130, 200)", "--perception", "ideal", "--no-report", "-o", "out")
    assert call("sweep", "obstacle_ahead", *options) == 0
    assert "2 that begin within the time budget" in capsys.readouterr().out
    rows, _ = read_results(Path("out"))
    short = rows["short_start_time"]
    assert [time is None or math.isnan(time) for time in short] == [False, False, True, True]
    assert [budget < 6.5 for budget in rows["time_budget"]] == [True, True, False, False]
