"""Other dependencies of a run with a camera than its arguments: the processor, and the code chosen for it."""

from __future__ import annotations

import os

import cv2

from scenario_compiler.recording.versions import processor_model

CHOOSING = ("NPY_DISABLE_CPU_FEATURES", "NPY_ENABLE_CPU_FEATURES", "OPENBLAS_CORETYPE")
"""Environment variables that say which implementations of functions NumPy and OpenBLAS use."""


def drawn_by() -> dict[str, str]:
    """Return the facts that are recorded with a run that has a camera, besides the versions of libraries.

    "processor" is the model of the processor with the instruction sets that OpenCV knows: those with a star are used if
    the processor has them, those with a question mark are missing or switched off. Those of CHOOSING that are set are
    listed by their names. If all of these and OpenCV's version are equal, pictures are equal byte by byte; otherwise
    single pixels may differ by some grey levels, and confidences in their last digits.
    """
    return {
        "processor": f"{processor_model()} {cv2.getCPUFeaturesLine()}".strip(),
        **{name: os.environ[name] for name in CHOOSING if os.environ.get(name)},
    }
