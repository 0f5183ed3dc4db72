"""The loop that executes plans in worlds.

In: a `Plan` and a `World`. Out: a `Recording`. Imports the packages below it except the languages: a plan from JSON
runs without importing `source`.
"""

from scenario_compiler.runtime.loop import open_world, run

__all__ = ["open_world", "run"]
