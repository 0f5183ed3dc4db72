"""Pictures of the bank with the boundaries that a detector finds in them."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from scenario_compiler.perception.calibration.bank import BANK, pictures
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import Confidence
from scenario_compiler.perception.detectors import DetectorName, create_detector
from scenario_compiler.perception.overlay import draw_lanes

ACROSS, SCALE, SEED = 4, 0.75, 5


def montage(name: DetectorName, situations: Sequence[str], confidence: Confidence | None = None) -> bytes:
    """Return a JPEG with a picture of each situation, the detected boundaries, and the confidence in both sides.

    Args:
        name: Name of the detector.
        situations: Names of the situations.
        confidence: The detector's confidence, the packaged one if None.
    """
    detector, tiles = create_detector(name, confidence=confidence), []
    for called in situations:
        situation = next(one for one in BANK if one.name == called)
        image, _ = next(pictures(situation, SEED, 1))
        found = detector.detect(image)
        tile = draw_lanes(image, found, Camera())
        tile[:24] = tile[:24] // 4
        text = f"{called}: {found.left.p:.2f} {found.right.p:.2f}"
        cv2.putText(tile, text, (6, 17), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (255, 255, 255), 1, cv2.LINE_AA)
        tiles.append(tile)
    rows = [np.hstack(tiles[k : k + ACROSS]) for k in range(0, len(tiles), ACROSS)]
    small = cv2.resize(np.vstack(rows), (0, 0), fx=SCALE, fy=SCALE, interpolation=cv2.INTER_AREA)
    good, data = cv2.imencode(".jpg", small)
    if not good:
        raise ValueError(f"pictures of shape {small.shape} cannot be encoded")
    return data.tobytes()
