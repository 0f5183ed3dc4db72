"""ASAM's schemas for tests, taken from the wheels of its quality checkers and cached."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pytest

CACHE = Path(tempfile.gettempdir()) / "scenario-compiler-tests"


def schemas_of_wheel(wheel: str, package: str) -> Path:
    """Return the folder of a wheel's schemas; skip the test if the package index does not have the wheel."""
    cache = CACHE / wheel
    folder = cache / "schemas"
    if folder.is_dir():
        return folder
    cache.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(cache), wheel]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        pytest.skip("the package index did not answer within 60 s")
    wheels = sorted(cache.glob("*.whl"))
    if done.returncode != 0 or not wheels:
        pytest.skip(f"the package index does not give {wheel}")
    with tempfile.TemporaryDirectory(dir=cache) as unpacked, zipfile.ZipFile(wheels[-1]) as archive:
        archive.extractall(unpacked, [name for name in archive.namelist() if name.endswith(".xsd")])
        if not folder.is_dir():
            Path(unpacked, package, "schema").rename(folder)
    return folder
