from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenario_compiler.forms.declaration import column_types
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables
from tests.roads.make import network, road

END = (30.0, 18.0)
"""Where the parabola y = 0.02 x^2 ends that starts at the origin, m."""

LENGTH = (math.asinh(1.2) + 1.2 * math.sqrt(2.44)) / 0.08
"""Its length, m; its direction at the end is atan(1.2)."""


def parabola(kind: str, x: float = 0.0, y: float = 0.0, h: float = 0.0) -> str:
    wide = 30.0 if kind == "normalized" else 30.0 / LENGTH
    shape = f'<paramPoly3 pRange="{kind}" bU="{wide!r}" cV="{0.02 * wide**2!r}"/>'
    if kind == "poly3":
        shape = '<poly3 a="0" b="0" c="0.02" d="0"/>'
    return f'<geometry s="0" x="{x!r}" y="{y!r}" hdg="{h!r}" length="{LENGTH!r}">{shape}</geometry>'


@pytest.mark.parametrize("contact", ["start", "end"])
@pytest.mark.parametrize("link", ["predecessor", "successor"])
@pytest.mark.parametrize("kind", ["poly3", "normalized", "arcLength"])
def test_a_link_between_curves_without_a_contact_point_is_to_the_nearest_end(
    tmp_path: Path, kind: str, link: str, contact: str
) -> None:
    x, y = (0.0, 0.0) if link == "predecessor" else END
    sense = 1.0 if (link == "predecessor") == (contact == "end") else -1.0
    if contact == "end":
        x, y = x - sense * END[0], y - sense * END[1]
    other = road("2", LENGTH, parabola(kind, x, y, 0.0 if sense > 0.0 else math.pi))

    def tables(attribute: str) -> RoadTables:
        linked = f'<{link} elementType="road" elementId="2" {attribute}/>'
        return network(tmp_path, road("1", LENGTH, parabola(kind), link=linked), other).tables

    made, stated = tables(""), tables(f'contactPoint="{contact}"')
    column = made.road_start_contact if link == "predecessor" else made.road_end_contact
    assert column == [AT_START if contact == "start" else AT_END, -1]
    for name in column_types(RoadTables):
        assert getattr(made, name) == getattr(stated, name)
