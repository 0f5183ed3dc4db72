"""Defaults of the takeover policy that depend on what is written."""

from __future__ import annotations

import pytest

from scenario_compiler.expressions import parse_expression
from scenario_compiler.plan.defaults import complete_takeover
from scenario_compiler.vocabulary.takeover import Cause, Takeover
from scenario_compiler.vocabulary.word import Number, number_value


@pytest.mark.parametrize(("begins", "ends"), [(None, 0.7), (0.5, 0.7), (0.85, 0.85), (parse_expression("$low"), 0.9)])
def test_a_warning_does_not_end_at_a_lower_confidence_than_it_begins(begins: Number | None, ends: float) -> None:
    written = Takeover(causes=(Cause(kind="lane_confidence", warning_below=begins),))
    (cause,) = complete_takeover(written).causes
    assert cause.warning_over is not None
    assert number_value(cause.warning_over, {"low": 0.9}) == ends
