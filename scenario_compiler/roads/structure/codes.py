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
    "OpenDRIVE has no such element at this place in the file's version. It is not read." + _WHY,
)
UNKNOWN_ATTRIBUTE = Code(
    "SC321",
    "unknown-road-attribute",
    "The element has no such attribute in the file's version of OpenDRIVE." + _WHY,
)
MISSING_ATTRIBUTE = Code(
    "SC322",
    "missing-road-attribute",
    "An attribute that the element must have is missing. Where it is read, its default (mostly 0) is used." + _WHY,
)
BAD_VALUE = Code(
    "SC323",
    "bad-road-value",
    "The value of an attribute (or the text of an element) is not of the kind that OpenDRIVE demands: not a number, "
    "outside its "
    "limits, or a word that the file's version does not know." + _WHY,
)
MISPLACED_ELEMENT = Code(
    "SC324",
    "misplaced-road-element",
    "The element is known here, but not in this order or not this often: OpenDRIVE fixes the order of an element's "
    "children." + _WHY,
)
MISSING_ELEMENT = Code("SC325", "missing-road-element", "A child that the element must have is missing." + _WHY)
STRAY_TEXT = Code("SC326", "stray-road-text", "Text stands where OpenDRIVE has none; it is not read." + _WHY)
REPEATED_KEY = Code(
    "SC327",
    "repeated-road-id",
    "Two elements that must be told apart by an attribute (mostly id) have the same value, so a reference to it has "
    "no single "
    "meaning." + _WHY,
)
LOST_REFERENCE = Code(
    "SC328",
    "lost-road-reference",
    "An attribute names an element (mostly by its id) that does not exist in the file." + _WHY,
)
UNKNOWN_VERSION = Code(
    "SC329",
    "unknown-road-version",
    "The header names no version of OpenDRIVE from 1.1 to 1.8, so the structure of the file cannot be checked. It is "
    "read as far "
    "as it can be.",
    Severity.WARNING,
)
EXCLUDED = Code(
    "SC330",
    "excluded-road-element",
    "Attributes or children stand together that OpenDRIVE excludes from one another (a radius beside a length, a "
    "lane offset "
    "beside lane borders), or one is missing that another demands. Programs differ in which of them they follow."
    + _WHY,
)
