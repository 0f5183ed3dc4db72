"""The versions, besides the plan and the seed, on which the numbers of a run depend: libraries and the processor."""

from __future__ import annotations

import os
import platform
import sys
from contextlib import suppress
from functools import lru_cache
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

MODEL = ("vendor_id", "cpu family", "model", "CPU implementer", "CPU part")
"""Names under which Linux lists a processor's model, by which OpenBLAS chooses among implementations of a function."""

FEATURES = ("sse4_1", "sse4_2", "avx", "f16c", "fma", "avx2", "avx512", "asimd", "sve", "neon")
"""Prefixes of the names of processor features by which NumPy and OpenCV choose among implementations of a function."""


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that affect a run's numbers, by name."""
    return {"python": platform.python_version()} | {name: version_of(one) for name, one in LIBRARIES.items()}


def version_of(distribution: str) -> str:
    """Return the version of an installed distribution.

    It is in the name of the folder NAME-VERSION.dist-info (PyPA, "Recording installed projects"). `importlib.metadata`
    gives it for every way of installing, but loads Python's modules for e-mails to read it, which takes a twentieth of
    a short run; it is asked only where there is no such folder.
    """
    start, end = f"{distribution.replace('-', '_')}-", ".dist-info"
    for name in _installed():
        if name.lower().startswith(start) and name.endswith(end):
            return name[len(start) : -len(end)]
    from importlib.metadata import version

    return version(distribution)


@lru_cache(maxsize=1)
def _installed() -> tuple[str, ...]:
    """Return the names of what is installed, in the order in which Python looks for it."""
    found: list[str] = []
    for folder in sys.path:
        with suppress(OSError), os.scandir(folder or ".") as entries:
            found += [entry.name for entry in entries]
    return tuple(found)


def processor() -> str:
    """Return the processor's architecture and, if the system provides them, its model and those of FEATURES it has."""
    listed = _listed(Path("/proc/cpuinfo"))
    flags = {*listed.get("flags", "").split(), *listed.get("Features", "").split()}
    return " ".join([processor_model(), *sorted(flag for flag in flags if flag.startswith(FEATURES))])


def processor_model() -> str:
    """Return the processor's architecture and, if the system provides it, its model: "x86_64 AuthenticAMD 26 2"."""
    listed = _listed(Path("/proc/cpuinfo"))
    return " ".join([platform.machine(), *(listed[name] for name in MODEL if name in listed)])


@lru_cache(maxsize=1)
def _listed(file: Path) -> dict[str, str]:
    """Return what Linux lists about the first processor; nothing on another system."""
    try:
        first = file.read_text(encoding="utf-8", errors="replace").partition("\n\n")[0]
    except OSError:
        return {}
    return {name.strip(): text.strip() for name, _, text in (line.partition(":") for line in first.splitlines())}
