"""The order of conditions and the steps of a session."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest

from scenario_compiler.compiler import read_source
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.source.study import StudyElement, square_rows
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.study.procedure import order_of, procedure, square_row

FILE = Path(__file__).parents[1] / "source" / "study" / "every_word.xml"


@pytest.fixture(scope="module")
def study() -> StudyElement:
    read = read_source(FILE, Diagnostics())
    assert read is not None
    assert isinstance(read[1], StudyFile)
    assert read[1].study is not None
    return read[1].study


@pytest.mark.parametrize("count", range(1, 12))
def test_a_square_is_balanced(count: int) -> None:
    """Each condition stands equally often in each place, and follows each other one equally often."""
    rows = [square_row(count, row) for row in range(square_rows(count))]
    assert all(sorted(row) == list(range(count)) for row in rows)
    for place in range(count):
        assert len(set(Counter(row[place] for row in rows).values())) == 1
    after = Counter((row[k], row[k + 1]) for row in rows for k in range(count - 1))
    assert len(after) == count * (count - 1)
    assert len(set(after.values())) <= 1


def test_repetitions_and_sessions_take_the_next_rows(study: StudyElement) -> None:
    twice = study.model_copy(update={"repetitions": 2, "sessions": 2})
    first, second = order_of(twice, 1, 1), order_of(twice, 1, 2)
    assert len(first) == 16
    assert first[:8] == order_of(study, 1, 1)
    assert first[8:] == order_of(study, 2, 1)
    assert second[:8] == order_of(study, 3, 1)


def test_a_drawn_order_depends_on_seed_and_participant_alone(study: StudyElement) -> None:
    drawn = study.model_copy(update={"order": "random"})
    assert order_of(drawn, 3, 1) == order_of(drawn, 3, 1)
    assert order_of(drawn, 3, 1) != order_of(drawn, 4, 1)
    assert sorted(order_of(drawn, 3, 1)) == sorted(order_of(study, 1, 1))
    other = drawn.model_copy(update={"seed": 8})
    assert [order_of(drawn, one, 1) for one in range(1, 6)] != [order_of(other, one, 1) for one in range(1, 6)]


def test_the_steps_of_a_session(study: StudyElement) -> None:
    steps = procedure(study, 1, 1)
    assert [one.number for one in steps] == list(range(len(steps)))
    kinds = [one.kind for one in steps]
    assert kinds[:4] == ["consent", "page", "ask", "drive"]
    assert kinds[-2:] == ["page", "end"]
    runs = [one.trial for one in steps if one.trial is not None]
    assert [one.number for one in runs] == list(range(1, 11))
    assert Counter(one.role for one in runs) == {"practice": 1, "trial": 8, "foil": 1}
    assert [one.role for one in runs][:2] == ["practice", "trial"]
    assert len({one.seed for one in runs}) == 10
    for before, step in pairwise(steps):
        if before.trial is not None and before.trial.role == "trial":
            assert step.about == before.trial
    assert kinds.count("break") == 2
    assert procedure(study, 1, 1) == steps
    assert procedure(study, 2, 1) != steps


def test_probes_are_drawn_within_their_times_for_their_share(study: StudyElement) -> None:
    times = [
        one.trial.probe_at
        for participant in range(1, 60)
        for one in procedure(study, participant, 1)
        if one.trial is not None and one.trial.role != "practice"
    ]
    probed = [one for one in times if one is not None]
    assert all(8.0 <= one <= 14.0 for one in probed)
    assert 0.4 < len(probed) / len(times) < 0.6
    assert all(
        one.trial.probe_at is None for one in procedure(study, 1, 1) if one.trial and one.trial.role == "practice"
    )
