"""OpenSCENARIO's grammar: the combined tables of its elements and words."""

from __future__ import annotations

from scenario_compiler.openscenario.structure import codes
from scenario_compiler.openscenario.structure import document_elements as document
from scenario_compiler.openscenario.structure import entity_elements as entity
from scenario_compiler.openscenario.structure import global_action_elements as global_action
from scenario_compiler.openscenario.structure import position_elements as position
from scenario_compiler.openscenario.structure import private_action_elements as private_action
from scenario_compiler.openscenario.structure import storyboard_elements as storyboard
from scenario_compiler.openscenario.structure.distribution_elements import DISTRIBUTION_ELEMENTS
from scenario_compiler.openscenario.structure.words import KINDS, WORDS, is_parameter, loosely
from scenario_compiler.structure.grammar import Faults, Grammar

FIRST_MINOR, LAST_MINOR = 0, 3
"""First and last declared minor version of OpenSCENARIO XML 1."""

OPENSCENARIO = Grammar(
    name="OpenSCENARIO",
    root="OpenSCENARIO",
    tables=(
        document.DOCUMENT_ELEMENTS,
        document.PARAMETER_ELEMENTS,
        document.CATALOG_ELEMENTS,
        document.ROAD_NETWORK_ELEMENTS,
        entity.ENTITY_ELEMENTS,
        entity.OBJECT_ELEMENTS,
        position.POSITION_ELEMENTS,
        position.ROUTE_ELEMENTS,
        position.TRAJECTORY_ELEMENTS,
        storyboard.STORYBOARD_ELEMENTS,
        storyboard.TRIGGER_ELEMENTS,
        storyboard.ENTITY_CONDITION_ELEMENTS,
        storyboard.VALUE_CONDITION_ELEMENTS,
        private_action.PRIVATE_ACTION_ELEMENTS,
        private_action.LONGITUDINAL_ACTION_ELEMENTS,
        private_action.LATERAL_ACTION_ELEMENTS,
        private_action.SYNCHRONIZE_ACTION_ELEMENTS,
        private_action.ROUTING_ACTION_ELEMENTS,
        private_action.CONTROLLER_ACTION_ELEMENTS,
        private_action.APPEARANCE_ACTION_ELEMENTS,
        private_action.TRAILER_ACTION_ELEMENTS,
        global_action.GLOBAL_ACTION_ELEMENTS,
        global_action.VALUE_ACTION_ELEMENTS,
        global_action.ENVIRONMENT_ELEMENTS,
        global_action.SIGNAL_ACTION_ELEMENTS,
        global_action.TRAFFIC_ACTION_ELEMENTS,
        DISTRIBUTION_ELEMENTS,
    ),
    words=WORDS,
    kinds=KINDS,
    minors=range(FIRST_MINOR, LAST_MINOR + 1),
    faults=Faults(
        unknown_element=codes.UNKNOWN_ELEMENT,
        unknown_attribute=codes.UNKNOWN_ATTRIBUTE,
        missing_attribute=codes.MISSING_ATTRIBUTE,
        missing_element=codes.MISSING_ELEMENT,
        bad_value=codes.BAD_VALUE,
        order=codes.ELEMENT_ORDER,
        misplaced=codes.MISPLACED_ELEMENT,
        stray_text=codes.STRAY_TEXT,
        blank=codes.BLANKS,
        other_version=codes.OTHER_VERSION,
        loose=codes.LOOSE_VALUE,
        out_of_range=codes.OUT_OF_RANGE,
    ),
    stands_for_word=is_parameter,
    loosely=loosely,
)
