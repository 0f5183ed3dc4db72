"""The forms of all positions of OpenSCENARIO."""

from __future__ import annotations

from scenario_compiler.openscenario.motion import ON_CURVES
from scenario_compiler.openscenario.points import POINTS
from scenario_compiler.openscenario.spelling import Forms

POSITIONS = Forms((*POINTS.forms, *ON_CURVES.forms))
"""The positions that OpenSCENARIO can express."""
