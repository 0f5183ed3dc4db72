"""How a sweep varies a scenario, written as a distribution of parameter values and read back."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import compile_built, variation_of
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.expressions import parse_expression
from scenario_compiler.openscenario.export.files import write_openscenario
from scenario_compiler.vocabulary.entities import Ego, Static
from scenario_compiler.vocabulary.positions import LanePositionWord, RelativeLanePosition
from scenario_compiler.vocabulary.scenario import Parameter, Scenario
from scenario_compiler.vocabulary.variation import (
    Axis,
    Choice,
    Constraint,
    Grid,
    Histogram,
    Lognormal,
    Normal,
    Poisson,
    Triangular,
    Uniform,
    Values,
    Vary,
    Weighted,
)
from scenario_compiler.vocabulary.weather import Weather

DRAWN = (
    Uniform(parameter="gap", least=30.0, greatest=60.0),
    Normal(parameter="gap", mean=40.0, deviation=3.0),
    Normal(parameter="gap", mean=40.0, deviation=3.0, least=30.0, greatest=50.0),
    Lognormal(parameter="gap", mu=3.7, sigma=0.25),
    Poisson(parameter="gap", mean=40.0),
    Histogram(parameter="gap", edges=(30.0, 40.0, 60.0), weights=(1.0, 2.0)),
    Weighted(parameter="gap", of=("30", "50"), weights=(1.0, 3.0)),
)
LISTED = (
    Values(parameter="gap", of=("30", "45")),
    Grid(parameter="gap", first=30.0, last=60.0, count=4),
)


def exported(folder: Path, vary: Vary, version: str = "1.3") -> Diagnostics:
    scenario = Scenario(
        name="varied",
        map="town_grid",
        duration=1.0,
        weather=Weather(preset="ClearNoon"),
        parameters=(
            Parameter(name="gap", type="length", default="40"),
            Parameter(name="speed", type="speed", default="10"),
        ),
        vary=vary,
        ego=Ego(speed=parse_expression("$speed"), start=LanePositionWord(road="9", lane=-2, s=30.0)),
        actors=(Static(id="van", at=RelativeLanePosition(entity="ego", distance=parse_expression("$gap"))),),
    )
    done = compile_built(scenario, perception="ideal")
    return write_openscenario(done.plan, done.network, folder / "out.xosc", version, done.scenario)


def read_back(folder: Path) -> Vary:
    sink = Diagnostics()
    vary = variation_of(folder / "out_variation.xosc", {}, sink)
    assert vary is not None
    return vary


@pytest.mark.parametrize("axis", [*DRAWN, *LISTED], ids=lambda axis: axis.tag())
def test_distribution_is_read_back(axis: Axis, tmp_path: Path) -> None:
    exported(tmp_path, Vary.model_validate({"samples": 20, "seed": 3, "axes": (axis,)}))
    vary = read_back(tmp_path)
    assert len(vary.axes) == 1
    for field, value in axis.model_dump().items():
        assert getattr(vary.axes[0], field) == (pytest.approx(value) if isinstance(value, float) else value)
    assert (vary.samples, vary.seed) == ((20, 3) if axis in DRAWN else (None, None))


def test_equally_likely_values_have_one_weight(tmp_path: Path) -> None:
    exported(tmp_path, Vary(axes=(Choice(parameter="gap", of=("30", "50")),)))
    assert read_back(tmp_path).axes == (Weighted(parameter="gap", of=("30", "50"), weights=(1.0, 1.0)),)


@pytest.mark.parametrize(
    ("vary", "version", "told"),
    [
        (Vary(axes=(DRAWN[0],)), "1.0", "<ParameterValueDistribution> is not known before 1.1"),
        (Vary(axes=(DRAWN[3],)), "1.1", "<LogNormalDistribution> is not known before 1.2"),
        (Vary(axes=(Triangular(parameter="gap", least=1, likeliest=2, greatest=3),)), "1.3", "<triangular>"),
        (Vary(axes=(DRAWN[0], Values(parameter="speed", of=("8", "12")))), "1.3", "either all drawn or all listed"),
        (Vary(axes=(DRAWN[0],), constraints=(Constraint(holds="$gap > 35"),)), "1.3", "$gap > 35"),
    ],
)
def test_variations_without_a_distribution_are_reported(vary: Vary, version: str, told: str, tmp_path: Path) -> None:
    sink = exported(tmp_path, vary, version)
    assert any(told in one.message for one in sink), [one.message for one in sink]
    assert (tmp_path / "out_variation.xosc").exists() == (len(vary.axes) > 1 or bool(vary.constraints))


def test_unknown_version_is_a_programmers_mistake(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"1\.0, 1\.1, 1\.2, 1\.3"):
        exported(tmp_path, Vary(axes=DRAWN[:1]), "2.0")
