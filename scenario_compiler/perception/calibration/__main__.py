"""`python -m scenario_compiler.perception.calibration [FRAMES]`: fit, measure, write `lane_confidence.json`."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

import cv2
import numpy as np

import scenario_compiler.perception
from scenario_compiler.perception.calibration.fit import cross_validated, fit_logistic, reliability
from scenario_compiler.perception.calibration.measure import collect, mean_confidence, table_rows
from scenario_compiler.perception.confidence import FEATURES
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector

FRAMES = 4000
PER_ROW = 60
QUALITIES = (1.0, 0.8, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.0)
SIGMAS = (0.0, 5.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 60.0)
WEATHERS = (
    *("ClearNoon", "CloudyNoon", "WetNoon", "SoftRainNoon", "MidRainyNoon", "HardRainNoon", "ClearSunset"),
    *("WetSunset", "MidRainSunset", "HardRainSunset", "ClearNight", "HardRainNight", "DustStorm"),
)


def main(frames: int) -> None:
    """Calibrate with `frames` random frames and write the table."""
    cv2.setNumThreads(1)
    rows, outcomes, groups = collect(frames, seed=42)
    held_out = reliability(cross_validated(rows, outcomes, groups), outcomes)
    weights = tuple(round(float(w), 4) for w in fit_logistic(rows, outcomes))
    detector = ClassicalLaneDetector(weights=weights)
    print(held_out)
    by_quality = table_rows(detector, "quality", QUALITIES, PER_ROW)
    by_sigma = table_rows(detector, "sigma", SIGMAS, PER_ROW)
    by_weather = table_rows(detector, "weather", WEATHERS, PER_ROW)
    without = mean_confidence(detector, "quality", 0.0, 4 * PER_ROW)
    table = {
        "about": "Made by `python -m scenario_compiler.perception.calibration`; see perception/confidence.py.",
        "made_with": {"frames": frames, "per_row": PER_ROW, "opencv": cv2.__version__, "numpy": np.__version__},
        "features": FEATURES,
        "weights": weights,
        "reliability": asdict(held_out),
        "by_quality": [(value, row.p) for value, row in by_quality],
        "by_sigma": [(value, row.p) for value, row in by_sigma],
        "by_weather": [(value, row.p, row.any_below_warning, row.both_below_request) for value, row in by_weather],
        "neither_without_paint": without.both_below_request,
    }
    for name in ("by_quality", "by_sigma", "by_weather", "neither_without_paint"):
        print(name, table[name])
    path = Path(scenario_compiler.perception.__file__).parent / "lane_confidence.json"
    path.write_text(json.dumps(table, indent=1, default=list) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else FRAMES)
