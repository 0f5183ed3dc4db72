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
    "OpenDRIVE has no such element at this place in the file's version. It is not read.\n\n"
    '    <lane id="-1" type="driving"><colour .../></lane>     no version has <colour> here\n\n'
    "Correct the name, move the element to the right parent, put data of your own into <userData>, or raise "
    "revMinor to the version that has the element." + _WHY,
)
UNKNOWN_ATTRIBUTE = Code(
    "SC321",
    "unknown-road-attribute",
    "The element has no such attribute in the file's version of OpenDRIVE.\n\n"
    '    <lane id="-1" typ="driving">     the attribute is called type\n\n'
    "Correct the name, or raise revMinor to the version that has the attribute." + _WHY,
)
MISSING_ATTRIBUTE = Code(
    "SC322",
    "missing-road-attribute",
    "A required attribute is missing. If it is used, its default (mostly 0) replaces it.\n\n"
    '    <geometry s="0" x="0" y="0" hdg="0">     length is missing\n\n'
    "Add the attribute." + _WHY,
)
BAD_VALUE = Code(
    "SC323",
    "bad-road-value",
    "The value of an attribute (or the text of an element) is not valid in OpenDRIVE: it is not a number, is "
    "outside its limits, or is a word that the file's version does not have.\n\n"
    '    <lane id="-1" type="driveway">     the type is called driving\n'
    '    <road length="abc" ...>     not a number\n\n'
    "The message says which values are valid." + _WHY,
)
MISPLACED_ELEMENT = Code(
    "SC324",
    "misplaced-road-element",
    "The element is allowed here, but not in this order or not so many times: OpenDRIVE fixes the order and the "
    "number of an element's children.\n\n"
    "    <road ...><lanes>...</lanes><planView>...</planView></road>     <planView> comes first\n\n"
    "The message gives the order. Remove children that occur too often." + _WHY,
)
MISSING_ELEMENT = Code(
    "SC325",
    "missing-road-element",
    "A required child element is missing.\n\n"
    '    <road id="4" ...><planView>...</planView></road>     without <lanes>\n\n'
    "Add the child." + _WHY,
)
STRAY_TEXT = Code(
    "SC326",
    "stray-road-text",
    "There is text where OpenDRIVE does not allow any; it is not read.\n\n"
    '    <lane id="-1" type="driving">inner lane</lane>     this element has child elements only\n\n'
    "Remove the text, or turn it into a comment: <!-- inner lane -->." + _WHY,
)
REPEATED_KEY = Code(
    "SC327",
    "repeated-road-id",
    "Two elements have the same value of an attribute (mostly id) that must identify them, so a reference to it "
    "is ambiguous.\n\n"
    '    <lane id="-1" .../><lane id="-1" .../>     two lanes -1 in one section\n\n'
    "Give one of them another id, and correct the references to it." + _WHY,
)
LOST_REFERENCE = Code(
    "SC328",
    "lost-road-reference",
    "An attribute names an element (mostly by its id) that does not exist in the file.\n\n"
    '    <controller id="1" ...><control signalId="12"/></controller>     there is no signal 12\n\n'
    "Correct the id, or add the element." + _WHY,
)
UNKNOWN_VERSION = Code(
    "SC329",
    "unknown-road-version",
    "The header names no version of OpenDRIVE from 1.1 to 1.8, so the structure of the file cannot be checked. It "
    "is read as far as it can be.\n\n"
    '    <header revMajor="1" revMinor="9" .../>     revMinor is 1 to 8\n\n'
    "Write the version of the standard that the file follows.",
    Severity.WARNING,
)
EXCLUDED = Code(
    "SC330",
    "excluded-road-element",
    "The element has attributes or children that exclude each other in OpenDRIVE (a radius and a length, a lane "
    "offset and lane borders), or lacks one that another one requires. Programs differ in which of them they use.\n\n"
    '    <object id="1" radius="2" length="4" width="1" .../>     round or rectangular?\n\n'
    "Keep one of them, or add the missing one." + _WHY,
)
