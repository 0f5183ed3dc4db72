"""The versions, besides the plan and the seed, on which the numbers of a run depend: libraries and the processor."""

from __future__ import annotations

import platform
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

LIBRARIES = {
    "scenario-compiler": "scenario-compiler",
    "lxml": "lxml",
    "numpy": "numpy",
    "opencv": "opencv-python-headless",
    "pyarrow": "pyarrow",
    "pydantic": "pydantic",
    "scipy": "scipy",
}
"""Name of each library in a recording, and of its distribution."""

FEATURES = ("sse4_1", "sse4_2", "avx", "f16c", "fma", "avx2", "avx512", "asimd", "sve", "neon")
"""Prefixes of the names of processor features by which NumPy and OpenCV choose among implementations of a function."""


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that affect a run's numbers, by name."""
    return {"python": platform.python_version()} | {name: version(one) for name, one in LIBRARIES.items()}


@lru_cache(maxsize=1)
def processor() -> str:
    """Return the processor's architecture and, if the system provides them, those of FEATURES that it has."""
    return " ".join([platform.machine(), *_features(Path("/proc/cpuinfo"))])


def _features(told: Path) -> list[str]:
    """Return the features of the first processor that Linux lists; none on another system."""
    try:
        lines = told.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []
    flags = next((line.partition(":")[2].split() for line in lines if line.startswith(("flags", "Features"))), [])
    return sorted({flag for flag in flags if flag.startswith(FEATURES)})
