"""Mutants: real files with some faults in them, each decided by its number."""

from __future__ import annotations

import copy
import json
import re
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from lxml import etree

from scenario_compiler import compile_scenario
from scenario_compiler.plan.store import write_plan
from scenario_compiler.randomness import random_hash
from scenario_compiler.vocabulary.grammar import NUMBER

SUFFIXES = (".xml", ".xosc", ".xodr")
"""Endings of the files that mutants are made of."""

FAULTS = 4
"""Most faults in a mutant."""

LARGEST = 60_000
"""Largest original, bytes: a mutant is parsed and written anew."""

PLANNED = ("library/conflicts/obstacle_ahead.xml", "tests/benchmarks/cut_in.xml", "tests/benchmarks/scripted.xosc")
"""Scenarios whose plans are mutated too."""

VALUES = (
    "", "nan", "inf", "-1", "0", "1e308", "-1e308", "1e-320", "1e20", "9" * 400, "true", "Ego", "ego", "$missing",
    "${1/0}", "${", "${9^9^9^9}", "80 km/h", "5 ms", "..\\a\\b", "/dev/zero", "os:abort", "mod.py:Class", "=1+1",
    "\u00e4 \u2028", "\u202e", "a\nb", "::error::x", "$\\frac{1}{0}$", "<b>", "urn:x",
)  # fmt: skip
"""What a value may become."""

T = TypeVar("T")


@dataclass(frozen=True)
class Original:
    """A file that mutants are made of: its content, its ending, its folder, and the collection that it belongs to."""

    name: str
    content: bytes
    suffix: str
    folder: Path
    root: Path


@dataclass(frozen=True)
class Mutant:
    """A mutant.

    Attributes:
        name: Its kind, number and original.
        path: Its file.
        content: What the file holds.
    """

    name: str
    path: Path
    content: bytes


class Draw:
    """Draws that depend on the number of the mutant alone."""

    def __init__(self, number: int, stream: int) -> None:
        """Begin the draws of a mutant."""
        self._number, self._stream, self._count = number, stream, 0

    def below(self, bound: int) -> int:
        """Return a number from 0 to bound - 1."""
        self._count += 1
        return random_hash(self._number, self._stream, 0, self._count) % bound

    def one(self, of: Sequence[T]) -> T:
        """Return one of several."""
        return of[self.below(len(of))]


def originals(repository: Path, corpus: Path | None) -> list[Original]:
    """Return the files that mutants are made of, in a fixed order."""
    ours = ("library", "maps", "tests/cases", "tests/hostile", "tests/benchmarks")
    folders = [(repository, repository / name) for name in ours]
    folders += [] if corpus is None else [(corpus, corpus)]
    found = [
        Original(path.name, path.read_bytes(), path.suffix, path.parent, root)
        for root, folder in folders
        for path in sorted(folder.rglob("*"))
        if path.suffix in SUFFIXES and path.is_file() and 0 < path.stat().st_size < LARGEST
    ]
    return found + [_planned(repository, repository / name) for name in PLANNED]


def _planned(root: Path, path: Path) -> Original:
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "plan.json"
        write_plan(compile_scenario(path), target)
        return Original(f"{path.stem}.json", target.read_bytes(), ".json", path.parent, root)


class Mirrors:
    """Folders in which mutants lie as their originals do: with links to all that is beside and above those."""

    def __init__(self, base: Path) -> None:
        """Take an empty folder for them."""
        self._base = base
        self._made: dict[Path, Path] = {}

    def of(self, original: Original) -> Path:
        """Return the mirror of an original's folder."""
        if original.folder not in self._made:
            there, here = original.root, self._base / str(len(self._made))
            for part in (*original.folder.relative_to(original.root).parts, ""):
                here.mkdir(parents=True)
                for entry in sorted(there.iterdir()):
                    if entry.name != part and not entry.name.startswith("."):
                        (here / entry.name).symlink_to(entry)
                there, here = there / part, here / part
            self._made[original.folder] = here
        return self._made[original.folder]


def mutant(number: int, kind: str, sources: Sequence[Original], mirrors: Mirrors) -> Mutant:
    """Make a mutant, in a file beside what its original names."""
    draw = Draw(number, len(kind))
    original = draw.one([one for one in sources if kind != "runs" or _runs(one)])
    content = original.content
    damage = _nudged if kind == "runs" else _damaged
    for _ in range(1 + draw.below(FAULTS)):
        content = damage(content, original.suffix, draw)
    path = mirrors.of(original) / f"mutant{original.suffix}"
    path.write_bytes(content)
    return Mutant(f"{kind} {number} ({original.name})", path, content)


def _damaged(content: bytes, suffix: str, draw: Draw) -> bytes:
    if draw.below(4) == 0:
        return draw.one(BYTE_FAULTS)(content, draw)
    if suffix == ".json":
        return _json_fault(content, draw)
    try:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False))
    except etree.XMLSyntaxError:
        return draw.one(BYTE_FAULTS)(content, draw)
    draw.one(TREE_FAULTS)(draw.one(list(root.iter(etree.Element))), draw)
    return etree.tostring(root.getroottree())


def _runs(original: Original) -> bool:
    """Return whether a file is a scenario that may run as it is: no road, no catalog, no template, nothing faulty."""
    faulty = {"cases", "hostile", "files", "templates", "catalogs"} & set(original.folder.parts)
    scenario = any(word in original.content for word in (b"<Storyboard", b"<scenario ", b"scenario-compiler/plan"))
    return scenario and not faulty and original.suffix != ".xodr"


def _nudged(content: bytes, suffix: str, draw: Draw) -> bytes:
    """Change a number by a factor; once in a while do greater damage."""
    if suffix == ".json" or draw.below(8) == 0:
        return _damaged(content, suffix, draw)
    try:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False))
    except etree.XMLSyntaxError:
        return content
    numbers = [
        (element, str(name))
        for element in root.iter(etree.Element)
        for name, value in sorted(element.attrib.items())
        if str(name) not in ("version", "revMajor", "revMinor") and re.fullmatch(NUMBER, str(value))
    ]
    if numbers:
        element, name = draw.one(numbers)
        element.set(name, f"{float(str(element.get(name))) * draw.one(FACTORS):.6g}")
    return etree.tostring(root.getroottree())


FACTORS = (0.0, -1.0, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3, 1e6, 1e-3)
"""By what a number is multiplied."""


def _cut(content: bytes, draw: Draw) -> bytes:
    return content[: draw.below(len(content) + 1)]


def _flip(content: bytes, draw: Draw) -> bytes:
    at = draw.below(max(len(content), 1))
    return content[:at] + bytes([draw.below(256)]) + content[at + 1 :]


def _insert(content: bytes, draw: Draw) -> bytes:
    at = draw.below(len(content) + 1)
    return content[:at] + draw.one(VALUES).encode("utf-8", "surrogatepass") + content[at:]


def _repeat(content: bytes, draw: Draw) -> bytes:
    begin = draw.below(len(content) + 1)
    piece = content[begin : begin + draw.below(2000)]
    return content[:begin] + piece * (1 + draw.below(4)) + content[begin:]


def _drop(content: bytes, draw: Draw) -> bytes:
    begin = draw.below(len(content) + 1)
    return content[:begin] + content[begin + draw.below(200) :]


BYTE_FAULTS: tuple[Callable[[bytes, Draw], bytes], ...] = (_cut, _flip, _insert, _repeat, _drop)


def _delete(element: etree._Element, draw: Draw) -> None:
    del draw
    parent = element.getparent()
    if parent is not None:
        parent.remove(element)


def _double(element: etree._Element, draw: Draw) -> None:
    parent = element.getparent()
    if parent is not None:
        for _ in range(1 + draw.below(3)):
            parent.append(copy.deepcopy(element))


def _move(element: etree._Element, draw: Draw) -> None:
    other = draw.one(list(element.getroottree().getroot().iter(etree.Element)))
    other.append(copy.deepcopy(element))


def _rename(element: etree._Element, draw: Draw) -> None:
    other = draw.one(list(element.getroottree().getroot().iter(etree.Element)))
    element.tag = other.tag


def _spoil(element: etree._Element, draw: Draw) -> None:
    if element.attrib:
        name = draw.one(sorted(map(str, element.attrib)))
        if draw.below(5) == 0:
            del element.attrib[name]
        else:
            element.attrib[name] = draw.one(VALUES)


def _exchange(element: etree._Element, draw: Draw) -> None:
    tree = element.getroottree().getroot()
    values = [str(value) for one in tree.iter(etree.Element) for value in one.attrib.values()]
    if element.attrib and values:
        element.attrib[draw.one(sorted(map(str, element.attrib)))] = draw.one(values)


TREE_FAULTS: tuple[Callable[[etree._Element, Draw], None], ...] = (
    _delete, _double, _move, _rename, _spoil, _spoil, _spoil, _exchange, _exchange,
)  # fmt: skip


def _json_fault(content: bytes, draw: Draw) -> bytes:
    """Change, delete or repeat one value of a plan."""
    try:
        plan: Any = json.loads(content)
    except ValueError:
        return draw.one(BYTE_FAULTS)(content, draw)
    at = plan
    for _ in range(draw.below(7)):
        inner = [one for one in (at.values() if isinstance(at, dict) else at) if isinstance(one, (dict, list)) and one]
        if not inner:
            break
        at = draw.one(inner)
    if not at or not isinstance(at, (dict, list)):
        return content
    key: Any = draw.one(sorted(at)) if isinstance(at, dict) else draw.below(len(at))
    what = draw.below(5)
    if what == 0:
        del at[key]
    elif what == 1 and isinstance(at, list):
        at.append(at[key])
    elif what == 2:
        at[key] = {"expr": draw.one(("$speed", "1/0", "$gone", "9^9^9"))}
    else:
        at[key] = draw.one((None, -1, 0, 1e20, 1e308, 10**30, "", "x", [], {}, True, *VALUES[:6]))
    return json.dumps(plan).encode()
