"""Measures how detectors, the sensor's health and the request react to camera failures of every kind and severity.

    python -m tests.benchmarks.failure_curves docs

A straight road, or a bend where the kind says so, is driven at a clear noon at 15 m/s with 15 images a second. A
failure begins after eight images, at full strength. Confidence, error and health are means over the last eight of 40
images; the request comes when on five of eight images both sides are below 0.3. Writes `images/camera_failures.jpg`
and `images/camera_failure_curves.png`, and the table between the markers of `camera-failures.md`, in the folder.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.ego.camera_health import BLUR_AT_ONE, IMPULSES_AT_ONE, NOISE_AT_ONE
from scenario_compiler.perception.calibration.truth import Truth
from scenario_compiler.perception.degradation import Degradation
from scenario_compiler.perception.detectors import DETECTORS, DetectorName, create_detector
from scenario_compiler.perception.lane_detector import LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.sensor_health import SensorMonitor
from scenario_compiler.randomness import random_unit
from scenario_compiler.vocabulary.sensors import EXPOSURE_AT_ONE, SEVERITIES
from tests.perception.scenery import CLEAR, bend, two_lanes

IMAGES, BEGIN, LAST, RATE, SPEED, SEED = 40, 8, 8, 15.0, 15.0, 1
REQUEST_BELOW, COUNT, OF = 0.3, 5, 8
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)
TURN = math.radians(5.0)
"""Angle of the misalignments with the amount 1, rad."""

BEGINNING, ENDING = "<!-- measured -->", "<!-- end of what was measured -->"

RADIUS = 90.0
"""Radius of the bend, m: at 15 m/s the lateral acceleration is 2.5 m/s2."""

IN_A_BEND = "motion_blur, radius 90 m"

State = Callable[[float, int], Degradation]
STATES: dict[str, State] = {
    "noise": lambda amount, _: Degradation(sigma=NOISE_AT_ONE * amount),
    "blur": lambda amount, _: Degradation(blur=BLUR_AT_ONE * amount),
    "impulse_noise": lambda amount, _: Degradation(impulses=IMPULSES_AT_ONE * amount),
    "overexposure": lambda amount, _: Degradation(brighter=amount),
    "motion_blur": lambda amount, _: Degradation(exposure=EXPOSURE_AT_ONE * amount, speed=SPEED),
    IN_A_BEND: lambda amount, _: Degradation(exposure=EXPOSURE_AT_ONE * amount, speed=SPEED, yaw_rate=SPEED / RADIUS),
    "blackout": lambda amount, _: Degradation(dark=amount),
    "dirt": lambda amount, _: Degradation(dirt=amount),
    "dead_rows": lambda amount, _: Degradation(dead_rows=amount),
    "quantisation": lambda amount, _: Degradation(coarse=amount),
    "latency": lambda amount, _: Degradation(late=amount),
    "dropout": lambda amount, k: Degradation(missing=_strikes(op.FAILURE_DROPOUT, amount, k)),
    "freeze": lambda amount, k: Degradation(frozen=_strikes(op.FAILURE_FREEZE, amount, k)),
    "misalignment, yaw": lambda amount, _: Degradation(turned=(TURN * amount, 0.0, 0.0)),
    "misalignment, pitch": lambda amount, _: Degradation(turned=(0.0, TURN * amount, 0.0)),
    "misalignment, roll": lambda amount, _: Degradation(turned=(0.0, 0.0, TURN * amount)),
}
"""Kind of a failure to the sensor's state for an amount, in the image with a number."""

TITLE = 20
"""Height of the title above a row of pictures, pixels."""

SHOWN = tuple(kind for kind in STATES if kind not in ("latency", "dropout", "freeze"))
"""Kinds that a single picture shows."""


class Answer(NamedTuple):
    """Confidence of the better side, its largest error, m, the sensor's health, and when a request comes, s, or NaN."""

    confidence: float
    error: float
    health: float
    request: float


def _strikes(kind: int, share: float, image: int) -> bool:
    """Return whether a failure that strikes a share of the images strikes this one, as the engine draws it."""
    return random_unit(SEED, op.STREAM_FAILURE, kind, image) < share


def amounts_of(kind: str) -> tuple[float, ...]:
    """Return the five amounts that are looked at: those of ImageNet-C where it has any."""
    return next((amounts for name, amounts in SEVERITIES.items() if name == kind.split(",")[0]), SHARES)


def drive(kind: str, amount: float) -> list[tuple[NDArray[np.uint8], Truth]]:
    """Return the images of the drive with a failure, and where the lane is before a camera that is mounted rightly."""
    reference = bend(RADIUS if kind == IN_A_BEND else 0.0)
    camera, found = RoadCamera(two_lanes(reference), seed=SEED), []
    for k in range(IMAGES):
        state = STATES[kind](amount, k) if k >= BEGIN else Degradation()
        here = 70.0 + SPEED / RATE * k
        pose, s = reference.pose(here), np.arange(here, here + 40.0, 0.5)
        truth = Truth.of(camera.view(pose), reference.points(s, 1.75), reference.points(s, -1.75), (1.0, 1.0))
        found.append((camera.frame(pose, [], CLEAR, state, k, t=k / RATE), truth))
    return found


def answer(images: list[tuple[NDArray[np.uint8], Truth]], name: DetectorName) -> Answer:
    """Return how a detector and the monitor of the sensor answer to the images of a drive."""
    detector, monitor, state = create_detector(name), SensorMonitor(), LaneState()
    confidence, error, health, weak, request = [], [], [], [], float("nan")
    for k, (image, truth) in enumerate(images):
        found = detector.detect(image, state)
        state = state.after(found)
        side, better = max(enumerate((found.left, found.right)), key=lambda one: one[1].p)
        confidence.append(better.p)
        error.append(truth.error(side, better))
        health.append(monitor.observe(image, SPEED / RATE).health)
        weak.append(confidence[-1] * health[-1] < REQUEST_BELOW)
        if np.isnan(request) and sum(weak[-OF:]) >= COUNT:
            request = (k - BEGIN) / RATE
    return Answer(_late(confidence), _late(error), _late(health), request)


def _late(column: list[float]) -> float:
    return float(np.mean(column[-LAST:]))


def write_montage(file: Path) -> None:
    """Write one row of pictures for each kind, from the mildest to the most severe."""
    rows = []
    for kind in SHOWN:
        tiles, reference = [], bend(RADIUS if kind == IN_A_BEND else 0.0)
        for amount in amounts_of(kind):
            camera = RoadCamera(two_lanes(reference), seed=SEED)
            image = camera.frame(reference.pose(109.0), [], CLEAR, STATES[kind](amount, 9), 9)
            tiles.append(cv2.resize(image, (256, 128), interpolation=cv2.INTER_AREA))
        row = np.hstack(tiles)
        title = np.full((TITLE, row.shape[1], 3), 40, np.uint8)
        cv2.putText(title, kind, (6, TITLE - 6), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (255, 255, 255), 1, cv2.LINE_AA)
        rows += [title, row]
    cv2.imwrite(str(file), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 85])


def write_curves(found: dict[tuple[DetectorName, str], list[Answer]], file: Path) -> None:
    """Draw confidence and health over the severity, a panel for each kind."""
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(4, 4, figsize=(12, 9.4), sharex=True, sharey=True)
    colours = dict(zip(get_args(DetectorName), ("#0072b2", "#d55e00"), strict=True))
    for axis, kind in zip(axes.flat, STATES, strict=True):
        for name in DETECTORS:
            axis.plot(range(1, 6), [one.confidence for one in found[name, kind]], "o-", color=colours[name], label=name)
        axis.plot(range(1, 6), [one.health for one in found["classical", kind]], "k--", label="sensor's health")
        axis.set_title(kind, fontsize=10)
        axis.axhline(REQUEST_BELOW, color="0.5", linewidth=0.8, linestyle=":", label="request below")
    axes[0, 3].legend(fontsize=8, loc="center")  # nothing of this panel lies there
    for axis in axes[:, 0]:
        axis.set_ylabel("confidence, health")
    for axis in axes[-1]:
        axis.set_xlabel("severity, or fifths of amount 1")
    figure.tight_layout()
    figure.savefig(file, dpi=85)


def table(found: dict[tuple[DetectorName, str], list[Answer]]) -> str:
    """Return the table, a row for each kind."""
    lines = [
        "| kind | amounts | confidence, classical | learned | error, m, classical | learned | health "
        "| request, s, classical | learned |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for kind in STATES:
        both = [found[name, kind] for name in get_args(DetectorName)]
        cells = [
            ", ".join(f"{one:.3g}" for one in amounts_of(kind)),
            *(", ".join(f"{one.confidence:.2f}" for one in of) for of in both),
            *(", ".join("far" if one.error >= 10.0 else f"{one.error:.2f}" for one in of) for of in both),
            ", ".join(f"{one.health:.2f}" for one in both[0]),
            *(", ".join("-" if np.isnan(one.request) else f"{one.request:.1f}" for one in of) for of in both),
        ]
        lines.append(f"| {kind} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main(folder: Path) -> None:
    """Measure, and write both pictures and the table."""
    found: dict[tuple[DetectorName, str], list[Answer]] = {}
    for kind in STATES:
        for amount in amounts_of(kind):
            images = drive(kind, amount)
            for name in get_args(DetectorName):
                found.setdefault((name, kind), []).append(answer(images, name))
    write_montage(folder / "images" / "camera_failures.jpg")
    write_curves(found, folder / "images" / "camera_failure_curves.png")
    page = folder / "camera-failures.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGINNING)
    after = rest.split(ENDING)[1]
    page.write_text(f"{before}{BEGINNING}\n\n{table(found)}\n\n{ENDING}{after}", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
