"""Guards: a division, or a call of a function with a limited domain, needs a test of its operand in the same function.

Without one the interpreted form may raise and the compiled form may stop, and either ends the run. Both forms still
detect at run time what a test does not exclude.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from scenario_compiler.forms.language import Finding, FunctionSource, number_named

GUARDED_CALLS = ("sqrt", "acos", "asin", "log", "int", "exp")
GUARDS = ("max", "min", "clip", "safe_sqrt", "abs", "floor", "ceil")


def unguarded(source: FunctionSource) -> Iterator[Finding]:
    """Yield the divisions and calls whose operand is not tested in the function."""
    tested = _tested(source.tree)
    for node in ast.walk(source.tree):
        if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Div | ast.FloorDiv | ast.Mod):
            divisor = node.right if isinstance(node, ast.BinOp) else node.value
            if not _safe_divisor(source, divisor, tested):
                yield source.finding(node, f"divides by {ast.unparse(divisor)} without a guard")
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in GUARDED_CALLS:
            argument = node.args[0]
            if not _safe_argument(source, argument, tested):
                yield source.finding(node, f"calls {node.func.id}({ast.unparse(argument)}) without a guard")


def _tested(tree: ast.FunctionDef) -> set[str]:
    """Return the texts of all compared expressions, and of the names that are assigned a guard's result."""
    tested: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            tested |= {_inner(side) for side in (node.left, *node.comparators)}
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and _is_guard(node.value):
            tested.add(node.targets[0].id)
    return tested


def _is_guard(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in GUARDS


def _safe_divisor(source: FunctionSource, node: ast.expr, tested: set[str]) -> bool:
    value = _constant(source, node)
    if value is not None:
        return value != 0
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return all(_safe_divisor(source, side, tested) for side in (node.left, node.right))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        constant = _constant(source, node.left)
        return constant is not None and constant > 0  # the other term is assumed not to be negative
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub):
        return all(_inner(side) in tested for side in (node.left, node.right))  # both are compared
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "sqrt":
        argument = node.args[0]
        return _is_sum_of_squares(argument) and _safe_divisor(source, argument, tested)
    return _is_guard(node) or _inner(node) in tested


def _safe_argument(source: FunctionSource, node: ast.expr, tested: set[str]) -> bool:
    if _constant(source, node) is not None or _is_guard(node) or _inner(node) in tested:
        return True
    return _is_sum_of_squares(node)


def _inner(node: ast.expr) -> str:
    """Return the text of an expression without abs() and signs, because a test of either guards both."""
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


def _constant(source: FunctionSource, node: ast.expr) -> float | None:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return node.value
    if isinstance(node, ast.Name | ast.Attribute):
        return number_named(source, node)
    if isinstance(node, ast.BinOp):
        left, right = _constant(source, node.left), _constant(source, node.right)
        if left is not None and right is not None and isinstance(node.op, ast.Mult):
            return left * right
    return None
