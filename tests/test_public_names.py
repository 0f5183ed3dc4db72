"""The public names of the package, and the modules that importing the package loads."""

from __future__ import annotations

import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler.public import public_names
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.vocabulary.schema import words_below

door = importlib.import_module("scenario_compiler")

DOORS = ("scenario_compiler", "scenario_compiler.perception", "scenario_compiler.roads")
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
REPOSITORY = Path(__file__).resolve().parent.parent
DEEP = re.compile(r"^\s*(?:from|import) scenario_compiler\.(?!(?:perception|roads|worlds) import)", re.MULTILINE)
"""An import of a module of ours other than the doors for programs."""


def test_every_promised_name_is_public() -> None:
    assert sorted(set(PROMISED) - set(door.__all__)) == []


def test_every_word_of_the_language_is_public() -> None:
    below = words_below((LibraryElement, CatalogElement))
    words = {word.__name__ for word in below if word.__module__.startswith("scenario_compiler.vocabulary.")}
    assert len(words) > 100
    assert sorted(words - set(door.__all__)) == []


@pytest.mark.parametrize("package", DOORS)
def test_public_names_resolve_and_are_documented(package: str) -> None:
    module = importlib.import_module(package)
    names = public_names(package)
    assert list(module.__all__) == sorted(names)
    for name in names:
        named = getattr(module, name)
        assert named.__doc__ or not (inspect.isclass(named) or inspect.isfunction(named)), name
        assert name in dir(module)


@pytest.mark.parametrize("package", DOORS)
def test_an_unknown_name_is_an_attribute_error(package: str) -> None:
    with pytest.raises(AttributeError, match=f"'{package}' has no attribute 'no_such_name'"):
        _ = importlib.import_module(package).no_such_name


@pytest.mark.parametrize("folder", ["examples", "docs", "README.md"])
def test_pages_and_examples_import_only_public_names(folder: str) -> None:
    where = REPOSITORY / folder
    files = [where] if where.is_file() else [path for end in ("*.py", "*.md") for path in sorted(where.rglob(end))]
    assert files
    assert [path.name for path in files if DEEP.search(path.read_text(encoding="utf-8"))] == []


def test_importing_the_package_imports_nothing_else_of_it() -> None:
    probe = "import sys, scenario_compiler; print(*(m for m in sys.modules if 'scenario_compiler.' in m))"
    found = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []


def test_importing_a_word_does_not_import_the_stages() -> None:
    probe = "import sys\nfrom scenario_compiler import Ego\nprint([m for m in ('numpy', 'cv2') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert found.stdout == "[]\n"
