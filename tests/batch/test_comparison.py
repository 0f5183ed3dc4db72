"""Comparisons of two sweeps, variant by variant: which variants belong together, what differs, and by how much."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from scenario_compiler.batch.codebook import PARAMETER, Column
from scenario_compiler.batch.comparison import Change, NumberPair, SweepComparison, compare_sweeps
from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.measuring import TAKEOVERS, error_columns
from scenario_compiler.batch.results import ResultStore
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.recording.takeovers import Takeover
from tests.batch.conftest import conflict_in

LISTED = ("distance=grid(30, 330, 7)", "speed=values(8, 13.9, 20)")


def swept(conflict: Path, folder: Path, workers: int = 1, **settings: Any) -> Path:
    """Return the folder of a sweep of 21 variants."""
    spec = SweepSpec(**{"vary": LISTED, "perception": "ideal", **settings})
    run_sweep(conflict, spec, folder, workers=workers, report=False)
    return folder


@pytest.fixture(scope="module")
def shared_conflict(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return conflict_in(tmp_path_factory.mktemp("conflict"))


@pytest.fixture(scope="module")
def usual(shared_conflict: Path) -> Path:
    """Return the folder of a sweep with which the others are compared."""
    return swept(shared_conflict, shared_conflict.parent / "usual")


def numbers_of(found: SweepComparison) -> dict[str, NumberPair]:
    return {one.name: one for one in found.variants.numbers}


def changes_of(found: SweepComparison, what: str) -> dict[tuple[str | None, str | None], int]:
    return {(one.first, one.second): one.rows for one in found.variants.changes if one.what == what}


@pytest.mark.parametrize("workers", [1, 3])
def test_two_sweeps_of_one_specification_are_equal(
    shared_conflict: Path, usual: Path, tmp_path: Path, workers: int
) -> None:
    found = compare_sweeps(usual, swept(shared_conflict, tmp_path / "again", workers))
    assert found.equal
    assert found.pairs.tolist() == [[k, k] for k in range(21)]
    assert all(fact.first == fact.second for fact in found.facts)
    assert all(one.variants is None and not one.differ for one in numbers_of(found).values())
    assert set(changes_of(found, "result")) == {("pass", "pass"), ("fail", "fail")}


def test_another_seed_gives_the_same_variants_with_other_drivers(
    shared_conflict: Path, usual: Path, tmp_path: Path
) -> None:
    found = compare_sweeps(usual, swept(shared_conflict, tmp_path / "other", seed=2))
    assert len(found.pairs) == 21
    assert [(fact.what, fact.first, fact.second) for fact in found.facts if fact.first != fact.second] == [
        ("seed", "1", "2")
    ]
    times = [read_results(folder)[0]["takeover_time"] for folder in (usual, tmp_path / "other")]
    differences = {
        k: other - one
        for k, (one, other) in enumerate(zip(*times, strict=True))
        if one is not None and other is not None
    }
    largest = max(differences, key=lambda k: abs(differences[k]))
    measured = numbers_of(found)["takeover_time"]
    assert measured.unit == "s"
    assert measured.both == len(differences)
    assert measured.median == np.median(list(differences.values()))
    assert (measured.largest, measured.variants) == (differences[largest], (largest, largest))
    assert measured.differ == sum(one != other for one, other in zip(*times, strict=True))
    assert measured.differ >= measured.first_alone + measured.second_alone
    assert not found.equal


def test_another_driver_changes_outcomes_of_named_variants(shared_conflict: Path, usual: Path, tmp_path: Path) -> None:
    other = swept(shared_conflict, tmp_path / "other", settings={"preset": "absent"})
    found = compare_sweeps(usual, other)
    facts = {fact.what: (fact.first, fact.second) for fact in found.facts if fact.first != fact.second}
    assert facts.keys() == {"plan digest", "$preset"}
    assert facts["$preset"] == ("", "absent")
    tables = [read_results(folder)[0] for folder in (usual, other)]
    for what in ("result", "resolution", "stop_reason"):
        pairs = list(zip(*(table[what] for table in tables), strict=True))
        assert changes_of(found, what) == {pair: pairs.count(pair) for pair in pairs}
    (changed,) = (one for one in found.variants.changes if (one.first, one.second) == ("driver", "unanswered"))
    assert changed.rows == len(changed.variants) > 0
    for first, second in changed.variants.tolist():
        assert (tables[0]["resolution"][first], tables[1]["resolution"][second]) == ("driver", "unanswered")
    name = "minimum_time_to_collision"
    told = [["fails" if name in row.split() else "holds" for row in table["failed"]] for table in tables]
    pairs = list(zip(*told, strict=True))
    assert changes_of(found, f"criterion {name}") == {pair: pairs.count(pair) for pair in pairs}
    assert numbers_of(found)["takeover_time"].second_alone == 0
    answered = [time is not None for time in tables[0]["takeover_time"]]
    assert numbers_of(found)["takeover_time"].first_alone == sum(answered) > 0


def test_surrogate_and_ideal_perception_differ_by_little(shared_conflict: Path, usual: Path, tmp_path: Path) -> None:
    """The lane is free of faults, so that both perceptions lead to nearly the same runs, but not to the bit."""
    other = swept(shared_conflict, tmp_path / "other", perception="surrogate")
    assert not compare_sweeps(usual, other).equal
    within = compare_sweeps(usual, other, tolerance=1000.0)
    assert ("perception", "ideal", "surrogate") in [(one.what, one.first, one.second) for one in within.facts]
    assert len(within.pairs) == 21
    assert not any(one.differ - one.first_alone - one.second_alone for one in within.variants.numbers)
    assert numbers_of(within)["minimum_confidence"].largest != 0.0


def test_other_parameters_leave_variants_out(shared_conflict: Path, usual: Path, tmp_path: Path) -> None:
    """The second sweep has its axes in another order, one distance more and one speed less."""
    vary = ("speed=values(20, 8)", "distance=values(345, 30, 80, 130, 180, 230, 280, 330)")
    found = compare_sweeps(usual, swept(shared_conflict, tmp_path / "other", vary=vary))
    tables = [read_results(folder)[0] for folder in (usual, tmp_path / "other")]
    assert len(found.pairs) == 14
    for first, second in found.pairs.tolist():
        for name in ("parameter.distance", "parameter.speed"):
            assert tables[0][name][first] == tables[1][name][second]
    assert [tables[0]["parameter.speed"][k] for k in found.first_alone] == [13.9] * 7
    assert [tables[1]["parameter.distance"][k] for k in found.second_alone] == [345.0] * 2
    assert not found.equal


def test_repeats_are_paired_in_their_order(shared_conflict: Path, usual: Path, tmp_path: Path) -> None:
    """The draws of a run depend on its seed and its index, so that only some repeats are equal."""
    found = compare_sweeps(usual, swept(shared_conflict, tmp_path / "other", repeat=3))
    assert found.pairs.tolist() == [[k, 3 * k] for k in range(21)]
    assert len(found.second_alone) == 42
    again = compare_sweeps(tmp_path / "other", tmp_path / "other")
    assert again.equal
    assert again.pairs.tolist() == [[k, k] for k in range(63)]


def test_a_longer_random_sweep_contains_the_shorter_one(shared_conflict: Path, tmp_path: Path) -> None:
    vary = ("distance=uniform(30, 330)",)
    folders = [swept(shared_conflict, tmp_path / str(count), vary=vary, samples=count) for count in (8, 12)]
    found = compare_sweeps(*folders)
    assert found.differ == 0
    assert found.second_alone.tolist() == [8, 9, 10, 11]
    assert not found.equal


def test_sweeps_without_a_common_variant_are_not_compared(shared_conflict: Path, usual: Path, tmp_path: Path) -> None:
    vary = ("distance=uniform(30, 330)", "speed=values(8)")
    one, other = (swept(shared_conflict, tmp_path / str(seed), vary=vary, seed=seed) for seed in (1, 2))
    with pytest.raises(
        SweepError, match=r"no variant of .*1 has the parameters .*2: they differ in seed; values\("
    ) as it:
        compare_sweeps(one, other)
    assert "\n" not in str(it.value)
    fewer = swept(shared_conflict, tmp_path / "fewer", vary=("distance=grid(30, 330, 7)",))
    for pair, whose in (((usual, fewer), "first"), ((fewer, usual), "second")):
        with pytest.raises(SweepError, match=f"'speed' varies in the {whose} sweep only"):
            compare_sweeps(*pair)


def test_variants_without_a_result_are_compared_by_their_reasons(shared_conflict: Path, tmp_path: Path) -> None:
    """A distance of 5 m is refused, which is not a result; reasons that differ in their numbers count as one."""
    vary, where = ("distance=values(5, 6, 60)",), ("distance > 1",)
    one = swept(shared_conflict, tmp_path / "one", vary=vary, where=where)
    other = swept(shared_conflict, tmp_path / "other", vary=("distance=values(5, 60)",), where=where, seed=2)
    assert compare_sweeps(one, one).equal
    found = compare_sweeps(one, other)
    assert changes_of(found, "result") == {("error", "error"): 1, ("fail", "fail"): 1}
    reason = "distance is 5, but must be at least 10"
    assert changes_of(found, "error") == {(reason, reason): 1, ("", ""): 1}
    assert changes_of(found, "failed") == {}


@pytest.mark.parametrize(
    ("missing", "reason"),
    [
        ("results.parquet", "contains an unfinished sweep; `sweep` with --resume finishes it"),
        ("takeovers.parquet", "is incomplete: it has no takeovers.parquet"),
    ],
)
def test_a_sweep_that_is_not_whole_is_refused(usual: Path, tmp_path: Path, missing: str, reason: str) -> None:
    shutil.copytree(usual, tmp_path / "part")
    (tmp_path / "part" / missing).unlink()
    with pytest.raises(SweepError, match=reason):
        compare_sweeps(usual, tmp_path / "part")


Row = Mapping[str, Any]


def made(folder: Path, rows: Sequence[Row], takeovers: Sequence[Sequence[Takeover]] = ()) -> Path:
    """Write the tables of a sweep with given results; other columns are empty."""
    column = Column(f"{PARAMETER}gap", "number", "m", "The gap.")
    store = ResultStore(folder, [column], {"target": "made.xml", "variants": len(rows), "spec": {}})
    store.open(resume=False)
    columns = error_columns(len(rows), "") | {"variant": list(range(len(rows))), "seed": [1] * len(rows)}
    columns |= {"digest": ["d"] * len(rows), column.column: [float(k) for k in range(len(rows))]}
    columns |= {name: [row[name] for row in rows] for name in rows[0]}
    columns[TAKEOVERS] = [[tuple(vars(one).values()) for one in some] for some in takeovers or [()] * len(rows)]
    store.write_part(0, columns)
    store.merge(1)
    return folder


@pytest.mark.parametrize(("tolerance", "differ"), [(None, 3), (0.0, 3), (0.05, 2), (0.1, 1)])
def test_a_tolerance_is_of_every_measure(tmp_path: Path, tolerance: float | None, differ: int) -> None:
    """A difference as large as the tolerance is within it, also if binary fractions make it larger: 3.25 - 3.2.

    A value that only one sweep has differs in any case.
    """
    one = made(tmp_path / "one", [{"takeover_time": value} for value in (1.0, 3.2, 2.0, None)])
    other = made(tmp_path / "other", [{"takeover_time": value} for value in (1.0, 3.25, 1.9, 4.0)])
    found = compare_sweeps(one, other, tolerance=tolerance)
    assert found.differ == differ
    measured = numbers_of(found)["takeover_time"]
    assert measured == NumberPair("takeover_time", "s", 3, 0, 1, differ, 0.0, 1.9 - 2.0, (2, 2))


def test_the_first_variant_with_one_value_is_named_if_no_difference_is(tmp_path: Path) -> None:
    one = made(tmp_path / "one", [{"collision_speed": None}, {"collision_speed": 3.0}])
    other = made(tmp_path / "other", [{"collision_speed": None}, {"collision_speed": None}])
    measured = numbers_of(compare_sweeps(one, other))["collision_speed"]
    assert measured == NumberPair("collision_speed", "m/s", 0, 1, 0, 1, None, None, (1, 1))


def test_numbers_that_are_too_far_apart_have_a_finite_difference(tmp_path: Path) -> None:
    one, other = (made(tmp_path / name, [{"final_speed": by * 1.7e308}] * 2) for name, by in (("one", -1), ("two", 1)))
    measured = numbers_of(compare_sweeps(one, other))["final_speed"]
    assert measured.median == measured.largest == np.finfo(float).max


def test_each_criterion_and_reference_driver_changes_on_its_own(tmp_path: Path) -> None:
    rows = [("", ""), ("no_collision", "careful_driver"), (None, None)]
    others = [("no_collision stay_on_road", "careful_driver"), ("no_collision", "careful_driver"), ("", None)]
    one, other = (
        made(tmp_path / name, [{"failed": failed, "avoided_by": avoided} for failed, avoided in some])
        for name, some in (("one", rows), ("other", others))
    )
    found = compare_sweeps(one, other)
    assert changes_of(found, "criterion no_collision") == {
        ("holds", "fails"): 1, ("fails", "fails"): 1, (None, "holds"): 1,
    }  # fmt: skip
    assert changes_of(found, "criterion stay_on_road")["holds", "fails"] == 1
    assert changes_of(found, "reference driver careful_driver") == {
        ("collision", "no collision"): 1, ("no collision", "no collision"): 1, (None, None): 1,
    }  # fmt: skip
    assert found.differ == 2


def takeover(number: int, at: float, cause: str = "path_blocked") -> Takeover:
    return Takeover(number=number, cause=cause, resolution="driver", request_time=at)


def test_takeovers_are_paired_by_their_number_in_the_run(tmp_path: Path) -> None:
    """The second request of variant 1 comes later and for another cause; the third is in the first sweep only."""
    rows = [{"result": "pass"}] * 3
    first = [(), (takeover(1, 2.0), takeover(2, 5.0), takeover(3, 9.0)), (takeover(1, 1.0),)]
    second = [(), (takeover(1, 2.0), takeover(2, 5.5, "lane_ends")), (takeover(1, 1.0),)]
    found = compare_sweeps(made(tmp_path / "one", rows, first), made(tmp_path / "other", rows, second))
    takeovers = found.takeovers
    assert (takeovers.rows, takeovers.first_alone, takeovers.second_alone) == (3, 1, 0)
    times = next(one for one in takeovers.numbers if one.name == "request_time")
    assert times == NumberPair("request_time", "s", 3, 0, 0, 1, 0.0, 0.5, (1, 1))
    changed = [one for one in takeovers.changes if one.first != one.second]
    assert [(one.what, one.first, one.second) for one in changed] == [("cause", "path_blocked", "lane_ends")]
    assert isinstance(changed[0], Change)
    assert changed[0].variants.tolist() == [[1, 1]]
    assert found.differ == 1


def test_a_takeover_more_makes_a_pair_differ(tmp_path: Path) -> None:
    rows = [{"result": "pass"}] * 2
    one = made(tmp_path / "one", rows, [(takeover(1, 2.0),), ()])
    other = made(tmp_path / "other", rows, [(takeover(1, 2.0), takeover(2, 4.0)), ()])
    found = compare_sweeps(one, other)
    assert (found.takeovers.first_alone, found.takeovers.second_alone, found.differ) == (0, 1, 1)


def test_columns_of_another_version_are_named_and_not_compared(tmp_path: Path) -> None:
    one, other = (made(tmp_path / name, [{"result": "pass"}]) for name in ("one", "other"))
    table = pq.read_table(other / "results.parquet")
    about = json.loads(table.schema.metadata[b"scenario-compiler"])
    about["columns"] = [column for column in about["columns"] if column["column"] != "final_speed"]
    metadata = {b"scenario-compiler": json.dumps(about).encode()}
    pq.write_table(table.drop_columns(["final_speed"]).replace_schema_metadata(metadata), other / "results.parquet")
    found = compare_sweeps(one, other)
    assert ("columns that are not compared", "final_speed", "") in [
        (fact.what, fact.first, fact.second) for fact in found.facts
    ]
    assert found.equal


@pytest.mark.parametrize("metadata", [b"", b"[]", b"{}", b'{"format": "scenario-compiler/sweep/1"}'])
def test_a_table_that_does_not_describe_itself_is_refused(usual: Path, tmp_path: Path, metadata: bytes) -> None:
    shutil.copytree(usual, tmp_path / "changed")
    for name in ("results.parquet", "takeovers.parquet"):
        file = tmp_path / "changed" / name
        table = pq.read_table(file)
        pq.write_table(table.replace_schema_metadata({b"scenario-compiler": metadata}), file)
        with pytest.raises(SweepError, match=f"{name} is not the table of a sweep"):
            compare_sweeps(usual, tmp_path / "changed")
        shutil.copy(usual / name, file)
