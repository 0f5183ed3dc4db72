"""How the automation `lane_detection` drives, unless a scenario's properties change it.

The look-ahead of 0.4 s within 3 to 20 m and the gain of 2 are the AISA toolkit's. The controller's parameters have
these defaults. Surrogate perception drives by all of them, and ideal perception drives bends by them.
"""

from __future__ import annotations

LANE_KEEPING: dict[str, float] = {
    "look_ahead_time": 0.4,
    "look_ahead_min": 3.0,
    "look_ahead_max": 20.0,
    "speed_gain": 2.0,
    "time_gap": 1.5,
    "minimum_gap": 2.0,
    "lateral_acceleration": 2.5,
    "following_acceleration": 1.5,
    "following_deceleration": 2.0,
}
"""Name of a parameter to its default, in the order in which the engine has them; SI units."""

TRUSTED = 0.3
"""Confidence from which a boundary determines the path: the request's own threshold."""
