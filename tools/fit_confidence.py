"""Fits the confidence of a lane detector to many roads, and measures it on maps that its fit does not know.

    python tools/fit_confidence.py DETECTOR MAPS OUT [--jobs 16]

DETECTOR is `classical` or `learned`. MAPS is a folder of road files, with those that `training_roads` makes and
repainted copies of all but the towns: docs/perception.md and docs/perception-learned.md name them. The network of the
learned detector is the packaged one, and no file may have taken part in its training (`train_lane_network`).

Clips are seen with a confidence that was fitted to other files (`calibration.cross_fit`); for that a few clips of each
file are seen first, with a confidence that takes one feature as evidence. In some clips a lorry is close ahead, which
hides most of both lines; the towns' clips have none, and are those of `scenario-compiler calibrate`. The file of the
confidence, the page with the tables of the maps that are left out, and other_roads.json, the figures of the other
files, each with a fit that did not know them, are written to OUT. The packages `xgboost` and `matplotlib` are needed.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

from scenario_compiler.perception.calibration.collect import Looks
from scenario_compiler.perception.calibration.cross_fit import COPY, fits_to_others
from scenario_compiler.perception.calibration.figures import REMEMBERING, figures_of, fitted, judged, worth
from scenario_compiler.perception.calibration.gather import Gathered, gather_bank, gather_drawn, gather_maps
from scenario_compiler.perception.confidence import Confidence, Tree, confidence_text
from scenario_compiler.perception.detectors import DETECTORS, DetectorName, detector_class
from scenario_compiler.report.perception_page import Measured, write_perception_page

TOWNS = ("Town01", "Town03", "Town04", "Town05")
"""The towns, which have more and other junctions than all other files together."""


class Recipe(NamedTuple):
    """What is different for each detector.

    Attributes:
        left_out: The maps of the tables, each with a fit to all other files.
        evidence: The feature that is taken as evidence of paint at first, and the number from which on it is.
    """

    left_out: tuple[str, ...]
    evidence: tuple[str, float]


RECIPES: Mapping[DetectorName, Recipe] = {
    "classical": Recipe(TOWNS, ("prominence", 2.2)),
    "learned": Recipe(("Town03", "Town05", "soderleden"), ("painted", 0.5)),
}

OF_TOWNS, OF_TABLES, FIRST, DRAWN, PICTURES = 2880, 8640, 24, 3500, 200
"""Clips of a town for the fits, of each map for the tables, and of each file at first; random situations; pictures of
each situation of the bank.
"""

KINDS = {
    COPY: ("repainted", 60),
    "avenues_": ("avenues", 60),
    "crossings_": ("crossings", 84),
    "motorways_": ("motorways", 108),
    "streets_": ("streets", 84),
    "wide_": ("wide streets", 108),
    "made_up_": ("made-up", 84),
    "": ("road files", 120),
}
"""Kinds of files by the beginnings of their names, and the clips of a file of each; the first that fits."""

LORRIES = 0.12
"""Share of the clips with a lorry close ahead."""


def kind_of(name: str) -> tuple[str, int]:
    """Return the kind of a file, and the clips of each such file that is no town."""
    return next(kind for begin, kind in KINDS.items() if name.startswith(begin))


def of_evidence(detector: DetectorName) -> Confidence:
    """Return a confidence that takes one feature as evidence, for looks to which another one is fitted."""
    name, threshold = RECIPES[detector].evidence
    feature = detector_class(detector).features.index(name)
    return Confidence.of([0.0] * 3, [Tree([feature, -1, -1], [threshold], [[-2.0] * 3, [2.0] * 3])])


def looks_at(
    detector: DetectorName, files: Sequence[Path], fits: Mapping[str, Confidence], jobs: int
) -> dict[str, Looks]:
    """Return the looks at the files by their names, each file seen with its fit."""
    towns = [file for file in files if file.stem in TOWNS]
    maps = gather_maps(detector, towns, OF_TOWNS, jobs, fits)
    for kind, clips in KINDS.values():
        some = [file for file in files if file.stem not in TOWNS and kind_of(file.stem)[0] == kind]
        maps |= gather_maps(detector, some, clips, jobs, fits, lorries=LORRIES)
    return {name: maps[name] for name in sorted(maps)}


def figures_of_others(
    maps: Mapping[str, Looks], fits: Mapping[str, Confidence], left_out: Collection[str]
) -> dict[str, object]:
    """Return the figures of each kind of files that are not left out, with fits that did not know them."""
    groups: dict[str, list[Looks]] = {}
    for name, one in maps.items():
        if name not in left_out:
            groups.setdefault(kind_of(name)[0], []).append(judged(one, fits[name]))
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
    parser.add_argument("detector", choices=list(DETECTORS))
    parser.add_argument("maps", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--jobs", type=int, default=16)
    options = parser.parse_args()
    began, jobs, detector, out = time.monotonic(), options.jobs, options.detector, options.out
    out.mkdir(parents=True, exist_ok=True)
    left_out = RECIPES[detector].left_out
    files = sorted(options.maps.glob("*.xodr"))
    start = of_evidence(detector)
    drawn = gather_drawn(detector, DRAWN, jobs, seen_with=start)
    first = gather_maps(detector, files, FIRST, jobs, {file.stem: start for file in files}, lorries=LORRIES)
    fits = fits_to_others(Gathered(first, (), drawn, FIRST), left_out, jobs)
    gathered = Gathered(looks_at(detector, files, fits, jobs), (), drawn, OF_TOWNS)
    confidence = fitted(gathered)
    measured = detector_class(detector)
    (out / measured.confidence_file).write_text(confidence_text(confidence, measured.features), encoding="utf-8")
    fits = fits_to_others(gathered, left_out, jobs)
    figures = json.dumps(figures_of_others(gathered.maps, fits, left_out), indent=1)
    (out / "other_roads.json").write_text(figures + "\n", encoding="utf-8")
    of_tables = [file for file in files if file.stem in left_out]
    tables = gather_maps(detector, of_tables, OF_TABLES, jobs, fits)
    bank = gather_bank(detector, PICTURES, jobs, seen_with=confidence)
    sides = sum(len(one.error) for one in gathered.maps.values())
    print(f"{sides} sides on {len(gathered.maps)} files, and {len(drawn.error)} in random situations")
    minutes = (time.monotonic() - began) / 60.0
    command = f"python tools/fit_confidence.py {detector} MAPS OUT"
    seen = f"the fits saw {sides} sides on {len(files)} files"
    looked = f"{OF_TABLES} clips of six images on each of {len(tables)} maps; {seen}"
    shown = figures_of(Gathered(tables, bank, drawn, OF_TABLES), left_out, None)
    write_perception_page(shown, Measured(detector, command, minutes, jobs, looked, PICTURES), out, confidence)


if __name__ == "__main__":
    main()
