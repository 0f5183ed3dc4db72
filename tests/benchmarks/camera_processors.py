"""Measures how far pictures, detections in them and runs with them differ between processors.

    python -m tests.benchmarks.camera_processors

Everything is done in three processes: with all instruction sets of this processor, with the matrix products of a
processor without AVX, and with no instructions beyond those for which OpenCV (SSE3) and NumPy (x86-64-v2) were built.
Both detectors look at clips on two maps and at drives with each camera failure, with memory of earlier images, and the
library's five conflicts are run.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler import compile_scenario, load_network, open_world, run
from scenario_compiler.batch.typical_sweeps import CONFLICTS
from scenario_compiler.compiler import Overrides
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.detectors import DETECTORS, create_detector
from scenario_compiler.perception.lane_detector import CalibratedDetector, LaneState
from scenario_compiler.resources import library_folder, maps_folder
from tests.benchmarks.failure_curves import STATES, amounts_of, drive

MAPS, CLIPS, SEED = ("town_grid", "highway_loop"), 40, 77
FAILURE = 1
"""Index of the amount of a camera failure."""

OLD_PRODUCTS = {"OPENBLAS_CORETYPE": "Prescott"}


def seen(detectors: list[CalibratedDetector], images: Iterable[NDArray[np.uint8]]) -> NDArray[np.float64]:
    """Return by image, detector and side the confidence and the boundary's offset 10 m ahead; images are remembered."""
    states, found = [LaneState() for _ in detectors], []
    for image in images:
        results = [detector.detect(image, state) for detector, state in zip(detectors, states, strict=True)]
        states = [state.after(result) for state, result in zip(states, results, strict=True)]
        found.append([[(side.p, float(side.y(10.0))) for side in (one.left, one.right)] for one in results])
    return np.array(found)


def measured() -> dict[str, NDArray[np.generic]]:
    """Return the clips' pictures, what the detectors see in them and in the failing drives, and the runs' results."""
    detectors = [create_detector(name) for name in DETECTORS]
    pictures: list[NDArray[np.uint8]] = []
    clips = []
    for name in MAPS:
        roads = MapRoads(load_network(next((maps_folder() / name).glob("*.xodr"))))
        for _, _, views in roads.clips(SEED, range(CLIPS)):
            images = [view.image for view in views]
            pictures += images
            clips.append(seen(detectors, images))
    failing = [seen(detectors, (image for image, _ in drive(kind, amounts_of(kind)[FAILURE]))) for kind in STATES]
    results: dict[str, NDArray[np.generic]] = {
        "pictures": np.array(pictures), "clips": np.concatenate(clips), "failing": np.concatenate(failing),
    }  # fmt: skip
    for name in CONFLICTS:
        plan = compile_scenario(
            library_folder() / "conflicts" / f"{name}.xml", overrides=Overrides(perception="camera")
        )
        network = load_network(plan.map.file)
        with open_world("kinematic", plan, network) as world:
            recording = run(plan, world, seed=1)
        results[f"path {name}"] = np.stack([recording.x[:, 0], recording.y[:, 0]], axis=1)
        results[f"times {name}"] = np.array([event.t for event in recording.events])
    return results


def without_extensions() -> dict[str, str]:
    """Return the environment of a process that uses no instructions beyond the baseline."""
    opencv = [one.strip("*") for one in cv2.getCPUFeaturesLine().split() if one.startswith("*") and "?" not in one]
    numpy = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    return OLD_PRODUCTS | {"OPENCV_CPU_DISABLE": ",".join(opencv), "NPY_DISABLE_CPU_FEATURES": " ".join(numpy)}


def compare(here: dict[str, NDArray[np.generic]], there: dict[str, NDArray[np.generic]]) -> None:
    """Print how far the results of two processes differ."""
    apart = np.abs(here["pictures"].astype(np.int64) - there["pictures"].astype(np.int64))
    print(
        f"  {(apart > 0).mean():.1e} of the values of {len(apart)} pictures differ, by up to {apart.max()} grey levels"
    )
    for what in ("clips", "failing"):
        moved = np.abs(here[what].astype(np.float64) - there[what].astype(np.float64))
        for k, detector in enumerate(DETECTORS):
            confidence, boundary = moved[:, k, :, 0].max(axis=1), moved[:, k, :, 1].max(axis=1)
            print(
                f"  {what}, {detector}, {len(moved)} images: confidence by {confidence.max():.1e}, "
                f"by over 0.01 in {(confidence > 0.01).sum()}; boundary by {boundary.max():.1e} m"
            )
    for name in CONFLICTS:
        one, other = here[f"path {name}"].astype(np.float64), there[f"path {name}"].astype(np.float64)
        steps = min(len(one), len(other))
        aside = np.hypot(*(one[:steps] - other[:steps]).T).max()
        first, second = here[f"times {name}"], there[f"times {name}"]
        same = "the same times of events" if np.array_equal(first, second) else f"events at {first} and {second}"
        print(f"  {name}: paths apart by {aside:.1e} m at most, lengths {len(one)} and {len(other)}, {same}")


def main() -> None:
    """Measure, let other processes measure, and print how far they differ."""
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_bytes(pickle.dumps(measured()))
        return
    here = measured()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "other.pickle"
        command = [sys.executable, "-m", "tests.benchmarks.camera_processors", str(file)]
        for environment in (OLD_PRODUCTS, without_extensions()):
            subprocess.run(command, env={**os.environ, **environment}, check=True, stderr=subprocess.DEVNULL)
            print(f"with {environment}")
            compare(here, pickle.loads(file.read_bytes()))


if __name__ == "__main__":
    main()
