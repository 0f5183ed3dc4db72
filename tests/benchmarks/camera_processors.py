"""Measures how far pictures, and detections in them, differ between processors.

    python -m tests.benchmarks.camera_processors

The same pictures are drawn twice: with every instruction set of this processor, and by a second process in which OpenCV
and NumPy may use none beyond what they were built for (SSE3 and x86-64-v2). Both detectors look at each.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.detectors import DETECTORS, create_detector
from scenario_compiler.resources import maps_folder
from scenario_compiler.roads import load_network

MAPS, CLIPS, SEED = ("town_grid", "highway_loop"), 40, 77


def measured() -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Return the pictures, and by picture, detector and side the confidence and the boundary's offset 10 m ahead."""
    images, found = [], []
    detectors = [create_detector(name) for name in DETECTORS]
    for name in MAPS:
        roads = MapRoads(load_network(next((maps_folder() / name).glob("*.xodr"))))
        for _, _, views in roads.clips(SEED, range(CLIPS)):
            image = next(views).image
            results = [detector.detect(image) for detector in detectors]
            images.append(image)
            found.append([[(side.p, float(side.y(10.0))) for side in (one.left, one.right)] for one in results])
    return np.array(images), np.array(found)


def without_extensions() -> dict[str, str]:
    """Return the environment of a process that uses no instructions beyond the baseline."""
    opencv = [one.strip("*") for one in cv2.getCPUFeaturesLine().split() if one.startswith("*") and "?" not in one]
    numpy = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    return {"OPENCV_CPU_DISABLE": ",".join(opencv), "NPY_DISABLE_CPU_FEATURES": " ".join(numpy)}


def main() -> None:
    """Draw, let another process draw, and print how far both differ."""
    if len(sys.argv) > 1:
        np.savez(sys.argv[1], *measured())
        return
    images, found = measured()
    disabled = without_extensions()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "other.npz"
        command = [sys.executable, "-m", "tests.benchmarks.camera_processors", str(file)]
        subprocess.run(command, env={**os.environ, **disabled}, check=True, stderr=subprocess.DEVNULL)
        with np.load(file) as other:
            apart = np.abs(images.astype(np.int64) - other["arr_0"])
            moved = np.abs(found - other["arr_1"])
    print(f"without {disabled}")
    print(
        f"{(apart > 0).mean():.1e} of the values of {len(images)} pictures differ, by {apart.max()} grey levels at most"
    )
    for k, name in enumerate(DETECTORS):
        print(
            f"{name}: confidence by {moved[:, k, :, 0].max():.1e}, boundary by {moved[:, k, :, 1].max():.1e} m at most"
        )


if __name__ == "__main__":
    main()
