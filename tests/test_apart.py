"""Tests that run in a process of their own are reported as all others are, however their process ends."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

TESTS = """
import os, signal
import pytest

pytestmark = pytest.mark.apart

def test_passes():
    pass

def test_fails():
    assert 1 + 1 == 3

def test_skips():
    pytest.skip("it lacks something")

def test_skips_while_it_is_set_up(request):
    request.getfixturevalue("lacking")

@pytest.fixture
def lacking():
    pytest.skip("a fixture lacks something")

def test_is_killed():
    os.kill(os.getpid(), signal.SIGKILL)

def test_leaves():
    os._exit(0)
"""


def test_reports_of_other_processes_are_complete(repository: Path, tmp_path: Path) -> None:
    (tmp_path / "test_them.py").write_text(TESTS, encoding="utf-8")
    words = [sys.executable, "-m", "pytest", "-p", "tests.apart", "-c", str(repository / "pyproject.toml")]
    done = subprocess.run(
        [*words, "-p", "no:cacheprovider", str(tmp_path)], cwd=repository, capture_output=True, text=True, check=False
    )
    assert "3 failed, 1 passed, 2 skipped" in done.stdout, done.stdout + done.stderr
    assert "test_them.py:14: it lacks something" in done.stdout
    assert "assert (1 + 1) == 3" in done.stdout
    assert "the process of the test was ended 2 times, by SIGKILL" in done.stdout
    assert "the process of the test ended without a report" in done.stdout
    assert done.returncode == 1
