"""Translates expressions of marked functions to C and determines the kinds of their values.

Python evaluates operands from left to right, C in any order. For that reason an operand may change the state only if
the other operands are numbers, local variables and calculations with them.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from scenario_compiler.forms.declaration import CONTAINERS, put_to_start, write_first
from scenario_compiler.forms.language import (
    BOOL,
    BUILTINS,
    INT,
    INTS,
    MATH,
    NOTHING,
    REAL,
    REALS,
    Finding,
    FunctionSource,
    Kind,
    Signature,
    c_name,
    container_columns,
    number_named,
    table_named,
)

C_WORDS = frozenset(
    {
        *("auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern"),
        *("fail", "failed", "far", "float", "for", "goto", "if", "inline", "int", "long", "near", "register"),
        *("restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch", "typedef", "union"),
        *("unsigned", "void", "volatile", "while"),
    }
)
"""Names that a local variable cannot have in C."""

CHECKED_INT = {ast.Add: "ADD", ast.Sub: "SUBTRACT", ast.Mult: "MULTIPLY"}
PLAIN = {
    **{ast.Add: "+", ast.Sub: "-", ast.Mult: "*"},
    **{ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^", ast.LShift: "<<", ast.RShift: ">>"},
}
COMPARISONS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}


class Broken(Exception):
    """An expression or statement has no translation.

    `finding` gives the reason; it is None if an earlier finding already gives it.
    """

    def __init__(self, finding: Finding | None) -> None:
        """Set the finding."""
        super().__init__(str(finding))
        self.finding = finding


@dataclass(frozen=True)
class CText:
    """The C text of an expression.

    Attributes:
        text: The text.
        kind: The kind of its value.
        atomic: Whether it needs no parentheses as an operand.
    """

    text: str
    kind: Kind
    atomic: bool = True

    @property
    def inner(self) -> str:
        """The text as an operand, in parentheses if it needs them."""
        return self.text if self.atomic else f"({self.text})"


@dataclass(frozen=True)
class OtherFunctions:
    """All marked functions, as far as the translation of one of them needs to know them.

    Attributes:
        signatures: The kinds of arguments and result of every marked function by its name in C.
        impure: The names in C of those that write a column or an array.
    """

    signatures: dict[str, Signature]
    impure: frozenset[str]


class Expressions:
    """Translates the expressions of one function.

    Attributes:
        source: The function.
        around: The other functions.
        variables: Kinds of the arguments and of the local variables found so far.
        lost: Local variables whose kind is unknown because their assignment has no translation.
        tables: Tuples of numbers or functions that are used, by their names in C.
    """

    def __init__(self, source: FunctionSource, around: OtherFunctions, tables: dict[str, tuple[object, ...]]) -> None:
        """Begin the translation of a function; tables that it uses are added to `tables`."""
        self.source = source
        self.around = around
        self.variables: dict[str, Kind] = dict(source.signature.arguments)
        self.lost: set[str] = set()
        self.tables = tables

    def broken(self, node: ast.AST, rule: str) -> Broken:
        """Return the exception for a node without a translation; `rule` is the predicate of the function."""
        return Broken(self.source.finding(node, rule))

    def value(self, node: ast.expr) -> CText:
        """Return the C of an expression."""
        for kind, translate in self._translations.items():
            if isinstance(node, kind):
                return translate(self, node)
        raise self.broken(node, f"has {ast.unparse(node)!r}, which the engine's language lacks")

    def of_kind(self, node: ast.expr, kind: Kind) -> CText:
        """Return the C of an expression, whose value must have the given kind."""
        code = self.value(node)
        if code.kind != kind:
            raise self.broken(node, f"has {ast.unparse(node)!r}, which is {code.kind}, where {kind} belongs")
        return code

    def number(self, node: ast.expr) -> CText:
        """Return the C of an expression, whose value must be an int or a real."""
        code = self.value(node)
        if code.kind not in (INT, REAL):
            raise self.broken(node, f"calculates with {ast.unparse(node)!r}, which is {code.kind}")
        return code

    def test(self, node: ast.expr) -> CText:
        """Return the C of a branch's condition, which must be a comparison or an int; an int is false if it is 0."""
        code = self.value(node)
        if code.kind not in (BOOL, INT):
            raise self.broken(node, f"decides by {ast.unparse(node)!r}, which is {code.kind}")
        return code

    def changes(self, node: ast.AST) -> bool:
        """Return whether evaluating a node may change a column or an array."""
        return any(self._called(one) & self.around.impure for one in ast.walk(node) if isinstance(one, ast.Call))

    def _called(self, call: ast.Call) -> set[str]:
        if isinstance(call.func, ast.Subscript):
            return {c_name(one) for one in table_named(self.source, call.func.value) or () if callable(one)}
        meaning = self.source.meaning(call.func.id) if isinstance(call.func, ast.Name) else None
        return {c_name(meaning)} if callable(meaning) else set()

    def unordered(self, node: ast.AST, operands: Sequence[ast.expr]) -> None:
        """Raise Broken if one operand changes what another may read, because C evaluates operands in any order."""
        changing = [one for one in operands if self.changes(one)]
        others = [one for one in operands if one not in changing]
        if len(changing) > 1 or (changing and not all(self._still(one) for one in others)):
            text = ast.unparse(changing[0])
            raise self.broken(node, f"changes the state in {text!r} beside what may see it: give it a line of its own")

    def _still(self, node: ast.expr) -> bool:
        """Return whether no call can change an expression's value: no call and no element of an array is in it."""
        seen = (ast.Subscript, ast.Call)
        return not any(isinstance(one, seen) for one in ast.walk(node))

    def _constant(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.Constant)
        if isinstance(node.value, bool):
            return CText(str(int(node.value)), BOOL)
        if not isinstance(node.value, int | float):
            raise self.broken(node, f"has the constant {node.value!r}")
        return literal(node.value)

    def _name(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.Name)
        if node.id in self.variables:
            return CText(local_name(node.id), self.variables[node.id])
        if node.id in self.lost:
            raise Broken(None)
        number = number_named(self.source, node)
        if number is None:
            raise self.broken(node, f"uses {node.id}, which is not a variable, number or marked function")
        return literal(number, node.id)

    def _attribute(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.Attribute)
        number = number_named(self.source, node)
        if number is None:
            raise self.broken(node, f"takes {ast.unparse(node)}, which is not a number of a module, as a whole")
        return literal(number, ast.unparse(node))

    def column(self, node: ast.Attribute) -> tuple[str, str, str]:
        """Return the container's argument name, the name and the kind of the column that an attribute names."""
        owner = node.value.id if isinstance(node.value, ast.Name) else ""
        columns = container_columns(owner) if owner in CONTAINERS and owner in self.variables else {}
        if node.attr not in columns:
            raise self.broken(node, f"reads {ast.unparse(node)}, which is not a column")
        return owner, node.attr, columns[node.attr]

    def place(self, node: ast.Subscript) -> CText:
        """Return the C of an element of a column, an array or a table of numbers."""
        if isinstance(node.value, ast.Attribute):
            owner, column, number = self.column(node.value)
            return CText(f"AT({owner}, {local_name(column)}, {self.of_kind(node.slice, INT).text})", number)
        name = node.value.id if isinstance(node.value, ast.Name) else ""
        if name in self.lost:
            raise Broken(None)
        kind = self.variables.get(name, NOTHING)
        index = self.of_kind(node.slice, INT).text
        if kind in (INTS, REALS):
            return CText(f"ITEM({local_name(name)}, {index})", INT if kind == INTS else REAL)
        table = table_named(self.source, node.value)
        kinds = {type(one) for one in table or ()}
        if kinds not in ({int}, {float}) or table is None:
            raise self.broken(node, f"takes an element of {ast.unparse(node.value)}")
        return CText(f"ITEM({self.table(node.value, table)}, {index})", INT if kinds == {int} else REAL)

    def table(self, node: ast.expr, table: tuple[object, ...]) -> str:
        """Return the name in C of the tuple that a name refers to, and add the tuple to `tables`."""
        assert isinstance(node, ast.Name)
        return table_name(self.tables, node.id, table)

    def _subscript(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.Subscript)
        return self.place(node)

    def _unary(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.UnaryOp)
        if isinstance(node.op, ast.Not):
            return CText(f"!{self.test(node.operand).inner}", BOOL)
        if isinstance(node.op, ast.USub):
            constant = node.operand.value if isinstance(node.operand, ast.Constant) else None
            if isinstance(constant, int | float):
                return literal(-constant)
            code = self.number(node.operand)
            return CText(f"-{code.inner}", code.kind, atomic=False)
        raise self.broken(node, f"has the operator of {ast.unparse(node)!r}")

    def _binary(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.BinOp)
        self.unordered(node, (node.left, node.right))
        return self.calculation(node, node.op, self.number(node.left), self.number(node.right), node.right)

    def calculation(self, node: ast.AST, operator: ast.operator, a: CText, b: CText, divisor: ast.expr) -> CText:
        """Return the C of a binary operator between two numbers; `divisor` is the second operand's expression."""
        real = REAL in (a.kind, b.kind)
        if isinstance(operator, ast.Div):
            a, b = as_real(a), as_real(b)
            if self._never_zero(divisor):
                return CText(f"{a.inner} / {b.inner}", REAL, atomic=False)
            return CText(f"DIVIDE({a.text}, {b.text})", REAL)
        if isinstance(operator, ast.FloorDiv) and not real:
            return CText(f"INT_FLOOR_DIVIDE({a.text}, {b.text})", INT)
        if isinstance(operator, ast.Mod):
            return CText(f"{'REAL' if real else 'INT'}_MODULO({a.text}, {b.text})", REAL if real else INT)
        symbol = PLAIN.get(type(operator))
        if symbol is None or (real and type(operator) not in CHECKED_INT):
            raise self.broken(node, f"has an operator that the engine's language lacks for {a.kind} and {b.kind}")
        if not real and type(operator) in CHECKED_INT:
            return CText(f"{CHECKED_INT[type(operator)]}({a.text}, {b.text})", INT)
        shifted = "(int64_t)" if isinstance(operator, ast.LShift) else ""
        return CText(f"{shifted}{a.inner} {symbol} {b.inner}", REAL if real else INT, atomic=False)

    def _never_zero(self, node: ast.expr) -> bool:
        """Return whether a divisor cannot be zero: a number, `max` with a positive number, or such a number plus `abs`.

        A NaN among the arguments of `max` does not make the result zero.
        """
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "max":
            return any(self._number_in(one) > 0 for one in node.args)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) and isinstance(node.right, ast.Call):
            return self._number_in(node.left) > 0 and ast.unparse(node.right.func) == "abs"
        return self._number_in(node) != 0

    def _number_in(self, node: ast.expr) -> float:
        """Return the number that a literal or a constant's name stands for; 0 for all else."""
        if isinstance(node, ast.Name) and node.id in self.variables:
            return 0
        number = node.value if isinstance(node, ast.Constant) else number_named(self.source, node)
        return number if isinstance(number, int | float) else 0

    def _compare(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.Compare)
        self.unordered(node, (node.left, *node.comparators))
        if len(node.ops) > 1 and any(self.changes(one) for one in node.comparators[:-1]):
            raise self.broken(node, "compares a call that changes the state twice")
        parts = []
        left = node.left
        for operator, right in zip(node.ops, node.comparators, strict=True):
            parts.append(self._comparison(node, left, operator, right))
            left = right
        return CText(" && ".join(parts), BOOL, atomic=False)

    def _comparison(self, node: ast.Compare, left: ast.expr, operator: ast.cmpop, right: ast.expr) -> str:
        if isinstance(operator, ast.In | ast.NotIn):
            if not isinstance(right, ast.Tuple) or self.changes(left):
                raise self.broken(node, f"has {ast.unparse(node)!r}: `in` takes a written tuple and no changing call")
            among = " || ".join(f"{self.number(left).inner} == {self.number(one).inner}" for one in right.elts)
            return f"!({among})" if isinstance(operator, ast.NotIn) else f"({among})"
        symbol = COMPARISONS.get(type(operator))
        if symbol is None:
            raise self.broken(node, f"has {ast.unparse(node)!r}, which the engine's language lacks")
        a, b = self.value(left), self.value(right)
        if not ({a.kind, b.kind} <= {INT, REAL} or a.kind == b.kind == BOOL):
            raise self.broken(node, f"compares {a.kind} with {b.kind} in {ast.unparse(node)!r}")
        return f"{a.inner} {symbol} {b.inner}"

    def _bool(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.BoolOp)
        symbol = " && " if isinstance(node.op, ast.And) else " || "
        return CText(symbol.join(self.test(one).inner for one in node.values), BOOL, atomic=False)

    def _choice(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.IfExp)
        chosen, other = self.number(node.body), self.number(node.orelse)
        if chosen.kind != other.kind:
            raise self.broken(node, f"chooses between {chosen.kind} and {other.kind} in {ast.unparse(node)!r}")
        test = self.test(node.test)
        return CText(f"{test.inner} ? {chosen.inner} : {other.inner}", chosen.kind, atomic=False)

    def _call(self, node: ast.expr) -> CText:
        assert isinstance(node, ast.Call)
        if node.keywords:
            raise self.broken(node, "passes an argument by name")
        self.unordered(node, node.args)
        if isinstance(node.func, ast.Subscript):
            return self._call_of_table(node, node.func)
        if not isinstance(node.func, ast.Name):
            raise self.broken(node, f"calls {ast.unparse(node.func)}, which is not a plain name")
        meaning = self.source.meaning(node.func.id)
        if callable(meaning) and c_name(meaning) in self.around.signatures:
            name = c_name(meaning)
            return CText(f"{name}({self._arguments(node, name)})", self.around.signatures[name].result)
        if meaning is put_to_start:
            return self._clearing(node)
        if meaning is write_first:
            return self._writing(node)
        if node.func.id in MATH and meaning is not None and meaning.__module__ == "math":
            return self._call_of_math(node, node.func.id)
        if node.func.id in BUILTINS and meaning is None:
            return self._call_of_builtin(node, node.func.id)
        raise self.broken(node, f"calls {node.func.id}, which is neither marked nor known to both forms")

    def _clearing(self, node: ast.Call) -> CText:
        """Return the call of the C function for `put_to_start`."""
        name = self._container(node)
        if not CONTAINERS[name].written:
            raise self.broken(node, f"puts {name} to its start, which it may not write")
        return CText(f"{clearing_name(name)}({name})", NOTHING)

    def _writing(self, node: ast.Call) -> CText:
        """Return the assignments for `write_first`."""
        name = self._container(node)
        names = table_named(self.source, node.args[1]) or ()
        columns = container_columns(name)
        if len(node.args) != 4 or not names or not set(names) <= set(columns):
            raise self.broken(node, f"writes {ast.unparse(node.args[1])}, which are not columns of {name}")
        out, base = self.of_kind(node.args[2], REALS).text, self.of_kind(node.args[3], INT)
        written = (
            f"ITEM({out}, ADD({base.text}, {place})) = (double)AT({name}, {local_name(column)}, 0)"
            for place, column in enumerate(names)
        )
        return CText(f"({', '.join(written)})", NOTHING)

    def _container(self, node: ast.Call) -> str:
        """Return the argument name of the container that is a call's first argument."""
        name = ast.unparse(node.args[0]) if node.args else "nothing"
        if name not in self.variables or name not in CONTAINERS:
            raise self.broken(node, f"calls {ast.unparse(node.func)} with {name}, which is not a container")
        return name

    def _call_of_table(self, node: ast.Call, func: ast.Subscript) -> CText:
        """Return the call of an element of a table of functions, which must all have the same kinds."""
        table = table_named(self.source, func.value)
        names = [c_name(one) for one in table or () if callable(one)]
        if table is None or len(names) < len(table) or any(name not in self.around.signatures for name in names):
            raise self.broken(node, f"calls an element of {ast.unparse(func.value)}, which is not a table of functions")
        kinds = {(tuple(one.arguments.values()), one.result) for one in map(self.around.signatures.get, names) if one}
        if len(kinds) > 1:
            raise self.broken(node, f"calls an element of {ast.unparse(func.value)}, whose functions differ in kind")
        index = self.of_kind(func.slice, INT).text
        dispatch = self.table(func.value, table)
        return CText(f"{dispatch}({index}, {self._arguments(node, names[0])})", self.around.signatures[names[0]].result)

    def _arguments(self, node: ast.Call, name: str) -> str:
        wanted = list(self.around.signatures[name].arguments.values())
        if len(wanted) != len(node.args):
            raise self.broken(node, f"calls {name} with {len(node.args)} arguments, not {len(wanted)}")
        return ", ".join(self.of_kind(one, kind).text for one, kind in zip(node.args, wanted, strict=True))

    def _call_of_math(self, node: ast.Call, name: str) -> CText:
        given = [as_real(self.number(one)).text for one in node.args]
        if name in ("sqrt", "log", "floor", "ceil"):
            return CText(f"{name.upper()}({given[0]})", MATH[name])
        if name in ("sin", "cos", "tan", "acos", "asin"):
            return CText(f"IN_DOMAIN({name}, {given[0]})", REAL)
        if name in ("exp", "sinh", "cosh"):
            return CText(f"IN_RANGE({name}, {given[0]})", REAL)
        return CText(f"{name}({', '.join(given)})", MATH[name])

    def _call_of_builtin(self, node: ast.Call, name: str) -> CText:
        if name == "len":
            return self._length(node)
        given = [self.number(one) for one in node.args]
        if name == "int":
            return given[0] if given[0].kind == INT else CText(f"INT({given[0].text})", INT)
        if name == "float":
            return as_real(given[0])
        kinds = {code.kind for code in given}
        if len(kinds) > 1 or name == "range":
            raise self.broken(node, f"calls {name} with {' and '.join(sorted(map(str, kinds)))}")
        kind = given[0].kind
        if name == "abs":
            return CText(f"{'fabs' if kind == REAL else 'int_abs'}({given[0].text})", kind)
        text = given[0].text
        for other in given[1:]:
            text = f"{kind}_{name}({text}, {other.text})"
        return CText(text, kind)

    def _length(self, node: ast.Call) -> CText:
        argument = node.args[0]
        if isinstance(argument, ast.Attribute):
            owner, column, _ = self.column(argument)
            return CText(f"{owner}->{local_name(column)}_size", INT)
        if isinstance(argument, ast.Name) and self.variables.get(argument.id) in (INTS, REALS):
            return CText(f"{local_name(argument.id)}.size", INT)
        raise self.broken(node, f"takes the length of {ast.unparse(argument)}")

    _translations: ClassVar[dict[type[ast.expr], Callable[[Expressions, ast.expr], CText]]] = {
        ast.Constant: _constant,
        ast.Name: _name,
        ast.Attribute: _attribute,
        ast.Subscript: _subscript,
        ast.UnaryOp: _unary,
        ast.BinOp: _binary,
        ast.Compare: _compare,
        ast.BoolOp: _bool,
        ast.IfExp: _choice,
        ast.Call: _call,
    }


def literal(value: float, name: str = "") -> CText:
    """Return the C of a number, with the name under which it was written as a comment."""
    text = f"INT64_C({value})" if isinstance(value, int) and abs(value) >= 1 << 31 else repr(value)
    noted = f"{text} /* {name} */" if name else text
    return CText(f"({noted})" if value < 0 else noted, INT if isinstance(value, int) else REAL)


def clearing_name(argument: str) -> str:
    """Return the name of the C function that sets a container's columns to their start."""
    return f"clear_{argument}"


def as_real(code: CText) -> CText:
    """Return the C of a number, converted to a real."""
    return code if code.kind == REAL else CText(f"(double){code.inner}", REAL, atomic=False)


def local_name(name: str) -> str:
    """Return the name of a local variable or an argument in C."""
    return f"{name}_" if name in C_WORDS else name


def table_name(tables: dict[str, tuple[object, ...]], name: str, table: tuple[object, ...]) -> str:
    """Return the name in C of a table; a table has one name everywhere, and different tables have different names."""
    for known, other in tables.items():
        if other is table:
            return known
    new = f"table_{name.lower()}"
    while new in tables:
        new += "_"
    tables[new] = table
    return new
