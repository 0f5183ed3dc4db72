"""Hypothesis strategies of words, made from their declarations, and the way of a word through XML and back."""

from __future__ import annotations

import types
from collections.abc import Mapping
from typing import Annotated, Any, ForwardRef, Literal, Union, get_args, get_origin, get_type_hints

from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document
from scenario_compiler.expressions import Expression, Value, parse_expression
from scenario_compiler.openscenario.node import FileContext, Known, Node
from scenario_compiler.openscenario.output import Version
from scenario_compiler.openscenario.positions import POSITIONS
from scenario_compiler.openscenario.scope import Bound, Scope
from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import AttributeSpelling, Word, spelling_of

Fixed = Mapping[tuple[type[Word], str], Any]

ENTITIES = ("ego", "other", "third one")
UNSAID = {word for word in get_args(Position) if word not in POSITIONS.by_word}
"""Positions that OpenSCENARIO cannot say."""

OPEN: dict[str, Value] = {"gap": 12.5}
"""The scenario's open parameters and their values."""

_NUMBERS = st.one_of(
    st.floats(-1e6, 1e6, allow_nan=False).map(lambda x: x + 0.0),
    st.integers(-100, 100).map(float),
    st.sampled_from([parse_expression("$gap"), parse_expression("($gap * 2)"), parse_expression("max($gap, 1)")]),
)
_TEXTS = st.text(st.characters(codec="ascii", min_codepoint=32, exclude_characters="$"), min_size=1, max_size=12).map(
    lambda text: text.strip() or "x"
)


def words(word: type[Word], fixed: Fixed) -> st.SearchStrategy[Any]:
    """Return a strategy of a word; `fixed` are the strategies of fields that their declaration does not say all of."""
    fields: dict[str, st.SearchStrategy[Any]] = {}
    for name, info in word.model_fields.items():
        if name == "word":
            continue
        spelling = spelling_of(info)
        known = fixed.get((word, name))
        if known is not None:
            fields[name] = known
        elif isinstance(spelling, AttributeSpelling) and spelling.names == "entity" and not spelling.separated:
            fields[name] = st.sampled_from(ENTITIES if info.is_required() else (*ENTITIES, ""))
        else:
            annotation: object = info.annotation
            if isinstance(annotation, ForwardRef):
                annotation = get_type_hints(word, include_extras=True)[name]
            fields[name] = _values(annotation, fixed)
    return st.fixed_dictionaries(fields).map(lambda values: word(**_facing_one_way(values)))


def _facing_one_way(values: dict[str, Any]) -> dict[str, Any]:
    """A heading in the world takes the place of a relative one, so that only one of them is said."""
    return {**values, "turn": 0.0} if "turn" in values and values.get("heading") is not None else values


def _values(annotation: Any, fixed: Fixed) -> st.SearchStrategy[Any]:
    origin = get_origin(annotation)
    if origin is Annotated:
        return _values(get_args(annotation)[0], fixed)
    if origin is Literal:
        return st.sampled_from(get_args(annotation))
    if origin is tuple:
        inner = _values(get_args(annotation)[0], fixed)
        return st.lists(inner, min_size=2, max_size=3).map(tuple)
    if origin in (Union, types.UnionType):
        members = [member for member in get_args(annotation) if member not in UNSAID]
        if Expression in members:
            return st.one_of(_NUMBERS, *([st.none()] if type(None) in members else []))
        return st.one_of([_values(member, fixed) for member in members])
    if annotation is type(None):
        return st.none()
    if isinstance(annotation, type) and issubclass(annotation, Word):
        return st.deferred(lambda: words(annotation, fixed))
    simple = {bool: st.booleans(), int: st.integers(-9, 9), float: st.floats(-80.0, 80.0), str: _TEXTS}
    return simple[annotation]


def node_of(element: etree._Element, version: Version, sink: Diagnostics) -> Node:
    """Return an element, written and parsed again, as a node of a file of a version with ENTITIES and OPEN."""
    text = etree.tostring(element, encoding="unicode")
    document = Document("written.xosc", text, etree.fromstring(text))
    known = Known(entities={name: "vehicle" for name in ENTITIES})
    bound = {name: Bound("double", str(value), parse_expression(f"${name}")) for name, value in OPEN.items()}
    return Node(document.root, FileContext(document, sink, version, known), Scope(bound, OPEN))
