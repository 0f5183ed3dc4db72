"""Fits the confidence of the learned lane detector to roads on which its network was not trained, and measures it.

    python tools/fit_learned_confidence.py MAPS OUT [--jobs 16]

The network is the packaged one. MAPS is a folder of road files of which none took part in its training
(`train_lane_network`): docs/perception-learned.md names them. It also has the files that `training_roads` makes, with
repainted copies of all but the towns. As for the classical detector, clips are seen with a confidence that was fitted
to other files (`calibration.cross_fit`); for that a few clips of each file are seen first, with a confidence that takes
what the network says. In some clips a lorry is close ahead, which hides most of both lines; the towns' clips have none,
and are those of `scenario-compiler calibrate`. learned_confidence.json, the page with the tables of the maps that are
left out, and other_roads.json, the figures of the other files, each with a fit that did not know them, are written to
OUT. The packages `xgboost` and `matplotlib` are needed.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import time
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import cv2

from scenario_compiler.perception.calibration.collect import Looks, look_at_drawn, look_at_map
from scenario_compiler.perception.calibration.cross_fit import COPY, parts_of
from scenario_compiler.perception.calibration.figures import REMEMBERING, figures_of, fitted, judged, worth
from scenario_compiler.perception.calibration.gather import (
    DRAWN_SEED,
    PART,
    Gathered,
    gather_maps,
    gather_pictures,
    seed_of,
)
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.confidence import Confidence, Tree, confidence_text
from scenario_compiler.perception.learned_detector import LEARNED_FEATURES, LearnedLaneDetector
from scenario_compiler.report.perception_page import Measured, write_perception_page
from scenario_compiler.roads import load_network

TOWNS, LEFT_OUT = ("Town03", "Town05"), ("Town03", "Town05", "soderleden")
"""The towns, which have more and other junctions than all other files together; and the maps of the tables, each with a
fit to all other files.
"""

CLIPS, OF_TOWNS, FIRST, DRAWN, PICTURES = 240, 2880, 48, 3500, 200
"""Clips of a file, of a town or a map of the tables, and of each file at first; random situations; pictures of each
situation of the bank.
"""

FEWER = {COPY: 120, "avenues_": 120, "streets_": 160, "made_up_": 160}
"""Clips of a file by the beginning of its name, where there are many of a kind."""

KINDS = {COPY: "repainted", "avenues_": "avenues", "streets_": "streets", "made_up_": "made-up"}
"""Kinds of files by the beginnings of their names."""

LORRIES = 0.12
"""Share of the clips with a lorry close ahead."""


class Part(NamedTuple):
    """Clips of a road file, or random situations if it names none."""

    file: str
    first: int
    last: int


def parts(file: str, count: int) -> list[Part]:
    """Return the parts of the clips of a file."""
    return [Part(file, k, min(k + PART, count)) for k in range(0, count, PART)]


def clips_of(name: str) -> int:
    """Return the number of clips of a file that is no town."""
    return next((count for begin, count in FEWER.items() if name.startswith(begin)), CLIPS)


def of_paint_alone() -> Confidence:
    """Return a confidence that trusts what the network takes for painted, for looks to which another one is fitted."""
    painted = LEARNED_FEATURES.index("painted")
    tree = Tree([painted, -1, painted, -1, -1], [0.0, 0.5], [[-2.0] * 3, [1.0] * 3, [2.0] * 3])
    return Confidence.of([0.0] * 3, [tree])


_seen_with: dict[str, Confidence] = {}


def _begin(seen_with: Mapping[str, Confidence]) -> None:
    cv2.setNumThreads(1)
    _seen_with.update(seen_with)


@lru_cache(maxsize=1)
def _roads(file: str) -> MapRoads:
    return MapRoads(load_network(file, cache=False), lorries=LORRIES)


@lru_cache(maxsize=1)
def _detector(name: str) -> LearnedLaneDetector:
    return LearnedLaneDetector(confidence=_seen_with.get(name) or of_paint_alone())


def looks(part: Part) -> Looks:
    """Return what the detector sees in a part."""
    numbers = range(part.first, part.last)
    if not part.file:
        return look_at_drawn(_detector(""), DRAWN_SEED, numbers)
    name = Path(part.file).stem
    return look_at_map(_roads(part.file), _detector(name), seed_of(name), numbers)


def seen(wanted: Iterable[Part], jobs: int, seen_with: Mapping[str, Confidence]) -> dict[str, Looks]:
    """Return what the detector sees in some parts, by the name of the file."""
    found: dict[str, list[Looks]] = {}
    todo = list(wanted)
    with multiprocessing.get_context("spawn").Pool(jobs, _begin, (dict(seen_with),)) as pool:
        for part, one in zip(todo, pool.imap(looks, todo), strict=True):
            if len(one.error):
                found.setdefault(Path(part.file).stem, []).append(one)
    return {name: Looks.joined(several) for name, several in found.items()}


def fits_to_others(gathered: Gathered) -> dict[str, Confidence]:
    """Return, by the name of each file, a confidence fitted to files of other parts than its own."""
    found: dict[str, Confidence] = {}
    for part in parts_of(gathered.maps, LEFT_OUT):
        found |= dict.fromkeys(part, fitted(gathered, part))
    return found


def figures_of_others(maps: Mapping[str, Looks], fits: Mapping[str, Confidence]) -> dict[str, object]:
    """Return the figures of each kind of files that are not left out, with fits that did not know them."""
    groups: dict[str, list[Looks]] = {}
    for name, one in maps.items():
        if name not in LEFT_OUT:
            kind = next((kind for begin, kind in KINDS.items() if name.startswith(begin)), "road files")
            groups.setdefault(kind, []).append(judged(one, fits[name]))
    figures: dict[str, object] = {}
    for kind, several in groups.items():
        together = Looks.joined(several)
        number = together.condition("number")
        single, driving = worth(kind, together.only(number == 0)), worth(kind, together.only(number >= REMEMBERING))
        figures[kind] = {"single": asdict(single), "driving": asdict(driving)}
    return figures


def main() -> None:
    """Look, fit and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--jobs", type=int, default=16)
    options = parser.parse_args()
    began, jobs = time.monotonic(), options.jobs
    options.out.mkdir(parents=True, exist_ok=True)
    files = sorted(options.maps.glob("*.xodr"))
    left_out = [file for file in files if file.stem in LEFT_OUT]
    drawn = seen(parts("", DRAWN), jobs, {})[""]
    first = seen((part for file in files for part in parts(str(file), min(FIRST, clips_of(file.stem)))), jobs, {})
    fits = fits_to_others(Gathered(first, (), drawn, FIRST))
    others = (part for file in files if file.stem not in TOWNS for part in parts(str(file), clips_of(file.stem)))
    towns = [file for file in files if file.stem in TOWNS]
    maps = seen(others, jobs, fits) | gather_maps("learned", towns, OF_TOWNS, jobs, fits)
    gathered = Gathered({name: maps[name] for name in sorted(maps)}, (), drawn, OF_TOWNS)
    confidence = fitted(gathered)
    text = confidence_text(confidence, LearnedLaneDetector.features)
    (options.out / LearnedLaneDetector.confidence_file).write_text(text, encoding="utf-8")
    fits = fits_to_others(gathered)
    figures = json.dumps(figures_of_others(gathered.maps, fits), indent=1)
    (options.out / "other_roads.json").write_text(figures + "\n", encoding="utf-8")
    tables = gather_maps("learned", left_out, OF_TOWNS, jobs, fits)
    bank, _ = gather_pictures("learned", PICTURES, jobs, seen_with=confidence)
    sides = sum(len(one.error) for one in gathered.maps.values())
    print(f"{sides} sides on {len(gathered.maps)} files, and {len(drawn.error)} in random situations")
    minutes = (time.monotonic() - began) / 60.0
    command = "python tools/fit_learned_confidence.py MAPS OUT"
    looked = (
        f"{OF_TOWNS} clips of six images on each of {len(tables)} maps, and the fits saw {sides} sides on {len(files)}"
    )
    shown = figures_of(Gathered(tables, bank, drawn, OF_TOWNS), LEFT_OUT, None)
    write_perception_page(shown, Measured("learned", command, minutes, jobs, looked, PICTURES), options.out, confidence)


if __name__ == "__main__":
    main()
