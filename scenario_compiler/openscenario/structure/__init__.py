"""Checks whether an OpenSCENARIO file of version 1.0 to 1.3 has the structure of its version.

In: a document. Out: the version, and diagnostics with line and column (`check_structure`). The tables of elements
(`*_elements`) and of words contain the facts; `grammar` combines them, `check` compares a file with them, `elements`
lists the versions that have each element. Imports the hall, and the codes and files of `openscenario`.
"""

from scenario_compiler.openscenario.structure.check import (
    check_structure,
    file_version,
    is_of_old_format,
    report_old_format,
)
from scenario_compiler.openscenario.structure.elements import Element, elements

__all__ = ["Element", "check_structure", "elements", "file_version", "is_of_old_format", "report_old_format"]
