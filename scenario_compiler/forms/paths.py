"""Control flow of a marked function: variables must be assigned before they are read, and every path must return.

Otherwise Python would raise, but C would continue with an arbitrary value.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from scenario_compiler.forms.language import NOTHING, Finding, FunctionSource


def unassigned(source: FunctionSource) -> Iterator[Finding]:
    """Yield the reads of local variables that some path has not assigned, and paths without a result."""
    tree, body = source.tree, source.body
    local = {n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    found: list[tuple[int, str]] = []
    reached = _flow(body, {a.arg for a in tree.args.args}, local, found)
    for line, name in found:
        yield Finding(source.file, line, f"{tree.name} reads {name}, which a path has not assigned")
    if reached is not None and source.signature.result != NOTHING:
        yield source.finding(tree, "has a path without a result")


def _flow(
    statements: list[ast.stmt], known: set[str], local: set[str], found: list[tuple[int, str]]
) -> set[str] | None:
    """Return the names that are assigned after the statements; None if control does not get there."""
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
            found.append((name.lineno, name.id))


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
