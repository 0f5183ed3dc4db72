"""Other dependencies of a picture than its arguments: the version of OpenCV and the instructions that it uses."""

from __future__ import annotations

import platform

import cv2


def drawn_by() -> dict[str, str]:
    """Return the facts that are recorded with a run that has a camera.

    "opencv" is its version. "processor" is the kind of processor with the instruction sets that OpenCV knows: those
    with a star are used if the processor has them, those with a question mark are missing. If both are equal, pictures
    are equal byte by byte; otherwise single pixels may differ by some grey levels.
    """
    return {"opencv": cv2.__version__, "processor": f"{platform.machine()} {cv2.getCPUFeaturesLine()}".strip()}
