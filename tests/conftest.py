"""Fixtures for all tests: the checkout, the corpus, and a check of files that are made from the code."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from playwright.sync_api import Browser

from scenario_compiler.__main__ import start_lightly
from tests.apart import pytest_runtest_protocol
from tests.browser import opened_browser

__all__ = ["pytest_runtest_protocol"]

start_lightly()
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:  # as shells start what runs in the background
    signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None, max_examples=50)
settings.register_profile("quick", settings.get_profile("repeatable"), max_examples=20)
settings.load_profile("repeatable")


def pytest_configure(config: pytest.Config) -> None:
    """Draw fewer examples for a property if the slow tests are left out; `make test-all` draws all."""
    if config.getoption("markexpr") == "not slow":
        settings.load_profile("quick")


def pytest_collection_finish() -> None:
    """Leave what is there for good, thousands of tests and all modules, out of every later collection of garbage."""
    gc.collect()
    gc.freeze()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--update`: files that are made from the code are rewritten instead of compared."""
    parser.addoption("--update", action="store_true", help="rewrite generated files instead of comparing them")


@pytest.fixture(scope="session")
def repository() -> Path:
    """Root of the checkout: the folder with schemas/, library/ and maps/."""
    return Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def corpus() -> Path:
    """Folder of real OpenSCENARIO, OpenDRIVE and AISA files, named by SCENARIO_COMPILER_CORPUS."""
    named = os.environ.get("SCENARIO_COMPILER_CORPUS")
    if not named:
        pytest.skip("SCENARIO_COMPILER_CORPUS is not set")
    folder = Path(named)
    if not folder.is_dir():
        pytest.fail(f"SCENARIO_COMPILER_CORPUS names no folder: {folder}")
    return folder


@pytest.fixture(scope="session")
def golden(corpus: Path) -> Path:
    """Folder of trajectories and waypoints recorded with other programs, beside the corpus."""
    folder = corpus.parent / "golden"
    if not folder.is_dir():
        pytest.skip(f"no recorded trajectories at {folder}")
    return folder


@pytest.fixture
def assert_fresh(request: pytest.FixtureRequest) -> Callable[[Path, str], None]:
    """A check that a file holds the text made from the code; with `--update` the file is written."""
    update = bool(request.config.getoption("--update"))

    def check(path: Path, text: str) -> None:
        if update:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        assert path.is_file(), f"{path} is missing: `make generate` writes it"
        assert path.read_text(encoding="utf-8") == text, f"{path} is stale: `make generate` rewrites it"

    return check


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """The machine's Chromium, without a window."""
    with opened_browser() as opened:
        yield opened
