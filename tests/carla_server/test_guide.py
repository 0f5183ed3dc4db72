"""The guide's commands run, and the example runs as it is written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import cv2
import pytest
import yaml

from tests.carla_server.conftest import Served, free_port
from tests.pages import code_blocks

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "carla-server.md").read_text(encoding="utf-8")


def test_the_example_drives_and_takes_a_picture(server: Served, tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    command = [sys.executable, str(ROOT / "examples" / "carla_client.py"), str(picture), str(server.port)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] in GUIDE
    image = cv2.imread(str(picture))
    assert image is not None
    assert image.shape == (600, 800, 3)
    world = server.client().get_world()
    assert not world.get_settings().synchronous_mode
    assert list(world.get_actors().filter("vehicle.*")) == []


@pytest.mark.slow
def test_the_pipelines_commands_run(client_version: str, tmp_path: Path) -> None:
    (workflow,) = code_blocks(GUIDE, "yaml")
    steps = yaml.safe_load(workflow)["jobs"]["drive"]["steps"]
    commands = steps[-1]["run"].replace("serve-carla", f"serve-carla --carla-version {client_version}")
    port = free_port()
    commands = commands.replace("2000", f"{port}").replace("picture.png", f"{tmp_path}/picture.png {port}")
    script = f"set -em\ncd {tmp_path}\nln -s {ROOT}/examples\n{commands}wait\n"
    paths = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, timeout=180, check=False, env=paths)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "picture.png").is_file()
