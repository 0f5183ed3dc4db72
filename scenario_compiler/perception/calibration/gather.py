"""Gathers observations on several cores: of clips on maps, of the bank, and of random situations."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple

import cv2

from scenario_compiler.interruption import left_to_this_process
from scenario_compiler.perception.calibration.bank import BANK
from scenario_compiler.perception.calibration.collect import Looks, look_at_bank, look_at_drawn, look_at_map
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.confidence import Confidence
from scenario_compiler.perception.detectors import DetectorName, create_detector
from scenario_compiler.perception.lane_detector import CalibratedDetector
from scenario_compiler.randomness import hash_bits
from scenario_compiler.roads import load_network

PART = 24
"""Number of clips of a job, which share the wear of the paint."""

SEED, BANK_SEED, DRAWN_SEED = 11, 5, 23


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
    lorries: float = 0.0


Progress = Callable[[int, int], None]
"""Called with the number of finished jobs and that of all jobs."""


def gather_maps(
    detector: DetectorName,
    maps: Sequence[Path],
    clips: int,
    processes: int,
    seen_with: Mapping[str, Confidence] = MappingProxyType({}),
    progress: Progress | None = None,
    lorries: float = 0.0,
) -> dict[str, Looks]:
    """Return the observations of clips, by the map's name.

    Args:
        detector: Name of the detector.
        maps: Road files; one without a driving lane gives nothing.
        clips: Number of clips of each map.
        processes: Number of worker processes.
        seen_with: The confidence with which the clips of a map are seen, by its name; it decides what is remembered.
            Other maps are seen with the packaged confidence.
        progress: Where progress is reported.
        lorries: Share of the clips in which a lorry is close ahead.

    Raises:
        CompileError: A road file cannot be read.
    """
    parts = [(k, min(k + PART, clips)) for k in range(0, clips, PART)]
    jobs = [_Job(detector, "map", str(path), *part, lorries) for path in maps for part in parts]
    by_map: dict[str, list[Looks]] = {}
    for job, looks in zip(jobs, _done(jobs, processes, seen_with, progress), strict=True):
        if len(looks.error):
            by_map.setdefault(Path(job.which).stem, []).append(looks)
    return {name: Looks.joined(parts) for name, parts in by_map.items()}


def gather_bank(
    detector: DetectorName,
    pictures: int,
    processes: int,
    progress: Progress | None = None,
    seen_with: Confidence | None = None,
) -> tuple[Looks, ...]:
    """Return the observations of each situation of the bank, seen without memory.

    Args:
        detector: Name of the detector.
        pictures: Number of pictures of each situation.
        processes: Number of worker processes.
        progress: Where progress is reported.
        seen_with: The confidence with which they are seen, the packaged one if None.
    """
    jobs = [_Job(detector, "bank", str(number), 0, pictures) for number in range(len(BANK))]
    return tuple(_done(jobs, processes, _of_no_map(seen_with), progress))


def gather_drawn(
    detector: DetectorName,
    count: int,
    processes: int,
    progress: Progress | None = None,
    seen_with: Confidence | None = None,
) -> Looks:
    """Return the observations of `count` random situations, seen without memory (see `gather_bank`)."""
    jobs = [_Job(detector, "drawn", "", k, min(k + PART, count)) for k in range(0, count, PART)]
    return Looks.joined(_done(jobs, processes, _of_no_map(seen_with), progress))


def _of_no_map(seen_with: Confidence | None) -> dict[str, Confidence]:
    return {} if seen_with is None else {NO_MAP: seen_with}


def _done(
    jobs: Sequence[_Job], processes: int, seen_with: Mapping[str, Confidence], progress: Progress | None
) -> list[Looks]:
    done: list[Looks] = []
    with left_to_this_process():
        workers = multiprocessing.get_context("spawn").Pool(processes, _begin, (dict(seen_with),))
    with workers as pool:
        for number, looks in enumerate(pool.imap(_do, jobs), 1):
            done.append(looks)
            if progress is not None:
                progress(number, len(jobs))
    return done


_seen_with: dict[str, Confidence] = {}
"""The confidence with which this worker process sees the clips of a map, by the map's name."""


def _begin(seen_with: dict[str, Confidence]) -> None:
    cv2.setNumThreads(1)
    _seen_with.update(seen_with)


NO_MAP = ""
"""Stands for a map's name where pictures are of none."""


@lru_cache(maxsize=1)
def _detector(name: DetectorName, on_map: str = NO_MAP) -> CalibratedDetector:
    return create_detector(name, confidence=_seen_with.get(on_map))


@lru_cache(maxsize=1)
def _roads(path: str, lorries: float) -> MapRoads:
    return MapRoads(load_network(path), lorries=lorries)


def _do(job: _Job) -> Looks:
    if job.kind == "bank":
        return look_at_bank(_detector(job.detector), int(job.which), BANK_SEED, job.last)
    if job.kind == "drawn":
        return look_at_drawn(_detector(job.detector), DRAWN_SEED, range(job.first, job.last))
    name = Path(job.which).stem
    return look_at_map(
        _roads(job.which, job.lorries), _detector(job.detector, name), seed_of(name), range(job.first, job.last)
    )


def seed_of(name: str) -> int:
    """Return the seed of a map's clips, by the map's name.

    Each map has its own: if the clips of all maps had the same weather, noise and traffic, there would be only as many
    kinds of those as clips of one map, and a fit would learn them by heart.
    """
    return hash_bits(SEED, 0, name)
