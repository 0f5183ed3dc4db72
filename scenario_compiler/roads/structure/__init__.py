"""Checks whether a road file has the structure of its version of OpenDRIVE.

In: a document. Out: a verdict, and diagnostics with line and column (`check_structure`). The tables of elements
(`road_elements`, `object_elements`) and words contain the facts for versions 1.1 to 1.8; `grammar` combines them to
OpenDRIVE's grammar, and `check` compares a file with it. Imports the hall.
"""

from scenario_compiler.roads.structure.check import check_structure, road_version

__all__ = ["check_structure", "road_version"]
