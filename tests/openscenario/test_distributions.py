"""Distributions of parameter values: the first of each in a run, all of them in a sweep."""

from __future__ import annotations

import math
from pathlib import Path
from statistics import NormalDist

import pytest

from scenario_compiler.batch.distributions import parse_distribution
from scenario_compiler.batch.sampling import make_sampler
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.compiler import compile_target, read_source, variation_of
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.vocabulary.variation import Axis, Histogram, Lognormal, Normal, Poisson, Uniform, Vary, Weighted
from tests.openscenario.made import condition, declarations, event, scenario_text, speed, story

HEADER = '<FileHeader revMajor="1" revMinor="3" date="2026-01-01T00:00:00" description="" author=""/>'


def _single(name: str, inside: str) -> str:
    return (
        f'<DeterministicSingleParameterDistribution parameterName="{name}">{inside}'
        "</DeterministicSingleParameterDistribution>"
    )


def _sets(*sets: str) -> str:
    inside = "".join(
        "<ParameterValueSet>"
        + "".join(
            '<ParameterAssignment parameterRef="{}" value="{}"/>'.format(*pair.split("=")) for pair in one.split()
        )
        + "</ParameterValueSet>"
        for one in sets
    )
    return (
        f"<DeterministicMultiParameterDistribution><ValueSetDistribution>{inside}</ValueSetDistribution>"
        "</DeterministicMultiParameterDistribution>"
    )


def _drawn(name: str, inside: str) -> str:
    return f'<StochasticDistribution parameterName="{name}">{inside}</StochasticDistribution>'


VALUES = "<DistributionSet><Element value='5'/><Element value='7'/></DistributionSet>"
RANGE = "<DistributionRange stepWidth='0.1'><Range lowerLimit='1' upperLimit='1.3'/></DistributionRange>"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A scenario in another folder, with two numbers, a text and a whole number as parameters."""
    declared = declarations("v:double=2", "w:double=1", "name:string=x", "n:integer=1")
    text = scenario_text(
        story(event(action=speed("$v", "$w"), maximumExecutionCount="$n", name="$name")),
        declared=declared,
        init=f'<Private entityRef="Ego">{speed()}</Private>',
        stop=condition(),
    )
    folder = tmp_path / "scenarios"
    folder.mkdir()
    (folder / "base.xosc").write_text(text.replace("$name action", "action"), encoding="utf-8")
    return tmp_path / "varied.xosc"


def _write(file: Path, inside: str, path: str = "scenarios/base.xosc") -> None:
    text = f"<OpenSCENARIO>{HEADER}<ParameterValueDistribution><ScenarioFile filepath='{path}'/>{inside}"
    file.write_text(f"{text}</ParameterValueDistribution></OpenSCENARIO>", encoding="utf-8")


def _vary(file: Path) -> Vary:
    sink = Diagnostics()
    found = variation_of(file, {}, sink)
    assert found is not None, list(sink)
    return found


def _samples(vary: Vary) -> list[dict[str, object]]:
    spec = SweepSpec(
        vary=tuple(axis.spelling() for axis in vary.axes),
        where=tuple(one.holds for one in vary.constraints),
        samples=vary.samples or 1,
    )
    sampler = make_sampler(spec)
    return [dict(sampler.sample(index)) for index in range(sampler.total)]


def test_every_value_is_tried_with_every_other(file: Path) -> None:
    _write(file, f"<Deterministic>{_single('v', VALUES)}{_single('w', RANGE)}</Deterministic>")
    samples = _samples(_vary(file))
    assert len(samples) == 8
    assert samples[0] == {"v": 5.0, "w": 1.0}
    assert samples[-1]["w"] == pytest.approx(1.3)


def test_a_run_takes_the_first_values(file: Path) -> None:
    _write(file, f"<Deterministic>{_sets('n=3 name=y', 'n=4')}{_single('v', VALUES)}</Deterministic>")
    found = compile_target(file, {}, Diagnostics())
    assert found is not None
    event_of_first = found.plan.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0]
    assert (event_of_first.name, event_of_first.maximum_execution_count) == ("y", 3)
    assert {one.name: one.default for one in found.plan.parameters} == {"v": "5", "w": "1"}


def test_value_sets_are_counted(file: Path) -> None:
    _write(file, f"<Deterministic>{_sets('n=3 name=y', 'n=4')}{_sets('v=1', 'v=2', 'v=3')}</Deterministic>")
    vary = _vary(file)
    assert [axis.parameter for axis in vary.axes] == ["parameter_set", "parameter_set_2"]
    assert len(_samples(vary)) == 6
    second = compile_target(file, {"parameter_set": "1", "parameter_set_2": "2"}, Diagnostics())
    assert second is not None
    assert second.plan.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0].name == "x"
    assert {one.name: one.default for one in second.plan.parameters}["v"] == "3"
    sink = Diagnostics()
    compile_target(file, {"parameter_set": "2"}, sink)
    assert [one.code.id for one in sink] == ["SC111"]


def test_values_that_no_list_can_hold_are_counted(file: Path) -> None:
    values = "<DistributionSet><Element value='a, b'/><Element value='c'/></DistributionSet>"
    _write(file, f"<Deterministic>{_single('name', values)}</Deterministic>")
    assert [axis.parameter for axis in _vary(file).axes] == ["name_number"]
    found = compile_target(file, {}, Diagnostics())
    assert found is not None
    assert found.plan.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0].name == "a, b"


LIMITS = "<Range lowerLimit='1' upperLimit='4'/>"


@pytest.mark.parametrize(
    ("inside", "axis"),
    [
        (f"<UniformDistribution>{LIMITS}</UniformDistribution>", Uniform(parameter="v", least=1, greatest=4)),
        (
            f"<NormalDistribution expectedValue='2' variance='4'>{LIMITS}</NormalDistribution>",
            Normal(parameter="v", mean=2, deviation=2, least=1, greatest=4),
        ),
        ("<NormalDistribution expectedValue='2' variance='4'/>", Normal(parameter="v", mean=2, deviation=2)),
        ("<PoissonDistribution expectedValue='2'/>", Poisson(parameter="v", mean=2)),
        (
            "<Histogram><Bin weight='3'><Range lowerLimit='2' upperLimit='4'/></Bin>"
            "<Bin weight='1'><Range lowerLimit='0' upperLimit='1'/></Bin></Histogram>",
            Histogram(parameter="v", edges=(0, 1, 2, 4), weights=(1, 0, 3)),
        ),
        (
            "<ProbabilityDistributionSet><Element value='5' weight='1'/><Element value='7' weight='3'/>"
            "</ProbabilityDistributionSet>",
            Weighted(parameter="v", of=("5", "7"), weights=(1, 3)),
        ),
    ],
)
def test_distributions_are_drawn_from(file: Path, inside: str, axis: Axis) -> None:
    _write(file, f"<Stochastic numberOfTestRuns='40' randomSeed='9'>{_drawn('v', inside)}</Stochastic>")
    vary = _vary(file)
    assert vary.axes == (axis,)
    assert (vary.samples, vary.seed) == (40, 9)
    assert len({sample["v"] for sample in _samples(vary)}) > 1


def test_a_lognormal_distribution_has_the_moments_of_its_values(file: Path) -> None:
    inside = "<LogNormalDistribution expectedValue='2' variance='1'/>"
    _write(file, f"<Stochastic numberOfTestRuns='1'>{_drawn('v', inside)}</Stochastic>")
    (axis,) = _vary(file).axes
    assert isinstance(axis, Lognormal)
    assert math.exp(axis.mu + axis.sigma**2 / 2) == pytest.approx(2.0)
    assert math.expm1(axis.sigma**2) * math.exp(2 * axis.mu + axis.sigma**2) == pytest.approx(1.0)


@pytest.mark.parametrize("lower", [0.0, -1.0])
def test_a_lognormal_distribution_may_be_cut_off_at_or_below_0(file: Path, lower: float) -> None:
    """That limit has no effect: a third of the draws are in the lower third of all values below 5."""
    inside = f"<Range lowerLimit='{lower}' upperLimit='5'/>"
    drawn = f"<LogNormalDistribution expectedValue='2' variance='1'>{inside}</LogNormalDistribution>"
    _write(file, f"<Stochastic numberOfTestRuns='4'>{_drawn('v', drawn)}</Stochastic>")
    (axis,) = _vary(file).axes
    assert isinstance(axis, Lognormal)
    of_all = NormalDist(axis.mu, axis.sigma)
    quantile = parse_distribution(axis.spelling().partition("=")[2]).quantile(1.0 / 3.0)
    assert quantile == pytest.approx(math.exp(of_all.inv_cdf(of_all.cdf(math.log(5.0)) / 3.0)))


def test_a_range_cuts_a_poisson_distribution_off(file: Path) -> None:
    inside = f"<PoissonDistribution expectedValue='2'>{LIMITS}</PoissonDistribution>"
    _write(file, f"<Stochastic numberOfTestRuns='60'>{_drawn('v', inside)}</Stochastic>")
    assert {sample["v"] for sample in _samples(_vary(file))} == {1.0, 2.0, 3.0, 4.0}


@pytest.mark.parametrize(
    "inside",
    [
        "<Deterministic>" + _single("v", "<DistributionSet/>") + "</Deterministic>",
        "<Deterministic>" + _single("v", RANGE.replace("0.1", "0")) + "</Deterministic>",
        "<Deterministic>" + _single("v", RANGE.replace("1.3", "0.3")) + "</Deterministic>",
        "<Deterministic>" + _single("v", RANGE.replace("0.1", "1e-9")) + "</Deterministic>",
        "<Deterministic>" + _single("v", "<UserDefinedDistribution type='x'/>") + "</Deterministic>",
        "<Stochastic>" + _drawn("v", "<UserDefinedDistribution type='x'/>") + "</Stochastic>",
        "<Stochastic>" + _drawn("v", "<UniformDistribution/>") + "</Stochastic>",
        "<Stochastic>" + _drawn("v", "<NormalDistribution expectedValue='1' variance='0'/>") + "</Stochastic>",
        "<Stochastic>" + _drawn("v", "<LogNormalDistribution expectedValue='0' variance='1'/>") + "</Stochastic>",
        "<Stochastic>" + _drawn("v", "<PoissonDistribution expectedValue='-1'/>") + "</Stochastic>",
        "<Stochastic>" + _drawn("v", "<Histogram/>") + "</Stochastic>",
        "<Stochastic>" + _drawn("v", "<ProbabilityDistributionSet/>") + "</Stochastic>",
    ],
)
def test_unusable_distributions_are_reported(file: Path, inside: str) -> None:
    _write(file, inside)
    sink = Diagnostics()
    assert read_source(file, sink) is not None
    assert "SC755" in {one.code.id for one in sink}


@pytest.mark.parametrize("path", ["base.xosc", "elsewhere/base.xosc", ""])
def test_a_missing_scenario_is_reported(file: Path, path: str) -> None:
    _write(file, f"<Deterministic>{_single('v', VALUES)}</Deterministic>", path)
    sink = Diagnostics()
    assert read_source(file, sink) is None
    assert "SC754" in {one.code.id for one in sink}


def test_unknown_parameters_are_reported_at_their_places(file: Path) -> None:
    _write(file, f"<Deterministic>{_single('nobody', VALUES)}</Deterministic>")
    sink = Diagnostics()
    compile_target(file, {}, sink)
    assert [(one.code.id, one.place.file) for one in sink] == [("SC211", str(file))]


BINS = "<Bin weight='{}'><Range lowerLimit='0' upperLimit='3'/></Bin><Bin weight='1'><Range {}/></Bin>"
LATER = "lowerLimit='3' upperLimit='4'"


@pytest.mark.parametrize(
    ("inside", "fault"),
    [
        (f"<UniformDistribution>{LIMITS.replace('4', '0')}</UniformDistribution>", "whose upper limit is not below"),
        ("<NormalDistribution expectedValue='1' variance='0'/>", "its variance must be above 0"),
        ("<LogNormalDistribution expectedValue='0' variance='1'/>", "its expected value and its variance"),
        ("<LogNormalDistribution expectedValue='1e-4' variance='1'/>", "too great for its expected value"),
        (
            "<LogNormalDistribution expectedValue='2' variance='1'><Range lowerLimit='-2' upperLimit='0'/>"
            "</LogNormalDistribution>",
            "its range contains no value above 0",
        ),
        ("<PoissonDistribution expectedValue='-1'/>", "its expected value must be above 0"),
        (
            "<PoissonDistribution expectedValue='2'><Range lowerLimit='1.2' upperLimit='1.8'/></PoissonDistribution>",
            "its range contains no whole number",
        ),
        (f"<Histogram>{BINS.format(1, LATER.replace('3', '2'))}</Histogram>", "its bins overlap below 3"),
        (f"<Histogram>{BINS.format(-1, LATER)}</Histogram>", "its weights must not be below 0"),
        (
            "<ProbabilityDistributionSet><Element value='1' weight='-1'/><Element value='2' weight='2'/>"
            "</ProbabilityDistributionSet>",
            "its weights must not be below 0",
        ),
    ],
)
def test_the_reason_is_given_once(file: Path, inside: str, fault: str) -> None:
    _write(file, f"<Stochastic numberOfTestRuns='1'>{_drawn('v', inside)}</Stochastic>")
    sink = Diagnostics()
    assert read_source(file, sink) is not None
    (message,) = (one.message for one in sink if one.code.id == "SC755")
    assert fault in message


@pytest.mark.parametrize(
    "inside",
    [
        _single("v", VALUES) + _single("v", RANGE),
        _sets("v=1 n=2", "v=2") + _single("n", VALUES),
        _sets("v=1 n=2", "v=2") + _sets("w=1", "n=3"),
    ],
)
def test_a_parameter_that_is_varied_twice_is_reported_at_its_second_place(file: Path, inside: str) -> None:
    _write(file, f"<Deterministic>{inside}</Deterministic>".replace("><", ">\n<"))
    sink = Diagnostics()
    read_source(file, sink)
    text = file.read_text(encoding="utf-8").splitlines()
    (found,) = sink
    assert (found.code.id, found.place.file) == ("SC755", str(file))
    assert "is varied twice" in found.message
    assert found.place.line > len(text) / 2


def _listed(*values: str) -> str:
    return "<DistributionSet>" + "".join(f"<Element value='{one}'/>" for one in values) + "</DistributionSet>"


@pytest.mark.parametrize(
    ("inside", "reported"),
    [
        (_single("v", _listed("1", "x", "2.5")), ["'x', a value of 'v', is not of the type double"]),
        (_single("n", _listed("1", "1.5")), ["'1.5', a value of 'n', is not of the type integer"]),
        (_single("name", _listed("1", "x")), []),
        (_sets("n=2 name=y", "n=x"), ["'x', a value of 'n', is not of the type integer"]),
        (_single("n", RANGE), ["'n' is of the type integer, which needs whole numbers"]),
        (_single("n", RANGE.replace("0.1", "1").replace("1.3", "4")), []),
        (_single("name", RANGE), ["'name' is of the type string, which only a list of values varies"]),
    ],
)
def test_values_of_another_type_than_the_parameter_are_reported(file: Path, inside: str, reported: list[str]) -> None:
    _write(file, f"<Deterministic>{inside}</Deterministic>")
    sink = Diagnostics()
    read_source(file, sink)
    assert [one.message for one in sink] == reported
    assert all((one.code.id, one.place.file) == ("SC755", str(file)) for one in sink)


@pytest.mark.parametrize(
    ("inside", "reported"),
    [
        (f"<Deterministic>{_single('v', _listed('8', '30', '100'))}</Deterministic>", ["30"]),
        (f"<Deterministic>{_single('v', _listed('30', '8'))}</Deterministic>", ["30"]),
        (f"<Deterministic>{_sets('v=8 n=2', 'v=4')}</Deterministic>", ["4"]),
        (f"<Deterministic>{_single('v', RANGE.replace('0.1', '2').replace('1.3', '9'))}</Deterministic>", ["1"]),
        (
            f"<Stochastic numberOfTestRuns='4'>{_drawn('v', f'<UniformDistribution>{LIMITS}</UniformDistribution>')}"
            "</Stochastic>",
            ["1", "4"],
        ),
    ],
)
def test_values_that_meet_no_constraint_group_are_reported(file: Path, inside: str, reported: list[str]) -> None:
    base = file.parent / "scenarios" / "base.xosc"
    rules = (("greaterThan", 5), ("lessThan", 25)), (("equalTo", 100),)
    groups = "".join(
        "<ConstraintGroup>"
        + "".join(f'<ValueConstraint rule="{rule}" value="{value}"/>' for rule, value in group)
        + "</ConstraintGroup>"
        for group in rules
    )
    text = base.read_text(encoding="utf-8")
    declared = '<ParameterDeclaration name="v" parameterType="double" value="2"'
    assert f"{declared}/>" in text
    constrained = f"{declared.replace('2', '10')}>{groups}</ParameterDeclaration>"
    base.write_text(text.replace(f"{declared}/>", constrained), encoding="utf-8")
    _write(file, inside)
    sink = Diagnostics()
    assert compile_target(file, {}, sink) is not None
    assert [one.message.split()[2].rstrip(",") for one in sink if one.code.id == "SC742"] == reported
    assert all(one.place.file == str(file) for one in sink if one.code.id == "SC742")


def test_draws_of_fractions_for_an_integer_are_reported(file: Path) -> None:
    uniform, poisson = (
        f"<UniformDistribution>{LIMITS}</UniformDistribution>",
        "<PoissonDistribution expectedValue='2'/>",
    )
    for inside, reported in ((uniform, ["SC755"]), (poisson, [])):
        _write(file, f"<Stochastic numberOfTestRuns='4'>{_drawn('n', inside)}</Stochastic>")
        sink = Diagnostics()
        read_source(file, sink)
        assert [one.code.id for one in sink] == reported


def test_a_value_s_faults_are_reported_in_the_file_that_gives_it(file: Path) -> None:
    _write(file, f"<Deterministic>{_single('n', _listed('x', '2'))}</Deterministic>")
    sink = Diagnostics()
    compile_target(file, {}, sink)
    assert [one.place.file for one in sink if one.code.id == "SC743"] == [str(file)]
    sink = Diagnostics()
    compile_target(file, {"n": "y"}, sink)
    assert [one.place.file for one in sink if one.code.id == "SC743"] == ["--set"]


def test_faults_of_the_structure_are_warnings_in_a_run(file: Path) -> None:
    drawn = _drawn("w", f"<UniformDistribution>{LIMITS}</UniformDistribution>")
    _write(
        file,
        f"<Deterministic>{_single('v', VALUES)}</Deterministic><Stochastic numberOfTestRuns='-4'>{drawn}</Stochastic>",
    )
    sink = Diagnostics()
    assert compile_target(file, {}, sink) is not None
    structure = {(one.code.id, one.severity.value) for one in sink if one.place.file == str(file)}
    assert structure == {("SC704", "warning"), ("SC705", "warning")}


def test_the_whole_part_of_a_seed_is_used(file: Path) -> None:
    drawn = _drawn("w", f"<UniformDistribution>{LIMITS}</UniformDistribution>")
    for written, seed, reported in (("3.7", 3, ["SC750"]), ("3.0", 3, []), ("-2", -2, [])):
        _write(file, f"<Stochastic numberOfTestRuns='1' randomSeed='{written}'>{drawn}</Stochastic>")
        sink = Diagnostics()
        vary = variation_of(file, {}, sink)
        assert vary is not None
        assert (vary.seed, [one.code.id for one in sink]) == (seed, reported)
