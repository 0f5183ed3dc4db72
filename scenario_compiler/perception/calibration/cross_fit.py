"""Fits the confidence to clips that were seen with a confidence that did not know their maps.

The confidence decides what is remembered from one image to the next (`LaneState.after`), and the memory is an input of
the confidence. Had the clips been seen with a confidence that was fitted to them, the memory would be better than on
roads that nobody knows, and a fit would learn to distrust whatever is not remembered: on towns that were left out,
boundaries of medium confidence were right up to 0.15 more often than it said. So the maps are divided into parts, and
each part is seen with a confidence fitted to the others, as in cross-fitting (V. Chernozhukov et al., Double/debiased
machine learning, arXiv 1608.00060).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
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

MORE = 12
"""Factor by which a map that is left out of a fit has more clips: the tables are of such maps alone, and a bin of a few
hundred sides would have the largest error by chance (`fit.largest_by_chance`)."""


def copies_of(name: str, names: Collection[str]) -> frozenset[str]:
    """Return those of the names that are of one map: it and its repainted copies, whichever of them is given."""
    return frozenset(one for one in names if one.removeprefix(COPY) == name.removeprefix(COPY))


def parts_of(names: Collection[str], left_out: Collection[str]) -> list[frozenset[str]]:
    """Return the parts of the maps with these names, first those that are left out; copies are with their maps."""
    alone = {copies_of(name, names) for name in left_out}
    others = sorted({copies_of(name, names) for name in names} - alone, key=min)
    return [*sorted(alone, key=min), *(frozenset().union(*others[k::PARTS]) for k in range(min(PARTS, len(others))))]


def fits_to_others(gathered: Gathered, left_out: Collection[str], cores: int) -> dict[str, Confidence]:
    """Return, by the name of each map, a confidence fitted to the other parts; there is none if there is one part."""
    parts = parts_of(gathered.maps, left_out)
    return _fits_without([part for part in parts if len(part) < len(gathered.maps)], gathered, cores)


def _fits_without(parts: Sequence[frozenset[str]], gathered: Gathered, cores: int) -> dict[str, Confidence]:
    """Return, by the name of each map of the parts, a confidence fitted to all maps but those of its part.

    XGBoost leaves the interpreter to other threads while it works, so as many fits as there are cores go on at a time.
    """
    with ThreadPoolExecutor(cores) as threads:
        fits = list(threads.map(lambda part: fitted(gathered, part), parts))
    return {name: fit for part, fit in zip(parts, fits, strict=True) for name in part}


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
    seen_with = fits_to_others(gathered, left_out, processes)
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
    parts = {copies_of(name, gathered.maps) for name in left_out}
    seen_with = _fits_without(sorted(parts, key=min), gathered, processes)
    chosen = [path for path in maps if path.stem in left_out]
    seen = gather_maps(detector, chosen, MORE * gathered.clips, processes, seen_with, progress)
    return replace(gathered, maps={**gathered.maps, **seen})
