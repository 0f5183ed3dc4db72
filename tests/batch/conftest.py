"""A short conflict with parameters of every kind, and sweeps of it."""

from __future__ import annotations

from pathlib import Path

import pytest

CONFLICT = """<?xml version="1.0" encoding="UTF-8"?>
<scenarios version="1">
  <scenario name="short" map="town_grid" duration="6" step="0.05" control_every="2">
    <parameter name="distance" type="length" default="60" min="10" max="350"/>
    <parameter name="speed" type="speed" default="13.9"/>
    <parameter name="preset" type="text" default="study_means"/>
    <parameter name="weather" type="text" default="ClearNoon"/>
    <ego speed="$speed"><start><spawn_point name="main_street"/></start></ego>
    <use template="blocked_lane" distance="$distance"/>
    <takeover budget="7"><cause kind="path_blocked"/><driver preset="$preset"/></takeover>
    <criteria><no_collision/><stay_on_road/><minimum_time_to_collision at_least="1.5"/></criteria>
  </scenario>
</scenarios>
"""


def conflict_in(folder: Path) -> Path:
    """Write a conflict of 6 s: a blocked lane ahead of an ego vehicle at 13.9 m/s; return its file."""
    path = folder / "short.xml"
    path.write_text(CONFLICT, encoding="utf-8")
    return path


@pytest.fixture
def conflict(tmp_path: Path) -> Path:
    """File of the conflict."""
    return conflict_in(tmp_path)
