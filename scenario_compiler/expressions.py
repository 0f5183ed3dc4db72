"""Expressions: parses a text such as `1.9 * (1 - $overlap)` into a tree, and evaluates it deterministically.

Grammar, loosest first: `or`, `and`, `not`, one comparison (< <= > >= == !=), + -, * / %, unary + -, `^` (power), atoms:
number, 'text', true, false, pi, a parameter (`name` or `$name`), a function call, parentheses. `if(c, a, b)` evaluates
only the chosen branch. Angles of the trigonometric functions are in radians; `radians` and `degrees` convert. As in
RA Consulting's evaluator for ASAM OpenSCENARIO and in esmini, `%` has the sign of its left side, and `round` takes
halves away from 0.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

Value: TypeAlias = float | bool | str

MAX_DEPTH = 64
MAX_LENGTH = 4096
MAX_LENGTH_PUT_TOGETHER = 16 * MAX_LENGTH
MAX_SIGNS = 400
MAX_SHOWN = 100
LEAST_TO_CHECK = 2 * MAX_DEPTH
"""A text of at most this length cannot exceed the other limits, whatever it contains."""


class ExpressionError(ValueError):
    """An expression cannot be parsed or evaluated; `offset` is the position of the faulty character."""

    def __init__(self, message: str, offset: int = 0) -> None:
        """Keep the message and the offset into the text, counted from 0."""
        super().__init__(message)
        self.offset = offset


class _Literal(NamedTuple):
    value: Value


class _Name(NamedTuple):
    name: str


class _Call(NamedTuple):
    function: str
    arguments: tuple[_Node, ...]


_Node: TypeAlias = _Literal | _Name | _Call


@dataclass(frozen=True)
class Expression:
    """A parsed expression. Equal expressions have equal text."""

    text: str
    tree: _Node

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The parameters on which it depends, sorted."""
        found: set[str] = set()
        _collect(self.tree, found)
        return tuple(sorted(found))

    def evaluate(self, values: Mapping[str, Value]) -> Value:
        """Return the value for these parameters; raises ExpressionError on unknown names and undefined results."""
        return _evaluate(self.tree, values)

    def number(self, values: Mapping[str, Value]) -> float:
        """Return the value as a finite float; raises ExpressionError if it is not a finite number."""
        value = self.evaluate(values)
        if isinstance(value, str):
            raise ExpressionError(f"'{self.text}' is a text, not a number")
        number = float(value)
        if not math.isfinite(number):
            raise ExpressionError(f"'{self.text}' has no finite value")
        return number

    @cached_property
    def bounded(self) -> bool:
        """Whether the text could be parsed again; substitution can make it too long or too deeply nested."""
        if len(self.text) <= LEAST_TO_CHECK:
            return True
        try:
            parse_expression(self.text)
        except ExpressionError:
            return False
        return True

    def substitute(self, replacements: Mapping[str, Expression | Value]) -> Expression:
        """Return the expression with names replaced by values or other expressions.

        Raises ExpressionError, before the text is built, if it would be too long: each of many templates can double it.
        """
        lengths = {name: len(new.text) for name, new in replacements.items() if isinstance(new, Expression)}
        longer = sum(lengths.get(name, 0) for name in _NAME_IN_TEXT.findall(self.text)) if lengths else 0
        if longer > MAX_LENGTH_PUT_TOGETHER:
            raise ExpressionError("the expression becomes too long when its names are replaced by their values")
        tree = _substitute(self.tree, replacements)
        return Expression(_text(tree), tree)


def parse_expression(text: str) -> Expression:
    """Parse an expression; raises ExpressionError with the offset of the fault."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"the expression has {len(text)} characters; at most {MAX_LENGTH} are read")
    parser = _Parser(text)
    tree = parser.expression(0)
    if parser.kind != "end":
        raise ExpressionError(f"'{parser.token}' is not expected here", parser.offset)
    return Expression(_text(tree), tree)


def _mod(a: float, b: float) -> float:
    if b == 0.0:
        raise ZeroDivisionError
    return math.fmod(a, b)


def _round(a: float) -> float:
    whole = math.floor(abs(a))
    return math.copysign(whole + 1.0 if abs(a) - whole >= 0.5 else whole, a) + 0.0


def _sign(a: float) -> float:
    return float((a > 0) - (a < 0))


FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "abs": (1, abs),
    "sqrt": (1, math.sqrt),
    "sin": (1, math.sin),
    "cos": (1, math.cos),
    "tan": (1, math.tan),
    "asin": (1, math.asin),
    "acos": (1, math.acos),
    "atan": (1, math.atan),
    "atan2": (2, math.atan2),
    "exp": (1, math.exp),
    "log": (1, math.log),
    "floor": (1, lambda a: float(math.floor(a))),
    "ceil": (1, lambda a: float(math.ceil(a))),
    "round": (1, _round),
    "sign": (1, _sign),
    "radians": (1, math.radians),
    "degrees": (1, math.degrees),
    "pow": (2, lambda a, b: a**b),
    "min": (-1, lambda *some: min(some)),
    "max": (-1, lambda *some: max(some)),
    "if": (3, None),  # type: ignore[dict-item]  # evaluated lazily
}
"""Function name to number of arguments (-1: one or more) and implementation."""

_BINARY: dict[str, tuple[int, Callable[[Any, Any], Any]]] = {
    "or": (1, lambda a, b: bool(a) or bool(b)),
    "and": (2, lambda a, b: bool(a) and bool(b)),
    "<": (4, lambda a, b: a < b),
    "<=": (4, lambda a, b: a <= b),
    ">": (4, lambda a, b: a > b),
    ">=": (4, lambda a, b: a >= b),
    "==": (4, lambda a, b: a == b),
    "!=": (4, lambda a, b: a != b),
    "+": (5, lambda a, b: a + b),
    "-": (5, lambda a, b: a - b),
    "*": (6, lambda a, b: a * b),
    "/": (6, lambda a, b: a / b),
    "%": (6, _mod),
    "^": (8, lambda a, b: a**b),
}
_UNARY_POWER = 7
_NOT_POWER = 3

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>\$?[A-Za-z_][A-Za-z0-9_.]*)"
    r"|(?P<text>'[^']*')|(?P<sign><=|>=|==|!=|[-+*/%^<>(),])|(?P<end>$))"
)

RESERVED = frozenset(("and", "or", "not", "true", "false", "pi"))
"""Names that mean something in every expression, so that no parameter can have them."""

_ELSEWHERE = (("=", "=="), ("&", "and"), ("|", "or"), ("!", "not"), ("?", "if(condition, then, else)"))
"""Signs of other languages, and what is written for them here."""

_VISIBLE = re.compile(r"\S")
_NAME_IN_TEXT = re.compile(r"\$([A-Za-z0-9_.]+)")


def names_in(text: str) -> list[tuple[str, int]]:
    """Return the parameters that a text contains, each with the offset of its name, in order.

    The text need not be a complete expression; parts that cannot belong to an expression are skipped.
    """
    found: list[tuple[str, int]] = []
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            at = next(_VISIBLE.finditer(text, at)).end()
            continue
        name, before = match.group("name"), match.start("name")
        at = max(match.end(), at + 1)
        if name is None or name in RESERVED:
            continue
        if name.startswith("$") or not text[match.end() :].lstrip().startswith("("):
            found.append((name.lstrip("$"), before + name.startswith("$")))
    return found


class _Parser:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.depth = 0
        self.signs = 0
        self.kind, self.token, self.offset = "", "", 0
        self.advance()

    def advance(self) -> None:
        match = _TOKEN.match(self.text, self.at)
        if match is None:
            offset = len(self.text) - len(self.text[self.at :].lstrip())
            meant = next((f"; write {ours}" for other, ours in _ELSEWHERE if self.text.startswith(other, offset)), "")
            raise ExpressionError(f"'{self.text[offset]}' is not part of the expression language{meant}", offset)
        self.kind = str(match.lastgroup)
        self.token = match.group(self.kind)
        self.offset = match.start(self.kind)
        self.at = match.end()
        if self.kind == "name" and self.token in ("and", "or", "not"):
            self.kind = "sign"

    def expect(self, sign: str) -> None:
        if self.token != sign:
            raise ExpressionError(f"expected '{sign}', found '{self.token or 'the end'}'", self.offset)
        self.advance()

    def expression(self, power: int) -> _Node:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise ExpressionError("the expression is nested too deeply", self.offset)
        left = self.operand()
        while self.kind == "sign" and self.token in _BINARY and _BINARY[self.token][0] > power:
            sign = self.token
            self.signs += 1
            if self.signs > MAX_SIGNS:
                raise ExpressionError(f"the expression has more than {MAX_SIGNS} signs", self.offset)
            self.advance()
            left = _Call(sign, (left, self.expression(_BINARY[sign][0])))
        self.depth -= 1
        return left

    def operand(self) -> _Node:
        kind, token, offset = self.kind, self.token, self.offset
        if kind == "end":
            raise ExpressionError("the expression ends too early", offset)
        self.advance()
        if kind == "number":
            if not math.isfinite(float(token)):
                raise ExpressionError("the number is too large", offset)
            return _Literal(float(token))
        if kind == "text":
            return _Literal(token[1:-1])
        if kind == "name":
            return self.named(token, offset)
        if token == "(":
            inner = self.expression(0)
            self.expect(")")
            return inner
        if token in ("-", "+"):
            return _Call("negative" if token == "-" else "positive", (self.expression(_UNARY_POWER),))
        if token == "not":
            return _Call("not", (self.expression(_NOT_POWER),))
        raise ExpressionError(f"'{token}' is not expected here", offset)

    def named(self, token: str, offset: int) -> _Node:
        if self.token == "(" and not token.startswith("$"):
            return self.call(token, offset)
        if token in ("true", "false"):
            return _Literal(token == "true")
        if token == "pi":
            return _Literal(math.pi)
        return _Name(token.lstrip("$"))

    def call(self, name: str, offset: int) -> _Node:
        if name not in FUNCTIONS:
            raise ExpressionError(f"there is no function '{name}'", offset)
        self.expect("(")
        arguments = [self.expression(0)]
        while self.token == ",":
            self.advance()
            arguments.append(self.expression(0))
        self.expect(")")
        count = FUNCTIONS[name][0]
        if count not in (-1, len(arguments)):
            raise ExpressionError(f"'{name}' takes {count} argument(s), not {len(arguments)}", offset)
        return _Call(name, tuple(arguments))


def _evaluate(node: _Node, values: Mapping[str, Value]) -> Value:
    if isinstance(node, _Literal):
        return node.value
    if isinstance(node, _Name):
        if node.name not in values:
            raise ExpressionError(f"there is no parameter '{node.name}'")
        return values[node.name]
    if node.function == "if":
        condition, then, otherwise = node.arguments
        return _evaluate(then if _evaluate(condition, values) else otherwise, values)
    arguments = [_evaluate(argument, values) for argument in node.arguments]
    try:
        return _apply(node.function, arguments)
    except (ArithmeticError, ValueError, TypeError) as error:
        shown = _text(_Call(node.function, tuple(_Literal(a) for a in arguments)))
        shown = shown if len(shown) <= MAX_SHOWN else f"{shown[:MAX_SHOWN]}..."
        raise ExpressionError(f"{shown} has no value: {_reason(node.function, arguments, error)}") from None


def _apply(function: str, arguments: Sequence[Any]) -> Value:
    result: Any
    if function == "negative":
        result = -arguments[0]
    elif function == "positive":
        result = +arguments[0]
    elif function == "not":
        result = not arguments[0]
    elif function in _BINARY:
        result = _BINARY[function][1](arguments[0], arguments[1])
    else:
        result = FUNCTIONS[function][1](*arguments)
    if isinstance(result, str):
        return _checked_text(function, result)
    if isinstance(result, bool):
        return result
    if isinstance(result, complex):
        raise ValueError(function)
    if not math.isfinite(result):
        raise OverflowError(function)
    return float(result)


def _checked_text(function: str, text: str) -> str:
    """Return a text that a function has as its result; only some functions return texts, of a limited length."""
    if function not in ("+", "min", "max"):
        raise TypeError(function)
    if len(text) > MAX_LENGTH:
        raise OverflowError(function)
    return text


_NO_VALUE = {
    "sqrt": "a negative number has no root",
    "log": "only a number above 0 has a logarithm",
    "asin": "it takes a number from -1 to 1",
    "acos": "it takes a number from -1 to 1",
    "^": "a negative number has whole powers only",
    "pow": "a negative number has whole powers only",
}
"""The reason why a function has no value for a number."""


def _reason(function: str, arguments: Sequence[Value], error: Exception) -> str:
    """Return why a function has no value, in the words of the language; `error` is Python's."""
    text = next((one for one in arguments if isinstance(one, str)), None)
    if isinstance(error, OverflowError):
        return "the result is too large a number" if text is None else f"a text has at most {MAX_LENGTH} characters"
    if text is not None:
        return f"'{text}' is a text, not a number"
    if isinstance(error, ZeroDivisionError):
        return "0 has no negative powers" if function in ("^", "pow") else "nothing can be divided by 0"
    return _NO_VALUE.get(function, "it is not defined there")


def _collect(node: _Node, found: set[str]) -> None:
    if isinstance(node, _Name):
        found.add(node.name)
    elif isinstance(node, _Call):
        for argument in node.arguments:
            _collect(argument, found)


def _substitute(node: _Node, replacements: Mapping[str, Expression | Value]) -> _Node:
    if isinstance(node, _Name) and node.name in replacements:
        new = replacements[node.name]
        return new.tree if isinstance(new, Expression) else _Literal(new)
    if isinstance(node, _Call):
        return _Call(node.function, tuple(_substitute(a, replacements) for a in node.arguments))
    return node


def _text(node: _Node) -> str:
    if isinstance(node, _Literal):
        return format_value(node.value) if not isinstance(node.value, str) else f"'{node.value}'"
    if isinstance(node, _Name):
        return f"${node.name}"
    parts = [_text(argument) for argument in node.arguments]
    if node.function == "^" and parts[0].startswith("-"):
        parts[0] = f"({parts[0]})"  # the sign of a number that has replaced a name belongs to the number
    if node.function in _BINARY:
        return f"({parts[0]} {node.function} {parts[1]})"
    if node.function in ("negative", "positive"):
        return f"({'-' if node.function == 'negative' else '+'}{parts[0]})"
    if node.function == "not":
        return f"(not {parts[0]})"
    return f"{node.function}({', '.join(parts)})"


WHOLE_BELOW = 1e15
"""Amount from which on a whole number is written with an exponent, so that it is not an integer in XML."""


def format_value(value: Value) -> str:
    """Return a value as XML writes it: true/false, shortest round-trip decimals, whole numbers without a point."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    return str(int(value)) if value == int(value) and abs(value) < WHOLE_BELOW else repr(value)
