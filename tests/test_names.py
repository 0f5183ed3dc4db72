"""Names, units and folders as people write them: each mistake gets one clear line, the same in every command."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from scenario_compiler.markup.units import in_unit
from tests.command import call

SCENARIO = """\
<scenarios version="1">
  <scenario name="s" map="{map}" duration="{duration}">
    <ego speed="{speed}"><start><lane road="1" lane="-1" s="20"/></start></ego>
    <takeover budget="{budget}"/>
  </scenario>
</scenarios>
"""
USUAL = {"map": "town_grid", "duration": "5", "speed": "10", "budget": "7"}


def said(capsys: pytest.CaptureFixture[str], *command: object) -> tuple[int, list[str]]:
    """Run a command; return its exit code and each finding as code, line, message and hint."""
    code = call(*command, "--format", "json")
    found = json.loads(capsys.readouterr().out)
    return code, [f"{one['code']} {one['line']} {one['message']} | {one['hint']}" for one in found]


def written(folder: Path, **changes: str) -> Path:
    """Write the scenario with some values and return its file."""
    file = folder / "s.xml"
    file.write_text(SCENARIO.format(**(USUAL | changes)), encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("text", "quantity", "converted"),
    [
        ("80 km/h", "speed", "22.22"),
        ("80km/h", "speed", "22.22"),
        ("50,5 km/h", "speed", "14.03"),
        ("60 mph", "speed", "26.82"),
        ("13.9 m/s", "speed", "13.9"),
        ("500 ms", "time", "0.5"),
        ("2 min", "time", "120"),
        ("3 km", "length", "3000"),
        ("1.5707963 rad", "angle", "90"),
        ("0.5 g", "acceleration", "4.903"),
        ("50 %", "fraction", "0.5"),
        ("80 km/h", "time", ""),
        ("fast", "speed", ""),
        ("", "speed", ""),
        ("1e5", "speed", ""),
    ],
)
def test_a_number_with_a_unit_is_converted(text: str, quantity: str, converted: str) -> None:
    assert in_unit(text, quantity) == converted


@pytest.mark.parametrize(("speed", "hint"), [("80 km/h", "write 22.22"), ("22,2", "write 22.2"), ("quick", "")])
def test_the_hint_says_what_to_write(tmp_path: Path, capsys: pytest.CaptureFixture[str], speed: str, hint: str) -> None:
    code, found = said(capsys, "validate", written(tmp_path, speed=speed))
    assert code == 1
    assert [one.rpartition(" | ")[2] for one in found] == [hint]


def test_a_faulty_duration_is_one_finding(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for duration in ("-5", "5 s", "0"):
        _, found = said(capsys, "validate", written(tmp_path, duration=duration))
        assert len(found) == 1, found


def test_a_path_of_windows_is_written_with_slashes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = written(tmp_path, map="..\\\\maps\\\\town_grid.xodr".replace("\\\\", "\\"))
    assert "did you mean '../maps/town_grid.xodr'?" in said(capsys, "validate", file)[1][0]
    text = file.read_text(encoding="utf-8").replace("  <scenario", '  <include file="lib\\gone.xml"/>\n  <scenario')
    file.write_text(text, encoding="utf-8")
    assert next(one for one in said(capsys, "validate", file)[1] if one.startswith("SC220")).endswith(
        "| write lib/gone.xml"
    )


FAULTY = {
    "no plan": ("a.json", '{"a": 1}', "SC130"),
    "no JSON": ("a.json", "nonsense", "SC130"),
    "a list": ("a.json", "[]", "SC130"),
    "deep JSON": ("a.json", "[" * 100_000, "SC130"),
    "not text": ("a.json", "\udcff\udcfe", "SC130"),
    "OpenSCENARIO 0.9.1": (
        "a.xosc",
        '<OpenSCENARIO><FileHeader revMajor="0" revMinor="9" date="2017" description="" author=""/>'
        '<Catalogs/><RoadNetwork><Logics filepath="road.xodr"/></RoadNetwork><Entities><Object name="Ego"/></Entities>'
        "<Storyboard/></OpenSCENARIO>",
        "SC709",
    ),
    "a namespace": ("a.xml", '<scenarios xmlns="urn:x" version="1"><template name="t"/></scenarios>', "SC116"),
    "another language": ("a.xml", "<svg/>", "SC116"),
    "a missing include": (
        "a.xml",
        SCENARIO.format(**USUAL).replace("  <scenario", '  <include file="gone.xml"/>\n  <scenario'),
        "SC220",
    ),
    "no such file": ("gone.xml", None, "SC101"),
    "no such plan": ("gone.json", None, "SC101"),
}

COMMANDS = [
    "validate {}",
    "compile {} -o made.json",
    "run {}",
    "sweep {} --vary x=values(1,2) -o swept",
    "export {} -o made.xosc",
    "preview {} -o made.png",
]


@pytest.mark.parametrize("name", FAULTY)
def test_a_mistake_gives_the_same_line_in_every_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    file, text, code = FAULTY[name]
    if text is not None:
        Path(file).write_bytes(text.encode(errors="surrogateescape"))
    told = {}
    for command in COMMANDS:
        left, found = said(capsys, *command.format(file).split())
        assert left == 1, command
        told[command] = [one for one in found if not one.startswith(("SC211", "SC212"))]
    assert set(map(tuple, told.values())) == {tuple(told["validate {}"])}, told
    assert [one[:5] for one in told["validate {}"]] == [code]


def test_a_plan_is_distinguished_from_a_scenario(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = tmp_path / "plan.json"
    call("compile", written(tmp_path), "-o", plan)
    capsys.readouterr()
    assert said(capsys, "validate", plan) == (0, [])
    code, found = said(capsys, "preview", plan, "-o", tmp_path / "x.png")
    assert (code, len(found), "`run`, `sweep` and `export` take it" in found[0]) == (1, 1, True)


def test_a_plan_that_uses_an_undeclared_parameter_is_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.json"
    call("compile", written(tmp_path), "-o", plan)
    content = json.loads(plan.read_text(encoding="utf-8"))
    content["entities"][0]["speed"] = {"expr": "$speeed + $other"}
    plan.write_text(json.dumps(content), encoding="utf-8")
    capsys.readouterr()
    for command in ("validate", "run"):
        code, found = said(capsys, command, plan)
        assert code == 1
        assert [one.split(" | ")[0] for one in found] == [
            f"SC132 0 the plan uses a parameter '{name}' that it does not declare" for name in ("other", "speeed")
        ]


def test_a_conflict_of_the_library_is_found_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert call("compile", "sensornoise", "-o", "plan.json") == 0
    assert json.loads(Path("plan.json").read_text(encoding="utf-8"))["name"] == "sensornoise"
    assert call("run", "sensornoise", "--perception", "ideal", "--duration", "0.1") == 0
    assert call("compile", "sensornoize", "-o", "plan.json") == 2
    assert "did you mean 'sensornoise'?" in capsys.readouterr().err
    Path("sensornoise").write_text("<config/>", encoding="utf-8")
    assert call("run", "sensornoise") == 1, "a file of that name comes first"


def test_list_prints_paths_that_run_takes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deep" / "er").mkdir(parents=True)
    file = written(tmp_path / "deep" / "er")
    assert call("list", "deep") == 0
    row = next(line for line in capsys.readouterr().out.splitlines() if line.split()[:1] == ["s"])
    assert row.split()[1] == "deep/er/s.xml"
    assert call("list") == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.split()[:1] == ["sensornoise"]]
    assert rows
    assert Path(rows[0][1]).is_file()
    assert call("validate", file) == 0


def test_a_run_folder_is_reported_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    home.mkdir()
    elsewhere.mkdir()
    monkeypatch.chdir(home)
    shutil.copytree(Path(__file__).parent.parent / "maps" / "town_grid", home / "mine")
    (home / "mine" / "town_grid.xodr").rename(home / "mine" / "mine.xodr")
    file = written(home, map="mine/mine")
    assert call("run", file, "--perception", "ideal", "--duration", "0.5", "-o", "out") == 0
    report = (home / "out" / "report.html").read_bytes()
    (home / "out").rename(elsewhere / "moved")
    shutil.rmtree(home / "mine")
    file.unlink()
    monkeypatch.chdir("/")
    (elsewhere / "moved" / "report.html").unlink()
    assert call("report", elsewhere / "moved") == 0
    assert (elsewhere / "moved" / "report.html").read_bytes() == report
    assert call("run", elsewhere / "moved" / "plan.json", "--trajectory", elsewhere / "again.csv") == 0
    assert call("compare", elsewhere / "moved", elsewhere / "moved") == 0


@pytest.mark.parametrize("command", [one for one in COMMANDS if not one.startswith("validate")])
def test_a_name_without_a_file_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    """The message had no path, and its hint named the files of the folder."""
    monkeypatch.chdir(tmp_path)
    assert call(*command.format("#gone").split()) == 1
    assert "#gone: error[SC101]: no file is named before the '#'\n" in capsys.readouterr().err
