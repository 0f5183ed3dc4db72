"""The spawn points in a map's description (map.toml beside the OpenDRIVE file)."""

from __future__ import annotations

import filecmp
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace
from scenario_compiler.files import read_file
from scenario_compiler.resources import maps_folder

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BAD_DESCRIPTION = Code(
    "SC378",
    "bad-map-description",
    "The map.toml beside the map cannot be read as TOML, or a [[spawn_point]] in it lacks name, road, lane or s."
    "\n\n    [[spawn_point]]"
    '\n    name = "straight"'
    '\n    road = "1"'
    "\n    lane = -2"
    "\n    s = 120.0",
)


HEAD = 160
"""Number of bytes at the beginning of a file, including its header, that an export does not change."""


class NamedPosition(NamedTuple):
    """A named start position: a lane of a road at s, m."""

    road: str
    lane: int
    s: float
    summary: str


def read_spawn_points(network_path: str, sink: Diagnostics) -> dict[str, NamedPosition]:
    """Return the spawn points by name, in the order of the file; empty for a map without a description.

    A copy of a packaged map, also one made by `map export` for CARLA, uses the packaged map's description.
    """
    description = _description_file(Path(network_path))
    if not description.is_file():
        return {}
    points: dict[str, NamedPosition] = {}
    try:
        status = description.stat()
        for entry in _description(description, status.st_mtime_ns, status.st_size).get("spawn_point", []):
            points[str(entry["name"])] = NamedPosition(
                str(entry["road"]), int(entry["lane"]), float(entry["s"]), str(entry.get("summary", ""))
            )
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        sink.add(BAD_DESCRIPTION, f"cannot read the map's description: {_reason(error)}", FilePlace(str(description)))
    return points


def _description_file(network: Path) -> Path:
    """Return the description beside a map, or else that of the packaged map of which it is a copy."""
    beside = network.parent / "map.toml"
    if beside.is_file() or not network.is_file():
        return beside
    described = sorted(maps_folder().glob("*/map.toml"))
    equal = (one for one in described if any(_is_copy(network, map_) for map_ in one.parent.glob("*.xodr")))
    return next(equal, beside)


def _is_copy(network: Path, packaged: Path) -> bool:
    """Return whether a map is a copy of a packaged one, unchanged or exported for CARLA."""
    if filecmp.cmp(network, packaged, False):
        return True
    content = read_file(network)
    return content[:HEAD] == read_file(packaged)[:HEAD] and content == _exported(packaged)


@lru_cache(maxsize=8)
def _exported(packaged: Path) -> bytes:
    """Return a packaged map as it is exported for CARLA."""
    from scenario_compiler.document import parse_document
    from scenario_compiler.roads.export_carla import export_for_carla
    from scenario_compiler.roads.network import load_network

    sink = Diagnostics()
    document, network = parse_document(read_file(packaged), str(packaged), sink), load_network(packaged, sink=sink)
    return b"" if document is None or network is None else export_for_carla(document, network)


def _reason(error: Exception) -> str:
    """Return the fault of a description, for its author."""
    if isinstance(error, OSError):
        return str(error.strerror)
    if isinstance(error, tomllib.TOMLDecodeError):
        return f"it is not TOML: {error}"
    if isinstance(error, UnicodeDecodeError):
        return "it is not written in UTF-8"
    if isinstance(error, KeyError):
        return f"a [[spawn_point]] has no {error.args[0]}"
    return "a [[spawn_point]] has a text instead of a number, or is not a table"


@lru_cache(maxsize=8)
def _description(path: Path, modified: int, size: int) -> dict[str, Any]:
    """Return the contents of a map's description; the file is read again if it has changed."""
    del modified, size
    return tomllib.loads(read_file(path).decode())
