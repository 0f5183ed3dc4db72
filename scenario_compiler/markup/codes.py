"""The codes of what can be wrong with a scenario file's elements, attributes and literals (SC1xx)."""

from scenario_compiler.diagnostics import Code

UNKNOWN_ROOT = Code(
    "SC116",
    "unknown-root",
    "The file's first element tells what kind of file it is, and this one is not known:\n\n"
    '    <scenarios version="1">   conflicts and templates, in the conflict language\n'
    '    <catalog version="1">     vehicles and drivers that scenarios name\n'
    "    <config>                  the AISA toolkit's scenarios\n"
    "    <OpenSCENARIO>            ASAM OpenSCENARIO: a scenario, a catalog, values of parameters\n\n"
    "Check that the path names the file you meant, and the spelling of the first element.",
)
UNKNOWN_ELEMENT = Code(
    "SC105",
    "unknown-element",
    "An element stands where its parent has no place for one of that name, so it would have no effect:\n\n"
    '    <ego><kamera sensor_noise="3"/></ego>     <kamera> is not known, <camera> is\n\n'
    "Correct the spelling, or move the element to the parent that it belongs to. An editor that knows "
    "schemas/conflict.xsd offers the names that fit.",
)
UNKNOWN_ATTRIBUTE = Code(
    "SC106",
    "unknown-attribute",
    "An element has an attribute that it does not know, so the value would have no effect:\n\n"
    '    <ego velocity="13.9">     <ego> has a speed, not a velocity\n\n'
    "In a <use>, the attributes are the parameters of the template that it names, besides template and id. Correct the "
    "spelling or remove the attribute.",
)
MISSING_ATTRIBUTE = Code(
    "SC107",
    "missing-attribute",
    "An attribute without which the element means nothing is not there:\n\n"
    '    <lane road="3" s="20"/>     which lane?\n\n'
    "Write it. The message says what it holds.",
)
MISSING_ELEMENT = Code(
    "SC108",
    "missing-element",
    "A child element without which its parent means nothing is not there:\n\n"
    '    <ego speed="13.9"/>     where does it start?\n\n'
    "Write it. The message names the elements that would do.",
)
REPEATED_ELEMENT = Code(
    "SC109",
    "repeated-element",
    "An element stands twice where its parent takes one; which of the two counts would be a guess:\n\n"
    '    <takeover budget="7"/>\n'
    '    <takeover budget="5"/>\n\n'
    "Remove one of them.",
)
ELEMENT_ORDER = Code(
    "SC110",
    "element-order",
    "The children of an element stand in a fixed order, so that files read alike and the schema can check them. In a "
    "scenario: parameters, classification, ego, then everything on the road, takeover, criteria.\n\n"
    "    <scenario ...><takeover/> <ego>...</ego></scenario>     <ego> comes first\n\n"
    "Move the element to its place.",
)
WRONG_VALUE = Code(
    "SC111",
    "wrong-value",
    "The text of an attribute is not what the attribute holds: a number with a comma, a word that is none of the "
    "choices, a fraction where a whole number belongs:\n\n"
    '    <ego speed="50 km/h">     write the number alone, in m/s: speed="13.9"\n\n'
    "Numbers are decimal with a point, in the unit that the message names. `$name` and `${expression}` may stand for "
    "any value; what they come to counts then.",
)
OUT_OF_LIMITS = Code(
    "SC112",
    "out-of-limits",
    "A number lies outside what makes sense for it:\n\n"
    '    <markings road="1" from="0" to="50" quality="1.5"/>     a quality lies between 0 and 1\n\n'
    "For an expression, the value at the present values of the parameters counts; for a parameter, the limits that its "
    "declaration gives.",
)
BAD_EXPRESSION = Code(
    "SC113",
    "bad-expression",
    "An expression cannot be read, or has no value:\n\n"
    '    distance="${2 * ($gap + 1}"     a bracket is not closed\n'
    '    distance="${1 / $zero}"         there is no such number\n\n'
    "Expressions know + - * / % ^, comparisons, and, or, not, brackets, and abs, min, max, sqrt, sin, cos, tan, asin, "
    "acos, atan, atan2, exp, log, pow, floor, ceil, round, sign, radians, degrees, if(condition, then, else).",
)
STRAY_TEXT = Code(
    "SC114",
    "stray-text",
    "Text stands between elements, where it has no effect; mostly it is a tag that lost its bracket:\n\n"
    "    <criteria> no_collision </criteria>     write <no_collision/>\n\n"
    "Make it a tag, or a comment: <!-- ... -->.",
)
AGAINST_SCHEMA = Code(
    "SC115",
    "against-schema",
    "The file reads well but does not follow schemas/conflict.xsd. The two are made from one declaration, so this is "
    "most likely a fault of this program: please report it with the file."
    "\n\n    against the schema: Element 'road': This element is not expected.",
)
