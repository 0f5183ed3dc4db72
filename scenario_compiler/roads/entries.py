"""The functions of roads that are called from outside; each is a symbol of the library."""

from __future__ import annotations

from scenario_compiler.forms.language import Marked
from scenario_compiler.roads.curve_build import count_knots, store_knots
from scenario_compiler.roads.link_build import list_links, store_exits, store_links
from scenario_compiler.roads.locate_build import lay_chunks, list_cells, store_cells
from scenario_compiler.roads.locate_points import locate_point, locate_points
from scenario_compiler.roads.steady import note_lanes

ENTRIES: tuple[Marked, ...] = (
    *(list_links, store_links, store_exits),
    *(count_knots, store_knots),
    *(note_lanes, lay_chunks, list_cells, store_cells),
    *(locate_point, locate_points),
)
"""The entries of both forms."""
