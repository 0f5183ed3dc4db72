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
import time
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from scenario_compiler.perception.calibration.collect import Looks
from scenario_compiler.perception.calibration.cross_fit import COPY, fits_to_others
from scenario_compiler.perception.calibration.figures import REMEMBERING, figures_of, fitted, judged, worth
from scenario_compiler.perception.calibration.gather import Gathered, gather_bank, gather_drawn, gather_maps
from scenario_compiler.perception.confidence import Confidence, Tree, confidence_text
from scenario_compiler.perception.learned_detector import LEARNED_FEATURES, LearnedLaneDetector
from scenario_compiler.report.perception_page import Measured, write_perception_page

TOWNS, LEFT_OUT = ("Town03", "Town05"), ("Town03", "Town05", "soderleden")
"""The towns, which have more and other junctions than all other files together; and the maps of the tables, each with a
fit to all other files.
"""

OF_TOWNS, OF_TABLES, FIRST, DRAWN, PICTURES = 2880, 8640, 48, 3500, 200
"""Clips of a town for the fits, of a map of the tables, and of each file at first; random situations; pictures of each
situation of the bank.
"""

KINDS = {
    COPY: ("repainted", 120),
    "avenues_": ("avenues", 120),
    "crossings_": ("crossings", 160),
    "streets_": ("streets", 160),
    "made_up_": ("made-up", 160),
    "": ("road files", 240),
}
"""Kinds of files by the beginnings of their names, and the clips of a file of each; the first that fits."""

LORRIES = 0.12
"""Share of the clips with a lorry close ahead."""


def kind_of(name: str) -> tuple[str, int]:
    """Return the kind of a file, and the clips of each such file that is no town."""
    return next(kind for begin, kind in KINDS.items() if name.startswith(begin))


def of_paint_alone() -> Confidence:
    """Return a confidence that trusts what the network takes for painted, for looks to which another one is fitted."""
    painted = LEARNED_FEATURES.index("painted")
    tree = Tree([painted, -1, painted, -1, -1], [0.0, 0.5], [[-2.0] * 3, [1.0] * 3, [2.0] * 3])
    return Confidence.of([0.0] * 3, [tree])


def figures_of_others(maps: Mapping[str, Looks], fits: Mapping[str, Confidence]) -> dict[str, object]:
    """Return the figures of each kind of files that are not left out, with fits that did not know them."""
    groups: dict[str, list[Looks]] = {}
    for name, one in maps.items():
        if name not in LEFT_OUT:
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
    parser.add_argument("maps", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--jobs", type=int, default=16)
    options = parser.parse_args()
    began, jobs = time.monotonic(), options.jobs
    options.out.mkdir(parents=True, exist_ok=True)
    files = sorted(options.maps.glob("*.xodr"))
    left_out = [file for file in files if file.stem in LEFT_OUT]
    start = of_paint_alone()
    drawn = gather_drawn("learned", DRAWN, jobs, seen_with=start)
    first = gather_maps("learned", files, FIRST, jobs, {file.stem: start for file in files}, lorries=LORRIES)
    fits = fits_to_others(Gathered(first, (), drawn, FIRST), LEFT_OUT)
    towns = [file for file in files if file.stem in TOWNS]
    maps = gather_maps("learned", towns, OF_TOWNS, jobs, fits)
    for kind, clips in KINDS.values():
        some = [file for file in files if file.stem not in TOWNS and kind_of(file.stem)[0] == kind]
        maps |= gather_maps("learned", some, clips, jobs, fits, lorries=LORRIES)
    gathered = Gathered({name: maps[name] for name in sorted(maps)}, (), drawn, OF_TOWNS)
    confidence = fitted(gathered)
    text = confidence_text(confidence, LearnedLaneDetector.features)
    (options.out / LearnedLaneDetector.confidence_file).write_text(text, encoding="utf-8")
    fits = fits_to_others(gathered, LEFT_OUT)
    figures = json.dumps(figures_of_others(gathered.maps, fits), indent=1)
    (options.out / "other_roads.json").write_text(figures + "\n", encoding="utf-8")
    tables = gather_maps("learned", left_out, OF_TABLES, jobs, fits)
    bank = gather_bank("learned", PICTURES, jobs, seen_with=confidence)
    sides = sum(len(one.error) for one in gathered.maps.values())
    print(f"{sides} sides on {len(gathered.maps)} files, and {len(drawn.error)} in random situations")
    minutes = (time.monotonic() - began) / 60.0
    command = "python tools/fit_learned_confidence.py MAPS OUT"
    seen = f"the fits saw {sides} sides on {len(files)} files"
    looked = f"{OF_TABLES} clips of six images on each of {len(tables)} maps; {seen}"
    shown = figures_of(Gathered(tables, bank, drawn, OF_TABLES), LEFT_OUT, None)
    write_perception_page(shown, Measured("learned", command, minutes, jobs, looked, PICTURES), options.out, confidence)


if __name__ == "__main__":
    main()
