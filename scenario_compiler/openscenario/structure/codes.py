"""The codes of structural faults of a scenario file in OpenSCENARIO XML (SC701 to SC713)."""

from scenario_compiler.diagnostics import Code

_WHY = (
    "\n\nThe file is checked against the version that its <FileHeader> names; programs that trust it may reject the "
    "file or skip the element."
)

UNKNOWN_ELEMENT = Code(
    "SC701",
    "unknown-scenario-element",
    "OpenSCENARIO has no such element at this place, in no version:\n\n"
    '    <Entities><ScenarioObjekt name="Ego">     <ScenarioObject> is known\n\n'
    "Correct the spelling, or move the element to the parent that it belongs to." + _WHY,
)
UNKNOWN_ATTRIBUTE = Code(
    "SC702",
    "unknown-scenario-attribute",
    "The element has no such attribute, in no version of OpenSCENARIO:\n\n"
    '    <WorldPosition x="1" y="2" heading="0"/>     the heading is h\n\n'
    "Correct the spelling or remove it." + _WHY,
)
MISSING_ATTRIBUTE = Code(
    "SC703",
    "missing-scenario-attribute",
    'An attribute that the element must have is missing:\n\n    <WorldPosition x="1"/>     where is y?' + _WHY,
)
BAD_VALUE = Code(
    "SC704",
    "bad-scenario-value",
    "The value of an attribute is not of the type that OpenSCENARIO gives it: not a number, or none of its words. "
    "$name stands for any value, and since 1.1 ${expression} for numbers and booleans:\n\n"
    '    <AbsoluteTargetSpeed value="13,9"/>     write 13.9' + _WHY,
)
MISPLACED_ELEMENT = Code(
    "SC705",
    "misplaced-scenario-element",
    "The element is known here, but it stands too often, or beside one that excludes it:\n\n"
    "    <Position> <WorldPosition .../> <LanePosition .../> </Position>     one of the two" + _WHY,
)
MISSING_ELEMENT = Code(
    "SC706",
    "missing-scenario-element",
    'A child that the element must have is missing:\n\n    <Maneuver name="brake"/>     with no <Event>' + _WHY,
)
STRAY_TEXT = Code(
    "SC707",
    "stray-scenario-text",
    "Text stands where OpenSCENARIO has none, so it has no effect; mostly it is a tag that lost its bracket, or a "
    "comment without <!-- -->:\n\n"
    "    <Entities> the vehicles <ScenarioObject .../> </Entities>" + _WHY,
)
OTHER_VERSION = Code(
    "SC708",
    "word-of-another-version",
    "The element, attribute, value or order belongs to other versions of OpenSCENARIO than the one that the file's "
    "<FileHeader> names; the help names them:\n\n"
    '    <FileHeader revMajor="1" revMinor="1" .../> ... <Event priority="override" ...>     the word of 1.2\n\n'
    "Name the version that the file is written in, or write what its version has. The other words of that kind: "
    "overwrite (1.0, 1.1) and override (1.2), cartesianDistance (1.0) and euclidianDistance (1.1), model (1.0) and "
    "model3d (1.1). A run takes the words of all versions, with a warning.",
)
MISLABELLED = Code(
    "SC709",
    "mislabelled-version",
    "The <FileHeader> says 0.9. That was another format, before OpenSCENARIO 1.0, and many files say so that are "
    "not written in it:\n\n"
    '    <FileHeader revMajor="0" revMinor="9" .../>     with the elements of 1.0\n\n'
    'Write the version that the message names, such as revMajor="1" revMinor="0". A run reads such a file as 1.0.',
)
ELEMENT_ORDER = Code(
    "SC710",
    "scenario-element-order",
    "All the children are there that are needed, but in another order than OpenSCENARIO fixes:\n\n"
    "    <OpenSCENARIO> <FileHeader .../> <Entities/> <RoadNetwork/> ...     <RoadNetwork> comes first\n\n"
    "The help gives the order. A run does not mind, other programs may.",
)
BLANKS = Code(
    "SC711",
    "blanks-in-empty-element",
    "Blanks or a line break stand in an element that has attributes only; by the schema not even they may:\n\n"
    '    <Center x="1.4" y="0" z="0.9"> </Center>     write <Center x="1.4" y="0" z="0.9"/>\n\n'
    "A run does not mind, other programs may.",
)
LOOSE_VALUE = Code(
    "SC712",
    "loosely-written-value",
    "What the value means is plain, but it is not written as OpenSCENARIO demands: True in place of true, a blank "
    "beside a word, a day without its time:\n\n"
    '    <FileHeader date="2020-02-20" .../>     write 2020-02-20T00:00:00\n\n'
    "Write what the help says. A run takes it as meant, other programs may not.",
)
