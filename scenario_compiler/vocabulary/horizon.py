"""Limits shared by the language and the engine. They are separate because the engine is built without the words."""

HORIZON = 30.0
"""Greatest time to collision, s. A longer one is undefined, because nobody keeps speed and path for so long.

The number is our own choice. Without it, almost equal speeds would give meaningless times of hours.
"""

TYRES_HOLD = 8.3
"""Greatest lateral acceleration on a dry road, m/s2: 0.85 times gravity, from the middle of the peak coefficients of
adhesion of dry asphalt and concrete, 0.8 to 0.9 (Wong, Theory of Ground Vehicles)."""

TOLERANCE = 1.0e-6
"""Tolerance of every comparison of times, s, and of the values of conditions, in their units (esmini 3.6)."""
