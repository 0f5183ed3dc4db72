"""The marked functions as the text of one module, ready for numba, and the checks that it needs of them.

Every function keeps its name; names must be unique. Numbers of the modules are written into the functions, so that two
modules may call different numbers alike. Annotations and docstrings are left out, so that they do not change the text.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

DECORATOR = '@njit(error_model="python", no_cpython_wrapper=True, no_cfunc_wrapper=True)'
"""Division by zero as in Python; no wrappers, because Python calls only the entry."""

BUILTINS = frozenset({"abs", "float", "int", "len", "max", "min", "range"})
"""Built-in functions that mean the same in both forms."""

CompiledFunction = Callable[..., Any]


def function_tree(function: CompiledFunction) -> ast.FunctionDef:
    """Return the syntax tree of a function, with its place in the file."""
    lines, first = inspect.getsourcelines(function)
    tree = ast.parse(textwrap.dedent("".join(lines)))
    ast.increment_lineno(tree, first - 1)
    node = tree.body[0]
    if not isinstance(node, ast.FunctionDef):
        raise TypeError(f"{function.__qualname__} is not a function written with def")
    return node


def global_names(tree: ast.FunctionDef) -> list[str]:
    """Return the names that a function reads and does not assign, in order of appearance."""
    local = {argument.arg for argument in tree.args.args}
    local |= {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
    body = [n for statement in tree.body for n in ast.walk(statement)]
    annotations = {id(n) for a in body if isinstance(a, ast.AnnAssign) for n in ast.walk(a.annotation)}
    read = [n.id for n in body if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load) and id(n) not in annotations]
    return [name for name in dict.fromkeys(read) if name not in local]


@dataclass(frozen=True)
class Layout:
    """Where the compiled form finds a column: its place in the container's table, and the kind of its values.

    A container is a table of addresses, one a column, and after them the columns' lengths.

    Attributes:
        columns: By container argument (n, p, st) and column: (place, whether it holds floats).
        checked: Read columns as arrays, whose bounds numba can check.
    """

    columns: Mapping[str, Mapping[str, tuple[int, bool]]]
    checked: bool = False

    def column(self, owner: str, name: str) -> str:
        """Return the expression of a column."""
        place, floats = self.columns[owner][name]
        address = f"{'float' if floats else 'int'}_column({owner}[{place}])"
        return f"carray({address}, {self.size(owner, name)})" if self.checked else address

    def size(self, owner: str, name: str) -> str:
        """Return the expression of a column's length."""
        return f"{owner}[{self.columns[owner][name][0] + len(self.columns[owner])}]"


class _Plain(ast.NodeTransformer):
    """Drops what only readers need, writes numbers in place of their names, and columns by their places."""

    def __init__(self, numbers: dict[str, float], layout: Layout) -> None:
        self.numbers = numbers
        self.layout = layout

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        return _expression(self.layout.column(ast.unparse(node.value), node.attr))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.decorator_list = []
        node.returns = None
        for argument in node.args.args:
            argument.annotation = None
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
        self.generic_visit(node)
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST | None:
        if node.value is None:
            return None
        return self.visit(ast.Assign([node.target], node.value, lineno=node.lineno))  # type: ignore[no-any-return]

    def visit_Call(self, node: ast.Call) -> ast.AST:
        argument = node.args[0] if node.args else None
        if isinstance(node.func, ast.Name) and node.func.id == "len" and isinstance(argument, ast.Attribute):
            return _expression(self.layout.size(ast.unparse(argument.value), argument.attr))
        self.generic_visit(node)
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if isinstance(node.ctx, ast.Load) and node.id in self.numbers:
            return ast.copy_location(_number(self.numbers[node.id]), node)
        return node


def _number(value: float) -> ast.expr:
    if value < 0:
        return ast.UnaryOp(ast.USub(), ast.Constant(-value))
    return ast.Constant(value)


def _expression(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def module_text(functions: Iterable[CompiledFunction], layout: Layout) -> str:
    """Return the source of all functions, each under `@njit`, with every column taken from its container's table.

    Raises:
        TypeError: Two functions share a name, or one uses something else than marked functions, finite numbers,
            functions of `math` and BUILTINS.
    """
    registry: dict[str, CompiledFunction] = {}
    for function in functions:
        if function.__name__ in registry:
            raise TypeError(f"two compiled functions are called {function.__name__}")
        registry[function.__name__] = function
    imports: set[str] = set()
    body = []
    for name, function in registry.items():
        tree = function_tree(function)
        numbers: dict[str, float] = {}
        for used in global_names(tree):
            _resolve(function, used, registry, numbers, imports)
        plain = ast.fix_missing_locations(_Plain(numbers, layout).visit(tree))
        body.append(f"{DECORATOR}\n{ast.unparse(plain)}\n")
        if name in imports:
            raise TypeError(f"compiled function {name} hides a function of math")
    head = [f"from math import {name}" for name in sorted(imports)]
    return "\n".join(head) + "\n\n\n" + "\n\n".join(body)


def _resolve(
    function: CompiledFunction,
    used: str,
    registry: dict[str, CompiledFunction],
    numbers: dict[str, float],
    imports: set[str],
) -> None:
    """Decide what a global name of a function is; raise TypeError when it may not be used."""
    where = f"{function.__module__}.{function.__qualname__}"
    if used not in function.__globals__:
        if used not in BUILTINS or not hasattr(builtins, used):
            raise TypeError(f"{where} uses the name {used}, which is neither marked, nor a number, nor of math")
        return
    value = function.__globals__[used]
    if registry.get(used) is value:
        return
    if type(value) in (int, float) and math.isfinite(value):
        numbers[used] = value
    elif getattr(math, used, None) is value:
        imports.add(used)
    else:
        raise TypeError(f"{where} uses {used}, which is a {type(value).__name__}")
