"""Write what is made from the code: this folder's files, pages of docs/, a stub; with `--check`, say which are stale.

Run `python schemas/generate.py`, or `make generate`.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
import sys
from collections.abc import Callable
from pathlib import Path

from pydantic import BaseModel

from scenario_compiler import vocabulary
from scenario_compiler.cli.reference import commands_page
from scenario_compiler.controllers.reference import controllers_page
from scenario_compiler.coverage.conflict import conflict_table, conflict_words
from scenario_compiler.coverage.openscenario import openscenario_table
from scenario_compiler.coverage.table import Table, as_markdown
from scenario_compiler.coverage.uses import files_naming, files_with
from scenario_compiler.openscenario.structure.elements import elements
from scenario_compiler.plan.model import Plan
from scenario_compiler.public import public_names
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.report.reference import run_folder_page
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.source.form import conflict_xsd, language_reference
from scenario_compiler.vocabulary.word import Word

FOLDER = Path(__file__).resolve().parent


def json_schema(model: type[BaseModel]) -> str:
    """Return the JSON schema of a model's file form."""
    return json.dumps(model.model_json_schema(mode="serialization"), indent=1, sort_keys=True) + "\n"


GENERATED: dict[str, Callable[[], str]] = {
    "conflict.xsd": conflict_xsd,
    "events.schema.json": lambda: json_schema(EventRow),
    "outcome.schema.json": lambda: json_schema(Outcome),
    "plan.schema.json": lambda: json_schema(Plan),
}
"""File name to what writes its text."""


PAGES_FOLDER = FOLDER.parent / "docs"

COVERAGE_HEAD = """# What is covered

Made by `make generate`. `scenario-compiler coverage` prints the tables, with `--format json` for programs. A word is
executed by the module that is named, in the engine as the code that is named; `files` counts those of the library and
of the tests that use it, `tests` the files of tests in which an element stands. Besides, every action, condition and
position of OpenSCENARIO is written and read back in tests.
"""


def coverage_page() -> str:
    """Return the page on what of each language is read, executed and exported."""
    files = sorted(file for folder in ("library", "tests") for file in (FOLDER.parent / folder).rglob("*.xml"))
    uses = files_with(files, (LibraryElement, CatalogElement))
    conflict = conflict_table().with_column("files", [str(uses[word]) for word in conflict_words()])
    return "\n".join((COVERAGE_HEAD, as_markdown(conflict), as_markdown(_openscenario_with_tests())))


def _openscenario_with_tests() -> Table:
    """Return OpenSCENARIO's table with the number of the tests' files that have each element."""
    folder = FOLDER.parent / "tests"
    naming = files_naming(file for ending in ("py", "xml", "xosc") for file in sorted(folder.rglob(f"*.{ending}")))
    counts = [str(max(naming[tag] for tag in element.tags)) for element in elements().values()]
    return openscenario_table().with_column("tests", counts)


PAGES: dict[str, Callable[[], str]] = {
    "commands.md": commands_page,
    "controllers.md": controllers_page,
    "coverage.md": coverage_page,
    "language.md": language_reference,
    "run-folder.md": run_folder_page,
}
"""The same for pages of docs/."""


STUB = FOLDER.parent / "scenario_compiler" / "__init__.pyi"


def stub() -> str:
    """Return the stub that lists the package's public names: what stands in it, and every word of the vocabulary."""
    listed = {name: home for name, home in public_names("scenario_compiler").items() if not _is_word(home, name)}
    listed.update((word.__name__, word.__module__) for word in words())
    lines = [f"from {home} import {name} as {name}" for name, home in listed.items()]
    lines.sort(key=lambda line: (line.split()[1], line))
    folded = [line if len(line) <= 120 else line.replace("import ", "import (\n    ") + ",\n)" for line in lines]
    head = '"""What programs import from `scenario_compiler`; see `scenario_compiler.public`."""'
    return "\n".join((head, "", *folded, ""))


def words() -> list[type[Word]]:
    """Return all words of the vocabulary."""
    modules = [one.name for one in pkgutil.walk_packages(vocabulary.__path__, f"{vocabulary.__name__}.")]
    declared = [vars(importlib.import_module(name)).values() for name in modules]
    return [
        one
        for name, values in zip(modules, declared, strict=True)
        for one in values
        if isinstance(one, type) and issubclass(one, Word) and one is not Word
        if one.__module__ == name and not one.__name__.startswith("_")
    ]


def _is_word(home: str, name: str) -> bool:
    if not home.startswith(f"{vocabulary.__name__}."):
        return False
    named = getattr(importlib.import_module(home), name, Word)
    return isinstance(named, type) and issubclass(named, Word)


def main() -> int:
    """Write the files, or with `--check` compare them; return 1 when one is stale."""
    files = {
        **{PAGES_FOLDER / name: text for name, text in PAGES.items()},
        **{FOLDER / name: text for name, text in GENERATED.items()},
        STUB: stub,
    }
    stale = [path for path, text in files.items() if not _is_fresh(path, text())]
    if "--check" in sys.argv[1:]:
        for path in stale:
            print(f"{path.name} is stale: `make generate` rewrites it")
        return 1 if stale else 0
    for path in stale:
        path.write_text(files[path](), encoding="utf-8")
        print(f"wrote {path.name}")
    return 0


def _is_fresh(path: Path, text: str) -> bool:
    return path.is_file() and path.read_text(encoding="utf-8") == text


if __name__ == "__main__":
    sys.exit(main())
