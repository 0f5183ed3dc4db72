"""Translates statements of marked functions, and whole functions, to C.

A local variable has one kind in the whole function, that of its first assignment; it is declared at the beginning.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import ClassVar

from scenario_compiler.forms.declaration import CONTAINERS
from scenario_compiler.forms.expressions import Broken, CText, Expressions, OtherFunctions, local_name
from scenario_compiler.forms.guards import unguarded
from scenario_compiler.forms.language import (
    BOOL,
    INT,
    INTS,
    NOTHING,
    REAL,
    REALS,
    Finding,
    FunctionSource,
    Kind,
    kind_of,
)
from scenario_compiler.forms.paths import unassigned

C_TYPES: dict[Kind, str] = {
    INT: "int64_t",
    REAL: "double",
    BOOL: "int",
    NOTHING: "void",
    INTS: "Ints",
    REALS: "Reals",
}


def c_type(kind: Kind) -> str:
    """Return the C type for a kind."""
    if isinstance(kind, tuple):
        return "Several_" + "".join(part[0] for part in kind)
    return C_TYPES[kind] if kind in C_TYPES else f"{CONTAINERS[kind].columns.__name__} *"


def declared(kind: Kind, name: str) -> str:
    """Return the C declaration of a variable."""
    text = c_type(kind)
    return f"{text}{'' if text.endswith('*') else ' '}{name}"


def head(source: FunctionSource) -> str:
    """Return the C declarator of a function, without its body."""
    arguments = [declared(kind, local_name(name)) for name, kind in source.signature.arguments.items()]
    return f"static {declared(source.signature.result, source.name)}({', '.join(arguments) or 'void'})"


class Statements:
    """Translates one function; `findings` lists what has no translation."""

    def __init__(self, source: FunctionSource, around: OtherFunctions, tables: dict[str, tuple[object, ...]]) -> None:
        """Begin the translation of a function."""
        self.source = source
        self.expressions = Expressions(source, around, tables)
        self.findings: list[Finding] = [*unguarded(source), *unassigned(source)]
        self._lines: list[str] = []
        self._depth = 1
        self._temporaries = 0

    def translated(self) -> str:
        """Return the function in C."""
        self._block(self.source.body)
        arguments = self.source.signature.arguments
        variables = {name: kind for name, kind in self.expressions.variables.items() if name not in arguments}
        lines = [f"/* {self.source.summary.replace('*/', '* /')} */", head(self.source), "{"]
        for name, kind in variables.items():
            lines.append(f"    {declared(kind, local_name(name))} = 0;")
        return "\n".join([*lines, *self._lines, "}"]) + "\n"

    def _block(self, statements: Iterable[ast.stmt]) -> None:
        for statement in statements:
            try:
                self._one(statement)
            except Broken as broken:
                self.findings += [] if broken.finding is None else [broken.finding]
                stored = (one for one in ast.walk(statement) if isinstance(one, ast.Name))
                names = {one.id for one in stored if isinstance(one.ctx, ast.Store)}
                self.expressions.lost |= names - set(self.expressions.variables)

    def _one(self, statement: ast.stmt) -> None:
        for kind, translate in self._translations.items():
            if isinstance(statement, kind):
                self._lines.append(f'#line {statement.lineno} "{self.source.file}"')
                translate(self, statement)
                return
        what = type(statement).__name__
        raise self.expressions.broken(statement, f"has a statement that the engine's language lacks: {what}")

    def _write(self, text: str) -> None:
        self._lines.append("    " * self._depth + text)

    @contextmanager
    def _braces(self, opening: str) -> Iterator[None]:
        self._write(opening)
        self._depth += 1
        yield
        self._depth -= 1
        self._write("}")

    def _new(self, name: str) -> str:
        self._temporaries += 1
        return f"{name}__{self._temporaries}"

    def _expression(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.Expr)
        if not isinstance(statement.value, ast.Call):
            raise self.expressions.broken(statement, f"does nothing with {ast.unparse(statement.value)!r}")
        self._write(f"{self.expressions.value(statement.value).text};")

    def _delete(self, statement: ast.stmt) -> None:
        """Accept `del n`, by which a function declares that it does not use an argument."""
        assert isinstance(statement, ast.Delete)
        names = {one.id if isinstance(one, ast.Name) else "" for one in statement.targets}
        if not names <= set(self.source.signature.arguments):
            raise self.expressions.broken(statement, "deletes something else than an argument")

    def _nothing(self, statement: ast.stmt) -> None:
        del statement

    def _break(self, statement: ast.stmt) -> None:
        self._write("break;" if isinstance(statement, ast.Break) else "continue;")

    def _return(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.Return)
        result = self.source.signature.result
        if statement.value is None:
            if result != NOTHING:
                raise self.expressions.broken(statement, "returns nothing")
            self._write("return;")
        elif isinstance(statement.value, ast.Tuple) and isinstance(result, tuple):
            parts = statement.value.elts
            if len(parts) != len(result):
                raise self.expressions.broken(statement, f"returns {len(parts)} values, not {len(result)}")
            self.expressions.unordered(statement, parts)
            texts = [self.expressions.of_kind(one, kind).text for one, kind in zip(parts, result, strict=True)]
            self._write(f"return ({c_type(result)}){{{', '.join(texts)}}};")
        else:
            self._write(f"return {self.expressions.of_kind(statement.value, result).text};")

    def _annotated(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.AnnAssign)
        kind = kind_of(statement.annotation)
        if not isinstance(statement.target, ast.Name) or kind not in (INT, REAL):
            raise self.expressions.broken(statement, f"declares {ast.unparse(statement.target)} as no int or float")
        self._declare(statement.target, kind)
        if statement.value is not None:
            self._store(statement.target, self.expressions.of_kind(statement.value, kind))

    def _assign(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.Assign)
        targets = statement.targets
        if len(targets) == 1 and isinstance(targets[0], ast.Tuple):
            self._unpack(targets[0], statement.value)
            return
        value = self.expressions.value(statement.value)
        if value.kind not in (INT, REAL, BOOL):
            raise self.expressions.broken(statement, f"keeps {value.kind} from {ast.unparse(statement.value)!r}")
        if len(targets) > 1 or (isinstance(targets[0], ast.Subscript) and self.expressions.changes(statement.value)):
            name = self._new("value")
            with self._braces("{"):
                self._write(f"{declared(value.kind, name)} = {value.text};")
                for target in targets:
                    self._store(target, CText(name, value.kind))
            return
        self._store(targets[0], value)

    def _unpack(self, target: ast.Tuple, value: ast.expr) -> None:
        if isinstance(value, ast.Tuple):
            parts = [self.expressions.number(one) for one in value.elts]
            kinds = [one.kind for one in parts]
            names = [self._new("part") for _ in parts]
            setting = [f"{declared(one.kind, name)} = {one.text};" for one, name in zip(parts, names, strict=True)]
        else:
            whole = self.expressions.value(value)
            if not isinstance(whole.kind, tuple):
                raise self.expressions.broken(value, f"unpacks {ast.unparse(value)!r}, which is {whole.kind}")
            kinds, several = list(whole.kind), self._new("several")
            setting = [f"{declared(whole.kind, several)} = {whole.text};"]
            names = [f"{several}.part_{place}" for place in range(len(kinds))]
        if len(kinds) != len(target.elts):
            raise self.expressions.broken(target, f"unpacks {len(kinds)} values into {len(target.elts)}")
        with self._braces("{"):
            for line in setting:
                self._write(line)
            for one, name, kind in zip(target.elts, names, kinds, strict=True):
                if not (isinstance(one, ast.Name) and one.id == "_"):
                    self._store(one, CText(name, kind))

    def _augmented(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.AugAssign)
        if self.expressions.changes(statement):
            raise self.expressions.broken(statement, "changes the state in an assignment with an operator")
        reading = ast.parse(ast.unparse(statement.target), mode="eval").body
        before = self.expressions.number(ast.copy_location(reading, statement))
        value = self.expressions.number(statement.value)
        after = self.expressions.calculation(statement, statement.op, before, value, statement.value)
        self._store(statement.target, after)

    def _store(self, target: ast.expr, value: CText) -> None:
        """Write an assignment to a variable, or to an element of a column or an array."""
        if isinstance(target, ast.Name):
            self._declare(target, value.kind)
            self._write(f"{local_name(target.id)} = {value.text};")
            return
        if not isinstance(target, ast.Subscript):
            raise self.expressions.broken(target, f"assigns to {ast.unparse(target)}")
        if isinstance(target.value, ast.Attribute):
            owner, column, _ = self.expressions.column(target.value)
            if not CONTAINERS[owner].may_write(column):
                raise self.expressions.broken(target, f"writes {owner}.{column}")
        if self.expressions.changes(target):
            raise self.expressions.broken(target, "changes the state in the index of an assignment")
        place = self.expressions.place(target)
        if place.kind != value.kind:
            raise self.expressions.broken(
                target, f"stores {value.kind} in {ast.unparse(target)}, which is {place.kind}"
            )
        self._write(f"{place.text} = {value.text};")

    def _declare(self, target: ast.Name, kind: Kind) -> None:
        known = self.expressions.variables.setdefault(target.id, kind)
        if known != kind:
            raise self.expressions.broken(target, f"keeps {kind} in {target.id}, which is {known} elsewhere")

    def _if(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.If)
        with self._braces(f"if ({self.expressions.test(statement.test).text}) {{"):
            self._block(statement.body)
        if statement.orelse:
            self._lines[-1] += " else {"
            self._depth += 1
            self._block(statement.orelse)
            self._depth -= 1
            self._write("}")

    def _while(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.While)
        if statement.orelse:
            raise self.expressions.broken(statement, "has an else after a loop")
        with self._braces(f"while ({self.expressions.test(statement.test).text}) {{"):
            self._block(statement.body)

    def _for(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.For)
        if statement.orelse or not isinstance(statement.target, ast.Name):
            raise self.expressions.broken(statement, "has a loop that is not over one variable and without else")
        if isinstance(statement.iter, ast.Tuple):
            self._for_each(statement, statement.target, statement.iter)
        elif isinstance(statement.iter, ast.Call) and ast.unparse(statement.iter.func) == "range":
            self._for_range(statement, statement.target, statement.iter)
        else:
            raise self.expressions.broken(statement, f"loops over {ast.unparse(statement.iter)}")

    def _for_range(self, statement: ast.For, target: ast.Name, call: ast.Call) -> None:
        self.expressions.unordered(call, call.args)
        bounds = [self.expressions.of_kind(one, INT).text for one in call.args]
        first, last = bounds[:2] if len(bounds) > 1 else ("0", bounds[0])
        step = self._literal_step(call) if len(bounds) > 2 else 1
        at, end = self._new("at"), self._new("end")
        sign = "<" if step > 0 else ">"
        loop = f"for (int64_t {at} = {first}, {end} = {last}; {at} {sign} {end}; {at} += {step}) {{"
        with self._braces(loop):
            if target.id != "_":
                self._store(target, CText(at, INT))
            self._block(statement.body)

    def _literal_step(self, call: ast.Call) -> int:
        step = ast.literal_eval(call.args[2]) if not isinstance(call.args[2], ast.Name) else 0
        if not isinstance(step, int) or step == 0:
            raise self.expressions.broken(call, "has a step of range that is not a number in the source")
        return step

    def _for_each(self, statement: ast.For, target: ast.Name, values: ast.Tuple) -> None:
        parts = [self.expressions.number(one) for one in values.elts]
        if self.expressions.changes(values) or len({one.kind for one in parts}) != 1:
            raise self.expressions.broken(values, "loops over values of several kinds, or that change the state")
        each, at = self._new("each"), self._new("at")
        with self._braces("{"):
            listed = ", ".join(one.text for one in parts)
            self._write(f"{declared(parts[0].kind, each)}[] = {{{listed}}};")
            with self._braces(f"for (int {at} = 0; {at} < {len(parts)}; {at}++) {{"):
                self._store(target, CText(f"{each}[{at}]", parts[0].kind))
                self._block(statement.body)

    _translations: ClassVar[dict[type[ast.stmt], Callable[[Statements, ast.stmt], None]]] = {
        ast.Expr: _expression,
        ast.Assign: _assign,
        ast.AugAssign: _augmented,
        ast.AnnAssign: _annotated,
        ast.If: _if,
        ast.For: _for,
        ast.While: _while,
        ast.Return: _return,
        ast.Break: _break,
        ast.Continue: _break,
        ast.Pass: _nothing,
        ast.Delete: _delete,
    }
