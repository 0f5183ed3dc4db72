"""The layer rule: who imports whom, read from the source of every module, imports inside functions included.

A row imports from the rows below it only, never sideways or up; the modules of the hall import only
each other; a heavy package is imported in the one place that needs it. A new package gets its row in `ROWS`.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

NAME = "scenario_compiler"
PACKAGE = Path(__file__).resolve().parent.parent / NAME

ROWS = (
    ("__main__",),
    ("cli",),
    ("batch", "study", "carla_server"),
    ("report", "validation", "listing"),
    ("runtime", "compiler", "coverage"),
    ("languages",),
    ("worlds",),
    ("controllers",),
    ("perception", "source", "openscenario"),
    ("markup",),
    ("recording",),
    ("engine",),
    ("plan",),
    ("vocabulary",),
    ("roads",),
)
HALL = (
    "diagnostic_formats",
    "diagnostics",
    "document",
    "expressions",
    "files",
    "frames",
    "interruption",
    "legible",
    "marker",
    "outputs",
    "randomness",
    "resources",
    "structure",
    "trust",
)
LEVEL = {room: level for level, row in enumerate(reversed((*ROWS, HALL))) for room in row}

KEPT_APART = {
    "engine": ("document",),  # the engine knows no XML
    "runtime": ("languages", "openscenario", "source"),  # a plan that comes from JSON runs without a front end
    "worlds": ("openscenario", "source"),
    "controllers": ("openscenario", "source"),
    "report": ("languages", "openscenario", "source"),
}
"""Rooms below that a room may not import all the same."""

HEAVY: dict[str, tuple[str, ...]] = {
    "av": ("report.video",),
    "carla": ("worlds.carla",),
    "cv2": ("perception",),
    "dask": ("batch.cluster",),
    "distributed": ("batch.cluster",),
    "llvmlite": ("engine.build", "engine.linking"),
    "matplotlib": ("report.plots", "report.sweep_plots", "report.map_plot", "report.preview", "report.lettering"),
    "numba": ("engine.linking",),
    "qc_baselib": ("openscenario.xsd",),
    "qc_openscenario": ("openscenario.xsd",),
    "pyarrow": ("batch.results", "recording.store"),
    "scenariogeneration": (),
    "xmlschema": ("roads.xsd",),
    "scipy": ("batch.sampling", "batch.search"),
    "starlette": ("study.server",),
    "uvicorn": ("study.server",),
}
"""Packages that cost start-up time or are extras, and the module (or package) that alone imports each."""


@dataclass(frozen=True)
class Import:
    """One import as written: the importing module and the imported one, dotted, and the place."""

    importer: str
    imported: str
    place: str


def imports_of(root: Path) -> Iterator[Import]:
    """Yield every import in the package at `root`.

    A name imported from a package counts as a module where it is one. A text such as
    "scenario_compiler.worlds.carla:World" counts too: tables of lazily imported modules are written so.
    """
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root.parent).with_suffix("").parts
        importer = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            line = getattr(node, "lineno", 0)
            place = f"{path.relative_to(root.parent)}:{line}"
            for imported in _named_by(node, root):
                yield Import(importer, imported, place)


def _named_by(node: ast.AST, root: Path) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        source = "." * node.level + (node.module or "")
        if node.level or source.split(".")[0] != root.name:
            return [source]
        folder = root.parent.joinpath(*source.split("."))
        modules = [a.name for a in node.names if (folder / a.name).is_dir() or (folder / f"{a.name}.py").is_file()]
        rest = [source] if len(modules) < len(node.names) else []
        return [f"{source}.{module}" for module in modules] + rest
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        named = re.fullmatch(rf"({root.name}(?:\.\w+)+)(?::\w+)?", node.value)
        return [named.group(1)] if named else []
    return []


def violations(root: Path) -> list[str]:
    """Return a sentence for each import in the package at `root` that breaks the layer rule."""
    broken = (_broken_rule(one, root.name) for one in imports_of(root))
    return [sentence for sentence in broken if sentence]


def _broken_rule(one: Import, name: str) -> str | None:
    inner = one.importer.removeprefix(name).removeprefix(".")
    top = one.imported.split(".")[0]
    if top in HEAVY:
        allowed = HEAVY[top]
        if any(inner == place or inner.startswith(f"{place}.") for place in allowed):
            return None
        return f"{one.place}: {top} is imported in {' and '.join(allowed) or 'no module'} only"
    if one.imported.startswith("."):
        return f"{one.place}: relative import"
    if top != name or not inner:
        return None
    room, target = inner.split(".")[0], one.imported.removeprefix(name).removeprefix(".").split(".")[0]
    if not target:
        return f"{one.place}: {inner} imports from the package's door; name the module that holds it"
    return _broken_row(one.place, room, target)


def _broken_row(place: str, room: str, target: str) -> str | None:
    for unknown in (room, target):
        if unknown not in LEVEL:
            return f"{place}: {unknown} has no row in the layer table"
    if target in KEPT_APART.get(room, ()):
        return f"{place}: {room} is kept apart from {target}"
    if target == room or LEVEL[target] < LEVEL[room] or (room in HALL and target in HALL):
        return None
    direction = "sideways" if LEVEL[target] == LEVEL[room] else "up"
    return f"{place}: {room} imports {target}, which is {direction}"


def test_the_package_keeps_the_layer_rule() -> None:
    assert violations(PACKAGE) == []


def test_every_module_has_a_row() -> None:
    rooms = {path.stem for path in PACKAGE.glob("*.py")} | {path.parent.name for path in PACKAGE.glob("*/*.py")}
    assert rooms - {"__init__", NAME} <= set(LEVEL)


@pytest.mark.parametrize(
    ("module", "source", "sentence"),
    [
        ("roads/lanes.py", "from house.plan.store import Plan", "roads imports plan, which is up"),
        ("roads/lanes.py", "import house.plan", "roads imports plan, which is up"),
        ("roads/lanes.py", "from house import plan", "roads imports plan, which is up"),
        ("roads/lanes.py", "def f():\n    import house.plan", "roads imports plan, which is up"),
        (
            "roads/lanes.py",
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from house.plan import Plan",
            "roads imports plan, which is up",
        ),
        ("worlds/__init__.py", "TABLE = {'x': 'house.cli:main'}", "worlds imports cli, which is up"),
        ("perception/camera.py", "import house.source", "perception imports source, which is sideways"),
        ("openscenario/held.py", "import house.source", "openscenario imports source, which is sideways"),
        ("runtime/loop.py", "from house import compiler", "runtime imports compiler, which is sideways"),
        ("frames.py", "from house.roads import Network", "frames imports roads, which is up"),
        ("engine/step.py", "from house import document", "engine is kept apart from document"),
        ("runtime/loop.py", "import house.source.conflict", "runtime is kept apart from source"),
        ("roads/lanes.py", "from house import load_network", "name the module that holds it"),
        ("roads/lanes.py", "from . import tables", "relative import"),
        ("cellar/wine.py", "from house import frames", "cellar has no row"),
        ("engine/step.py", "import numba", "numba is imported in engine.linking only"),
        (
            "cli.py",
            "def f():\n    from matplotlib import pyplot",
            "matplotlib is imported in report.plots",
        ),
    ],
)
def test_a_broken_rule_is_found(tmp_path: Path, module: str, source: str, sentence: str) -> None:
    root = _house(tmp_path, {module: source})
    assert [sentence in found for found in violations(root)] == [True]


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("roads/lanes.py", "from house.roads import tables\nfrom house.roads.tables import RoadTables"),
        ("roads/lanes.py", "from house.diagnostics import Code\nimport numpy"),
        ("document.py", "from house.diagnostics import Code"),
        ("plan/lower.py", "import house.roads.tables\nfrom house import vocabulary"),
        ("engine/linking.py", "import numba"),
        ("perception/render.py", "import cv2"),
        ("__init__.py", "PUBLIC = {'run': 'house.runtime'}\nfrom house.cli import main"),
        ("cli.py", "TEXT = 'see house.md and house'"),
    ],
)
def test_a_kept_rule_is_not_found_broken(tmp_path: Path, module: str, source: str) -> None:
    assert violations(_house(tmp_path, {module: source})) == []


def _house(folder: Path, files: dict[str, str]) -> Path:
    """Write a package with the rooms that the cases import from, and `files` in it; return its root."""
    root = folder / "house"
    rooms = (
        "__init__.py",
        "roads/__init__.py",
        "roads/tables.py",
        "plan/__init__.py",
        "compiler.py",
        "source/__init__.py",
    )
    for path, text in (
        {room: "" for room in (*rooms, "vocabulary/__init__.py", "document.py", "frames.py")} | files
    ).items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, encoding="utf-8")
    return root


PROBE = """
import sys
from scenario_compiler.cli import main
sys.argv[0] = "scenario-compiler"
try:
    main()
except SystemExit:
    pass
print(*sorted({name.split(".")[0] for name in sys.modules}), file=sys.stderr)
"""


@pytest.mark.parametrize("folder", ["library", "maps"])
def test_validate_loads_no_heavy_package(repository: Path, folder: str) -> None:
    assert heavy_packages_of("validate", str(repository / folder)) == []


def test_a_run_that_writes_a_trajectory_loads_no_heavy_package(repository: Path, tmp_path: Path) -> None:
    scenario, trajectory = repository / "tests" / "benchmarks" / "cut_in.xml", tmp_path / "trajectory.csv"
    wanted = ("--perception", "ideal", "--duration", "1", "--trajectory", str(trajectory))
    assert heavy_packages_of("run", str(scenario), *wanted) == []
    assert trajectory.is_file()


def heavy_packages_of(*arguments: str) -> list[str]:
    """Return the packages of HEAVY that a command loads."""
    probe = [sys.executable, "-c", PROBE, *arguments]
    done = subprocess.run(probe, capture_output=True, text=True, check=True, timeout=120)
    loaded = done.stderr.splitlines()[-1].split()
    assert NAME in loaded
    return sorted(set(loaded) & set(HEAVY))


ONE_FILE_PROBE = """
import sys
from scenario_compiler.cli import main
sys.argv = ["scenario-compiler", "validate", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    assert end.code == 0
from scenario_compiler.vocabulary.word import Word
built, words = [], [Word]
while words:
    word = words.pop()
    words += word.__subclasses__()
    built += [word.__name__] if word.__pydantic_complete__ else []
print("built:", *sorted(built), file=sys.stderr)
"""


@pytest.mark.parametrize("file", ["library/conflicts/obstacle_ahead.xml", "tests/benchmarks/scripted.xosc"])
def test_validate_builds_no_validator_of_words(repository: Path, file: str) -> None:
    probe = [sys.executable, "-c", ONE_FILE_PROBE, str(repository / file)]
    done = subprocess.run(probe, capture_output=True, text=True, check=True, timeout=120)
    assert done.stderr.splitlines()[-1] == "built:"
