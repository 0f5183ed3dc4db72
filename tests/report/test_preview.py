"""The preview: paths are drawn, and no text covers another."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba, to_rgba_array
from matplotlib.figure import Figure

from scenario_compiler.compiler import Compilation, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.report.map_plot import draw_map
from scenario_compiler.report.preview import draw_section, own_path, section_of
from scenario_compiler.resources import library_folder

WORKS = """<scenarios version="1"><scenario name="works" map="town_grid" duration="20">
  <ego speed="10"><start><lane road="4" lane="-1" s="20"/></start></ego>
  <static id="cone" model="static.prop.trafficcone01"><at><lane road="4" lane="-1" s="60"/></at></static>
  <{line} colour="yellow"/>
  <takeover/>
</scenario></scenarios>"""


def compiled_file(path: str | Path) -> Compilation:
    compilation = compile_target(path, {}, Diagnostics())
    assert compilation is not None
    return compilation


def compiled(target: str) -> Compilation:
    return compiled_file(f"{library_folder() / 'conflicts'}/{target}")


def made_axes() -> Axes:
    figure = Figure(figsize=(11.0, 3.2))
    FigureCanvasAgg(figure)
    return figure.add_axes((0.0, 0.0, 1.0, 1.0))


def test_a_path_leads_from_the_start_over_its_points() -> None:
    done = compiled("in_traffic.xml#jaywalker")
    ego, walker = done.plan.entities
    assert own_path(done.plan, done.network, ego) == []
    along = own_path(done.plan, done.network, walker)
    places = [done.network.road_pose("1", s, t) for s, t in ((182, -4.75), (199, -4.75), (205, 4.75), (239, 4.75))]
    assert along == [pytest.approx((place.x, place.y)) for place in places]


def test_labels_that_would_cover_another_are_left_out() -> None:
    done, axes = compiled("narrowing_variants.xml#motorway_works"), made_axes()
    draw_section(axes, done.plan, done.network, section_of(done.plan, done.network))
    labels = [text for text in axes.texts if text.get_text() in done.plan.derived]
    assert {"ego", "work_zone_taper1.cone1"} <= {text.get_text() for text in labels} < set(done.plan.derived)
    extents = [text.get_window_extent() for text in axes.texts]
    assert not any(one.overlaps(other) for one, other in combinations(extents, 2))


def test_no_road_id_covers_the_scale_bar() -> None:
    done, axes = compiled("obstacle_ahead.xml"), made_axes()
    draw_map(axes, done.network, section_of(done.plan, done.network))
    (length,) = (text for text in axes.texts if text.get_text().endswith(" m"))
    ids = [text for text in axes.texts if text is not length]
    assert "4" in {text.get_text() for text in ids}
    bar = axes.lines[-1].get_window_extent()
    for text in ids:
        assert not text.get_window_extent().overlaps(length.get_window_extent())
        assert not text.get_window_extent().overlaps(bar)


def painted_yellow(axes: Axes) -> int:
    """Return the number of yellow quads among the marks."""
    yellow = to_rgba("#ffd400")
    marks = [one for one in axes.collections if isinstance(one, LineCollection)]
    return sum(to_rgba(colour) == yellow for one in marks for colour in to_rgba_array(one.get_colors()))


@pytest.mark.parametrize(
    "line", ['secondary_markings road="4" from="20" to="90" t="-1"', 'line_beside entity="cone" to="20"']
)
def test_lines_that_the_scenario_paints_are_drawn(line: str, tmp_path: Path) -> None:
    path = tmp_path / "works.xml"
    path.write_text(WORKS.format(line=line), encoding="utf-8")
    done, axes = compiled_file(path), made_axes()
    draw_section(axes, done.plan, done.network, section_of(done.plan, done.network))
    assert painted_yellow(axes) > 0
    plain, bare = done.plan.model_copy(update={"secondary_markings": ()}), made_axes()
    draw_section(bare, plain, done.network, section_of(done.plan, done.network))
    assert painted_yellow(bare) == 0
