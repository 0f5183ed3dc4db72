"""A variant of a plan is refused where compiling with its values reports an error, and for the same reason."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.program import Numbers, build_program
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.expressions import Value, format_value
from scenario_compiler.languages import ScenarioNameNeededError
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import read_plan, write_plan
from scenario_compiler.plan.variants import VariantChecks
from scenario_compiler.randomness import uniform
from tests.plan.starts import parked_ahead

IDEAL = Overrides(perception="ideal")

CONFLICT = """<scenarios version="1">
  <template name="ahead">
    <parameter name="far" type="length" min="5" max="200"/>
    <static id="parked"><at><ahead_of entity="ego" distance="${2 * $far}"/></at></static>
  </template>
  <scenario name="short" map="town_grid" duration="3" step="0.05">
    <parameter name="s" type="length" default="20"/>
    <parameter name="speed" type="speed" default="10" max="40"/>
    <parameter name="far" type="length" default="30"/>
    <parameter name="turn" type="angle" default="1"/>
    <parameter name="due" type="time" default="2"/>
    <ego speed="$speed"><start><lane road="1" lane="-1" s="$s"/></start>
      <when><angle entity="ego" kind="heading" value="0" tolerance="$turn"/><do><stop/></do></when></ego>
    <use template="ahead" far="${sqrt($far)}"/>
    <dynamic id="walker" model="walker.pedestrian.0001">
      <start><lane road="1" lane="-1" s="200" offset="-0.5"/></start>
      <path><point time="1"><lane road="1" lane="-1" s="200"/></point>
            <point time="$due"><lane road="1" lane="-1" s="$s"/></point></path>
    </dynamic>
    <criteria><minimum_time_to_collision at_least="${$speed / 5}"/></criteria>
  </scenario>
</scenarios>
"""


def refused(target: str, values: dict[str, Value]) -> list[str]:
    """Return the errors of compiling with values."""
    sink = Diagnostics()
    compile_target(target, {name: format_value(value) for name, value in values.items()}, sink, overrides=IDEAL)
    return [one.message for one in sink if one.severity is Severity.ERROR]


def checks_of(target: str) -> tuple[Plan, VariantChecks]:
    """Return a plan at its defaults and the checks of its variants."""
    done = compile_target(target, {}, Diagnostics(), overrides=IDEAL)
    assert done is not None
    return done.plan, VariantChecks(done.plan, done.network)


@pytest.fixture
def conflict(tmp_path: Path) -> str:
    """File of a conflict whose numbers are limited in all ways that there are."""
    path = tmp_path / "short.xml"
    path.write_text(CONFLICT, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({}, ""),
        ({"speed": 0.0}, ""),
        ({"speed": -3.0}, "speed is -3, but must be at least 0"),
        ({"speed": 41.0}, "speed is 41, but must be at most 40"),
        ({"far": 24.0}, "far is 4.898979485566356, but must be at least 5"),
        ({"far": -1.0}, "sqrt(-1) has no value: a negative number has no root"),
        ({"s": -5.0}, "s is -5, but must be at least 0"),
        ({"s": 500.0}, "s = 500 m is outside road '1', which is 456.00 m long"),
        ({"turn": 0.0}, ""),
        ({"turn": -0.5}, "tolerance is -0.5, but must be at least 0"),
        ({"s": 198.0}, "'ego' and 'walker' overlap at the start"),
        ({"due": 0.5}, "the point is due at 0.5 s, but the one before at 1 s"),
    ],
)
def test_a_variant_is_refused_like_a_run(conflict: str, values: dict[str, Value], fault: str) -> None:
    _, checks = checks_of(conflict)
    errors = refused(conflict, values)
    assert checks.fault(values) == fault
    assert fault in errors if fault else not errors


def test_a_plan_s_file_keeps_the_limits(conflict: str, tmp_path: Path) -> None:
    plan, checks = checks_of(conflict)
    write_plan(plan, tmp_path / "plan.json")
    read = read_plan(tmp_path / "plan.json", Diagnostics())
    assert read is not None
    assert read.limits == plan.limits
    assert {limit.holder for limit in plan.limits} >= {"s", "speed", "far", "distance", "tolerance", "time", "at_least"}
    assert checks.fault({"speed": -1.0})


def _targets(library: Path) -> list[str]:
    found = []
    for file in sorted(library.glob("*.xml")):
        try:
            compile_target(str(file), {}, Diagnostics(), overrides=IDEAL)
            found.append(str(file))
        except ScenarioNameNeededError as several:
            found += [f"{file}#{name}" for name in several.names]
    return found


def doubts_start(done: Compilation, values: dict[str, Value]) -> bool:
    """Return whether a run leaves open if its start is sound: entities may overlap, or it has a fault."""
    program = build_program(done.plan, done.network)
    numbers = Numbers(done.plan, done.network).rows([values])
    summaries, _ = Simulation(done.network.tables, program).sweep(numbers, [make_draws(1)], 0)
    return bool(summaries[0, SUMMARY.index("start_tight")] or summaries[0, SUMMARY.index("flag")])


def test_variants_of_the_library_are_refused_as_runs_are(repository: Path) -> None:
    """Values from far below to far above what each parameter may have, of at most two parameters at a time."""
    outcomes = set()
    for target in _targets(repository / "library" / "conflicts")[::3]:
        done = compile_target(target, {}, Diagnostics(), overrides=IDEAL)
        assert done is not None
        plan, checks = done.plan, VariantChecks(done.plan, done.network)
        for k in range(4 if plan.parameters else 0):
            values: dict[str, Value] = {}
            for one in (plan.parameters[k % len(plan.parameters)], plan.parameters[-1]):
                usual = float(str(one.default))
                low, high = one.limits.minimum, one.limits.maximum
                low = usual - 3 * abs(usual) - 5 if low is None else low
                high = usual + 3 * abs(usual) + 5 if high is None else high
                values[one.name] = low + (high - low) * (1.6 * uniform(7, k, target + one.name) - 0.3)
            fault, errors = checks.fault(values), refused(target, values)
            assert fault in errors if fault else not errors, (target, values)
            outcomes.add(bool(fault))
    assert outcomes == {True, False}


@pytest.mark.parametrize(("distance", "sound"), [(0.5, False), (30.0, True), (9000.0, False)])
def test_a_run_does_not_hide_a_fault_of_its_start(tmp_path: Path, distance: float, sound: bool) -> None:
    path = parked_ahead(tmp_path)
    done = compile_target(str(path), {}, Diagnostics(), overrides=IDEAL)
    assert done is not None
    checks = VariantChecks(done.plan, done.network)
    assert checks.fault({"far": distance}, starts=False) == ""
    assert (checks.fault({"far": distance}) == "") == sound
    assert doubts_start(done, {"far": distance}) != sound
