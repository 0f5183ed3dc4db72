"""Records: values that a program or a JSON file gives are checked, and those that were checked already are not."""

from __future__ import annotations

import copy
import pickle

import pytest
from pydantic import BaseModel, ValidationError

from scenario_compiler.records import Record, field


class Wheel(Record):
    """A wheel."""

    radius: float = field(description="Radius, m.", gt=0.0)
    notes: dict[str, str] = field(default={}, description="Notes by author.")


class Part(Record):
    """A part, which may have parts."""

    word: str = "part"
    wheels: tuple[Wheel, ...] = ()
    inner: Part | None = None


class Special(Part):
    """A part with one more field."""

    name: str


CART = Part(wheels=(Wheel(radius=0.4), Wheel(radius=0.5, notes={"me": "new"})), inner=Part(inner=Part()))


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({}, "Field required"),
        ({"radius": 0.0}, "greater than 0"),
        ({"radius": float("nan")}, "finite number"),
        ({"radius": 0.4, "color": "red"}, "Extra inputs are not permitted"),
    ],
)
def test_the_constructor_checks_values(values: dict[str, object], reason: str) -> None:
    with pytest.raises(ValidationError, match=rf"1 validation error for Wheel\n[^$]*{reason}"):
        Wheel.model_validate(values)


def test_a_fault_inside_another_record_names_its_place() -> None:
    with pytest.raises(ValidationError) as found:
        Part.model_validate({"wheels": [{"radius": 0.4}], "inner": {"wheels": [{"radius": -1.0}]}})
    assert found.value.errors()[0]["loc"] == ("inner", "wheels", 0, "radius")


def test_json_contains_everything_and_is_read_back() -> None:
    assert Part.model_validate_json(CART.model_dump_json()) == CART
    assert Part.model_validate(CART.model_dump()) == CART
    assert type(Part.model_validate(CART.model_dump()).inner) is Part


def test_the_json_schema_is_that_of_the_declarations() -> None:
    schema = Part.model_json_schema()
    assert schema["$defs"]["Part"]["description"] == "A part, which may have parts."
    radius = schema["$defs"]["Wheel"]["properties"]["radius"]
    assert radius == {"title": "Radius", "type": "number", "exclusiveMinimum": 0.0, "description": "Radius, m."}


def test_values_that_were_checked_already_are_not_checked_again() -> None:
    made = Wheel.model_construct(radius=-1.0)
    assert (made.radius, made.notes, made.model_fields_set) == (-1.0, {}, {"radius"})


def test_two_records_share_no_default_that_can_be_changed() -> None:
    assert Wheel.model_construct(radius=1.0).notes is not Wheel.model_construct(radius=1.0).notes


def test_a_record_without_a_required_value_has_no_such_attribute() -> None:
    with pytest.raises(AttributeError, match="no attribute 'radius'"):
        _ = Wheel.model_construct().radius


def test_a_record_is_frozen() -> None:
    with pytest.raises(AttributeError, match="frozen"):
        CART.word = "whole"
    with pytest.raises(AttributeError, match="frozen"):
        del CART.word


def test_fields_of_a_base_class_come_first() -> None:
    assert [*Special.model_fields] == ["word", "wheels", "inner", "name"]
    assert Special(name="axle") != Part()


def test_copies_are_equal_and_changes_are_made_in_them_alone() -> None:
    changed = CART.model_copy(update={"word": "whole"})
    assert (changed.word, changed.wheels, CART.word) == ("whole", CART.wheels, "part")
    assert "word" in changed.model_fields_set
    for made in (copy.copy(CART), copy.deepcopy(CART), pickle.loads(pickle.dumps(CART))):
        assert made == CART
        assert made.model_fields_set == CART.model_fields_set


def test_a_copy_with_an_unknown_field_is_refused() -> None:
    with pytest.raises(TypeError, match="Part has no field 'wrod'"):
        CART.model_copy(update={"wrod": "whole"})


def test_equal_records_have_equal_hashes() -> None:
    assert hash(Part(inner=Part())) == hash(Part(inner=Part()))
    assert repr(Part()) == "Part(word='part', wheels=(), inner=None)"


def test_a_model_can_contain_records() -> None:
    class Told(BaseModel):
        part: Part

    told = Told.model_validate({"part": {"inner": {}}})
    assert told.part == Part(inner=Part())
    assert Told.model_validate_json(told.model_dump_json()) == told
