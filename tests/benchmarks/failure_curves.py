"""Measures how confidence, the sensor's health and the request answer to camera failures, for every detector.

    python -m tests.benchmarks.failure_curves DIR

A straight road at a clear noon is driven at 15 m/s with 15 images a second. A failure begins after eight images, at
full strength. Confidence and health are means over the last eight of 40 images; the request comes when on five of eight
images both sides are below 0.3. Writes `camera_failures.jpg` and `camera_failure_curves.png` to DIR, and prints a
table.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.degradation import Degradation, degraded
from scenario_compiler.perception.detectors import DETECTORS, DetectorName, create_detector
from scenario_compiler.perception.lane_detector import LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.sensor_health import SensorMonitor
from scenario_compiler.vocabulary.sensors import SEVERITIES, FailureKind
from tests.perception.scenery import CLEAR, bend, two_lanes

IMAGES, BEGIN, LAST, RATE, SPEED = 40, 8, 8, 15.0, 15.0
REQUEST_BELOW, COUNT, OF = 0.3, 5, 8
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)
STATES: dict[FailureKind, tuple[str, float]] = {
    "noise": ("sigma", 80.0),
    "blur": ("blur", 9.0),
    "impulse_noise": ("impulses", 0.5),
    "overexposure": ("brighter", 1.0),
    "blackout": ("dark", 1.0),
    "dirt": ("dirt", 1.0),
    "dead_rows": ("dead_rows", 1.0),
    "quantisation": ("coarse", 1.0),
}
"""Kind of a failure to what it changes in the sensor's state, and how much of that amount 1 is."""


class Answer(NamedTuple):
    """Confidence of the better side, the sensor's health, and when a request comes, s; NaN without one."""

    confidence: float
    health: float
    request: float


def state_of(kind: FailureKind, amount: float) -> Degradation:
    """Return the sensor's state under a failure."""
    name, at_one = STATES[kind]
    changes: dict[str, Any] = {name: at_one * amount}
    return replace(Degradation(), **changes)


def amounts_of(kind: FailureKind) -> tuple[float, ...]:
    """Return the five amounts that are looked at: those of ImageNet-C where it has any."""
    return SEVERITIES.get(kind, SHARES)


def clean_images() -> list[NDArray[np.uint8]]:
    """Return the images of the drive without a failure."""
    reference = bend(0.0)
    camera = RoadCamera(two_lanes(reference))
    return [camera.frame(reference.pose(20.0 + SPEED / RATE * k), [], CLEAR, 0.0, k) for k in range(IMAGES)]


def answer(images: list[NDArray[np.uint8]], name: DetectorName, kind: FailureKind, amount: float) -> Answer:
    """Return how a detector and the monitor of the sensor answer to a failure."""
    detector, monitor, state = create_detector(name), SensorMonitor(), LaneState()
    confidence, health, weak, request = [], [], [], float("nan")
    for k, clean in enumerate(images):
        image = degraded(clean, state_of(kind, amount), 1, k) if k >= BEGIN else clean
        found = detector.detect(image, state)
        state = state.after(found)
        confidence.append(max(found.left.p, found.right.p))
        health.append(monitor.observe(image, SPEED / RATE).health)
        weak.append(confidence[-1] * health[-1] < REQUEST_BELOW)
        if np.isnan(request) and sum(weak[-OF:]) >= COUNT:
            request = (k - BEGIN) / RATE
    return Answer(float(np.mean(confidence[-LAST:])), float(np.mean(health[-LAST:])), request)


def write_montage(images: list[NDArray[np.uint8]], file: Path) -> None:
    """Write one row of pictures for each kind, from the mildest to the most severe."""
    rows = []
    for kind in STATES:
        tiles = [cv2.resize(degraded(images[-1], state_of(kind, one), 1, 9), (256, 128)) for one in amounts_of(kind)]
        cv2.putText(tiles[0], kind, (6, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (255, 255, 255), 3, cv2.LINE_AA)
        cv2.putText(tiles[0], kind, (6, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
        rows.append(np.hstack(tiles))
    cv2.imwrite(str(file), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 85])


def write_curves(found: dict[tuple[DetectorName, FailureKind], list[Answer]], file: Path) -> None:
    """Draw confidence and health over the severity, a panel for each kind."""
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(2, 4, figsize=(12, 5.4), sharex=True, sharey=True)
    colours = dict(zip(get_args(DetectorName), ("#0072b2", "#d55e00"), strict=True))
    for axis, kind in zip(axes.flat, STATES, strict=True):
        for name in DETECTORS:
            axis.plot(range(1, 6), [one.confidence for one in found[name, kind]], "o-", color=colours[name], label=name)
        axis.plot(range(1, 6), [one.health for one in found["classical", kind]], "k--", label="sensor's health")
        axis.set_title(kind, fontsize=10)
        axis.axhline(REQUEST_BELOW, color="0.7", linewidth=0.8)
    axes[0, 0].legend(fontsize=8, loc="lower left")
    axes[0, 0].set_ylabel("confidence")
    axes[1, 0].set_ylabel("confidence")
    for axis in axes[1]:
        axis.set_xlabel("severity, or fifths of amount 1")
    figure.tight_layout()
    figure.savefig(file, dpi=85)


def main(folder: Path) -> None:
    """Measure, write both pictures and print the table."""
    images = clean_images()
    found = {
        (name, kind): [answer(images, name, kind, one) for one in amounts_of(kind)]
        for name in get_args(DetectorName)
        for kind in STATES
    }
    write_montage(images, folder / "camera_failures.jpg")
    write_curves(found, folder / "camera_failure_curves.png")
    print("| kind | amounts | classical | learned | health | request, s: classical | learned |")
    print("|---|---|---|---|---|---|---|")
    for kind in STATES:
        classical, learned = found["classical", kind], found["learned", kind]
        cells = [
            ", ".join(f"{one:.3g}" for one in amounts_of(kind)),
            ", ".join(f"{one.confidence:.2f}" for one in classical),
            ", ".join(f"{one.confidence:.2f}" for one in learned),
            ", ".join(f"{one.health:.2f}" for one in classical),
            *(
                ", ".join("-" if np.isnan(one.request) else f"{one.request:.1f}" for one in of)
                for of in (classical, learned)
            ),
        ]
        print(f"| {kind} | " + " | ".join(cells) + " |")


def _seconds(time: float) -> str:
    return "-" if np.isnan(time) else f"{time:.1f}"


if __name__ == "__main__":
    main(Path(sys.argv[1]))
