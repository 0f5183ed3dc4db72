"""The codes of structural faults of a scenario file in OpenSCENARIO XML (SC701 to SC713)."""

from scenario_compiler.diagnostics import Code, Severity

_WHY = (
    "\n\nThe file is checked against the version that its <FileHeader> names; programs that trust it may reject the "
    "file or skip the element."
)

UNKNOWN_ELEMENT = Code(
    "SC701",
    "unknown-scenario-element",
    "No version of OpenSCENARIO has this element at this place:\n\n"
    '    <Entities><ScenarioObjekt name="Ego">     the element is called <ScenarioObject>\n\n'
    "Correct the spelling, or move the element to the right parent." + _WHY,
)
UNKNOWN_ATTRIBUTE = Code(
    "SC702",
    "unknown-scenario-attribute",
    "No version of OpenSCENARIO has this attribute of the element:\n\n"
    '    <WorldPosition x="1" y="2" heading="0"/>     the attribute is called h\n\n'
    "Correct the spelling or remove it." + _WHY,
)
MISSING_ATTRIBUTE = Code(
    "SC703",
    "missing-scenario-attribute",
    'A required attribute is missing:\n\n    <WorldPosition x="1"/>     y is missing' + _WHY,
)
BAD_VALUE = Code(
    "SC704",
    "bad-scenario-value",
    "The value of an attribute does not have the attribute's type in OpenSCENARIO: it is not a number, or not one "
    "of the allowed words. $name is allowed in place of any value, and since 1.1 ${expression} in place of "
    "numbers and booleans:\n\n"
    '    <AbsoluteTargetSpeed value="13,9"/>     write 13.9' + _WHY,
)
MISPLACED_ELEMENT = Code(
    "SC705",
    "misplaced-scenario-element",
    "The element is allowed here, but it occurs too often, or together with an element that excludes it:\n\n"
    "    <Position> <WorldPosition .../> <LanePosition .../> </Position>     keep one of the two" + _WHY,
)
MISSING_ELEMENT = Code(
    "SC706",
    "missing-scenario-element",
    'A required child element is missing:\n\n    <Maneuver name="brake"/>     an <Event> is missing inside' + _WHY,
)
STRAY_TEXT = Code(
    "SC707",
    "stray-scenario-text",
    "There is text where OpenSCENARIO does not allow any, so it has no effect. Usually it is a tag without its "
    "angle brackets, or a comment without <!-- -->:\n\n"
    "    <Entities> the vehicles <ScenarioObject .../> </Entities>" + _WHY,
)
OTHER_VERSION = Code(
    "SC708",
    "word-of-another-version",
    "The element, attribute, value or order belongs to other versions of OpenSCENARIO than the version in the "
    "file's <FileHeader>; the help names these versions:\n\n"
    '    <FileHeader revMajor="1" revMinor="1" .../> ... <Event priority="override">     the word of 1.2\n\n'
    "Correct the version in the header, or use the words of that version. Words that changed between versions are "
    "overwrite (1.0, 1.1) and override (1.2), cartesianDistance (1.0) and euclidianDistance (1.1), model (1.0) "
    "and model3d (1.1). A run accepts the words of all versions, with a warning.",
)
MISLABELLED = Code(
    "SC709",
    "mislabelled-version",
    "The <FileHeader> gives the version 0.9. This was a different format before OpenSCENARIO 1.0; many files have "
    "this version in their header without being in that format:\n\n"
    '    <FileHeader revMajor="0" revMinor="9" .../>     with the elements of 1.0\n\n'
    'Write the version that the message names, such as revMajor="1" revMinor="0". A run reads such a file as 1.0.',
)
ELEMENT_ORDER = Code(
    "SC710",
    "scenario-element-order",
    "All required children are present, but in another order than that of OpenSCENARIO:\n\n"
    "    <OpenSCENARIO> <FileHeader .../> <Entities/> <RoadNetwork/> ...     <RoadNetwork> comes first\n\n"
    "The help gives the order. A run accepts any order; other programs may not.",
)
BLANKS = Code(
    "SC711",
    "blanks-in-empty-element",
    "An element that only has attributes contains spaces or a line break, which the schema does not allow:\n\n"
    '    <Center x="1.4" y="0" z="0.9"> </Center>     write <Center x="1.4" y="0" z="0.9"/>\n\n'
    "A run ignores them; other programs may reject the file.",
)
LOOSE_VALUE = Code(
    "SC712",
    "loosely-written-value",
    "The meaning of the value is clear, but its form is not that of OpenSCENARIO: True instead of true, a space "
    "beside a word, a date without a time:\n\n"
    '    <FileHeader date="2020-02-20" .../>     write 2020-02-20T00:00:00\n\n'
    "The help gives the right form. A run accepts the value; other programs may not.",
)
OUT_OF_RANGE = Code(
    "SC713",
    "number-out-of-range",
    "The number is beyond the range that OpenSCENARIO's documentation gives for this attribute. The schemas do not "
    "have these ranges, so the file is valid; a run uses the number as far as it can be used:\n\n"
    '    <Condition name="start" delay="-1" .../>     a delay is at least 0 s\n'
    '    <Sun elevation="45" .../>     angles are in radians, not in degrees\n\n'
    "The range is that of the class model, which ASAM's reference implementation checks too, or that of the quantity: "
    "lengths, durations and tolerances are not negative. Values of parameters are not checked.",
    Severity.WARNING,
)
