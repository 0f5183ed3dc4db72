"""Every action, condition and position: what is written is read back, and each either has a form or a reason."""

from __future__ import annotations

from typing import Any, get_args

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.ego import visibility
from scenario_compiler.expressions import parse_expression
from scenario_compiler.openscenario.actions import ACTIONS, read_actions, write_action
from scenario_compiler.openscenario.actions import UNSAID as UNSAID_ACTIONS
from scenario_compiler.openscenario.actions.environment import FOG_AT_ONE, FOG_THINNED
from scenario_compiler.openscenario.conditions import BY_ENTITY, BY_VALUE, OWN, read_condition, write_condition
from scenario_compiler.openscenario.motion import read_position, write_position
from scenario_compiler.openscenario.output import VERSIONS, Output, Version
from scenario_compiler.openscenario.points import UNSAID as UNSAID_POSITIONS
from scenario_compiler.openscenario.positions import POSITIONS
from scenario_compiler.vocabulary.actions import (
    Action,
    AssignControllerAction,
    AtRate,
    EnvironmentAction,
    FinalSpeed,
    LaneChangeAction,
    LateralDistanceAction,
    OverrideControllerAction,
    RelativeSpeedAction,
    SynchronizeAction,
    WeatherAction,
)
from scenario_compiler.vocabulary.conditions import (
    CollisionCondition,
    Condition,
    RelativeClearanceCondition,
    TimeToCollisionCondition,
)
from scenario_compiler.vocabulary.positions import (
    FreePosition,
    GeoPosition,
    Nurbs,
    Position,
    RelativeLanePosition,
    RouteWord,
    Trajectory,
    Waypoint,
)
from scenario_compiler.vocabulary.word import Word
from tests.openscenario.words import ENTITIES, OPEN, node_of, words

EXAMPLES = settings().max_examples
"""Number of examples that a property is tried with."""

NEWEST: Version = (1, 3)

_NAME = st.sampled_from(["A1", "way home"])
_MASTER = "other"

FIXED: dict[tuple[type[Word], str], Any] = {
    (GeoPosition, "latitude"): st.sampled_from([0.0, 45.0, -90.0]),
    (GeoPosition, "longitude"): st.sampled_from([0.0, 90.0, -180.0]),
    (Nurbs, "order"): st.integers(2, 5),
    (RouteWord, "name"): _NAME,
    (Waypoint, "strategy"): st.sampled_from(("fastest", "leastIntersections", "shortest")),
    (Trajectory, "name"): _NAME,
    (RelativeClearanceCondition, "of"): st.sampled_from([(), ENTITIES]),
    (LaneChangeAction, "of"): st.sampled_from(ENTITIES),
    (LateralDistanceAction, "distance"): st.floats(0.0, 9.0),
    (AssignControllerAction, "name"): st.just("ACCController"),
    (AssignControllerAction, "model"): st.just("acc"),
    (OverrideControllerAction, "value"): st.integers(-1, 6).map(float),
    (SynchronizeAction, "master"): st.just(_MASTER),
    (FinalSpeed, "relative_to"): st.just(_MASTER),
    (WeatherAction, "preset"): st.just("custom"),
    (WeatherAction, "cloudiness"): st.floats(0.0, 100.0),
    (WeatherAction, "over_time"): st.floats(0.0, 9.0),
    (EnvironmentAction, "date_time"): st.just("2024-01-31T10:00:00"),
    (EnvironmentAction, "friction"): st.floats(0.0, 1.0),
    **{(word, "entity"): st.just("") for word in BY_ENTITY.by_word},
}
"""Strategies of what a declaration does not say all of. Triggering entities stand beside a condition, not in it."""


SAID = [*ACTIONS.by_word, *BY_ENTITY.by_word, *BY_VALUE.by_word, *POSITIONS.by_word]


def _written(word: Word, output: Output) -> etree._Element | None:
    if isinstance(word, get_args(Action)):
        return write_action(word, output)
    if isinstance(word, get_args(Condition)):
        return write_condition(word, output)
    return write_position(word, output)


def _read(word: Word, element: etree._Element, version: Version, sink: Diagnostics) -> list[Word | None]:
    node = node_of(element, version, sink)
    if isinstance(word, get_args(Action)):
        return list(read_actions(node))
    return [read_condition(node) if isinstance(word, get_args(Condition)) else read_position(node)]


def _settled(word: Word) -> Word:
    """Return a word with only one of the fields that exclude each other."""
    if isinstance(word, RelativeSpeedAction) and not isinstance(word.dynamics, AtRate):
        word = word.model_copy(update={"continuous": False})
    if getattr(word, "dynamics", None) is not None:
        return word.model_copy(update={"over_time": 0.0})
    if isinstance(word, CollisionCondition):
        return word.model_copy(update={"with_entities": () if word.with_type else ("other",)})
    if isinstance(word, TimeToCollisionCondition):
        to = "other" if word.position is None else ""
        return word.model_copy(update={"to": to})
    if isinstance(word, SynchronizeAction) and word.final_speed is not None and not word.final_speed.relative_to:
        return word.model_copy(update={"final_speed": word.final_speed.model_copy(update={"kind": "delta"})})
    return word


@pytest.mark.parametrize("kind", SAID, ids=lambda kind: kind.__name__)
@settings(
    max_examples=EXAMPLES // 4,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.large_base_example],
)
@given(data=st.data())
def test_what_is_written_is_read_back(kind: type[Word], data: st.DataObject) -> None:
    word = _settled(data.draw(words(kind, FIXED)))
    sink = Diagnostics()
    element = _written(word, Output(NEWEST, sink, OPEN))
    assert element is not None
    assert list(sink) == []
    assert _read(word, element, NEWEST, sink) == [word], etree.tostring(element, pretty_print=True).decode()
    assert list(sink) == []


@pytest.mark.parametrize("kind", SAID, ids=lambda kind: kind.__name__)
@settings(
    max_examples=EXAMPLES // 8,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.large_base_example],
)
@given(data=st.data(), version=st.sampled_from(VERSIONS[:-1]))
def test_words_that_an_older_version_lacks_are_reported(
    kind: type[Word], data: st.DataObject, version: Version
) -> None:
    word = _settled(data.draw(words(kind, FIXED)))
    if version == (1, 0) and getattr(word, "rule", "") in ("lessOrEqual", "greaterOrEqual"):
        return  # strictly less or greater than a value within the tolerance of comparisons takes its place
    told, sink = Diagnostics(), Diagnostics()
    element = _written(word, Output(version, told, OPEN))
    if element is None:
        assert {one.code.id for one in told} == {"SC783"}
    elif not list(told):
        assert _read(word, element, version, sink) == [word], etree.tostring(element, pretty_print=True).decode()
        assert list(sink) == []


@pytest.mark.parametrize(
    ("position", "version", "why"),
    [
        (
            RelativeLanePosition(entity="ego", distance=10.0),
            NEWEST,
            "it follows the lane over junctions",
        ),
        (GeoPosition(latitude=48.0, longitude=11.0), (1, 0), "1.0 has no <GeoPosition>"),
    ],
)
def test_the_reason_why_a_position_cannot_be_written_is_reported(position: Word, version: Version, why: str) -> None:
    sink = Diagnostics()
    element = write_position(position, Output(version, sink))
    assert [one.get("x") for one in element] == ["0"]
    (told,) = sink
    assert told.message.startswith(f"the position <{position.tag()}> cannot be written: {why}")


def test_every_word_has_a_form_or_a_reason() -> None:
    actions = {word.tag() for word in get_args(Action)}
    assert actions == {word.tag() for word in ACTIONS.by_word} | set(UNSAID_ACTIONS)
    positions = {word.tag() for word in get_args(Position)}
    assert positions == {word.tag() for word in POSITIONS.by_word} | set(UNSAID_POSITIONS)
    assert set(get_args(Condition)) == {*BY_ENTITY.by_word, *BY_VALUE.by_word, *OWN}


@pytest.mark.parametrize(
    ("text", "version", "written"),
    [
        ("$gap", (1, 0), "$gap"),
        ("$gap + 1", (1, 0), "13.5"),
        ("$gap + 1", (1, 1), "${($gap + 1)}"),
        ("radians($gap)", (1, 1), "${(0.017453292519943295 * $gap)}"),
        ("abs(2 - $gap)", (1, 1), "${sqrt(((2 - $gap) * (2 - $gap)))}"),
        ("pow($gap, 2)", (1, 1), "156.25"),
        ("pow($gap, 2)", (1, 2), "${pow($gap, 2)}"),
        ("max($gap, 20)", (1, 2), "20"),
        ("max($gap, 20)", (1, 3), "${max($gap, 20)}"),
        ("$gap ^ 2", (1, 3), "156.25"),
        ("if($gap > 3, 1, 2)", (1, 3), "1"),
    ],
)
def test_expressions_are_written_where_the_version_has_them(text: str, version: Version, written: str) -> None:
    sink = Diagnostics()
    output = Output(version, sink, OPEN)
    assert output.text(parse_expression(text), FreePosition(x=0.0, y=0.0)) == written
    assert len(list(sink)) == (0 if "$" in written else 1)


def test_fog_is_as_thick_as_the_cameras_see_it() -> None:
    assert (visibility.FOG_AT_ONE, visibility.FOG_THINNED) == (FOG_AT_ONE, FOG_THINNED)
