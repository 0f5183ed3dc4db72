"""Finds and loads the map of a scenario or of a stored plan."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from scenario_compiler.diagnostics import (
    Code,
    Diagnostic,
    Diagnostics,
    FilePlace,
    Place,
    Severity,
    did_you_mean,
)
from scenario_compiler.files import is_file
from scenario_compiler.plan.model import Plan
from scenario_compiler.resources import PUBLISHED_AS, MapNotFoundError, find_map, known_maps, portable
from scenario_compiler.roads import Network, load_network

MAP_OF_RUN = "map.xodr"
"""Name of the map's file in the folder of a run."""

UNKNOWN_MAP = Code(
    "SC204",
    "unknown-map",
    "There is no OpenDRIVE file of that name on the map search path: the folder of the scenario's file, the folders "
    "of --maps, $SCENARIO_COMPILER_MAPS, $CARLA_ROOT/CarlaUE4/Content/Carla/Maps/OpenDrive, and the packaged maps. "
    "CARLA's towns are not packaged: they are part of a CARLA installation (set CARLA_ROOT), and `open(name, "
    "'w').write(world.get_map().to_opendrive())` saves one from a running server.\n\n"
    '    <scenario map="highway_lop" ...>     the packaged map is called highway_loop',
)
CHANGED_MAP = Code(
    "SC231",
    "changed-map",
    "The map has changed since the plan was compiled, so the plan's positions may no longer be correct. Compile the "
    "scenario again.\n\n"
    "    scenario-compiler compile conflict.xml -o plan.json     binds the positions to the map as it is now",
)


def open_map(
    name: str, beside: Path | None, place: Place, sink: Diagnostics, maps: Sequence[Path] = ()
) -> Network | None:
    """Find and load a map; if it is not found, report where it was looked for."""
    try:
        path = find_map(name, beside=beside, folders=maps)
    except MapNotFoundError as missing:
        folders = list(dict.fromkeys(str(file.parent) for file in missing.looked))
        hint = f"did you mean '{portable(name)}'?" if "\\" in name else did_you_mean(Path(name).stem, known_maps(maps))
        get = "give its folder with --maps, or set CARLA_ROOT to a CARLA installation for CARLA's towns"
        published = f"it is published as {PUBLISHED_AS[name]}.xodr" if name in PUBLISHED_AS else hint
        get = f"{published} Or {get}" if published.endswith("?") else "; ".join(filter(None, (published, get)))
        hint = f"{get}; looked in: {', '.join(folders)}"
        sink.add(UNKNOWN_MAP, f"there is no map '{name}'", place, hint=hint)
        return None
    status = path.stat()
    network, findings = _loaded(path, status.st_mtime_ns, status.st_size)
    sink.take(findings)
    return network


@lru_cache(maxsize=2)
def _loaded(path: Path, modified: int, size: int) -> tuple[Network | None, tuple[Diagnostic, ...]]:
    """Return a map and its diagnostics. The file is read once for all scenarios, unless it has changed."""
    del modified, size
    sink = Diagnostics()
    return load_network(path, sink=sink), tuple(_counted(sink, path))


def _counted(found: Diagnostics, path: Path) -> Iterator[Diagnostic]:
    """Yield the errors of a map, and the first warning of each code with the number of these warnings."""
    mild = [one for one in found if one.severity is not Severity.ERROR]
    counts = Counter(one.code for one in mild)
    yield from (one for one in found if one.severity is Severity.ERROR)
    for one in mild:
        more = counts.pop(one.code, 0) - 1
        if more > 0:
            hint = f"{more} more in this map: `scenario-compiler map check {path}` shows them"
            yield replace(one, hint="; ".join(part for part in (one.hint, hint) if part))
        elif more == 0:
            yield one


def open_plan_map(
    plan: Plan, sink: Diagnostics, maps: Sequence[Path] = (), beside: Path | None = None
) -> Network | None:
    """Load the map of a stored plan.

    It is the map in the plan's own folder if that is the folder of a run, otherwise the file with which the plan was
    compiled, otherwise a map of the same name on the search path.

    Args:
        plan: The plan.
        sink: The sink for diagnostics.
        maps: Folders in which the map is looked for first.
        beside: Folder of the plan; None if it has none.
    """
    own = None if beside is None else beside / MAP_OF_RUN
    name = plan.map.file if is_file(Path(plan.map.file)) else plan.map.name
    if own is not None and own.is_file():
        name = str(own.resolve())
    network = open_map(name, None, FilePlace(plan.name), sink, maps)
    if network is not None and network.sha256 != plan.map.sha256:
        sink.add(CHANGED_MAP, f"the map '{plan.map.name}' differs from the map of the plan", FilePlace(network.path))
        return None
    return network
