"""The number that a change of the weather leaves as it is; the engine reads it too, without the words."""

KEPT = -1.0
"""Number of a change of the weather that keeps its present value: CARLA's sign for a number that is left to the map."""
