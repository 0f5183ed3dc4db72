"""The door of the package: the names that programs import, and what asking for none of them costs."""

from __future__ import annotations

import importlib
import subprocess
import sys

import pytest

door = importlib.import_module("scenario_compiler")

PROMISED = (
    "Overrides",
    "Plan",
    "Recording",
    "compile_scenario",
    "find_map",
    "judge",
    "load_network",
    "run",
    "write_report",
)


def test_every_promised_name_is_public() -> None:
    assert sorted(set(PROMISED) - set(door.__all__)) == []


def test_public_names_are_sorted_and_listed_once() -> None:
    assert list(door.__all__) == sorted(set(door.__all__))


@pytest.mark.parametrize("name", PROMISED)
def test_public_name_resolves_and_is_documented(name: str) -> None:
    assert getattr(door, name).__doc__
    assert name in dir(door)


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = door.no_such_name


def test_importing_the_package_imports_nothing_else_of_it() -> None:
    probe = "import sys, scenario_compiler; print(*(m for m in sys.modules if 'scenario_compiler.' in m))"
    found = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []
