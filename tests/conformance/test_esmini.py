"""OpenSCENARIO files run as esmini ran them."""

from __future__ import annotations

from pathlib import Path

from tests.conformance.esmini import comparisons
from tests.conformance.explained import EXPLAINED

SHARE = 0.9
"""Least share of the recorded runs that must be met."""


def test_recorded_runs_are_met_and_every_other_one_is_explained(golden: Path) -> None:
    found = list(comparisons(golden.parent / "corpus", []))
    agreeing = [one.scenario for one in found if one.agrees]
    assert len(agreeing) >= SHARE * len(found), "\n".join(str(one) for one in found if not one.agrees)
    assert {one.scenario for one in found} - set(agreeing) == set(EXPLAINED)
