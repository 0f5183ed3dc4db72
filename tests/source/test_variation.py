"""A scenario's <vary> means the same as the options of the sweep command."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.batch.distributions import parse_distribution
from scenario_compiler.batch.sampling import make_sampler
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.compiler import variation_of
from scenario_compiler.diagnostics import Diagnostics
from tests.source.made import codes_of, expanded, library_text

PARAMETERS = (
    '<parameter name="gap" type="length" default="30" min="20" max="90"/>'
    '<parameter name="pace" type="speed" default="10"/><parameter name="count" type="integer" default="1"/>'
    '<parameter name="kind" type="text" default="vehicle.audi.a2"/>'
)

CARS = (
    '<repeat count="$count"><dynamic id="car" model="$kind" speed="$pace">'
    '<start><ahead_of entity="ego" distance="$gap"/></start></dynamic></repeat>'
)

AXES = {
    '<uniform parameter="gap" least="20" greatest="40"/>': "gap=uniform(20, 40)",
    '<normal parameter="pace" mean="10" deviation="1.5"/>': "pace=normal(10, 1.5)",
    '<normal parameter="pace" mean="10" deviation="1" least="8" greatest="12"/>': "pace=normal(10, 1, 8, 12)",
    '<lognormal parameter="gap" mu="3.4" sigma="0.2" least="20" greatest="60"/>': "gap=lognormal(3.4, 0.2, 20, 60)",
    '<triangular parameter="gap" least="20" likeliest="30" greatest="60"/>': "gap=triangular(20, 30, 60)",
    '<poisson parameter="count" mean="3"/>': "count=poisson(3)",
    '<histogram parameter="gap" edges="20 30 50" weights="1 2"/>': "gap=histogram(20, 1, 30, 2, 50)",
    '<choice parameter="kind" of="vehicle.audi.a2 vehicle.audi.tt"/>': "kind=choice(vehicle.audi.a2, vehicle.audi.tt)",
    '<grid parameter="gap" first="20" last="40" count="3"/>': "gap=grid(20, 40, 3)",
}


def _varied(inside: str) -> str:
    return library_text(CARS, parameters=f"{PARAMETERS}<vary>{inside}</vary>")


@pytest.mark.parametrize(("written", "spelled"), AXES.items())
def test_each_axis_is_one_that_a_sweep_samples(written: str, spelled: str) -> None:
    vary = expanded(_varied(written)).vary
    assert vary is not None
    assert [axis.spelling() for axis in vary.axes] == [spelled]
    assert parse_distribution(spelled.partition("=")[2]).text == spelled.partition("=")[2]


def test_a_sweep_fulfils_the_constraints() -> None:
    inside = "".join(list(AXES)[:2]) + '<constraint holds="$gap &gt; 3 * $pace"/>'
    vary = expanded(_varied(inside)).vary
    assert vary is not None
    where = tuple(one.holds for one in vary.constraints)
    sampler = make_sampler(SweepSpec(vary=tuple(axis.spelling() for axis in vary.axes), where=where, samples=20))
    samples = [sampler.sample(number) for number in range(20)]
    assert all(float(sample["gap"]) > 3 * float(sample["pace"]) for sample in samples)


def test_the_variation_of_a_file_is_found(tmp_path: Path) -> None:
    path = tmp_path / "varied.xml"
    path.write_text(_varied(next(iter(AXES))), encoding="utf-8")
    sink = Diagnostics()
    vary = variation_of(path, {}, sink)
    assert vary is not None
    assert vary.axes[0].parameter == "gap"
    assert not sink.found


@pytest.mark.parametrize(
    ("inside", "codes"),
    [
        ("", ["SC108"]),
        ('<uniform parameter="gap" least="40" greatest="30"/>', ["SC250"]),
        ('<normal parameter="pace" mean="1" deviation="0"/>', ["SC112"]),
        ('<normal parameter="pace" mean="1" deviation="1" least="0"/>', ["SC250"]),
        ('<lognormal parameter="gap" mu="3" sigma="1" least="0" greatest="50"/>', ["SC250"]),
        ('<normal parameter="pace" mean="1" deviation="0.1" least="5" greatest="6"/>', ["SC250"]),
        ('<lognormal parameter="gap" mu="3" sigma="0.01" least="30" greatest="50"/>', ["SC250"]),
        ('<histogram parameter="gap" edges="30 20" weights="1"/>', ["SC250"]),
        ('<histogram parameter="gap" edges="20 30" weights="0"/>', ["SC250"]),
        ('<choice parameter="gap" of="30 100"/>', ["SC112"]),
        ('<choice parameter="gap" of="30, 40"/>', ["SC250"]),
        ('<uniform parameter="kind" least="1" greatest="2"/>', ["SC250"]),
        ('<uniform parameter="count" least="1" greatest="2"/>', ["SC250"]),
        ('<grid parameter="count" first="1" last="2" count="3"/>', ["SC250"]),
        ('<grid parameter="count" first="1" last="5" count="3"/>', []),
        ('<grid parameter="count" first="2" last="2" count="1"/>', []),
        ('<poisson parameter="count" mean="2"/><poisson parameter="count" mean="2"/>', ["SC250"]),
    ],
)
def test_invalid_variations_are_reported(inside: str, codes: list[str]) -> None:
    assert codes_of(_varied(inside)) == codes
