"""Tables of the parts of each language that are read, executed and exported, made from the declarations.

One module a language, each with a function that returns its `Table`; `TABLES` names them. Words of a language go in,
rows of text come out; the command line and the generated page show them.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenario_compiler.coverage.table import Table

TABLES = {
    "conflict": "scenario_compiler.coverage.conflict:conflict_table",
    "openscenario": "scenario_compiler.coverage.openscenario:openscenario_table",
}
"""The languages, and the function that returns the table of each; imported when asked for."""


def table_of(language: str) -> Table:
    """Return the table of a language of `TABLES`."""
    module, _, function = TABLES[language].partition(":")
    make: Callable[[], Table] = getattr(importlib.import_module(module), function)
    return make()
