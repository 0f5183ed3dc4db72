"""docs/pipelines.md, the action and the pre-commit hook are correct: their commands run, on good and faulty files."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from scenario_compiler.resources import library_folder
from tests.pages import code_blocks

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "docs" / "pipelines.md").read_text(encoding="utf-8")
ACTION: dict[str, Any] = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
HOOKS: list[dict[str, Any]] = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
BLOCKS = {name: yaml.safe_load(text) for name, text in re.findall(r"```yaml\n# (\S+)\n(.*?)```", PAGE, re.DOTALL)}
SHELL = [line for block in code_blocks(PAGE, "sh") for line in block.splitlines()]
GITLAB = [line for steps in BLOCKS[".gitlab-ci.yml"].values() for line in steps["script"]]
COMMANDS = [
    line for line in dict.fromkeys([*SHELL, *GITLAB]) if line not in BLOCKS[".gitlab-ci.yml"]["sweep"]["script"]
]
"""The page's commands, each once; the sweep's are run as a job."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a library of two conflicts, as the page names it."""
    (tmp_path / "conflicts").mkdir()
    for name in ("obstacle_ahead.xml", "ramp_blocked.xml"):
        shutil.copy(library_folder() / "conflicts" / name, tmp_path / "conflicts")
    return tmp_path


def shell(script: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a script as GitHub and GitLab do: the first command that fails ends it."""
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script]
    given = {**os.environ, "PATH": path, **environment}
    return subprocess.run(command, cwd=folder, env=given, capture_output=True, text=True, timeout=300, check=False)


def break_one(folder: Path) -> None:
    """Put a fault into one of the conflicts."""
    file = folder / "conflicts" / "obstacle_ahead.xml"
    file.write_text(
        file.read_text(encoding="utf-8").replace('preset="study_means"', 'preset="study_mean"'), encoding="utf-8"
    )


@pytest.mark.parametrize("line", COMMANDS)
def test_a_command_of_the_page_runs(folder: Path, line: str) -> None:
    done = shell(line, folder)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_gitlab_gets_what_its_job_promises(folder: Path) -> None:
    break_one(folder)
    jobs = BLOCKS[".gitlab-ci.yml"]
    assert shell("\n".join(jobs["conflicts"]["script"]), folder).returncode == 1
    report = json.loads((folder / jobs["conflicts"]["artifacts"]["reports"]["codequality"]).read_text(encoding="utf-8"))
    assert [(one["check_name"], one["location"]["path"]) for one in report] == [
        ("SC218 unknown-driver", "conflicts/obstacle_ahead.xml")
    ]
    shutil.copy(library_folder() / "conflicts" / "obstacle_ahead.xml", folder / "conflicts")
    assert shell("\n".join(jobs["sweep"]["script"]), folder).returncode == 0
    assert [path for path in jobs["sweep"]["artifacts"]["paths"] if not (folder / path).exists()] == []


def inputs(**given: str) -> dict[str, str]:
    """Return the action's inputs: the given ones, otherwise their defaults."""
    assert set(given) <= set(ACTION["inputs"])
    defaults = {name: str(one.get("default", "")) for name, one in ACTION["inputs"].items()}
    return defaults | given


def step(name: str, folder: Path, given: Mapping[str, str]) -> tuple[subprocess.CompletedProcess[str], dict[str, str]]:
    """Run a step of the action; return its result and its outputs."""
    (found,) = (one for one in ACTION["runs"]["steps"] if one.get("name") == name)
    assert found["shell"] == "bash"

    def valued(text: str) -> str:
        text = re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda one: given[one.group(1)], text)
        return re.sub(r"\$\{\{ runner\.temp \}\}", str(folder), text)

    environment = {name: valued(str(text)) for name, text in found["env"].items()}
    outputs = folder / "outputs"
    outputs.write_text("", encoding="utf-8")
    done = shell(found["run"], folder, **environment, GITHUB_OUTPUT=str(outputs))
    return done, dict(line.split("=", 1) for line in outputs.read_text(encoding="utf-8").splitlines())


def test_no_input_is_put_into_a_script() -> None:
    scripts = [one["run"] for one in ACTION["runs"]["steps"] if "run" in one]
    assert len(scripts) == 3
    assert [script for script in scripts if "${{" in script] == []
    used = re.findall(r"inputs\.([\w-]+)", json.dumps(ACTION["runs"]))
    assert set(used) == set(ACTION["inputs"])


def test_the_action_passes_good_files(folder: Path) -> None:
    done, outputs = step("Validate", folder, inputs(paths="conflicts\n", strict="true"))
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
    assert json.loads(Path(outputs["sarif"]).read_text(encoding="utf-8"))["runs"][0]["results"] == []


def test_the_action_annotates_faults_and_writes_sarif(folder: Path) -> None:
    break_one(folder)
    done, outputs = step("Validate", folder, inputs(paths="conflicts/ramp_blocked.xml\n\nconflicts/obstacle_ahead.xml"))
    assert done.returncode == 1
    assert done.stdout.startswith("::error file=conflicts/obstacle_ahead.xml,line=20,")
    (result,) = json.loads(Path(outputs["sarif"]).read_text(encoding="utf-8"))["runs"][0]["results"]
    assert result["ruleId"] == "SC218"


def test_the_action_takes_folders_of_templates_and_maps(folder: Path) -> None:
    (folder / "our templates").mkdir()
    (folder / "our templates" / "ours.xml").write_text(
        '<scenarios version="1"><template name="ours"><static id="a"><at><ahead_of entity="ego" distance="90"/></at>'
        "</static></template></scenarios>",
        encoding="utf-8",
    )
    file = folder / "conflicts" / "obstacle_ahead.xml"
    text = re.sub(r'<use template="blocked_lane"[^>]*/>', '<use template="ours"/>', file.read_text(encoding="utf-8"))
    file.write_text(re.sub(r"<parameter [^>]*/>", "", text), encoding="utf-8")
    assert step("Validate", folder, inputs(paths="conflicts"))[0].returncode == 1
    (folder / "our maps").mkdir()
    given = inputs(paths="conflicts", templates="our templates\n", maps="our maps")
    done, _ = step("Validate", folder, given)
    assert done.returncode == 0, done.stdout


def test_the_action_gates_the_pass_rate(folder: Path) -> None:
    asked = BLOCKS[".github/workflows/conflicts.yml"]["jobs"]["conflicts"]["steps"][1]["with"]
    given = inputs(**{name: str(value) for name, value in asked.items()} | {"samples": "1"})  # it is drawn sooner
    done, outputs = step("Sweep", folder, given)
    assert done.returncode == 0, done.stderr
    assert "1 of 1 variants passed" in done.stdout
    assert (Path(outputs["folder"]) / "report.html").is_file()
    shutil.rmtree(outputs["folder"])
    file = folder / "conflicts" / "obstacle_ahead.xml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("<no_collision/>", '<minimum_time_to_collision at_least="30"/>'), encoding="utf-8")
    done, _ = step("Sweep", folder, given)
    assert done.returncode == 3, done.stdout + done.stderr
    assert "less than the required share of 0.9" in done.stderr


def test_the_workflow_gives_the_action_inputs_that_it_has() -> None:
    steps = BLOCKS[".github/workflows/conflicts.yml"]["jobs"]["conflicts"]["steps"]
    assert set(steps[1]["with"]) <= set(ACTION["inputs"])
    required = {name for name, one in ACTION["inputs"].items() if one.get("required")}
    assert required <= set(steps[1]["with"])


def test_the_hook_checks_the_files_it_gets(folder: Path) -> None:
    (hook,) = HOOKS
    (repository,) = BLOCKS[".pre-commit-config.yaml"]["repos"]
    assert [one["id"] for one in repository["hooks"]] == [hook["id"]]
    names = ("conflicts/obstacle_ahead.xml", "a.xosc", "b.xodr", "c.xsd", "d.xml.txt")
    assert [name for name in names if re.search(hook["files"], name)] == list(names[:3])
    assert re.search(repository["hooks"][0]["files"], names[0])
    line = shlex.join([*shlex.split(hook["entry"]), "conflicts/obstacle_ahead.xml", "conflicts/ramp_blocked.xml"])
    assert shell(line, folder).returncode == 0
    break_one(folder)
    assert shell(line, folder).returncode == 1


def test_every_format_of_the_program_is_in_its_help(folder: Path) -> None:
    done = shell("scenario-compiler --version && scenario-compiler validate --help", folder)
    assert re.match(r"scenario-compiler \d+\.\d+\.\d+\n", done.stdout)
    assert "{text,json,sarif,github,gitlab}" in done.stdout
