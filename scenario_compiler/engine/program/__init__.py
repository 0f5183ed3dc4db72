"""Makes a program from a plan: indices for ids, codes for words, and a slot for every number.

`build` goes through the plan. The row of a position is made by `positions.POSITIONS`, by the type of its word; those of
actions and conditions are made by their entries (`moves.table`, `story.table`).
"""

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.program.build import Numbers, build_program

__all__ = ["Numbers", "Program", "build_program"]
