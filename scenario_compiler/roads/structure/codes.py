"""The codes of structural faults of a road file."""

from scenario_compiler.diagnostics import Code, Severity

_WHY = (
    " The file is checked against the version that its header names (revMajor, revMinor); programs that trust that "
    "version may "
    "reject the file or skip the element."
)

UNKNOWN_ELEMENT = Code(
    "SC320",
    "unknown-road-element",
    "OpenDRIVE has no such element at this place in the file's version. It is not read."
    '\n\n    <lane id="-1" type="driving"><colour .../></lane>     no version has <colour> here'
    "\n\nCorrect the name, move the element to where it belongs, keep data of your own in <userData>, or raise "
    "revMinor to the version that has it." + _WHY,
)
UNKNOWN_ATTRIBUTE = Code(
    "SC321",
    "unknown-road-attribute",
    "The element has no such attribute in the file's version of OpenDRIVE."
    '\n\n    <lane id="-1" typ="driving">     type'
    "\n\nCorrect the name, or raise revMinor to the version that has it." + _WHY,
)
MISSING_ATTRIBUTE = Code(
    "SC322",
    "missing-road-attribute",
    "An attribute that the element must have is missing. Where it is read, its default (mostly 0) is used."
    '\n\n    <geometry s="0" x="0" y="0" hdg="0">     length is missing'
    "\n\nAdd the attribute." + _WHY,
)
BAD_VALUE = Code(
    "SC323",
    "bad-road-value",
    "The value of an attribute (or the text of an element) is not of the kind that OpenDRIVE demands: not a number, "
    "outside its limits, or a word that the file's version does not know."
    '\n\n    <lane id="-1" type="driveway">     driving'
    '\n    <road length="abc" ...>     a number in metres'
    "\n\nWrite a value of the kind that the message names." + _WHY,
)
MISPLACED_ELEMENT = Code(
    "SC324",
    "misplaced-road-element",
    "The element is known here, but not in this order or not this often: OpenDRIVE fixes the order of an element's "
    "children."
    "\n\n    <road ...><lanes>...</lanes><planView>...</planView></road>     <planView> comes first"
    "\n\nPut the children in the order that the message names, and each as often as it may stand." + _WHY,
)
MISSING_ELEMENT = Code(
    "SC325",
    "missing-road-element",
    "A child that the element must have is missing."
    '\n\n    <road id="4" ...><planView>...</planView></road>     without <lanes>'
    "\n\nAdd the child." + _WHY,
)
STRAY_TEXT = Code(
    "SC326",
    "stray-road-text",
    "Text stands where OpenDRIVE has none; it is not read."
    '\n\n    <lane id="-1" type="driving">inner lane</lane>     text in an element that holds elements'
    "\n\nRemove the text, or make a comment of it: <!-- inner lane -->." + _WHY,
)
REPEATED_KEY = Code(
    "SC327",
    "repeated-road-id",
    "Two elements that must be told apart by an attribute (mostly id) have the same value, so a reference to it has no "
    "single meaning."
    '\n\n    <lane id="-1" .../><lane id="-1" .../>     two lanes -1 in one section'
    "\n\nGive one of them another id, and correct what refers to it." + _WHY,
)
LOST_REFERENCE = Code(
    "SC328",
    "lost-road-reference",
    "An attribute names an element (mostly by its id) that does not exist in the file."
    '\n\n    <controller id="1" ...><control signalId="12"/></controller>     there is no signal 12'
    "\n\nCorrect the id, or add what it names." + _WHY,
)
UNKNOWN_VERSION = Code(
    "SC329",
    "unknown-road-version",
    "The header names no version of OpenDRIVE from 1.1 to 1.8, so the structure of the file cannot be checked. It is "
    "read as far as it can be."
    '\n\n    <header revMajor="1" revMinor="9" .../>     1 to 8'
    "\n\nWrite the version that the file really follows.",
    Severity.WARNING,
)
EXCLUDED = Code(
    "SC330",
    "excluded-road-element",
    "Attributes or children stand together that OpenDRIVE excludes from one another (a radius beside a length, a lane "
    "offset beside lane borders), or one is missing that another demands. Programs differ in which of them they follow."
    '\n\n    <object id="1" radius="2" length="4" width="1" .../>     round, or with four corners?'
    "\n\nKeep one of them, or add what the other demands." + _WHY,
)
