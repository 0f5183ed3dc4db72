"""Fits the confidence to clips that were seen with a confidence that did not know their maps.

The confidence decides what is remembered from one image to the next (`LaneState.after`), and the memory is an input of
the confidence. Had the clips been seen with a confidence that was fitted to them, the memory would be better than on
roads that nobody knows, and a fit would learn to distrust whatever is not remembered: on towns that were left out,
boundaries of medium confidence were right up to 0.15 more often than it said. So the maps are divided into parts, and
each part is seen with a confidence fitted to the others, as in cross-fitting (V. Chernozhukov et al., Double/debiased
machine learning, arXiv 1608.00060).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from scenario_compiler.perception.calibration.figures import fitted
from scenario_compiler.perception.calibration.gather import Gathered, Progress, gather_maps
from scenario_compiler.perception.confidence import Confidence
from scenario_compiler.perception.detectors import DetectorName

PARTS = 4
"""Number of parts of the maps that are not left out; each of the others is a part of its own."""

COPY = "repainted_"
"""Beginning of the name of a map's repainted copy (`tools/training_roads.py`), which belongs to the map's part."""

MORE = 6
"""Factor by which a map that is left out of a fit has more clips: the tables are of such maps alone, and a bin of a few
hundred sides would have the largest error by chance."""


def parts_of(names: Sequence[str], left_out: Sequence[str]) -> list[frozenset[str]]:
    """Return the parts of the maps with these names, in the order of their first maps; copies are with their maps."""
    roads = sorted({name.removeprefix(COPY) for name in names})
    others = [road for road in roads if road not in left_out]
    parts = [[road] for road in roads if road in left_out] + [others[k::PARTS] for k in range(PARTS)]
    members = (frozenset(name for name in names if name.removeprefix(COPY) in part) for part in parts)
    return [part for part in members if part]


def seen_across(
    detector: DetectorName,
    maps: Sequence[Path],
    gathered: Gathered,
    processes: int,
    left_out: Sequence[str] = (),
    progress: Progress | None = None,
) -> Gathered:
    """Return the observations of the same clips, each seen with a confidence fitted to the other parts.

    Args:
        detector: Name of the detector.
        maps: The road files.
        gathered: Observations of their clips, to which the confidences are fitted.
        processes: Number of worker processes.
        left_out: Names of maps that are a part of their own.
        progress: Where progress is reported.
    """
    seen_with: dict[str, Confidence] = {}
    for part in parts_of(list(gathered.maps), left_out):
        if len(part) < len(gathered.maps):
            seen_with |= dict.fromkeys(part, fitted(gathered, part))
    return replace(gathered, maps=gather_maps(detector, maps, gathered.clips, processes, seen_with, progress))


def with_left_out(
    detector: DetectorName,
    maps: Sequence[Path],
    gathered: Gathered,
    processes: int,
    left_out: Sequence[str],
    progress: Progress | None = None,
) -> Gathered:
    """Return the observations with `MORE` clips of the maps left out, seen with a confidence fitted to the others.

    The arguments are those of `seen_across`.
    """
    copies = {name: {one for one in gathered.maps if one.removeprefix(COPY) == name} for name in left_out}
    seen_with = {name: fitted(gathered, copies[name]) for name in left_out}
    chosen = [path for path in maps if path.stem in left_out]
    seen = gather_maps(detector, chosen, MORE * gathered.clips, processes, seen_with, progress)
    return replace(gathered, maps={**gathered.maps, **seen})
