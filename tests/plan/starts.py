"""A conflict whose start a parameter can make wrong."""

from __future__ import annotations

from pathlib import Path


def parked_ahead(folder: Path) -> Path:
    """Write a conflict in which a parked car stands `far` metres ahead of a cone: on it, free, or beyond the road."""
    path = folder / "start.xml"
    path.write_text(
        '<scenarios version="1"><scenario name="start" map="highway_loop" duration="3" step="0.05">'
        '<parameter name="far" type="length" default="30"/>'
        '<ego speed="10"><start><lane road="1" lane="-1" s="20"/></start></ego>'
        '<static id="cone"><at><lane road="1" lane="-3" s="20"/></at></static>'
        '<static id="parked"><at><ahead_of entity="cone" distance="$far"/></at></static>'
        "</scenario></scenarios>",
        encoding="utf-8",
    )
    return path
