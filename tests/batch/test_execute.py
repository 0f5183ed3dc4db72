"""Sweeps as a whole: a row says what its run says, and no split, interruption or worker changes a byte."""

from __future__ import annotations

import contextlib
import math
from pathlib import Path

import pytest

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import Progress, prepare, run_sweep
from scenario_compiler.batch.results import PARAMETER, read_results
from scenario_compiler.batch.runner import record
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.variants import with_values
from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import CompileError, Diagnostics
from scenario_compiler.recording.outcome import judge

LIBRARY = Path(__file__).parents[2] / "library" / "conflicts"
VARY = ("distance=uniform(10, 350)", "speed=choice(8, 13.9, 20)")


def _spec(**settings: object) -> SweepSpec:
    return SweepSpec.model_validate({"vary": VARY, "samples": 40, "perception": "ideal", **settings})


def _same(one: object, other: object) -> bool:
    return one == other or (other is None and isinstance(one, float) and math.isnan(one))


@pytest.mark.parametrize("form", ["interpreted", "compiled"])
def test_a_row_says_what_the_outcome_of_its_run_says(conflict: Path, tmp_path: Path, form: str) -> None:
    spec = _spec(samples=12, form=form, seed=5)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1)
    rows, about = read_results(tmp_path / "sweep")
    sweep = prepare(conflict, spec, Diagnostics())
    assert {"pass", "fail"} <= set(rows["result"])
    assert "driver" in rows["resolution"]
    for index in range(12):
        variant = sweep.variant(index, sweep.sampler.sample(index))
        family = sweep.families.base
        outcome = judge(with_values(family.plan, variant.values), record(family.plan, family.network, variant, 5))
        for name in ("result", "stop_reason", "duration", "resolution", "cause", "collision_with"):
            assert rows[name][index] == getattr(outcome, name), name
        for name, measure in outcome.measures.items():
            assert rows[name][index] == measure.value, name
        failed = [criterion.criterion for criterion in outcome.criteria if not criterion.passed]
        assert rows["failed"][index].split() == failed
        assert rows[PARAMETER + "distance"][index] == variant.values["distance"]
    assert about["measures"]["takeover_time"]["unit"] == "s"


@pytest.mark.parametrize("name", [path.stem for path in sorted(LIBRARY.glob("*.xml"))])
def test_library_conflicts_run_compiled_as_interpreted(name: str, tmp_path: Path) -> None:
    target = LIBRARY / f"{name}.xml"
    done = compile_target(target, {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert done is not None
    numbers = [one for one in done.plan.parameters if one.default]
    if not numbers:
        pytest.skip("the conflict has no parameter that stays a number")
    vary = tuple(f"{one.name}=uniform({0.9 * float(str(one.default))}, {one.default})" for one in numbers)
    tables = []
    for form in ("interpreted", "compiled"):
        spec = SweepSpec.model_validate({"vary": vary, "samples": 2, "perception": "ideal", "form": form})
        run_sweep(target, spec, tmp_path / form, workers=1)
        tables.append(read_results(tmp_path / form)[0])
    assert tables[0] == tables[1]


def test_no_split_changes_a_byte(conflict: Path, tmp_path: Path) -> None:
    contents = set()
    for workers in (1, 2):
        folder = tmp_path / str(workers)
        assert run_sweep(conflict, _spec(), folder, workers=workers).workers == workers
        contents.add((folder / "results.parquet").read_bytes())
    assert len(contents) == 1


def test_an_interrupted_sweep_is_resumed_to_the_same_bytes(conflict: Path, tmp_path: Path) -> None:
    class StopError(Exception):
        pass

    def stop(progress: Progress) -> None:
        if progress.done >= 20:
            raise StopError

    spec = _spec(samples=40)
    run_sweep(conflict, spec, tmp_path / "whole", workers=1)
    with contextlib.suppress(StopError):
        run_sweep(conflict, spec, tmp_path / "parts", workers=1, progress=stop)
    kept = list((tmp_path / "parts" / "parts").glob("*.parquet"))
    assert len(kept) == 2
    (kept[0].with_suffix(".parquet.tmp")).write_bytes(b"half a part")
    with pytest.raises(SweepError, match="--resume"):
        run_sweep(conflict, spec, tmp_path / "parts", workers=1)
    with pytest.raises(SweepError, match="another sweep: it differs in spec"):
        run_sweep(conflict, _spec(seed=2), tmp_path / "parts", workers=1, resume=True)
    seen: list[Progress] = []
    run_sweep(conflict, spec, tmp_path / "parts", workers=1, resume=True, progress=seen.append)
    assert seen[0].resumed == 32
    files = [sorted(p.name for p in (tmp_path / name).iterdir()) for name in ("whole", "parts")]
    assert files[0] == files[1]
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "parts")]
    assert tables[0] == tables[1]
    again = run_sweep(conflict, spec, tmp_path / "parts", workers=1, resume=True)
    assert (again.total, again.failed) == (40, 0)


def test_structure_makes_families_and_a_bad_one_costs_only_its_rows(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(vary=("preset=choice(urgent, nobody, absent)", "distance=grid(60, 80, 3)"), method="grid")
    result = run_sweep(conflict, spec, tmp_path / "sweep", workers=1)
    rows, _ = read_results(tmp_path / "sweep")
    assert rows[PARAMETER + "preset"] == ["urgent"] * 3 + ["nobody"] * 3 + ["absent"] * 3
    assert len(set(rows["digest"])) == 3
    assert result.failed == 3
    assert rows["error"][3:6] == ["there is no driver 'nobody'"] * 3
    assert rows["resolution"][:1] + rows["resolution"][-1:] == ["driver", "unanswered"]


def test_a_value_outside_its_limits_is_a_row_with_its_error(conflict: Path, tmp_path: Path) -> None:
    run_sweep(conflict, _spec(vary=("distance=grid(5, 60, 2)",)), tmp_path / "sweep", workers=1)
    rows, _ = read_results(tmp_path / "sweep")
    assert rows["result"] == ["error", "fail"]
    assert rows["error"][0] == "distance is 5, but must be at least 10"


@pytest.mark.parametrize("vary", [("distanse=uniform(1, 2)",), ()])
def test_a_wrong_sweep_writes_nothing(conflict: Path, tmp_path: Path, vary: tuple[str, ...]) -> None:
    with pytest.raises((CompileError, SweepError)):
        run_sweep(conflict, _spec(vary=vary), tmp_path / "sweep")
    assert not (tmp_path / "sweep").exists()


def test_other_files_are_left_alone(conflict: Path, tmp_path: Path) -> None:
    with pytest.raises(SweepError, match="holds no sweep"):
        run_sweep(conflict, _spec(), tmp_path)


def test_a_plan_is_swept_over_its_open_parameters(conflict: Path, tmp_path: Path) -> None:
    from scenario_compiler.plan.store import write_plan

    done = compile_target(conflict, {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert done is not None
    write_plan(done.plan, tmp_path / "plan.json")
    tables = []
    for target, perception in ((conflict, "ideal"), (tmp_path / "plan.json", None)):
        folder = tmp_path / target.suffix[1:]
        run_sweep(target, _spec(samples=4, perception=perception), folder, workers=1)
        tables.append(read_results(folder)[0])
    assert tables[0] == tables[1]
    with pytest.raises(SweepError, match="no open parameter 'preset'"):
        prepare(tmp_path / "plan.json", _spec(vary=("preset=choice(a, b)",), perception=None), Diagnostics())
