"""The language of marked functions: their syntax trees, the kinds of their values, and the meanings of their names.

Marked functions use a subset of Python (ARCHITECTURE.md, "One engine, two forms"): whole numbers and floats, the
columns of the declared containers, and calls of other marked functions by name. All of this is read from the functions'
files and modules; no function is executed.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

from scenario_compiler.forms.declaration import CONTAINERS, column_types, containers_in_order, put_to_start, write_first
from scenario_compiler.marker import REGISTRY

PACKAGE = Path(__file__).resolve().parents[1]
"""Folder of the package."""

INT, REAL, BOOL, NOTHING = "int", "real", "bool", "nothing"
INTS, REALS = "ints", "reals"
"""Kinds of values: numbers, results of comparisons, no value, and arguments that are arrays of numbers."""

Kind = str | tuple[str, ...]
"""One of these names, a container's argument name, or a tuple of INT and REAL for a function with several results."""

MATH: dict[str, str] = {
    **dict.fromkeys(("acos", "asin", "atan", "cos", "cosh", "exp", "log", "sin", "sinh", "sqrt", "tan", "tanh"), REAL),
    **dict.fromkeys(("atan2", "copysign"), REAL),
    **dict.fromkeys(("ceil", "floor"), INT),
    **dict.fromkeys(("isfinite", "isnan"), BOOL),
}
"""Functions of `math` that give the same results in both forms, and the kind of the result."""

BUILTINS = frozenset({"abs", "float", "int", "len", "max", "min", "range"})
"""Built-in functions that give the same results in both forms."""

Marked = Callable[..., Any]


@dataclass(frozen=True)
class Finding:
    """Something in a marked function that the engine's language does not have.

    Attributes:
        file: Path relative to the package's parent folder.
        line: Line in the file.
        rule: The fault, as a sentence whose subject is the function.
    """

    file: str
    line: int
    rule: str

    def __str__(self) -> str:
        """Return file, line and sentence in the format of compilers."""
        return f"{self.file}:{self.line}: {self.rule}"


class NotTranslatableError(Exception):
    """Marked functions use what the engine's language does not have; `findings` lists where."""

    def __init__(self, findings: Sequence[Finding]) -> None:
        """Set the findings."""
        super().__init__("\n".join(str(one) for one in findings))
        self.findings = tuple(findings)


@dataclass(frozen=True)
class Signature:
    """The kinds of a function's arguments by name, in order, and of its result."""

    arguments: Mapping[str, Kind]
    result: Kind


@dataclass(frozen=True)
class FunctionSource:
    """The source of a marked function.

    Attributes:
        function: The function.
        tree: Its syntax tree, with the line numbers of its file.
        file: Path of the file, relative to the package's parent folder.
        name: Its name in C, which is unique among all marked functions.
    """

    function: Marked
    tree: ast.FunctionDef
    file: str
    name: str

    @classmethod
    def of(cls, function: Marked) -> FunctionSource:
        """Read a function from its file; TypeError if it is not defined with `def`."""
        lines, first = inspect.getsourcelines(function)
        tree = ast.parse(textwrap.dedent("".join(lines)))
        ast.increment_lineno(tree, first - 1)
        node = tree.body[0]
        if not isinstance(node, ast.FunctionDef):
            raise TypeError(f"{function.__qualname__} is not a function written with def")
        path = Path(inspect.getfile(function)).resolve()
        inside = path.is_relative_to(PACKAGE.parent)
        file = path.relative_to(PACKAGE.parent).as_posix() if inside else path.name
        return cls(function, node, file, c_name(function))

    @cached_property
    def signature(self) -> Signature:
        """The kinds of its arguments and its result.

        Raises:
            NotTranslatableError: An annotation is missing or is not a kind, or the arguments are not allowed.
        """
        arguments = self.tree.args
        if arguments.defaults or arguments.kwonlyargs or arguments.vararg or arguments.kwarg or arguments.posonlyargs:
            raise NotTranslatableError([self.finding(self.tree, "has optional, named or collected arguments")])
        kinds = {one.arg: self._kind(one.annotation, one.arg) for one in arguments.args}
        order = [name for name in containers_in_order() if name in kinds]
        if order != list(kinds)[: len(order)]:
            message = f"does not take {' and '.join(order)} first and in this order"
            raise NotTranslatableError([self.finding(self.tree, message)])
        return Signature(kinds, self._kind(self.tree.returns, ""))

    def _kind(self, annotation: ast.expr | None, argument: str) -> Kind:
        if annotation is None:
            raise NotTranslatableError([self.finding(self.tree, "is not annotated")])
        kind = kind_of(annotation)
        container = CONTAINERS.get(argument)
        if container is not None and ast.unparse(annotation) == container.columns.__name__:
            return argument
        if kind is None or container is not None:
            message = f"has an argument or a result annotated as {ast.unparse(annotation)}"
            raise NotTranslatableError([self.finding(annotation, message)])
        return kind

    @property
    def body(self) -> list[ast.stmt]:
        """Its statements without the docstring."""
        return self.tree.body[1:] if ast.get_docstring(self.tree) is not None else self.tree.body

    @property
    def summary(self) -> str:
        """The first line of its docstring."""
        return (ast.get_docstring(self.tree) or "").partition("\n")[0]

    def finding(self, node: ast.AST, rule: str) -> Finding:
        """Return a finding at a node of its tree."""
        return Finding(self.file, getattr(node, "lineno", self.tree.lineno), f"{self.tree.name} {rule}")

    def meaning(self, name: str) -> Any:
        """Return the value of a global name of the function; None if it has none."""
        return self.function.__globals__.get(name)


def kind_of(annotation: ast.expr) -> Kind | None:
    """Return the kind for an annotation; None if there is none."""
    text = ast.unparse(annotation)
    known: dict[str, Kind] = {
        "int": INT,
        "float": REAL,
        "bool": BOOL,
        "None": NOTHING,
        "list[float]": REALS,
        "list[int]": INTS,
    }
    if text in known:
        return known[text]
    if isinstance(annotation, ast.Subscript) and text.startswith("tuple[") and isinstance(annotation.slice, ast.Tuple):
        parts = [kind_of(one) for one in annotation.slice.elts]
        if all(part in (INT, REAL) for part in parts):
            return tuple(str(part) for part in parts)
    return None


def c_name(function: Marked) -> str:
    """Return a function's name in C: its module's path below the package or engine, two underscores, and its name."""
    path = function.__module__.removeprefix("scenario_compiler.").removeprefix("engine.")
    return f"{path.replace('.', '_')}__{function.__name__}"


def container_columns(argument: str) -> dict[str, str]:
    """Return the kind of each column, by name and in order, of the container with this argument name."""
    return {name: REAL if floats else INT for name, floats in column_types(CONTAINERS[argument].columns).items()}


def number_named(source: FunctionSource, node: ast.expr) -> float | int | None:
    """Return the number to which a name, or an attribute of a module, refers; None if it is not a finite number."""
    value: object = None
    if isinstance(node, ast.Name):
        value = source.meaning(node.id)
    elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        owner = source.meaning(node.value.id)
        value = getattr(owner, node.attr, None) if isinstance(owner, ModuleType) else None
    if (type(value) is int or type(value) is float) and math.isfinite(value):
        return value
    return None


def table_named(source: FunctionSource, node: ast.expr) -> tuple[Any, ...] | None:
    """Return the tuple to which a name refers, of numbers or of marked functions; None if there is none."""
    value = source.meaning(node.id) if isinstance(node, ast.Name) else None
    return value if isinstance(value, tuple) and value else None


def modules_with_marks() -> Iterator[str]:
    """Yield the names of the package's modules in which a function is marked."""
    for path in sorted(PACKAGE.rglob("*.py")):
        if "\n@compiled\n" in path.read_text(encoding="utf-8"):
            parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
            yield ".".join(parts)


def marked_functions() -> list[Marked]:
    """Return the marked functions of the package, in an order that does not depend on the order of imports."""
    for name in modules_with_marks():
        importlib.import_module(name)
    ours = (function for function in REGISTRY if function.__module__.startswith("scenario_compiler."))
    return sorted(ours, key=lambda function: (function.__module__, function.__code__.co_firstlineno))


def entries() -> list[Marked]:
    """Return the functions that are called from outside: the ENTRIES of all the package's modules called `entries`."""
    found: list[Marked] = []
    for path in sorted(PACKAGE.rglob("entries.py")):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        found += importlib.import_module(".".join(parts)).ENTRIES
    return found


def impure(sources: Iterable[FunctionSource]) -> set[str]:
    """Return the names in C of the functions that write a column or an array, directly or through a call."""
    calls: dict[str, set[str]] = {}
    writing = {c_name(put_to_start), c_name(write_first)}
    for source in sources:
        calls[source.name] = set(_called(source))
        if any(_is_store(node) for node in ast.walk(source.tree)):
            writing.add(source.name)
    grown = True
    while grown:
        more = {name for name, called in calls.items() if name not in writing and called & writing}
        writing |= more
        grown = bool(more)
    return writing


def _is_store(node: ast.AST) -> bool:
    return isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store)


def _called(source: FunctionSource) -> Iterator[str]:
    for node in ast.walk(source.tree):
        if not isinstance(node, ast.Call):
            continue
        if isinstance(node.func, ast.Subscript):
            yield from (c_name(one) for one in table_named(source, node.func.value) or () if callable(one))
        elif isinstance(node.func, ast.Name) and callable(source.meaning(node.func.id)):
            yield c_name(source.meaning(node.func.id))
