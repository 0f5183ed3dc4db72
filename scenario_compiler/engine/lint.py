"""The rules of compiled functions, read from their syntax trees: what would differ between the forms, or fail.

A finding names the function, the line and the rule. What types can tell (an int in a float variable, a missing
return) is mypy's to find.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from scenario_compiler.engine.columns import column_types
from scenario_compiler.engine.source import function_tree, global_names
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.roads.tables import RoadTables

CONTAINERS: dict[str, Any] = {"n": RoadTables, "p": Program, "st": State}
WRITABLE = {"st": None, "p": ("const",), "n": ()}
"""Columns that may be written in a step: all of the state, and the numbers of the program (by a sweep)."""

BANNED_NODES: tuple[tuple[type[ast.AST], str], ...] = (
    (ast.Raise, "raises"),
    (ast.Assert, "asserts"),
    (ast.Try, "catches exceptions"),
    (ast.With, "opens a context"),
    (ast.Lambda, "has a lambda"),
    (ast.ClassDef, "has a class"),
    (ast.Yield, "is a generator"),
    (ast.Global, "writes a global"),
    (ast.Nonlocal, "is a closure"),
    (ast.List, "makes a list"),
    (ast.Dict, "makes a dict"),
    (ast.Set, "makes a set"),
    (ast.ListComp, "has a comprehension"),
    (ast.DictComp, "has a comprehension"),
    (ast.SetComp, "has a comprehension"),
    (ast.GeneratorExp, "has a comprehension"),
    (ast.JoinedStr, "makes a text"),
    (ast.Starred, "unpacks arguments"),
    (ast.Pow, "uses **, whose last bits differ"),
    (ast.Slice, "slices a column"),
    (ast.Delete, "deletes"),
)
BANNED_CALLS = {"hypot": "last bits differ", "fmod": "does not compile", "pow": "last bits differ"}
GUARDED_CALLS = ("sqrt", "acos", "asin", "log", "int", "exp")
GUARDS = ("max", "min", "clip", "safe_sqrt", "abs", "floor", "ceil")


@dataclass(frozen=True)
class Finding:
    """A rule that a function breaks."""

    function: str
    line: int
    rule: str

    def __str__(self) -> str:
        """Return it as one line."""
        return f"{self.function}:{self.line}: {self.rule}"


def lint(function: Callable[..., Any]) -> list[Finding]:
    """Return all findings in a marked function."""
    tree = function_tree(function)
    name = f"{function.__module__}.{function.__qualname__}"
    values = {used: function.__globals__.get(used) for used in global_names(tree)}
    numbers = {used: value for used, value in values.items() if isinstance(value, int | float)}
    checks = (_nodes(tree), _signature(tree), _attributes(tree), _guards(tree, numbers), _assigned(tree))
    return [Finding(name, line, rule) for check in checks for line, rule in check]


Found = Iterator[tuple[int, str]]


def _nodes(tree: ast.FunctionDef) -> Found:
    for statement in _body(tree):
        for node in ast.walk(statement):
            line = getattr(node, "lineno", tree.lineno)
            for kind, what in BANNED_NODES:
                if isinstance(node, kind):
                    yield line, what
            if isinstance(node, ast.FunctionDef):
                yield line, "has an inner function"
            if isinstance(node, ast.Constant) and not isinstance(node.value, int | float):
                yield line, f"has the constant {node.value!r}"
            if isinstance(node, ast.Call):
                yield from _call(node)


def _call(node: ast.Call) -> Found:
    if not isinstance(node.func, ast.Name):
        yield node.lineno, "calls something else than a bare name"
    elif node.func.id in BANNED_CALLS:
        yield node.lineno, f"calls {node.func.id}: {BANNED_CALLS[node.func.id]}"
    if node.keywords:
        yield node.lineno, "passes an argument by name"


def _signature(tree: ast.FunctionDef) -> Found:
    arguments = tree.args
    if arguments.defaults or arguments.kwonlyargs or arguments.vararg or arguments.kwarg:
        yield tree.lineno, "has optional, named or collected arguments"
    order = [a.arg for a in arguments.args if a.arg in CONTAINERS]
    if order != sorted(order, key=list(CONTAINERS).index) or [a.arg for a in arguments.args[: len(order)]] != order:
        yield tree.lineno, "does not take n, p and st first and in this order"
    if tree.returns is None or any(a.annotation is None for a in arguments.args):
        yield tree.lineno, "is not annotated"


def _attributes(tree: ast.FunctionDef) -> Found:
    indexed = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute)
    }
    measured = {
        id(node.args[0])
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "len" and node.args
    }
    for node in (n for statement in _body(tree) for n in ast.walk(statement)):
        if isinstance(node, ast.Attribute):
            owner = node.value.id if isinstance(node.value, ast.Name) else ""
            if owner not in CONTAINERS or node.attr not in CONTAINERS[owner].__slots__:
                yield node.lineno, f"reads {ast.unparse(node)}, which is no column"
            elif id(node) not in indexed and id(node) not in measured:
                yield node.lineno, f"takes the column {ast.unparse(node)} whole"
        if isinstance(node, ast.Assign | ast.AugAssign):
            yield from _stores(node)


def _stores(node: ast.Assign | ast.AugAssign) -> Found:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    for target in targets:
        if not isinstance(target, ast.Subscript) or not isinstance(target.value, ast.Attribute):
            continue
        column = target.value
        owner = column.value.id if isinstance(column.value, ast.Name) else ""
        if owner not in CONTAINERS:
            continue
        allowed = WRITABLE[owner]
        if allowed is not None and column.attr not in allowed:
            yield node.lineno, f"writes {owner}.{column.attr}"
        floats = column_types(CONTAINERS[owner]).get(column.attr, False)
        if isinstance(node.value, ast.Constant) and (type(node.value.value) is float) != floats:
            yield node.lineno, f"stores {node.value.value!r} in {owner}.{column.attr}"


def _guards(tree: ast.FunctionDef, numbers: dict[str, float]) -> Found:
    """Find divisions and partial functions whose operand no test in the function speaks of."""
    tested = _tested(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Div | ast.FloorDiv | ast.Mod):
            divisor = node.right if isinstance(node, ast.BinOp) else node.value
            if not _safe_divisor(divisor, numbers, tested):
                yield node.lineno, f"divides by {ast.unparse(divisor)} without a guard"
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in GUARDED_CALLS:
            argument = node.args[0]
            if not _safe_argument(argument, numbers, tested):
                yield node.lineno, f"calls {node.func.id}({ast.unparse(argument)}) without a guard"


def _tested(tree: ast.FunctionDef) -> set[str]:
    """Return the texts of what the function compares, and of names that a guard bounds."""
    tested: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            tested |= {_inner(side) for side in (node.left, *node.comparators)}
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and _is_guard(node.value):
            tested.add(node.targets[0].id)
    return tested


def _is_guard(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in GUARDS


def _safe_divisor(node: ast.expr, numbers: dict[str, float], tested: set[str]) -> bool:
    value = _constant(node, numbers)
    if value is not None:
        return value != 0
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return all(_safe_divisor(side, numbers, tested) for side in (node.left, node.right))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        constant = _constant(node.left, numbers)
        return constant is not None and constant > 0  # one plus something that cannot be negative
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub):
        return all(_inner(side) in tested for side in (node.left, node.right))  # one compared with the other
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "sqrt":
        argument = node.args[0]
        return _is_sum_of_squares(argument) and _safe_divisor(argument, numbers, tested)
    return _is_guard(node) or _inner(node) in tested


def _safe_argument(node: ast.expr, numbers: dict[str, float], tested: set[str]) -> bool:
    if _constant(node, numbers) is not None or _is_guard(node) or _inner(node) in tested:
        return True
    return _is_sum_of_squares(node)


def _inner(node: ast.expr) -> str:
    """Return the text of an expression without abs() and signs, which guard alike."""
    while True:
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "abs":
            node = node.args[0]
        elif isinstance(node, ast.UnaryOp):
            node = node.operand
        else:
            return ast.unparse(node)


def _is_sum_of_squares(node: ast.expr) -> bool:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return _is_sum_of_squares(node.left) and _is_sum_of_squares(node.right)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and node.value >= 0
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        factors = sorted(_factors(node))
        return all(factors.count(one) % 2 == 0 for one in factors)
    return False


def _factors(node: ast.expr) -> list[str]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return _factors(node.left) + _factors(node.right)
    return [ast.unparse(node)]


def _constant(node: ast.expr, numbers: dict[str, float]) -> float | None:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return node.value
    if isinstance(node, ast.Name):
        return numbers.get(node.id)
    if isinstance(node, ast.BinOp):
        left, right = _constant(node.left, numbers), _constant(node.right, numbers)
        if left is not None and right is not None and isinstance(node.op, ast.Mult):
            return left * right
    return None


def _assigned(tree: ast.FunctionDef) -> Found:
    """Find local variables that are read where some path has not assigned them."""
    body = _body(tree)
    local = {n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    found: list[tuple[int, str]] = []
    _flow(body, {a.arg for a in tree.args.args}, local, found)
    yield from found


def _flow(
    statements: list[ast.stmt], known: set[str], local: set[str], found: list[tuple[int, str]]
) -> set[str] | None:
    """Return the names assigned after the statements, None where control never gets there."""
    for statement in statements:
        after = _flow_one(statement, known, local, found)
        if after is None:
            return None
        known = after
    return known


def _flow_one(statement: ast.stmt, known: set[str], local: set[str], found: list[tuple[int, str]]) -> set[str] | None:
    if isinstance(statement, ast.If):
        _reads(statement.test, known, local, found)
        branches = [_flow(b, set(known), local, found) for b in (statement.body, statement.orelse)]
        reached = [branch for branch in branches if branch is not None]
        return set.intersection(*reached) if reached else None
    if isinstance(statement, ast.For | ast.While):
        _reads(statement.iter if isinstance(statement, ast.For) else statement.test, known, local, found)
        inside = set(known)
        if isinstance(statement, ast.For):
            inside |= _names(statement.target)
        _flow(statement.body, inside, local, found)
        return known
    _reads(statement, known, local, found)
    if isinstance(statement, ast.Return | ast.Continue | ast.Break):
        return None
    return known | _names(statement)


def _reads(node: ast.AST, known: set[str], local: set[str], found: list[tuple[int, str]]) -> None:
    for name in ast.walk(node):
        if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Load) and name.id in local - known:
            found.append((name.lineno, f"reads {name.id}, which a path has not assigned"))


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}


def _body(tree: ast.FunctionDef) -> list[ast.stmt]:
    return tree.body[1:] if ast.get_docstring(tree) is not None else tree.body
