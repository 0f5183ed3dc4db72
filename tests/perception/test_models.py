"""Models of what moves: closed from every side, as large as their boxes, with lamps where they belong."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.models import SHINES, TAG, Kind, Lamp, model_of, traits_of
from scenario_compiler.vocabulary.entities import Category

SIZES: dict[Kind, tuple[float, float, float]] = {
    "truck": (9.0, 2.5, 3.4),
    "bus": (12.0, 2.5, 3.1),
    "bicycle": (1.8, 0.6, 1.7),
    "motorbike": (2.2, 0.8, 1.6),
    "pedestrian": (0.5, 0.6, 1.75),
    "cone": (0.4, 0.4, 0.7),
}
KINDS: tuple[Kind, ...] = get_args(Kind)


def size_of(kind: Kind) -> tuple[float, float, float]:
    return SIZES.get(kind, (4.4, 1.85, 1.45))


def lit(kind: Kind, lamps: Lamp, ahead: bool) -> set[tuple[float, ...]]:
    """Return the colours of the lamps that shine at one end."""
    model, traits = model_of(kind, *size_of(kind)), traits_of(kind, *size_of(kind), (90, 90, 90), lamps)
    end = model.points[0].mean(axis=0) > 0.0
    return {tuple(row[:3]) for row in traits[(traits[:, SHINES] > 0.0) & (end == ahead)].tolist()}


def test_every_category_of_entities_has_a_model() -> None:
    assert set(KINDS) == set(get_args(Category))


@pytest.mark.parametrize("kind", KINDS)
def test_a_model_is_as_wide_and_as_tall_as_its_box_and_stays_in_it(kind: Kind) -> None:
    """Lamps and wheels stand a few centimetres proud."""
    length, width, height = size_of(kind)
    fine, coarse = (model_of(kind, length, width, height, one).points for one in (False, True))
    for points in (fine, coarse):
        assert np.abs(points[0]).max() < 0.52 * length
        assert np.abs(points[1]).max() < 0.52 * width
        assert 0.0 <= points[2].min() < 0.15 * height
        assert points[2].max() == pytest.approx(height, rel=0.01)
    assert np.abs(fine[1]).max() > 0.49 * width


@pytest.mark.parametrize("kind", KINDS)
def test_faces_look_outwards(kind: Kind) -> None:
    """An eye above sees every roof, one ahead every front; no face is seen from within the whole."""
    length, width, height = size_of(kind)
    model = model_of(kind, length, width, height)
    assert np.allclose(np.linalg.norm(model.normals, axis=0), 1.0)
    for eye, axis in (((0.0, 0.0, 50.0), 2), ((50.0, 0.0, 0.5 * height), 0), ((0.0, 50.0, 0.5 * height), 1)):
        seen = np.array(eye) @ model.normals > model.offsets
        assert (model.normals[axis, seen] > -0.3).all()
        assert (model.normals[axis, ~seen] < 0.3).all()
        assert seen.any()


@pytest.mark.parametrize("kind", KINDS)
def test_a_coarse_model_has_fewer_faces_and_the_same_kinds(kind: Kind) -> None:
    fine, coarse = (model_of(kind, *size_of(kind), one) for one in (False, True))
    assert len(coarse.tags) <= len(fine.tags)
    assert set(coarse.tags.tolist()) == set(fine.tags.tolist())


def test_both_orders_have_every_face_once() -> None:
    model = model_of("truck", *SIZES["truck"])
    every = np.arange(len(model.tags))
    assert sorted(model.rear_first.tolist()) == sorted(model.front_first.tolist()) == every.tolist()
    assert model.rear_first.tolist() != model.front_first.tolist()


def test_riders_are_distinguished_from_their_vehicles() -> None:
    assert set(model_of("bicycle", *SIZES["bicycle"]).tags.tolist()) == {Tag.BICYCLE, Tag.RIDER}
    assert set(traits_of("motorbike", *SIZES["motorbike"], (1, 2, 3), Lamp.NONE)[:, TAG].tolist()) == {
        Tag.MOTORCYCLE,
        Tag.RIDER,
    }


@pytest.mark.parametrize("kind", ["car", "van", "truck", "bus"])
def test_lamps_shine_at_their_end_in_their_colour(kind: Kind) -> None:
    red, bright, amber, white = (40, 40, 235), (110, 110, 255), (30, 165, 255), (235, 250, 255)
    assert lit(kind, Lamp.NONE, ahead=True) == lit(kind, Lamp.NONE, ahead=False) == set()
    assert lit(kind, Lamp.LOW_BEAM, ahead=True) == {white}
    assert lit(kind, Lamp.LOW_BEAM, ahead=False) == {red}
    assert lit(kind, Lamp.POSITION, ahead=False) == {red}
    assert lit(kind, Lamp.BRAKE, ahead=False) == {bright}
    assert lit(kind, Lamp.BRAKE, ahead=True) == set()
    assert lit(kind, Lamp.LEFT_BLINKER, ahead=True) == lit(kind, Lamp.LEFT_BLINKER, ahead=False) == {amber}


def test_blinkers_are_on_their_side() -> None:
    model = model_of("car", 4.4, 1.85, 1.45)
    for lamp, side in ((Lamp.LEFT_BLINKER, 1.0), (Lamp.RIGHT_BLINKER, -1.0)):
        shining = traits_of("car", 4.4, 1.85, 1.45, (1, 2, 3), lamp)[:, SHINES] > 0.0
        assert shining.any()
        assert (np.sign(model.points[1].mean(axis=0)[shining]) == side).all()


def test_lamps_have_carlas_numbers() -> None:
    carla = pytest.importorskip("carla")
    names = {"LOW_BEAM": "LowBeam", "HIGH_BEAM": "HighBeam", "RIGHT_BLINKER": "RightBlinker",
             "LEFT_BLINKER": "LeftBlinker", "NONE": "NONE"}  # fmt: skip
    for lamp in (Lamp.NONE, *Lamp):
        if lamp is not Lamp.AUTOMATIC:
            name = names.get(str(lamp.name), str(lamp.name).capitalize())
            assert int(getattr(carla.VehicleLightState, name)) == lamp
