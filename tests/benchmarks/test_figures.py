"""The table of figures can be printed; its values are measured by hand."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_the_language_servers_table_has_a_line_for_each_answer() -> None:
    script = Path(__file__).parent / "editor_figures.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=300, check=True)
    assert done.stdout.count(" of 100 ms") == 8


@pytest.mark.slow
def test_the_table_is_printed() -> None:
    script = Path(__file__).parent / "figures.py"
    done = subprocess.run(
        [sys.executable, str(script), "--short", "--runs", "1"], capture_output=True, text=True, timeout=300, check=True
    )
    assert "entity-steps/s" in done.stdout
    assert "ms a variant" in done.stdout


@pytest.mark.slow
def test_the_table_of_pictures_is_printed() -> None:
    script = Path(__file__).parent / "camera_figures.py"
    done = subprocess.run([sys.executable, str(script), "--rounds", "2"], capture_output=True, text=True, check=True)
    assert "1280 x 720, hard rain, 4 vehicles" in done.stdout
    assert "sensor health to lane detection" in done.stdout


@pytest.mark.slow
def test_the_table_of_surrogate_perception_is_printed() -> None:
    script = Path(__file__).parent / "surrogate_figures.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=300, check=True)
    assert done.stdout.count("million steps in a CPU second") == 5
    assert "10000 variants of markings_missing" in done.stdout
