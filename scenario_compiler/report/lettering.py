"""Draws texts from files into pictures letter by letter, without interpreting markup in them."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib.figure import Figure
from matplotlib.text import Text

from scenario_compiler.legible import legible

LETTERING: Any = {"text.parse_math": False}
"""Settings with which a text with dollar signs is not interpreted as a formula."""


@contextmanager
def lettered(figure: Figure) -> Iterator[Figure]:
    """Yield a figure for saving: invisible characters are escapes, and letters without a glyph are boxes."""
    for text in figure.findobj(Text):
        lines = text.get_text().split("\n")
        text.set_text("\n".join(map(legible, lines)))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from", category=UserWarning)
        yield figure
