"""Indices of the features of surrogate perception.

A view has the features of the left side, then those of the right side, then those of both. The network takes them for
one side at a time: that side's own, the other side's, those of both. Signs of a side's features are mirrored for the
right side, so that one network serves both. Distances are ahead of the camera. The names are those of the file of
coefficients.
"""

from __future__ import annotations

SAMPLES = 13
"""The paint is looked at in 13 pieces of 2 m from 4 to 30 m, which are summed up in windows of 4 to 6 m."""

S_STRENGTH = 0
S_QUALITY = 5
S_SEEN = 6
S_STRONG = 7
S_FARTHEST = 8
S_CONTRAST = 9
S_HIDDEN = 10
S_IN_VIEW = 11
S_BESIDE = 12
S_VOTES = 13
S_BROKEN = 14
S_WIDTH = 15
S_YELLOW = 16
S_DOUBLE = 17
S_RIVAL = 18
S_RIVAL_PAINT = 19
S_EDGE = 20
S_COVERED = 21
S_OFFSET = 22
S_HEADING = 23
S_BEND_NEAR = 24
S_BEND_FAR = 25
S_BEARING = 26
S_VOTES_LATELY = 27
SIDE_SIZE = 28
"""Places of a side's own features, from where that side begins."""

V_BOTH = 2 * SIDE_SIZE
V_JUNCTION_NEAR = V_BOTH
V_JUNCTION_FAR = V_BOTH + 1
V_TILT = V_BOTH + 2
V_TILT_SIZE = V_BOTH + 3
V_GRADE_CHANGE = V_BOTH + 4
V_LANE_WIDTH = V_BOTH + 5
V_WIDENING = V_BOTH + 6
V_CURVED_NEAR = V_BOTH + 7
V_CURVED_FAR = V_BOTH + 8
V_CONTRAST = V_BOTH + 9
V_LIGHT = V_BOTH + 10
V_RAIN = V_BOTH + 11
V_WATER = V_BOTH + 12
V_AIR = V_BOTH + 13
V_GLARE = V_BOTH + 14
V_CLOUD = V_BOTH + 15
V_CLUTTER = V_BOTH + 16
V_MEADOW_NEAR = V_BOTH + 17
V_MEADOW_FAR = V_BOTH + 18
V_DARKNESS = V_BOTH + 19
V_NOISE = V_BOTH + 20
V_BLACKOUT = V_BOTH + 21
V_BLUR = V_BOTH + 22
V_DIRT = V_BOTH + 23
V_IMPULSES = V_BOTH + 24
V_OVEREXPOSURE = V_BOTH + 25
V_DEAD_ROWS = V_BOTH + 26
V_QUANTISATION = V_BOTH + 27
V_LATENCY = V_BOTH + 28
V_SPEED = V_BOTH + 29
V_PITCH = V_BOTH + 30
V_LEADER = V_BOTH + 31
V_OBSTACLE = V_BOTH + 32
V_OBSTACLE_WIDTH = V_BOTH + 33
VIEW_SIZE = V_BOTH + 34
"""Places of the features of both sides, and the number of all."""

HIDDEN = 32
OUTPUTS = 2
UNITS = HIDDEN + OUTPUTS
"""Size of the network of surrogate perception: hidden units and outputs."""

SIDE_NAMES = (
    *("paint 4-8 m", "paint 8-12 m", "paint 12-18 m", "paint 18-24 m", "paint 24-30 m"),
    *("quality", "painted and seen", "strength", "farthest paint", "contrast", "hidden", "in view", "distance"),
    *("votes", "broken", "width of line", "yellow", "double", "distance of rival", "paint of rival", "pavement beyond"),
    *("covered", "offset", "heading", "bend near", "bend far", "bearing of obstacle", "votes lately"),
)
VIEW_NAMES = (
    *SIDE_NAMES,
    *(f"other side: {name}" for name in SIDE_NAMES),
    *("junction near", "junction far", "tilt", "size of tilt", "change of grade", "lane width", "widening"),
    *("curved near", "curved far", "contrast in the weather", "light", "rain", "water", "air", "glare", "clouds"),
    *("clutter", "meadow near", "meadow far", "darkness", "noise", "blackout", "blur", "dirt", "impulses"),
    *("overexposure", "dead rows", "quantisation", "latency", "speed", "pitch", "leader", "obstacle"),
    "width of obstacle",
)
"""The feature at each index."""
