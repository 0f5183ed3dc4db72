"""Samples: the distributions' moments, the evenness of the methods, and the dependence on seed and index."""

from __future__ import annotations

import math
import statistics
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.batch.distributions import SweepError, misfit, parse_distribution
from scenario_compiler.batch.sampling import latin_hypercube, make_sampler, sobol
from scenario_compiler.batch.spec import Method, SweepSpec
from scenario_compiler.vocabulary.scenario import ParameterKind


def _values(text: str, count: int = 4001) -> list[float]:
    quantile = parse_distribution(text).quantile
    return [float(quantile((k + 0.5) / count)) for k in range(count)]


@pytest.mark.parametrize(
    ("text", "mean", "deviation"),
    [
        ("uniform(5, 40)", 22.5, 35 / math.sqrt(12)),
        ("normal(10, 2)", 10.0, 2.0),
        ("lognormal(0.5, 0.4)", math.exp(0.58), math.exp(0.58) * math.sqrt(math.exp(0.16) - 1)),
        ("triangular(0, 1, 4)", 5 / 3, math.sqrt((0 + 1 + 16 - 0 - 0 - 4) / 18)),
        ("poisson(3.5)", 3.5, math.sqrt(3.5)),
        ("histogram(0, 1, 10, 3, 20)", 12.5, math.sqrt(100 / 12 + 100 * 3 / 16)),
        ("choice(10, 20, 30)", 20.0, 10 * math.sqrt(2 / 3)),
        ("values(10, 20, 30)", 20.0, 10 * math.sqrt(2 / 3)),
        ("weighted(10, 1, 20, 0, 30, 3)", 25.0, 10 * math.sqrt(3 / 4)),
    ],
)
def test_a_distribution_has_its_moments(text: str, mean: float, deviation: float) -> None:
    values = _values(text)
    assert statistics.fmean(values) == pytest.approx(mean, rel=5e-3)
    assert statistics.pstdev(values) == pytest.approx(deviation, rel=2e-2)


def test_limits_cut_a_distribution_off() -> None:
    values = _values("normal(0, 1, -1, 2)")
    assert -1.0 <= min(values) < -0.99
    assert 1.9 < max(values) <= 2.0
    assert all(1.0 <= value <= 3.0 for value in _values("lognormal(0, 2, 1, 3)"))


def _mean_beyond(limit: float) -> float:
    """Return the mean of the standard normal tail beyond a limit, by Laplace's asymptotic series of Mills' ratio."""
    return limit / (1.0 - limit**-2 + 3.0 * limit**-4 - 15.0 * limit**-6)


@pytest.mark.parametrize("away", [6.0, 12.0, 30.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_limits_far_from_the_mean_cut_a_tail_off(away: float, side: float) -> None:
    low, high = sorted((side * away, side * (away + 5.0)))
    values = [abs(value) for value in _values(f"normal(0, 1, {low}, {high})")]
    assert statistics.fmean(values) == pytest.approx(_mean_beyond(away), rel=1e-4)
    assert len(set(values)) == len(values)


def test_a_lognormal_distribution_has_far_limits_too() -> None:
    logarithms = map(math.log, _values("lognormal(0, 0.1, 3, 9)"))
    assert statistics.fmean(logarithms) == pytest.approx(0.1 * _mean_beyond(10.0 * math.log(3.0)), rel=1e-4)


@pytest.mark.parametrize("text", ["normal(100, 1, 200, 300)", "normal(0, 1, -60, -50)", "lognormal(0, 0.01, 2, 3)"])
def test_limits_without_probability_are_refused(text: str) -> None:
    with pytest.raises(SweepError, match="too many standard deviations away"):
        parse_distribution(text)


@pytest.mark.parametrize("text", ["poisson(3.5)", "histogram(0, 1, 10, 0, 15, 3, 20)", "triangular(2, 2, 5)"])
@given(low=st.floats(1e-12, 1 - 1e-12), high=st.floats(1e-12, 1 - 1e-12))
def test_quantiles_rise(text: str, low: float, high: float) -> None:
    quantile = parse_distribution(text).quantile
    assert float(quantile(min(low, high))) <= float(quantile(max(low, high)))


@pytest.mark.parametrize(
    "text",
    ["uniform", "uniform()", "uniform(3)", "uniform(4, 3)", "normal(0, 0)", "poisson(0)", "grid(1, 2, 2.5)",
     "weighted(1)", "weighted(1, 0)", "weighted(1, -1, 2, 3)",
     "histogram(0, 1)", "histogram(0, 1, 0)", "choice()", "choice(1,,2)", "gauss(1, 2)", "uniform(1, x)",
     "lognormal(0, 1, -1, 2)", "uniform(1, inf)", "triangular(3, 1, 2)"],
)  # fmt: skip
def test_a_wrong_distribution_is_refused(text: str) -> None:
    with pytest.raises(SweepError):
        parse_distribution(text)


def test_a_misspelt_distribution_gets_a_suggestion() -> None:
    with pytest.raises(SweepError, match=r"'unform\(1, 2\)' is not a distribution \(did you mean 'uniform'\?\)"):
        parse_distribution("unform(1, 2)")


def test_choices_keep_their_type() -> None:
    assert parse_distribution("choice(1, 2.5)").points == (1.0, 2.5)
    assert parse_distribution("choice(true, false)").points == (True, False)
    assert parse_distribution("choice(a, 2)").points == ("a", "2")
    assert parse_distribution("weighted(a, 1, 2, 1)").points == ("a", "2")
    assert parse_distribution("values(a, 2)").listed


@pytest.mark.parametrize(
    ("text", "fitting"),
    [
        ("uniform(1, 5)", {"length"}),
        ("histogram(1, 1, 2)", {"length"}),
        ("poisson(2)", {"length", "integer"}),
        ("grid(1, 5, 3)", {"length", "integer", "text"}),
        ("grid(1, 2, 3)", {"length", "text"}),
        ("choice(1, 2)", {"length", "integer", "text"}),
        ("weighted(1, 2, 2.5, 1)", {"length", "text"}),
        ("values(true, false)", {"boolean", "text"}),
        ("choice(a, 1)", {"text"}),
    ],
)
def test_a_distribution_fits_the_kinds_whose_values_it_gives(text: str, fitting: set[str]) -> None:
    kinds: tuple[ParameterKind, ...] = ("length", "integer", "text", "boolean")
    assert {kind for kind in kinds if not misfit(parse_distribution(text), kind)} == fitting


def test_a_random_sample_depends_on_seed_and_index_only() -> None:
    short = make_sampler(SweepSpec(vary=("a=uniform(0, 1)",), samples=3))
    long = make_sampler(SweepSpec(vary=("b=normal(0, 1)", "a=uniform(0, 1)"), samples=300))
    assert [short.sample(k)["a"] for k in range(3)] == [long.sample(k)["a"] for k in range(3)]
    other = make_sampler(SweepSpec(vary=("a=uniform(0, 1)",), samples=3, seed=2))
    assert short.sample(1) != other.sample(1)


@pytest.mark.parametrize("method", ["random", "latin", "sobol"])
def test_a_grid_axis_is_crossed_with_the_draws(method: Method) -> None:
    vary = ("a=grid(1, 3, 3)", "b=grid(0, 10, 2)", "c=uniform(0, 1)")
    sampler = make_sampler(SweepSpec(vary=vary, method=method, samples=4))
    rows = [sampler.sample(k) for k in range(sampler.total)]
    pairs = [(1.0, 0.0), (1.0, 10.0), (2.0, 0.0), (2.0, 10.0), (3.0, 0.0), (3.0, 10.0)]
    assert [(row["a"], row["b"]) for row in rows] == 4 * pairs
    draws = [{row["c"] for row in rows[start : start + 6]} for start in range(0, 24, 6)]
    assert [len(draw) for draw in draws] == [1, 1, 1, 1]
    assert len(set.union(*draws)) == 4


def test_a_draw_is_made_again_only_where_it_breaks_a_constraint() -> None:
    vary = ("a=values(0.5, 1)", "c=uniform(0, 1)")
    free, bound = (make_sampler(SweepSpec(vary=vary, samples=20, where=where)) for where in ((), ("c < a",)))
    again = [free.sample(k) != bound.sample(k) for k in range(40)]
    assert again == [float(free.sample(k)["c"]) >= float(free.sample(k)["a"]) for k in range(40)]
    assert 0 < sum(again) < 20


@pytest.mark.parametrize(("first", "last"), [(0.3, 0.9), (0.1, 1.9), (1.1, 6.7), (0.9, 0.3)])
@pytest.mark.parametrize("count", [2, 3, 11])
def test_a_grid_ends_at_its_ends_to_the_bit(first: float, last: float, count: int) -> None:
    points = [float(value) for value in parse_distribution(f"grid({first}, {last}, {count})").points]
    assert (points[0], points[-1], len(points)) == (first, last, count)


def test_a_grid_of_one_value_is_the_first() -> None:
    assert parse_distribution("grid(2, 8, 1)").points == (2.0,)


@pytest.mark.parametrize("method", ["random", "grid"])
def test_listed_points_are_run_as_often_as_there_are_samples(method: Method) -> None:
    vary = ("n=grid(1, 10, 4)", "a=values(x, y)")
    sampler = make_sampler(SweepSpec(vary=vary, method=method, samples=50))
    found = [tuple(sampler.sample(k).values()) for k in range(sampler.total)]
    assert len(found) == 400
    assert found[:3] == [("x", 1.0), ("y", 1.0), ("x", 4.0)]
    assert {found.count(point) for point in found} == {50}
    assert make_sampler(SweepSpec(vary=vary, method=method)).total == 8


def test_a_grid_of_choices_needs_no_number_of_samples() -> None:
    sampler = make_sampler(SweepSpec(vary=("a=choice(x, y)", "n=grid(1, 10, 4)"), method="grid"))
    assert [tuple(sampler.sample(k).values()) for k in range(3)] == [(1.0, "x"), (4.0, "x"), (7.0, "x")]
    assert sampler.total == 8
    with pytest.raises(SweepError, match="a grid needs points"):
        make_sampler(SweepSpec(vary=("a=uniform(1, 2)",), method="grid"))


@pytest.mark.parametrize("method", ["random", "latin", "sobol"])
@pytest.mark.parametrize("where", [(), ("a < 0.5",)])
def test_repeats_have_the_same_values_and_other_seeds(method: Method, where: tuple[str, ...]) -> None:
    vary = ("n=values(1, 2)", "a=uniform(0, 1)")
    once, often = (
        make_sampler(SweepSpec(vary=vary, method=method, samples=8, where=where, seed=5, repeat=repeat))
        for repeat in (1, 3)
    )
    assert often.total == 3 * once.total
    for index in range(often.total):
        assert often.sample(index) == once.sample(index // 3)
        assert often.seed_of(index) == 5 + index % 3


def test_a_latin_hypercube_has_one_point_in_each_stratum() -> None:
    points = latin_hypercube(["a", "b"], 50, 1)
    for axis in (0, 1):
        assert sorted((points[:, axis] * 50).astype(int).tolist()) == list(range(50))


def test_sobol_points_are_more_even_than_random_ones() -> None:
    points = sobol(["a", "b"], 256, 3)
    counts = [0] * 16
    for x, y in points:
        counts[int(x * 4) * 4 + int(y * 4)] += 1
    assert max(counts) - min(counts) <= 4
    assert (sobol(["a", "b"], 100, 3) == points[:100]).all()


@pytest.mark.parametrize("method", ["random", "latin", "sobol"])
def test_every_sample_fulfils_the_constraints(method: Method) -> None:
    vary = ("a=uniform(0, 10)", "b=uniform(0, 10)")
    spec = SweepSpec(vary, method, samples=64, where=("a < b", "a + c > 3"))
    sampler = make_sampler(spec, {"c": 1.0})
    assert (sampler.total == 64) == (method == "random")
    for index in range(sampler.total):
        a, b = (float(value) for value in sampler.sample(index).values())
        assert a < b
        assert a > 2


def test_listed_points_that_no_draw_can_save_are_left_out() -> None:
    vary = ("a=values(1, 2, 3)", "b=grid(0, 2, 3)", "c=uniform(0, 1)")
    spec = SweepSpec(vary, samples=4, where=("a > b", "c > 0.5"), seed=3)
    sampler = make_sampler(spec)
    rows = [sampler.sample(index) for index in range(sampler.total)]
    pairs = [(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (3.0, 0.0), (3.0, 1.0), (3.0, 2.0)]
    assert [(row["a"], row["b"]) for row in rows] == 4 * pairs
    assert all(float(row["c"]) > 0.5 for row in rows)
    shorter = make_sampler(replace(spec, samples=2))
    assert [shorter.sample(index) for index in range(shorter.total)] == rows[: shorter.total]


def test_a_listed_value_that_no_draw_can_match_is_named() -> None:
    spec = SweepSpec(vary=("a=values(3, 1)", "c=uniform(0, 1)"), where=("a > 2 + c",))
    sampler = make_sampler(spec)
    assert sampler.sample(0)["a"] == 3.0
    with pytest.raises(SweepError, match=r"draws for a = 1$"):
        sampler.sample(1)


@pytest.mark.parametrize("where", ["a > 20", "a >", "a > nothing"])
def test_an_impossible_constraint_is_refused(where: str) -> None:
    with pytest.raises(SweepError, match=r"constraint|no sample"):
        make_sampler(SweepSpec(vary=("a=uniform(0, 10)",), samples=8, where=(where,))).sample(0)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("method", "halton"),
        ("samples", 0),
        ("repeat", 0),
        ("seed", 2**63),
        ("time_limit", 0.0),
        ("time_limit", math.nan),
    ],
)
def test_options_beyond_their_limits_are_refused(name: str, value: Any) -> None:
    with pytest.raises(SweepError, match=f"^{name} is .*, not "):
        SweepSpec(vary=(), **{name: value})


@pytest.mark.parametrize("vary", [("gap",), ("=uniform(1,2)",), ("a=uniform(0,1)", "a=uniform(0,1)")])
def test_a_wrong_axis_is_refused(vary: tuple[str, ...]) -> None:
    with pytest.raises(SweepError):
        make_sampler(SweepSpec(vary=vary))
