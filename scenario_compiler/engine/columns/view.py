"""Indices of the features of surrogate perception, for one side of the lane.

Distances are along the path from the vehicle's reference point. Signs are those of the left side; for the right side
everything is mirrored, so that one function serves both. The coefficients' file uses the same names.
"""

from __future__ import annotations

WINDOWS = 5
"""Number of windows in which the paint is sampled: from 0 to 6 m (the stretch driven over last), then to 10, 14, 18, 26
m.
"""

V_PAINT = 0
V_OTHER_PAINT = 5
V_BROKEN = 10
V_WIDTH = 11
V_YELLOW = 12
V_OTHER_BROKEN = 13
V_JUNCTION_NEAR = 14
V_JUNCTION_FAR = 15
V_BEND_NEAR = 16
V_TOWARDS_NEAR = 17
V_BEND_FAR = 18
V_TOWARDS_FAR = 19
V_GRADE_CHANGE = 20
V_LANE_WIDTH = 21
V_WIDENING = 22
V_CONTRAST = 23
V_DARKNESS = 24
V_RAIN = 25
V_HAZE = 26
V_NOISE = 27
V_BLACKOUT = 28
V_BLUR = 29
V_DIRT = 30
V_IMPULSES = 31
V_OVEREXPOSURE = 32
V_DEAD_ROWS = 33
V_QUANTISATION = 34
V_LATENCY = 35
V_SPEED = 36
V_OFFSET = 37
V_HEADING = 38
V_PITCH = 39
V_LEADER = 40
V_COVERED = 41
V_OTHER_COVERED = 42
V_SEEN = 43
V_OTHER_SEEN = 44
VIEW_SIZE = 45

HIDDEN = 16
OUTPUTS = 2
UNITS = HIDDEN + OUTPUTS
"""Size of the network of surrogate perception: hidden units and outputs."""

VIEW_NAMES = (
    *("paint 0-6 m", "paint 6-10 m", "paint 10-14 m", "paint 14-18 m", "paint 18-26 m"),
    *("other side 0-6 m", "other side 6-10 m", "other side 10-14 m", "other side 14-18 m", "other side 18-26 m"),
    *("broken", "line width", "yellow", "other side broken", "junction near", "junction far"),
    *("bend near", "bend towards near", "bend far", "bend towards far", "change of grade"),
    *("lane width", "widening", "contrast", "darkness", "rain", "haze"),
    *("noise", "blackout", "blur", "dirt", "impulses", "overexposure", "dead rows", "quantisation", "latency"),
    *("speed", "offset", "heading", "pitch", "leader", "covered", "other side covered"),
    *("paint 6-18 m", "other side 6-18 m"),
)
"""Name of each feature. Shares are from 0 to 1, other values in SI units, except: curvatures in 1/40 m, the contrast
and the last two as logarithms, the darkness in units of 10 degrees of the sun below the horizon, rain and failures as
shares of their greatest values.
"""
