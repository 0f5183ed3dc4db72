"""Gathers observations on several cores: of clips on maps, of the bank, and of random situations."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal, NamedTuple

import cv2

from scenario_compiler.interruption import left_to_this_process
from scenario_compiler.perception.calibration.bank import BANK
from scenario_compiler.perception.calibration.collect import Looks, look_at_bank, look_at_drawn, look_at_map
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.detectors import DetectorName, create_detector
from scenario_compiler.perception.lane_detector import CalibratedDetector
from scenario_compiler.roads import load_network

PART = 24
"""Number of clips of a job, which share the wear of the paint."""

SEED, BANK_SEED, DRAWN_SEED = 11, 5, 23

MORE = 6
"""Factor by which a map that is left out of a fit has more clips: the tables are of such maps alone, and a bin of a few
hundred sides would have the largest error by chance."""


@dataclass(frozen=True, eq=False)
class Gathered:
    """Observations by their source.

    Attributes:
        maps: Observations of a map's clips, by the map's name.
        bank: Observations of each situation of the bank, in its order.
        drawn: Observations of random situations.
        clips: Number of clips of each map that are for fits; a map can have more.
    """

    maps: dict[str, Looks]
    bank: tuple[Looks, ...]
    drawn: Looks
    clips: int


class _Job(NamedTuple):
    detector: DetectorName
    kind: Literal["map", "bank", "drawn"]
    which: str
    first: int
    last: int


def gather(
    detector: DetectorName,
    maps: Sequence[Path],
    clips: int,
    pictures: int,
    processes: int,
    left_out: Sequence[str] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Gathered:
    """Run a detector.

    Args:
        detector: Its name.
        maps: Road files; one without a driving lane gives nothing.
        clips: Number of clips of each map; those that are left out of a fit have `MORE` times as many.
        pictures: Number of pictures of each situation of the bank; there are fifteen times as many random situations.
        processes: Number of worker processes.
        left_out: Names of the maps that are left out of a fit.
        progress: Called with the number of finished jobs and that of all jobs.

    Raises:
        CompileError: A road file cannot be read.
    """
    counts = {path: clips * (MORE if path.stem in left_out else 1) for path in maps}
    jobs = [
        _Job(detector, "map", str(path), k, min(k + PART, count))
        for path, count in counts.items()
        for k in range(0, count, PART)
    ]
    jobs += [_Job(detector, "bank", str(number), 0, pictures) for number in range(len(BANK))]
    jobs += [_Job(detector, "drawn", "", k, min(k + PART, 15 * pictures)) for k in range(0, 15 * pictures, PART)]
    done: list[Looks] = []
    with left_to_this_process():
        workers = multiprocessing.get_context("spawn").Pool(processes, _begin)
    with workers as pool:
        for number, looks in enumerate(pool.imap(_do, jobs), 1):
            done.append(looks)
            if progress is not None:
                progress(number, len(jobs))
    by_map: dict[str, list[Looks]] = {}
    for job, looks in zip(jobs, done, strict=True):
        if job.kind == "map" and len(looks.error):
            by_map.setdefault(Path(job.which).stem, []).append(looks)
    return Gathered(
        {name: Looks.joined(parts) for name, parts in by_map.items()},
        tuple(looks for job, looks in zip(jobs, done, strict=True) if job.kind == "bank"),
        Looks.joined([looks for job, looks in zip(jobs, done, strict=True) if job.kind == "drawn"]),
        clips,
    )


def _begin() -> None:
    cv2.setNumThreads(1)


@lru_cache(maxsize=1)
def _detector(name: DetectorName) -> CalibratedDetector:
    return create_detector(name)


@lru_cache(maxsize=1)
def _roads(path: str) -> MapRoads:
    return MapRoads(load_network(path))


def _do(job: _Job) -> Looks:
    if job.kind == "bank":
        return look_at_bank(_detector(job.detector), int(job.which), BANK_SEED, job.last)
    if job.kind == "drawn":
        return look_at_drawn(_detector(job.detector), DRAWN_SEED, range(job.first, job.last))
    return look_at_map(_roads(job.which), _detector(job.detector), SEED, range(job.first, job.last))
