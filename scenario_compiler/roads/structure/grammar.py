"""OpenDRIVE's grammar: the combined tables of its elements and words, with additions to the general notation.

`...` is additional data (userData, include, dataQuality), `..` the same but not in 1.6 and 1.7 (whose schemas leave it
out). Before 1.5 no attribute is required.
"""

from __future__ import annotations

from scenario_compiler.roads.structure import codes
from scenario_compiler.roads.structure.conditions import CONDITIONS, FIRST_MINOR_WITH_CONDITIONS
from scenario_compiler.roads.structure.object_elements import (
    JUNCTION_ELEMENTS,
    OBJECT_ELEMENTS,
    SIGNAL_ELEMENTS,
)
from scenario_compiler.roads.structure.road_elements import LANE_ELEMENTS, ROAD_ELEMENTS
from scenario_compiler.roads.structure.words import KINDS, WORDS
from scenario_compiler.structure.content import Choice, Model, Name, Repeat, Sequence
from scenario_compiler.structure.grammar import Faults, Grammar
from scenario_compiler.structure.notation import Declaration

FIRST_MINOR, LAST_MINOR = 1, 8
"""First and last declared minor version of OpenDRIVE 1."""


def _additional(minor: int) -> Model:
    """Return the model of additional data: at most one of each at first, then any number, in any order since 1.6."""
    data, include, quality = (
        Name("userData", "userData"),
        Name("include", "include"),
        Name("dataQuality", "dataQuality"),
    )
    if minor >= 6:
        return Repeat(Choice((data, include, quality)), 0, None)
    most = 1 if minor < 3 else None
    parts: tuple[Model, ...] = (Repeat(data, 0, most), Repeat(include, 0, most))
    return Sequence(parts if minor < 5 else (*parts, Repeat(quality, 0, 1)))


def _additional_but_in_6_and_7(minor: int) -> Model:
    return Sequence(()) if minor in {6, 7} else _additional(minor)


OPENDRIVE = Grammar(
    name="OpenDRIVE",
    root="OpenDRIVE",
    tables=(ROAD_ELEMENTS, LANE_ELEMENTS, OBJECT_ELEMENTS, SIGNAL_ELEMENTS, JUNCTION_ELEMENTS),
    words=WORDS,
    kinds=KINDS,
    minors=range(FIRST_MINOR, LAST_MINOR + 1),
    faults=Faults(
        unknown_element=codes.UNKNOWN_ELEMENT,
        unknown_attribute=codes.UNKNOWN_ATTRIBUTE,
        missing_attribute=codes.MISSING_ATTRIBUTE,
        missing_element=codes.MISSING_ELEMENT,
        bad_value=codes.BAD_VALUE,
        order=codes.MISPLACED_ELEMENT,
        misplaced=codes.MISPLACED_ELEMENT,
        stray_text=codes.STRAY_TEXT,
        excluded=codes.EXCLUDED,
    ),
    words_since=4,
    required_since=5,
    groups={"...": _additional, "..": _additional_but_in_6_and_7},
    conditions=CONDITIONS,
    conditions_since=FIRST_MINOR_WITH_CONDITIONS,
)


NAMESPACE = "http://code.asam.net/simulation/standard/opendrive_schema"
"""Namespace of ASAM's OpenDRIVE, which files from 1.6 on may have, although their schemas have none."""


def may_have_namespace(namespace: str, minor: int) -> bool:
    """Return whether the elements of a file of version 1.`minor` may be in a namespace; VIRES had one until 1.2."""
    bare = namespace.rstrip("/").replace("https://", "http://")
    return not namespace or minor <= 2 or (minor >= 6 and bare == NAMESPACE)


def declarations(minor: int) -> dict[str, Declaration]:
    """Return the declarations of OpenDRIVE 1.`minor`, by name."""
    return OPENDRIVE.declarations(minor)
