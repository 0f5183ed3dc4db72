"""Whole sweeps: rows agree with their runs, and no split, interruption or number of workers changes a byte."""

from __future__ import annotations

import contextlib
import shlex
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from _pytest.mark import ParameterSet
from lxml import etree

from scenario_compiler import compile_scenario, load_network
from scenario_compiler.batch.codebook import PARAMETER
from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import prepare, run_sweep
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.measuring import TAKEOVERS, Columns, row_of_recording
from scenario_compiler.batch.runner import Part, Runner, Variant, record
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress
from scenario_compiler.batch.variants import with_values
from scenario_compiler.batch.worst import repeat_command
from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import CompileError, Diagnostics, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import plan_text, read_plan, write_plan
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.store import read_recording
from scenario_compiler.report.statistics import wilson_interval
from scenario_compiler.runtime import open_world, run
from scenario_compiler.vocabulary.storyboard import Storyboard
from tests.plan.starts import parked_ahead

LIBRARY = Path(__file__).parents[2] / "library" / "conflicts"
VARY = ("distance=uniform(20, 350)", "speed=choice(8, 13.9, 20)")


def _spec(**settings: Any) -> SweepSpec:
    return SweepSpec(**{"vary": VARY, "samples": 40, "perception": "ideal", **settings})


@pytest.mark.parametrize("interpreted", [True, False])
def test_a_row_agrees_with_the_outcome_of_its_run(conflict: Path, tmp_path: Path, interpreted: bool) -> None:
    spec = _spec(samples=12, interpreted=interpreted, seed=5)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=False)
    rows, about = read_results(tmp_path / "sweep")
    takeovers = pq.read_table(tmp_path / "sweep" / "takeovers.parquet").to_pylist()
    assert takeovers
    sweep = prepare(conflict, spec, Diagnostics())
    assert {"pass", "fail"} <= set(rows["result"])
    assert {"driver", "open"} <= set(rows["resolution"])
    for index in range(12):
        variant = sweep.variant(index, sweep.sampler.sample(index))
        family = sweep.families.base
        outcome = judge(with_values(family.plan, variant.values), record(family.plan, family.network, variant))
        for name in ("result", "stop_reason", "duration", "resolution", "cause", "collision_with"):
            assert rows[name][index] == getattr(outcome, name), name
        for name, measure in outcome.measures.items():
            assert rows[name][index] == measure.value, name
        failed = [criterion.criterion for criterion in outcome.criteria if not criterion.passed]
        assert rows["failed"][index].split() == failed
        assert rows[PARAMETER + "distance"][index] == variant.values["distance"]
        expected = [{"variant": index, **one.model_dump()} for one in outcome.takeovers]
        assert [one for one in takeovers if one["variant"] == index] == expected
    assert [one["column"] for one in about["columns"]] == list(rows)


def run_both_ways(plan: Plan) -> tuple[Recording, Columns]:
    """Return the recording of a plan's run, and the row that the same run has in a sweep."""
    network, variant = load_network(plan.map.file), Variant(0, 1, 0, {})
    runner = Runner("compiled")
    runner.add(0, plan, network)
    (batch,) = runner.batches(Part(0, (variant,)))
    return record(plan, network, variant), batch.columns


def test_a_collision_is_judged_however_many_events_come_before_it(conflict: Path) -> None:
    """An event that starts again in every step fills the log of events many times."""
    driver = '<driver takeover_time="60"/><automation before="hold_speed" after="hold_speed"/>'
    text = conflict.read_text(encoding="utf-8").replace('<driver preset="$preset"/>', driver)
    speaks = '<when><time after="0"/><do><message text="again" modality="text"/></do></when>'
    conflict.write_text(text.replace("<takeover ", speaks + '<takeover minimum_risk="false" '), encoding="utf-8")
    once = compile_scenario(conflict, distance=70, overrides=Overrides(perception="ideal"))
    again = plan_text(once).replace('"maximum_execution_count": 1', '"maximum_execution_count": 1000')
    plan = Plan.model_validate_json(again)
    recording, row = run_both_ways(plan)
    assert sum(event.kind == "message" for event in recording.events) > 80
    assert row["collision_with"] == ["blocked_lane1.blocker"]
    assert row == row_of_recording(plan, recording)


def test_the_egos_trailer_is_no_other_road_user(tmp_path: Path) -> None:
    path = tmp_path / "towing.xml"
    path.write_text(
        '<scenarios version="1"><scenario name="towing" map="motorway" duration="4" step="0.05">'
        '<ego speed="25"><start><lane road="1" lane="-2" s="200"/></start></ego>'
        '<dynamic id="caravan" speed="25"><start><lane road="1" lane="-2" s="150"/></start></dynamic>'
        '<when><time after="0"/><do><connect_trailer trailer="caravan"/></do></when>'
        '<criteria><no_collision/><minimum_time_to_collision at_least="1"/></criteria>'
        "</scenario></scenarios>",
        encoding="utf-8",
    )
    plan = compile_scenario(path, overrides=Overrides(perception="ideal"))
    recording, row = run_both_ways(plan)
    assert recording.towed_by[-1].tolist() == [-1, 0]
    assert (row["result"], row["minimum_distance"]) == (["pass"], [None])
    assert row == row_of_recording(plan, recording)


def test_without_parameters_the_runs_differ_in_their_random_numbers_only(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(vary=(), samples=12, repeat=2)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1)
    rows, _ = read_results(tmp_path / "sweep")
    assert len(set(rows["digest"])) == 1
    assert rows["seed"] == 12 * [1, 2]
    assert len(set(rows["takeover_time"])) > 6
    assert "random numbers only" in (tmp_path / "sweep" / "report.html").read_text(encoding="utf-8")


def _library_targets() -> Iterator[ParameterSet]:
    """Yield every scenario of the library; all but the first of every third file are slow."""
    for number, path in enumerate(sorted(LIBRARY.glob("*.xml"))):
        names = [str(one.get("name")) for one in etree.parse(str(path)).getroot().iterchildren("scenario")]
        for k, name in enumerate(names):
            yield pytest.param(
                f"{path}#{name}", marks=[pytest.mark.slow] if k or number % 3 else [], id=f"{path.stem}#{name}"
            )


@pytest.mark.parametrize("target", list(_library_targets()))
def test_library_conflicts_give_equal_results_compiled_and_interpreted(target: str, tmp_path: Path) -> None:
    done = compile_target(target, {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert done is not None
    numbers = [one for one in done.plan.parameters if one.default]
    if not numbers:
        pytest.skip("the conflict has no parameter that stays a number")
    least = {one.name: max(0.9 * float(str(one.default)), one.limits.minimum or 0.0) for one in numbers}
    vary = tuple(f"{one.name}=uniform({least[one.name]}, {one.default})" for one in numbers)
    tables = []
    for interpreted in (True, False):
        spec = SweepSpec(vary=vary, samples=2, perception="ideal", interpreted=interpreted)
        folder = tmp_path / str(interpreted)
        run_sweep(target, spec, folder, workers=1, report=False)
        tables.append(read_results(folder)[0])
    assert tables[0] == tables[1]
    sweep = prepare(target, spec, Diagnostics())
    for index in range(2):
        variant = sweep.variant(index, sweep.sampler.sample(index))
        family = sweep.families.base
        recording = record(family.plan, family.network, variant)
        alone = row_of_recording(with_values(family.plan, variant.values), recording)
        for name, (found,) in alone.items():
            if name == TAKEOVERS:
                continue
            summed = name == "lane_position_deviation" and found is not None
            assert tables[0][name][index] == (pytest.approx(found, rel=1e-12, abs=1e-12) if summed else found), name


def test_no_split_changes_a_byte(conflict: Path, tmp_path: Path) -> None:
    contents = set()
    for workers in (1, 2):
        folder = tmp_path / str(workers)
        assert run_sweep(conflict, _spec(), folder, workers=workers, report=False).workers == workers
        contents.add((folder / "results.parquet").read_bytes())
    assert len(contents) == 1


def test_an_interrupted_sweep_is_resumed_to_the_same_bytes(conflict: Path, tmp_path: Path) -> None:
    class StopError(Exception):
        pass

    def stop(progress: Progress) -> None:
        if progress.done >= 20:
            raise StopError

    spec = _spec(samples=40, interpreted=True)
    run_sweep(conflict, spec, tmp_path / "whole", workers=1, report=False)
    with contextlib.suppress(StopError):
        run_sweep(conflict, spec, tmp_path / "parts", workers=1, progress=stop, report=False)
    kept = list((tmp_path / "parts" / "parts").glob("*.parquet"))
    assert len(kept) == 2
    (kept[0].with_suffix(".parquet.tmp")).write_bytes(b"half a part")
    with pytest.raises(SweepError, match="--resume"):
        run_sweep(conflict, spec, tmp_path / "parts", workers=1, report=False)
    with pytest.raises(SweepError, match=r"another sweep: it differs in --seed$"):
        run_sweep(conflict, _spec(seed=2, interpreted=True), tmp_path / "parts", workers=1, resume=True, report=False)
    seen: list[Progress] = []
    run_sweep(conflict, spec, tmp_path / "parts", workers=1, resume=True, progress=seen.append, report=False)
    assert seen[0].done == 32
    files = [sorted(p.name for p in (tmp_path / name).iterdir()) for name in ("whole", "parts")]
    assert files[0] == files[1]
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "parts")]
    assert tables[0] == tables[1]
    again = run_sweep(conflict, spec, tmp_path / "parts", workers=1, resume=True, report=False)
    assert (again.tally.runs, again.tally.broken_off) == (40, 0)


def test_each_structure_has_one_plan_and_a_faulty_one_loses_only_its_rows(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(
        vary=("preset=choice(study_means, nobody, absent)", "distance=grid(60, 80, 3)"), method="grid", samples=1
    )
    result = run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    assert rows[PARAMETER + "preset"] == ["study_means"] * 3 + ["nobody"] * 3 + ["absent"] * 3
    assert len(set(rows["digest"])) == 3
    assert result.tally.broken_off == 3
    assert rows["error"][3:6] == ["there is no driver 'nobody'"] * 3
    assert rows["resolution"][:1] + rows["resolution"][-1:] == ["driver", "unanswered"]


def test_a_value_outside_its_limits_is_a_row_with_its_error(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(vary=("distance=grid(5, 60, 2)",), samples=1, where=("distance > 1",))
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    assert rows["result"] == ["error", "fail"]
    assert rows["error"][0] == "distance is 5, but must be at least 10"


@pytest.mark.parametrize(
    ("settings", "runs"),
    [({}, 2), ({"preset": "absent"}, 0), ({"weather": "HardRainNoon", "preset": "study_means"}, 2)],
)
def test_constraints_know_parameters_of_every_type_that_do_not_vary(
    conflict: Path, tmp_path: Path, settings: dict[str, str], runs: int
) -> None:
    where = ("distance > 50", "preset == 'study_means'", "speed < 14")
    spec = _spec(vary=("distance=values(40, 60, 80)",), samples=1, where=where, settings=settings)
    if runs:
        assert run_sweep(conflict, spec, tmp_path / "sweep", report=False).tally.runs == runs
    else:
        with pytest.raises(SweepError, match="no sample meets"):
            run_sweep(conflict, spec, tmp_path / "sweep", report=False)


@pytest.mark.parametrize("where", ["distance > 100", "distance > nothing", "distance > 50 and speed > 100"])
def test_a_constraint_that_no_draw_meets_writes_nothing(conflict: Path, tmp_path: Path, where: str) -> None:
    spec = _spec(vary=("distance=uniform(40, 60)",), samples=1, where=(where,))
    with pytest.raises(SweepError, match=r"no sample meets|there is no parameter 'nothing'"):
        run_sweep(conflict, spec, tmp_path / "sweep", report=False)
    assert not (tmp_path / "sweep").exists()


@pytest.mark.parametrize("vary", [("distanse=uniform(1, 2)",), ("distance=uniform(5, 60)",), ()])
def test_a_wrong_sweep_writes_nothing(conflict: Path, tmp_path: Path, vary: tuple[str, ...]) -> None:
    with pytest.raises((CompileError, SweepError)):
        run_sweep(conflict, _spec(vary=vary, samples=1), tmp_path / "sweep", report=False)
    assert not (tmp_path / "sweep").exists()


def test_other_files_are_left_alone(conflict: Path, tmp_path: Path) -> None:
    with pytest.raises(SweepError, match="contains no sweep"):
        run_sweep(conflict, _spec(), tmp_path, report=False)


def test_a_plan_is_swept_over_its_open_parameters(conflict: Path, tmp_path: Path) -> None:
    done = compile_target(conflict, {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert done is not None
    write_plan(done.plan, tmp_path / "plan.json")
    with pytest.raises(SweepError, match="distance may become 5, but must be at least 10"):
        prepare(tmp_path / "plan.json", _spec(vary=("distance=uniform(5, 60)",), perception=None), Diagnostics())
    tables = []
    for target, perception in ((conflict, "ideal"), (tmp_path / "plan.json", None)):
        folder = tmp_path / target.suffix[1:]
        run_sweep(target, _spec(samples=4, perception=perception), folder, workers=1, report=False)
        tables.append(read_results(folder)[0])
    assert tables[0] == tables[1]
    with pytest.raises(SweepError, match="no open parameter 'preset'"):
        prepare(tmp_path / "plan.json", _spec(vary=("preset=choice(a, b)",), perception=None), Diagnostics())


def test_the_worst_cases_are_kept_and_shown(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=20, vary=("distance=uniform(12, 300)", "speed=uniform(8, 20)"), traces="worst:2")
    folder = tmp_path / "sweep"
    run_sweep(conflict, spec, folder, workers=1)
    rows, _ = read_results(folder)
    worst = [int(path.name) for path in sorted((folder / "traces").iterdir())]
    speeds = sorted((speed for speed in rows["collision_speed"] if speed is not None), reverse=True)
    assert sorted(rows["collision_speed"][index] for index in worst) == sorted(speeds[:2])
    for index in worst:
        recording = read_recording(folder / "traces" / f"{index:08}" / "recording.parquet")
        plan = read_plan(folder / "traces" / f"{index:08}" / "plan.json", Diagnostics())
        assert plan is not None
        assert recording.header.variant == index
        assert judge(plan, recording).measures["collision_time"].value == rows["collision_time"][index]
    page = (folder / "report.html").read_text(encoding="utf-8")
    etree.fromstring(page.encode(), etree.HTMLParser())
    assert f"--variant {worst[0]} -o variant-{worst[0]}" in page
    assert "collision rate" in page
    assert "<script" not in page


@pytest.mark.slow
def test_equal_sweeps_have_equal_reports(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=20, vary=("distance=uniform(12, 300)", "speed=uniform(8, 20)"))
    for name in ("one", "other"):
        run_sweep(conflict, spec, tmp_path / name, workers=1)
    pages = [(tmp_path / name / "report.html").read_bytes() for name in ("one", "other")]
    assert pages[0] == pages[1]


def test_a_case_is_repeated_from_its_command_line(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=3, seed=4, duration=4.0)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    words = shlex.split(repeat_command(str(conflict), spec, rows, 2))
    settings = dict(word.split("=", 1) for word in words if "=" in word)
    assert words[-6:-2] == ["--seed", "4", "--variant", "2"]
    done = compile_target(conflict, settings, Diagnostics(), overrides=spec.overrides)
    assert done is not None
    again = judge(done.plan, run(done.plan, open_world("kinematic", done.plan, done.network), 4, variant=2))
    assert again.measures["minimum_distance"].value == rows["minimum_distance"][2]


@pytest.mark.parametrize("text", ["worst", "worst:0", "best:3", "all:3", "random:x", "random:²"])
def test_an_invalid_value_of_traces_is_refused(text: str) -> None:
    with pytest.raises(SweepError, match="give worst:K"):
        _spec(traces=text).traces_wanted()


@pytest.mark.parametrize(
    ("hits", "count", "low", "high"),
    [(0, 10, 0.0, 0.2775), (5, 10, 0.2366, 0.7634), (10, 10, 0.7225, 1.0), (0, 0, 0.0, 1.0)],
)
def test_wilson_intervals(hits: int, count: int, low: float, high: float) -> None:
    assert wilson_interval(hits, count) == pytest.approx((low, high), abs=1e-4)


def test_a_rate_above_one_has_no_interval() -> None:
    with pytest.raises(ValueError, match="hits is from 0 to count, 10, not 11"):
        wilson_interval(11, 10)


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("vary", "speed=uniform(1, 2)", r"vary is a tuple of texts, not 'speed=uniform\(1, 2\)'"),
        ("where", "speed > 1", "where is a tuple of texts, not 'speed > 1'"),
        ("trust", "our_lab", "trust is a tuple of texts, not 'our_lab'"),
        ("settings", {"speed": 8}, "settings are texts by name, as on the command line, not {'speed': 8}"),
        ("samples", 2.5, "samples is a whole number, not 2.5"),
        ("seed", "1", "seed is a whole number, not '1'"),
    ],
)
def test_an_option_of_another_type_is_refused(option: str, value: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        SweepSpec(**{"vary": (), option: value})


def test_folders_and_numbers_of_other_types_are_read(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=np.int64(2), seed=np.int64(3))
    assert run_sweep(conflict, spec, str(tmp_path / "sweep"), workers=1, report=False).tally.runs == 2


def test_the_memory_of_a_sweep_does_not_depend_on_how_long_its_runs_are(conflict: Path) -> None:
    peaks = []
    for duration in (30.0, 600.0):
        sweep = prepare(conflict, _spec(samples=20), Diagnostics())
        family = sweep.families.base
        plan = family.plan.model_copy(update={"duration": duration, "storyboard": Storyboard()})
        runner = Runner("compiled")
        runner.add(0, plan, family.network)
        part = Part(0, tuple(Variant(index, 1, 0, {}) for index in range(20)))
        list(runner.batches(part))
        tracemalloc.start()
        (batch,) = runner.batches(part)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert max(batch.columns["duration"]) > 0.9 * duration
    assert peaks[1] < 1.1 * peaks[0]


@pytest.mark.parametrize("interpreted", [True, False])
def test_faults_of_starts_are_rows_with_the_error_of_a_run(tmp_path: Path, interpreted: bool) -> None:
    """Entities that overlap, and a start beyond the lane's end, among variants that run together."""
    path = parked_ahead(tmp_path)
    spec = SweepSpec(vary=("far=values(1, 100, 3, 40, 9000)",), perception="ideal", interpreted=interpreted)
    run_sweep(path, spec, tmp_path / "sweep", workers=1, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    for far, error in zip(rows[PARAMETER + "far"], rows["error"], strict=True):
        sink = Diagnostics()
        compile_target(path, {"far": str(far)}, sink, overrides=Overrides(perception="ideal"))
        assert error == next((one.message for one in sink if one.severity is Severity.ERROR), ""), far
    assert [bool(error) for error in rows["error"]] == [True, False, True, False, True]


def test_variants_beyond_limits_are_rows_with_the_error_of_a_run(conflict: Path, tmp_path: Path) -> None:
    vary = ("distance=normal(20, 30)", "speed=normal(2, 8)")
    run_sweep(conflict, _spec(vary=vary, samples=60), tmp_path / "sweep", workers=1, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    reasons = set()
    for index, found in enumerate(rows["result"]):
        values = {name: str(rows[PARAMETER + name][index]) for name in ("distance", "speed")}
        sink = Diagnostics()
        compile_target(conflict, values, sink, overrides=Overrides(perception="ideal"))
        assert (found == "error") == sink.has_errors
        if found == "error":
            assert rows["error"][index] in [one.message for one in sink]
            assert rows["final_speed"][index] is None
            reasons.add(str(rows["error"][index]).split(" is ")[0])
    assert {"speed", "distance"} <= reasons
    assert "pass" in rows["result"]


WAYPOINTS = (
    '<waypoint><lane road="1" lane="-1" s="{}"/></waypoint><waypoint><lane road="1" lane="-1" s="300"/></waypoint>'
)
ON_ROUTE = f"<on_route><route>{WAYPOINTS}</route><route_lane s='{{}}' lane='-1'/></on_route>"


@pytest.mark.parametrize(
    "place",
    [
        ON_ROUTE.format("60", "$d"),
        ON_ROUTE.format("${50 + $d}", "10"),
        '<on_trajectory s="30"><trajectory><clothoid curvature="0" curvature_rate="${$d / 10000}" length="40">'
        '<lane road="1" lane="-1" s="60"/></clothoid></trajectory></on_trajectory>',
        '<on_trajectory s="60"><trajectory><nurbs order="3" knots="0 0 0 1 1 1">'
        '<control_point><lane road="1" lane="-1" s="40"/></control_point>'
        '<control_point weight="$d"><free x="262" y="230"/></control_point>'
        '<control_point><lane road="1" lane="-1" s="120"/></control_point></nurbs></trajectory></on_trajectory>',
    ],
    ids=["on a route", "of a waypoint", "on a clothoid", "on a NURBS"],
)
def test_a_place_on_a_route_or_curve_varies_with_its_parameter(place: str, tmp_path: Path) -> None:
    """A sweep gives what single runs give, although the parameter is a number of the ego's too."""
    file = tmp_path / "place.xml"
    file.write_text(
        '<scenarios version="1"><scenario name="a" map="town_grid" duration="0.5">'
        '<parameter name="d" type="number" default="5"/>'
        '<ego speed="$d"><start><lane road="1" lane="-1" s="20"/></start></ego>'
        f'<dynamic id="lead" speed="0"><start>{place}</start></dynamic></scenario></scenarios>',
        encoding="utf-8",
    )
    spec = _spec(vary=("d=values(5, 12)",), samples=1)
    run_sweep(file, spec, tmp_path / "sweep", workers=1, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    singly = []
    for value in ("5", "12"):
        done = compile_target(file, {"d": value}, Diagnostics(), overrides=spec.overrides)
        assert done is not None
        recording = run(done.plan, open_world("kinematic", done.plan, done.network), 1)
        singly.append(judge(done.plan, recording).measures["minimum_distance"].value)
    assert rows["minimum_distance"] == pytest.approx(singly)
