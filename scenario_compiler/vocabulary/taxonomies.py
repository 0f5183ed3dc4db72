"""Published taxonomies of situations that `<classification>` can name, as far as their tables are public."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Taxonomy(NamedTuple):
    """A published list of situations.

    Attributes:
        title: Name of the list.
        source: Publication in which the situations appear.
        situations: Description of each situation, by its number or name.
        whole: Whether the list is complete; otherwise it lacks some situations of the publication.
    """

    title: str
    source: str
    situations: Mapping[str, str] = MappingProxyType({})
    whole: bool = True


TAXONOMIES: Mapping[str, Taxonomy] = {
    "gold2018": Taxonomy(
        "Gold et al. 2018",
        "Gold, Naujoks, Radlmayr, Bellem and Jarosch 2018: the situations that the AISA paper (HRI 2025, table 1) "
        "cites; the others are not public",
        {
            "2": "Sensor failure (total)",
            "5": "Lane change from an entrance ramp is not possible",
            "7": "Road narrows (detected by on-board sensors)",
            "9": "Danger zone or obstacle ahead",
            "10": "Loss of reference signals (lane markings missing)",
        },
        whole=False,
    ),
    "r157": Taxonomy(
        "UN R157 (ALKS)",
        "annex 5, tests 4.1 to 4.6, in the names of ASAM's public OSC-ALKS-scenarios",
        {
            "4.1_1": "Lane keeping: free driving",
            "4.1_2": "Lane keeping: swerving lead vehicle",
            "4.1_3": "Lane keeping: side vehicle",
            "4.2_1": "Blocked lane: fully blocking target",
            "4.2_2": "Blocked lane: partially blocking target",
            "4.2_3": "Blocked lane: crossing pedestrian",
            "4.2_4": "Blocked lane: multiple blocking targets",
            "4.3_1": "Following a lead vehicle: comfortable",
            "4.3_2": "Following a lead vehicle: emergency brake",
            "4.4_1": "Cut-in: no collision",
            "4.4_2": "Cut-in: unavoidable collision",
            "4.5_1": "Cut-out: fully blocking target",
            "4.5_2": "Cut-out: multiple blocking targets",
            "4.6_1": "Field of view: forward detection range",
            "4.6_2": "Field of view: lateral detection range",
        },
    ),
    "euroncap": Taxonomy(
        "Euro NCAP (crash avoidance)",
        "protocols AEB VRU 2023 and Crash Avoidance Frontal Collisions 2026: the tests of the public "
        "OSC-NCAP-scenarios",
        {
            "CCRs": "Car to car, rear, stationary",
            "CCRm": "Car to car, rear, moving",
            "CCRb": "Car to car, rear, braking",
            "CCFtap": "Car to car, front, turn across path",
            "CMRs": "Car to motorcyclist, rear, stationary",
            "CMRb": "Car to motorcyclist, rear, braking",
            "CMFtap": "Car to motorcyclist, front, turn across path",
            "CPFA": "Car to pedestrian, farside adult",
            "CPNA": "Car to pedestrian, nearside adult",
            "CPLA": "Car to pedestrian, longitudinal adult",
            "CPTA": "Car to pedestrian, turning adult",
            "CBNA": "Car to bicyclist, nearside adult",
            "CBNAO": "Car to bicyclist, nearside adult, obstructed",
            "CBFA": "Car to bicyclist, farside adult",
            "CBLA": "Car to bicyclist, longitudinal adult",
        },
        whole=False,
    ),
}
"""Taxonomies by the short names that `scheme` uses."""
