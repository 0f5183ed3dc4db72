"""Write what is made from the code: this folder's files, pages of docs/, a stub; with `--check`, say which are stale.

Run `python schemas/generate.py`, or `make generate`.
"""

from __future__ import annotations

import importlib
import json
import math
import pkgutil
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

from lxml import etree
from pydantic import BaseModel

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from scenario_compiler import vocabulary
from scenario_compiler.carla_server.matrix import calls_page
from scenario_compiler.cli.reference import commands_page
from scenario_compiler.controllers import CONTROLLERS, controller_class
from scenario_compiler.controllers.reference import controllers_page
from scenario_compiler.coverage.conflict import conflict_table, conflict_words
from scenario_compiler.coverage.openscenario import openscenario_table, words_of
from scenario_compiler.coverage.table import Table, as_markdown
from scenario_compiler.coverage.uses import backing_of, files_naming, files_with
from scenario_compiler.openscenario.structure.elements import Element, elements
from scenario_compiler.plan.defaults import CAUSE_DEFAULTS
from scenario_compiler.plan.model import Plan
from scenario_compiler.public import public_names
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.report.reference import run_folder_page
from scenario_compiler.resources import library_folder, maps_folder
from scenario_compiler.source.catalogs import CatalogElement, catalogs_in
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.source.form import conflict_xsd, study_xsd
from scenario_compiler.source.study import STUDIES
from scenario_compiler.vocabulary.reference import language_page as reference_page
from scenario_compiler.vocabulary.takeover import CauseKind
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather
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
    "study.xsd": study_xsd,
}
"""File name to what writes its text."""


PAGES_FOLDER = FOLDER.parent / "docs"

COVERAGE_HEAD = """# What is covered

Made by `make generate`. `scenario-compiler coverage` prints the tables, with `--format json` for programs. A word is
executed by the module that is named, in the engine as the code that is named; `files` counts those of the library and
of the tests that use it, `tests` the files of tests in which an element stands. Besides, every action, condition and
position of OpenSCENARIO is written and read back in tests. That what is executed is right is claimed of variants alone
that a recorded run of esmini 3.6 or a test with numbers worked out by hand backs ([conformance.md](conformance.md)).
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
    page = (PAGES_FOLDER / "conformance.md").read_text(encoding="utf-8")
    backing = backing_of(page)
    backed = [_backed(element, backing) for element in elements().values()]
    return openscenario_table().with_column("as esmini 3.6, or by a stated law", backed).with_column("tests", counts)


def _backed(element: Element, backing: Mapping[str, str]) -> str:
    """Return what backs an action, condition or position; the parts of others have no line of their own."""
    named = next((backing[tag] for tag in (element.name, *element.tags) if tag in backing), "")
    return named or ("not recorded" if words_of(element) else "-")


def language_page() -> str:
    """Return the reference of the language, with examples from the files that hold every word of it."""
    examples = _examples_in(f"every_{what}.xml" for what in ("word", "action", "entry"))
    return reference_page((LibraryElement, CatalogElement), examples)


STUDY_HEAD = """# Studies and questionnaires, word by word

Made from the declarations of the words: change those, then `make generate`. `schemas/study.xsd`
(`scenario-compiler schema study`) says the same to an editor. [Studies](study.md) tells how they are used.

The children of an element stand in the order in which they are listed. Numbers are decimal, in the unit that is given.
"""


def study_page() -> str:
    """Return the reference of studies and questionnaires, with examples from files that hold every word of them."""
    return reference_page(STUDIES, _examples_in(("study/every_word.xml", "study/questionnaire.xml")), STUDY_HEAD)


def _examples_in(files: Iterable[str]) -> dict[tuple[str, str], str]:
    """Return the first example of each element of some of the tests' files, by its tag and that of its parent."""
    examples: dict[tuple[str, str], str] = {}
    for file in files:
        for element in etree.parse(FOLDER.parent / "tests" / "source" / file).iter(etree.Element):
            parent = element.getparent()
            key = str(element.tag), "" if parent is None else str(parent.tag)
            examples.setdefault(key, _example(element))
    return examples


CHILDREN_SHOWN = 4
"""How many children an example shows; of more, the first ones."""


def _example(element: etree._Element) -> str:
    """Return the text of an element with its first children, and of those the attributes alone."""
    children = list(element.iterchildren(etree.Element))
    opened = f"<{element.tag!s}{_attributes(element)}"
    if not children:
        return f"{opened}/>"
    shown = [f"  <{one.tag!s}{_attributes(one)}{'>...</' + str(one.tag) if len(one) else '/'}>" for one in children]
    more = ["  ..."] if len(shown) > CHILDREN_SHOWN else []
    return "\n".join((f"{opened}>", *shown[:CHILDREN_SHOWN], *more, f"</{element.tag}>"))


def _attributes(element: etree._Element) -> str:
    given = ((name, value) for name, value in element.attrib.items() if not str(name).startswith("{"))
    return "".join(f" {name!s}={quoteattr(str(value))}" for name, value in given)


NAMES_HEAD = """# Names that come along

Made by `make generate` from what the program reads: the weathers, the library's catalogs, the controllers and the maps.
What an attribute is when it is left out stands with the attribute, in [the language, word by word](language.md); what a
cause of a request starts from is the last table here.
"""


def names_page() -> str:
    """Return the page on the weathers, vehicles, drivers, effects, controllers and maps that a scenario can name."""
    catalogs, _ = catalogs_in(library_folder() / "catalogs")
    numbers = list(Weather.model_fields)[2:]
    weathers = [(name, *(f"{one:g}" for one in values)) for name, values in WEATHER_PRESETS.items()]
    vehicles = [
        (one.name, one.category, f"{one.length:g} x {one.width:g} x {one.height:g}", one.summary)
        for one in catalogs.vehicles.values()
    ]
    drivers = [(one.name, one.summary, one.source) for one in catalogs.drivers.values()]
    effects = [(str(one.of), str(one.by), one.source) for one in catalogs.effects.values()]
    params = [
        (name, field, str(info.default), info.description or "")
        for name in CONTROLLERS
        for field, info in controller_class(name).Params.model_fields.items()
    ]
    maps = [
        (file.parent.name, " ".join(str(tomllib.loads(file.read_text("utf-8"))["summary"]).split()))
        for file in sorted(maps_folder().glob("*/map.toml"))
    ]
    causes = [(kind, name, _number(kind, name)) for kind, values in CAUSE_DEFAULTS.items() for name in values]
    tables = (
        Table("conflict", "Weathers", ("name", *(one.replace("_", " ") for one in numbers)), tuple(weathers)),
        Table("conflict", "Maps", ("name", "what it is"), tuple(maps)),
        Table("conflict", "Vehicles, people and things", ("name", "category", "box, m", "what it is"), tuple(vehicles)),
        Table("conflict", "Drivers", ("name", "whom it stands for", "source"), tuple(drivers)),
        Table("conflict", "Effects on takeover times", ("of", "by, s", "source"), tuple(effects)),
        Table("conflict", "Controllers", ("name", "property", "default", "what it is"), tuple(params)),
        Table("conflict", "Causes of requests", ("cause", "attribute", "default"), tuple(causes)),
    )
    return "\n".join((NAMES_HEAD, *map(as_markdown, tables)))


def _number(kind: CauseKind, name: str) -> str:
    """Return a cause's default as XML writes it."""
    value = CAUSE_DEFAULTS[kind][name]
    return f"{math.degrees(value):g} deg" if name == "field_of_view" else f"{value:g}"


PAGES: dict[str, Callable[[], str]] = {
    "carla-calls.md": calls_page,
    "commands.md": commands_page,
    "controllers.md": controllers_page,
    "coverage.md": coverage_page,
    "language.md": language_page,
    "names.md": names_page,
    "run-folder.md": run_folder_page,
    "study-language.md": study_page,
}
"""The same for pages of docs/, by their names."""


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
