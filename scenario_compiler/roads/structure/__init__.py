"""Checks whether a road file has the structure of its version of OpenDRIVE.

What enters: a document. What leaves: a verdict and diagnostics with line and column (`check_structure`). The tables
of elements (`road_elements`, `object_elements`) and words are the facts, for versions 1.1 to 1.8; `grammar` binds them
into OpenDRIVE's grammar, `check` holds a file to it. Imports the hall.
"""

from scenario_compiler.roads.structure.check import check_structure, road_version

__all__ = ["check_structure", "road_version"]
