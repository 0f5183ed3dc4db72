"""The driver's response: the distribution of each preset, each effect, the person, and the stages before the input."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.ego.answering import plan_answer, takeover_time
from scenario_compiler.engine.program import build_program
from scenario_compiler.recording.recording import Floats

DRAWS = 10_000
Law = Callable[[Floats], Floats]


@pytest.fixture
def program_of(tmp_path: Path) -> Callable[..., Program]:
    """Return what makes the program of a scenario with this in its takeover, at values of its parameters."""

    def made(takeover: str, budget: float = 7.0, **parameters: float) -> Program:
        declared = "".join(f'<parameter name="{k}" type="number" default="{v}"/>' for k, v in parameters.items())
        file = tmp_path / "made.xml"
        file.write_text(
            f'<scenarios version="1"><scenario name="s" map="town_grid" duration="10">{declared}'
            '<ego speed="10"><start><lane road="1" lane="-1" s="20"/></start></ego>'
            f'<takeover budget="{budget}">{takeover}</takeover></scenario></scenarios>',
            encoding="utf-8",
        )
        sink = Diagnostics()
        done = compile_target(file, {}, sink)
        assert done is not None, [as_text(one) for one in sink]
        return build_program(done.plan, done.network)

    return made


def answers(p: Program, request: int = 1, cause: int = op.CAUSE_NONE) -> Floats:
    """Return the takeover times at one request of many runs, s."""
    state = new_state(p)
    times = []
    for k in range(DRAWS):
        state.draw[:] = make_draws(1, k)
        state.requests[0] = request
        state.cause[0] = cause
        times.append(takeover_time(p, state))
    return np.array(times)


def lognormal(mu: float, sigma: float, late: float, latest: float, share: float = 1.0) -> Law:
    """Return the distribution of a lognormal body with late answers, multiplied by `share`."""

    def law(t: Floats) -> Floats:
        place = np.log(t / share)
        body = stats.norm.cdf((place - mu) / sigma)
        return np.asarray((1 - late) * body + late * np.clip((place - mu) / (math.log(latest) - mu), 0, 1))

    return law


def mean_of(mu: float, sigma: float, late: float, latest: float) -> float:
    """Return that distribution's mean, by integration."""
    body = stats.lognorm(sigma, scale=math.exp(mu)).mean()
    reached = stats.loguniform(math.exp(mu), latest).mean()
    return float((1 - late) * body + late * reached)


def accepted(times: Floats, law: Law) -> bool:
    """Return whether a Kolmogorov-Smirnov test at 1 % accepts that times follow a law."""
    return bool(stats.kstest(times, law).pvalue > 0.01)


STUDY_MEANS = (0.877, 0.481, 0.004, 19.79)
UNHURRIED = (1.5058, 0.2529, 0.04, 25.75)


@pytest.mark.parametrize(
    ("preset", "median", "spread", "greatest"),
    [("unhurried", 4.567, 1.632, 25.75), ("unhurried_with_task", 6.061, 2.393, 20.994), ("mixed", 2.470, 1.415, 15.0)],
)
def test_medians_and_quartiles_are_those_that_eriksson_and_stanton_print(
    program_of: Callable[..., Program], preset: str, median: float, spread: float, greatest: float
) -> None:
    times = answers(program_of(f'<driver preset="{preset}"/>'))
    low, middle, high = np.quantile(times, [0.25, 0.5, 0.75])
    assert middle == pytest.approx(median, rel=0.02)
    assert high - low == pytest.approx(spread, rel=0.02)
    assert 0.8 * greatest < times.max() <= greatest


def test_mean_and_standard_deviation_are_those_that_zhang_prints(program_of: Callable[..., Program]) -> None:
    times = answers(program_of(""))
    assert times.mean() == pytest.approx(2.72, rel=0.02)
    assert times.std() == pytest.approx(1.45, rel=0.05)


EFFECTS = [
    ('<driver task="handheld"/>', 7.0, 1, 1.33),
    ('<driver task="visual"/>', 7.0, 1, 0.29),
    ('<driver task="none"/>', 7.0, 1, 0.0),
    ('<driver eyes_closed="true"/>', 7.0, 1, 1.19),
    ('<driver/><message modality="text icon"/>', 7.0, 1, 1.41),
    ('<driver/><message modality="text"/><message modality="vibration"/>', 7.0, 1, 0.0),
    ('<driver/><message modality="none"/>', 7.0, 1, 0.58),
    ("<driver/>", 7.0, 1, 0.0),
    ("<driver/>", 7.0, 2, -1.0),
    ("<driver/>", 7.0, 6, -1.0),
    ("<driver/>", 5.0, 1, -0.54),
    ("<driver/>", 60.0, 1, 0.81),
    ('<driver traffic_density="20"><effect of="traffic_density" by="0.05"/></driver>', 7.0, 1, 1.0),
    ('<driver task="handheld" eyes_closed="true"><effect of="handheld_task" by="0.5"/></driver>', 7.0, 2, 0.69),
]


@pytest.mark.parametrize(("takeover", "budget", "request_number", "added"), EFFECTS)
def test_each_effect_moves_the_mean_and_keeps_the_shape(
    program_of: Callable[..., Program], takeover: str, budget: float, request_number: int, added: float
) -> None:
    before = mean_of(*STUDY_MEANS)
    times = answers(program_of(takeover, budget), request_number)
    assert accepted(times, lognormal(*STUDY_MEANS, share=(before + added) / before))
    assert times.mean() == pytest.approx(before + added, abs=0.06)


@pytest.mark.parametrize(
    ("cause", "added"), [(op.CAUSE_PATH_BLOCKED, -0.54), (op.CAUSE_LANE_ENDS, 0.54), (op.CAUSE_LANE_CONFIDENCE, 0.0)]
)
def test_the_budget_is_that_of_the_requests_cause(program_of: Callable[..., Program], cause: int, added: float) -> None:
    """Before, a driver who had 5 s for an obstacle took as long as one with the 7 s of the policy."""
    own = '<cause kind="path_blocked" budget="5"/><cause kind="lane_ends" budget="9"/><cause kind="lane_confidence"/>'
    assert answers(program_of(f"{own}<driver/>"), cause=cause).mean() == pytest.approx(
        mean_of(*STUDY_MEANS) + added, abs=0.06
    )
    if cause == op.CAUSE_PATH_BLOCKED:
        assert answers(program_of(f'{own}<driver preset="sumo_toc"/>'), cause=cause).mean() == pytest.approx(
            3.5, abs=0.1
        )


def test_a_task_of_the_measurements_is_not_added_again(program_of: Callable[..., Program]) -> None:
    plain = program_of('<driver preset="unhurried_with_task"/>')
    for driver, added in (('task="visual"', 0.0), ('task="handheld"', 1.04), ('task="none"', -0.29)):
        other = program_of(f'<driver preset="unhurried_with_task" {driver}/>')
        assert answers(other).mean() - answers(plain).mean() == pytest.approx(added, abs=0.01)


def test_the_budget_makes_no_difference_where_there_was_none(program_of: Callable[..., Program]) -> None:
    takeover = '<driver preset="unhurried"/>'
    assert accepted(answers(program_of(takeover, 4.0)), lognormal(*UNHURRIED))


@pytest.mark.parametrize(("budget", "mean"), [(4.0, 2.8), (7.0, 4.9), (10.0, 2.0 * math.sqrt(10.0))])
@pytest.mark.parametrize("request_number", [1, 2])
def test_sumos_law(program_of: Callable[..., Program], budget: float, mean: float, request_number: int) -> None:
    times = answers(program_of('<driver preset="sumo_toc"/>', budget), request_number)
    deviation = (budget - mean) / stats.norm.ppf(0.95)
    assert accepted(times, stats.truncnorm(-mean / deviation, np.inf, mean, deviation).cdf)
    assert np.mean(times > budget) == pytest.approx(0.05, abs=0.007)


def test_a_studys_own_regression_is_an_expression(program_of: Callable[..., Program]) -> None:
    model = '<driver_model name="own" law="normal" mu="${1.5 + 0.3 * $b - 0.02 * $age}" sigma="${0.1 * $b}"/>'
    mean, deviation = 1.5 + 0.3 * 5 - 0.02 * 40, 0.5
    assert accepted(
        answers(program_of(model, b=5, age=40)), stats.truncnorm(-mean / deviation, np.inf, mean, deviation).cdf
    )


def test_requests_of_one_person_are_correlated_and_never_the_same(program_of: Callable[..., Program]) -> None:
    p = program_of('<driver_model name="own" mu="1" sigma="0.3" person="0.6"/>')
    logs = np.log([answers(p, request) for request in (2, 5, 9)])
    assert np.corrcoef(logs)[np.triu_indices(3, 1)] == pytest.approx([0.6] * 3, abs=0.02)
    assert not np.isclose(logs[0], logs[1]).any()


def test_after_a_lapse_there_is_no_response_and_a_fixed_time_is_unchanged(program_of: Callable[..., Program]) -> None:
    assert np.mean(answers(program_of('<driver preset="unreliable"/>')) == op.FAR) == pytest.approx(0.05, abs=0.007)
    assert set(answers(program_of('<driver takeover_time="2" task="handheld"/>'), 2)) == {2.0}
    assert set(answers(program_of('<driver preset="absent"/>'))) == {op.FAR}


def test_eyes_come_first_then_hands_then_the_first_input(program_of: Callable[..., Program]) -> None:
    p = program_of('<driver_model name="own" mu="1" sigma="0.3" eyes_on="0.25" hands_on="0.5" stage_spread="0.5"/>')
    state = new_state(p)
    shares = []
    for k in range(2000):
        state.draw[:] = make_draws(1, k)
        state.requests[0] = 1
        plan_answer(p, state)
        assert 0.0 < state.eyes_on_at[0] < state.hands_on_at[0] < state.answer_at[0]
        eyes = state.eyes_on_at[0]
        shares.append((eyes / state.answer_at[0], (state.hands_on_at[0] - eyes) / (state.answer_at[0] - eyes)))
    assert np.median(shares, axis=0) == pytest.approx([0.25, 0.5], abs=0.01)
    assert np.std(np.log(shares) - np.log1p(-np.array(shares)), axis=0) == pytest.approx([0.5, 0.5], abs=0.03)
