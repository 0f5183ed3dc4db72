"""The one loop that executes plans, and the door to the worlds.

In: a `Plan` and a `World`. Out: a `Recording`. Imports everything below it but no front end: a plan from JSON runs with
`source` never imported.
"""

from scenario_compiler.runtime.loop import open_world, run

__all__ = ["open_world", "run"]
