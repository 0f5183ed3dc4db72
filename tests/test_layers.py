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
    ("study",),
    ("batch", "live", "carla_server", "editor", "survey"),
    ("report", "validation", "listing"),
    ("study_plans",),
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
    ("forms",),
)
HALL = (
    "addresses",
    "diagnostic_formats",
    "diagnostics",
    "document",
    "expressions",
    "files",
    "frames",
    "garbage_collection",
    "interruption",
    "legible",
    "marker",
    "outputs",
    "processes",
    "public",
    "randomness",
    "records",
    "resources",
    "structure",
    "trust",
)
LEVEL = {room: level for level, row in enumerate(reversed((*ROWS, HALL))) for room in row}

ENGINE_ROWS = (
    ("reference_runs", "at_first"),
    ("simulation",),
    ("program", "entries"),
    ("story",),
    ("moves",),
    ("ego", "traffic", "measures"),
    ("motion",),
    ("columns",),
)
"""The rooms of the engine, by the same rule: a row imports from rows below it only."""

KEPT_APART = {
    "engine": ("document",),  # the engine knows no XML
    "runtime": ("languages", "openscenario", "source"),  # a plan that comes from JSON runs without a front end
    "worlds": ("openscenario", "source"),
    "controllers": ("openscenario", "source"),
    "source": ("engine", "plan", "recording", "roads"),  # a document is expanded without a map
    "report": ("languages", "openscenario", "source", "worlds"),
    "batch": ("worlds",),
}
"""Rooms below that a room may not import nevertheless."""

HEAVY: dict[str, tuple[str, ...]] = {
    "av": ("report.video",),
    "carla": ("worlds.carla_session",),
    "cv2": ("perception",),
    "dask": ("batch.cluster",),
    "distributed": ("batch.cluster",),
    "lsprotocol": ("editor.server",),
    "msgpack": ("carla_server",),
    "mcap": ("report.mcap_file",),
    "matplotlib": (
        "report.plots",
        "report.sweep_plots",
        "report.map_plot",
        "report.preview",
        "report.lettering",
        "report.reliability_plot",
    ),
    "pandas": ("batch.many", "recording.recording"),
    "pygls": ("editor.server",),
    "qc_baselib": ("openscenario.xsd",),
    "qc_openscenario": ("openscenario.xsd",),
    "pydantic": (
        *("controllers.lane_detection", "controllers.model", "controllers.named", "live", "plan.store"),
        *("recording.events", "recording.outcome", "records", "study.server", "survey", "vocabulary.word"),
    ),
    "pyarrow": ("batch.finished", "batch.results", "recording.arrow", "recording.store"),
    "pylsl": ("study.outlet",),
    "rerun": ("report.rerun_file",),
    "scenariogeneration": (),
    "xmlschema": ("roads.xsd",),
    "scipy": (
        "batch.sampling",
        "batch.search",
        "perception.calibration.fit",
        "perception.calibration.lines",
        "study.effects",
    ),
    "starlette": ("live.server", "live.cockpit", "live.web", "study.server"),
    "uvicorn": ("live.web",),
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

    A name imported from a package counts as a module if it is one. A text such as
    "scenario_compiler.worlds.carla:World" counts too: tables of lazily imported modules are written so.
    """
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root.parent).with_suffix("").parts
        importer = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        shown = path.relative_to(root.parent)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for imported in _named_by(node, root):
                yield Import(importer, imported, f"{shown}:{getattr(node, 'lineno', 0)}")


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
    """Return a sentence for each import in the package at `root` that breaks the layer rule, and for each circle."""
    imports = list(imports_of(root))
    broken = [_broken_rule(one, root.name) for one in imports] + [_broken_room(one, root.name) for one in imports]
    circles = [f"{' and '.join(circle)} import one another" for circle in circles_of(imports, root.name)]
    return [sentence for sentence in broken if sentence] + circles


def circles_of(imports: list[Import], name: str) -> list[list[str]]:
    """Return the groups of modules that import one another, directly or through others (Tarjan's algorithm)."""
    graph: dict[str, set[str]] = {}
    for one in imports:
        target = one.imported.removeprefix(f"{name}.")
        if target != one.imported:
            graph.setdefault(one.importer.removeprefix(f"{name}."), set()).add(target)
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    open_modules: list[str] = []
    found: list[list[str]] = []

    def visit(module: str) -> None:
        order[module] = lowest[module] = len(order)
        open_modules.append(module)
        for target in sorted(graph.get(module, ())):
            if target not in order:
                visit(target)
            if target in open_modules:
                lowest[module] = min(lowest[module], lowest[target])
        if lowest[module] == order[module]:
            place = open_modules.index(module)
            circle = sorted(open_modules[place:])
            del open_modules[place:]
            found.extend([circle] if len(circle) > 1 else [])

    for module in sorted(graph):
        if module not in order:
            visit(module)
    return found


def _broken_room(one: Import, name: str) -> str | None:
    """Return what is wrong with an import from one room of the engine into another."""
    inside = f"{name}.engine."
    if not one.importer.startswith(inside) or not one.imported.startswith(inside):
        return None
    level = {room: number for number, row in enumerate(reversed(ENGINE_ROWS)) for room in row}
    rooms = [module.removeprefix(inside).split(".")[0] for module in (one.importer, one.imported)]
    for room in rooms:
        if room not in level:
            return f"{one.place}: {room} has no row in the engine's table"
    if rooms[0] == rooms[1] or level[rooms[1]] < level[rooms[0]]:
        return None
    return f"{one.place}: the engine's {rooms[0]} imports {rooms[1]}, which is not below it"


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
        ("openscenario/contents.py", "import house.source", "openscenario imports source, which is sideways"),
        ("runtime/loop.py", "from house import compiler", "runtime imports compiler, which is sideways"),
        ("frames.py", "from house.roads import Network", "frames imports roads, which is up"),
        ("engine/step.py", "from house import document", "engine is kept apart from document"),
        ("runtime/loop.py", "import house.source.conflict", "runtime is kept apart from source"),
        ("roads/lanes.py", "from house import load_network", "name the module that holds it"),
        ("roads/lanes.py", "from . import tables", "relative import"),
        ("cellar/wine.py", "from house import frames", "cellar has no row"),
        ("engine/motion/a.py", "from house.engine.story import step", "motion imports story, which is not below it"),
        ("engine/cellar/a.py", "from house.engine.columns import log", "cellar has no row in the engine's table"),
        ("engine/step.py", "import cv2", "cv2 is imported in perception only"),
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
        ("perception/render.py", "import cv2"),
        ("__init__.py", "PUBLIC = {'run': 'house.runtime'}\nfrom house.cli import main"),
        ("cli.py", "TEXT = 'see house.md and house'"),
    ],
)
def test_a_kept_rule_is_not_found_broken(tmp_path: Path, module: str, source: str) -> None:
    assert violations(_house(tmp_path, {module: source})) == []


def test_a_circle_of_modules_is_found(tmp_path: Path) -> None:
    files = {
        "plan/one.py": "from house.plan import two",
        "plan/two.py": "def f():\n    from house.plan.three import g",
        "plan/three.py": "from house.plan.one import x",
        "plan/four.py": "from house.plan.one import x",
    }
    assert violations(_house(tmp_path, files)) == ["plan.one and plan.three and plan.two import one another"]


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


@pytest.mark.parametrize("files", ["library", "maps", "tests/benchmarks/scripted.xosc"])
def test_validate_loads_no_heavy_package(repository: Path, files: str) -> None:
    assert heavy_packages_of("validate", str(repository / files)) == []


def test_a_run_that_writes_a_trajectory_loads_no_heavy_package(repository: Path, tmp_path: Path) -> None:
    scenario, trajectory = repository / "tests" / "benchmarks" / "cut_in.xml", tmp_path / "trajectory.csv"
    wanted = ("--perception", "ideal", "--duration", "1", "--trajectory", str(trajectory))
    assert heavy_packages_of("run", str(scenario), *wanted) == []
    assert trajectory.is_file()


def test_a_sweep_does_not_load_pydantic(tmp_path: Path) -> None:
    wanted = ("--perception", "ideal", "--duration", "1", "--vary", "distance=uniform(100, 300)", "--no-report")
    assert "pydantic" not in heavy_packages_of("sweep", "obstacle_ahead", *wanted, "-o", str(tmp_path / "sweep"))


def heavy_packages_of(*arguments: str) -> list[str]:
    """Return the packages of HEAVY that a command loads."""
    probe = [sys.executable, "-c", PROBE, *arguments]
    done = subprocess.run(probe, capture_output=True, text=True, check=True, timeout=120)
    loaded = done.stderr.splitlines()[-1].split()
    assert NAME in loaded
    return sorted(set(loaded) & set(HEAVY))
