"""The numbers of a word are floats or expressions, in Python and in JSON."""

from __future__ import annotations

import json

import pytest
from pydantic import ValidationError

from scenario_compiler.expressions import Expression, parse_expression
from scenario_compiler.vocabulary.actions import LaneOffsetAction, SpeedAction


@pytest.mark.parametrize(("given", "kept"), [(2, 2.0), (2.5, 2.5), ("2.5", 2.5)])
def test_a_number_is_kept_as_a_float(given: object, kept: float) -> None:
    found = SpeedAction.model_validate({"to": given}).to
    assert type(found) is float
    assert found == kept


@pytest.mark.parametrize("given", [{"expr": "2 * speed"}, parse_expression("2 * speed")])
def test_an_expression_is_kept_open(given: object) -> None:
    word = SpeedAction.model_validate({"to": given})
    assert isinstance(word.to, Expression)
    assert word.model_dump(mode="json")["to"] == {"expr": "(2 * $speed)"}
    assert SpeedAction.model_validate_json(word.model_dump_json()) == word


@pytest.mark.parametrize(
    "given", [float("inf"), float("nan"), "fast", None, {"expr": 1}, {"expr": "2 *"}, {"text": "speed"}, [1.0]]
)
def test_anything_else_is_not_a_number(given: object) -> None:
    with pytest.raises(ValidationError):
        SpeedAction.model_validate({"to": given})
    with pytest.raises(ValidationError):
        SpeedAction.model_validate_json(json.dumps({"to": given}))


def test_the_json_schema_describes_numbers() -> None:
    properties = LaneOffsetAction.model_json_schema()["properties"]
    assert properties["to"]["anyOf"] == [
        {"type": "number"},
        {"type": "object", "additionalProperties": {"type": "string"}},
    ]
    assert properties["over_time"]["description"] == "Duration of the move, s; with 0 it is immediate."
