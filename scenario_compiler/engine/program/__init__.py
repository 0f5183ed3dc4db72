"""Makes a program from a plan: indices for ids, codes for words, and one slot for every number.

`build` goes through the plan; what a word becomes stands in a table by the word's type: `positions.POSITIONS`,
`actions.ACTIONS` and `conditions.CONDITIONS`, each entry a small function that returns the word's row.
"""

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.program.build import Numbers, build_program, rows

__all__ = ["Numbers", "Program", "build_program", "rows"]
