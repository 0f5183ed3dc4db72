"""The files of scenarios for a person at the wheel."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.live.scenarios import OPEN, SOON, TOLD


@pytest.fixture
def soon(tmp_path: Path) -> Path:
    """A request that waits for its answer."""
    return written(tmp_path / "soon.xml", SOON)


@pytest.fixture
def open_road(tmp_path: Path) -> Path:
    """A road without anything ahead."""
    return written(tmp_path / "open.xml", OPEN)


@pytest.fixture
def told(tmp_path: Path) -> Path:
    """A request that is sounded and spoken."""
    return written(tmp_path / "told.xml", TOLD)


def written(file: Path, text: str) -> Path:
    """Write a file; return it."""
    file.write_text(text, encoding="utf-8")
    return file
