"""Colours and words of a report.

The colours are those of Okabe and Ito (2008), which readers with any common colour vision can distinguish, and
placeholders for the page's own colours, which differ between light and dark.
"""

from __future__ import annotations

from scenario_compiler.recording.names import EventKind, TimelineState

BLUE = "#0072B2"
SKY = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
ORANGE = "#E69F00"
VERMILION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#8A8F98"
BLACK = "#000000"

INK = "#010203"
QUIET = "#020304"
LINE = "#030405"
PAPER = "#040506"
ASPHALT = "#050607"
VERGE = "#060708"
PAVEMENT = "#070809"
PAINT = "#08090a"
EGO = "#090a0b"
THEME = {
    INK: "var(--ink)",
    QUIET: "var(--quiet)",
    LINE: "var(--line)",
    PAPER: "var(--paper)",
    ASPHALT: "var(--asphalt)",
    VERGE: "var(--verge)",
    PAVEMENT: "var(--pavement)",
    PAINT: "var(--paint)",
    EGO: "var(--ego)",
}
"""Colours with which plots are drawn, and the page's variables that replace them."""

STATE_COLOURS: dict[TimelineState, str] = {
    "automated": SKY,
    "warning": YELLOW,
    "request": ORANGE,
    "escalation": VERMILION,
    "manual": GREEN,
    "hand_back": BLUE,
    "minimum_risk": PURPLE,
    "standstill": GREY,
    "collision": BLACK,
}

MOMENT_COLOURS: dict[EventKind, str] = {
    "warning": YELLOW,
    "request": ORANGE,
    "escalation": VERMILION,
    "response": GREEN,
    "minimum_risk": PURPLE,
    "collision": BLACK,
    "standstill": GREY,
}

WORDS = {
    "automated": "automated",
    "warning": "warning",
    "request": "takeover request",
    "escalation": "escalation",
    "manual": "driver in control",
    "hand_back": "handing back",
    "minimum_risk": "minimum-risk manoeuvre",
    "standstill": "standstill",
    "response": "driver takes over",
    "collision": "collision",
    "maximum_drac": "maximum DRAC",
    "minimum_post_encroachment_time": "minimum post-encroachment time",
    "minimum_risk_time": "minimum-risk time",
}
"""Names of states, moments and measures for readers, where they are more than the words of the program's name."""


def words_of(name: str) -> str:
    """Return the name of a state, an event, a cause or a measure for readers."""
    return WORDS.get(name, name.replace("_", " "))
