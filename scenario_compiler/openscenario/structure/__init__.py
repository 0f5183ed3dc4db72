"""Checks whether an OpenSCENARIO file of version 1.0 to 1.3 has the structure of its version.

What enters: a document. What leaves: the version and diagnostics with line and column (`check_structure`). The tables
of elements (`*_elements`) and of words are the facts; `grammar` binds them, `check` holds a file to them, `elements`
tells which version has what. Imports the hall, and the codes and files of `openscenario`.
"""

from scenario_compiler.openscenario.structure.check import (
    check_structure,
    file_version,
    is_of_old_format,
    report_old_format,
)
from scenario_compiler.openscenario.structure.elements import Element, elements

__all__ = ["Element", "check_structure", "elements", "file_version", "is_of_old_format", "report_old_format"]
