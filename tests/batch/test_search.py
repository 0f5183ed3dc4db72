"""Searches: a boundary to its tolerance, a minimum, and resuming both."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.search import find_boundary, minimise
from scenario_compiler.batch.spec import SweepSpec


def _spec(*vary: str, **settings: Any) -> SweepSpec:
    return SweepSpec(vary, perception="ideal", **settings)


def test_the_distance_at_which_collisions_begin_is_found(conflict: Path, tmp_path: Path) -> None:
    spec = _spec("distance=uniform(20, 200)", "speed=uniform(20, 20)")
    with pytest.raises(SweepError, match="along one parameter"):
        find_boundary(conflict, spec, tmp_path / "wrong", when="collision", tolerance=0.5)
    spec = _spec("distance=uniform(20, 200)", settings={"speed": "20", "preset": "absent"})
    found = find_boundary(conflict, spec, tmp_path / "search", when="collision", tolerance=0.5)
    assert 0 < found.without - found.with_it <= 0.5
    rows, about = read_results(tmp_path / "search")
    assert found.evaluations == len(rows["variant"]) == 11
    for distance, time in zip(rows["parameter.distance"], rows["collision_time"], strict=True):
        assert (time is not None) == (distance <= found.with_it)
    assert about["asked"] == "boundary of collision to 0.5"
    again = find_boundary(conflict, spec, tmp_path / "other", when="collision_time >= 0", tolerance=0.5)
    assert again == found


def test_a_search_without_a_range_is_refused(conflict: Path, tmp_path: Path) -> None:
    spec = SweepSpec(vary=(), samples=5, perception="ideal")
    with pytest.raises(SweepError, match="needs a range"):
        minimise(conflict, spec, tmp_path / "search", measure="takeover_time", evaluations=5)


def test_an_unknown_optimizer_is_refused(conflict: Path, tmp_path: Path) -> None:
    unknown: Any = "nelder_mead"
    with pytest.raises(SweepError, match="optimizer is one of direct, nelder-mead, not 'nelder_mead'"):
        minimise(conflict, _spec(), tmp_path / "search", measure="takeover_time", evaluations=5, optimizer=unknown)


def test_an_interrupted_search_is_resumed(conflict: Path, tmp_path: Path) -> None:
    spec = _spec("distance=uniform(20, 200)", settings={"speed": "8"})
    whole = find_boundary(conflict, spec, tmp_path / "whole", when="request", tolerance=1.0)
    with pytest.raises(SweepError, match="--resume"):
        find_boundary(conflict, spec, tmp_path / "whole", when="request", tolerance=1.0)
    with pytest.raises(SweepError, match="differs in what is searched for"):
        find_boundary(conflict, spec, tmp_path / "whole", when="collision", tolerance=1.0, resume=True)
    assert whole == find_boundary(conflict, spec, tmp_path / "whole", when="request", tolerance=1.0, resume=True)


def test_a_missing_boundary_is_reported(conflict: Path, tmp_path: Path) -> None:
    spec = _spec("distance=uniform(20, 200)")
    for when, text in (("final_speed > 1000", "at neither end"), ("a <", "read")):
        with pytest.raises(SweepError, match=text):
            find_boundary(conflict, spec, tmp_path / text, when=when, tolerance=1.0)
    for when, text in (("braking", "neither a measure"), ("colision", "passed.*did you mean 'collision'")):
        with pytest.raises(SweepError, match=text):
            find_boundary(conflict, spec, tmp_path / when, when=when, tolerance=1.0)
    with pytest.raises(SweepError, match="needs a range"):
        find_boundary(conflict, _spec("distance=normal(1, 2)"), tmp_path / "n", when="collision", tolerance=1.0)
    with pytest.raises(SweepError, match="too small"):
        find_boundary(conflict, spec, tmp_path / "nan", when="collision", tolerance=math.nan)


@pytest.mark.parametrize("optimizer", ["direct", "nelder-mead"])
def test_a_search_keeps_within_the_constraints(conflict: Path, tmp_path: Path, optimizer: str) -> None:
    spec = _spec("distance=uniform(40, 300)", "speed=uniform(8, 20)", where=("distance > 100 + 2 * speed",))
    settings = {"measure": "minimum_distance", "evaluations": 30, "optimizer": optimizer}
    found = minimise(conflict, spec, tmp_path / "search", **settings)  # type: ignore[arg-type]
    rows, _ = read_results(tmp_path / "search")
    pairs = list(zip(rows["parameter.distance"], rows["parameter.speed"], strict=True))
    assert len(pairs) == found.evaluations
    assert all(distance > 100 + 2 * speed for distance, speed in pairs)


def test_a_search_that_the_constraints_forbid_is_refused(conflict: Path, tmp_path: Path) -> None:
    spec = _spec("distance=uniform(40, 300)", where=("distance > 400",))
    with pytest.raises(SweepError, match=r"no sample meets \(\$distance > 400\)"):
        minimise(conflict, spec, tmp_path / "least", measure="minimum_distance", evaluations=5)
    outside = _spec("distance=uniform(40, 300)", where=("distance > 60",))
    with pytest.raises(SweepError, match=r"distance = 40 does not meet \(\$distance > 60\)"):
        find_boundary(conflict, outside, tmp_path / "boundary", when="request", tolerance=1.0)


@pytest.mark.parametrize("optimizer", ["direct", "nelder-mead"])
def test_the_least_distance_is_found(conflict: Path, tmp_path: Path, optimizer: str) -> None:
    spec = _spec("distance=uniform(40, 300)", "speed=uniform(8, 20)")
    settings = {"measure": "minimum_distance", "evaluations": 30, "optimizer": optimizer}
    found = minimise(conflict, spec, tmp_path / "search", **settings)  # type: ignore[arg-type]
    rows, _ = read_results(tmp_path / "search")
    assert found.measure == min(rows["minimum_distance"])
    assert found.measure < rows["minimum_distance"][0]
    assert 40 <= found.values["distance"] <= 300
    again = minimise(conflict, spec, tmp_path / "search", resume=True, **settings)  # type: ignore[arg-type]
    assert again == found
    for name, text in (("beauty", "no measure 'beauty'$"), ("minimum_distanc", "did you mean 'minimum_distance'")):
        with pytest.raises(SweepError, match=text):
            minimise(conflict, spec, tmp_path / "other", measure=name, evaluations=3)
    with pytest.raises(SweepError, match="at least one run"):
        minimise(conflict, spec, tmp_path / "none", measure="minimum_distance", evaluations=0)
