"""The functions of roads that are called from outside: each is a symbol of the library."""

from __future__ import annotations

from scenario_compiler.forms.language import Marked
from scenario_compiler.roads.locate_points import locate_point, locate_points

ENTRIES: tuple[Marked, ...] = (locate_point, locate_points)
"""Entries by which a form is called, in both forms."""
