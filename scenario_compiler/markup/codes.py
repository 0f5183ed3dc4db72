"""The codes of faults in a scenario file's elements, attributes and literals (SC1xx)."""

from scenario_compiler.diagnostics import Code, Severity

UNKNOWN_ROOT = Code(
    "SC116",
    "unknown-root",
    "The file's first element determines the kind of file. This first element is unknown; the known ones are:\n\n"
    '    <scenarios version="1">   conflicts and templates, in the conflict language\n'
    '    <catalog version="1">     vehicles and drivers that scenarios name\n'
    "    <config>                  the AISA toolkit's scenarios\n"
    "    <OpenSCENARIO>            ASAM OpenSCENARIO: a scenario, a catalog, values of parameters\n\n"
    "Check the path, and the spelling of the first element.",
)
WRONG_QUANTITY = Code(
    "SC298",
    "wrong-quantity",
    "A parameter is used as it is where another quantity is needed: a length as a time, or a speed as a length. The "
    "number is the same, but its unit is not.\n\n"
    '    <parameter name="distance" type="length" default="60"/>\n'
    '    <takeover budget="$distance"/>     budget="${$distance / $speed}"\n\n'
    "Name the parameter that is meant, correct its type, or calculate: the result of an expression has no quantity.",
    Severity.WARNING,
)
UNKNOWN_ELEMENT = Code(
    "SC105",
    "unknown-element",
    "An element is not allowed inside its parent, so it would have no effect:\n\n"
    '    <ego><kamera sensor_noise="3"/></ego>     <kamera> is not known, <camera> is\n\n'
    "Correct the spelling, or move the element to the right parent. An editor that supports schemas/conflict.xsd "
    "completes the allowed names.",
)
UNKNOWN_ATTRIBUTE = Code(
    "SC106",
    "unknown-attribute",
    "An element does not have this attribute, so the value would have no effect:\n\n"
    '    <ego velocity="13.9">     <ego> has a speed, not a velocity\n\n'
    "In a <use>, the attributes are template, id, and the parameters of the template. Correct the spelling or remove "
    "the attribute.",
)
MISSING_ATTRIBUTE = Code(
    "SC107",
    "missing-attribute",
    "A required attribute is missing:\n\n"
    '    <lane road="3" s="20"/>     which lane?\n\n'
    "Add it. The message describes its value.",
)
MISSING_ELEMENT = Code(
    "SC108",
    "missing-element",
    "A required child element is missing:\n\n"
    '    <ego speed="13.9"/>     where does it start?\n\n'
    "Add one. The message lists the possible elements.",
)
REPEATED_ELEMENT = Code(
    "SC109",
    "repeated-element",
    "An element occurs twice although its parent allows only one. It is not clear which of the two is meant:\n\n"
    '    <takeover budget="7"/>\n'
    '    <takeover budget="5"/>\n\n'
    "Remove one of them.",
)
ELEMENT_ORDER = Code(
    "SC110",
    "element-order",
    "The children of an element have a fixed order, so that files look alike and the schema can check them. In a "
    "scenario: parameters, classification, ego, then the other entities and events, takeover, criteria.\n\n"
    "    <scenario ...><takeover/> <ego>...</ego></scenario>     <ego> comes first\n\n"
    "Move the element to its place.",
)
WRONG_VALUE = Code(
    "SC111",
    "wrong-value",
    "The text of an attribute is not a valid value: a number with a comma, a word that is not one of the choices, or "
    "a fraction instead of a whole number:\n\n"
    '    <ego speed="50 km/h">     write the number alone, in m/s: speed="13.9"\n\n'
    "Numbers are decimal with a point, in the unit that the message names. `$name` and `${expression}` are allowed "
    "instead of any value; their value is checked.",
)
OUT_OF_LIMITS = Code(
    "SC112",
    "out-of-limits",
    "A number is outside its limits:\n\n"
    '    <markings road="1" from="0" to="50" quality="1.5"/>     a quality lies between 0 and 1\n\n'
    "An expression is checked at the present values of its parameters, a parameter against the limits in its "
    "declaration.",
)
BAD_EXPRESSION = Code(
    "SC113",
    "bad-expression",
    "An expression is malformed, or has no value:\n\n"
    '    distance="${2 * ($gap + 1}"     a parenthesis is not closed\n'
    '    distance="${1 / $zero}"         division by zero\n\n'
    "Expressions support + - * / % ^, the comparisons == != < <= > >= (in XML, < is written &lt;), and, or, not, "
    "parentheses, and the functions abs, min, max, sqrt, sin, cos, tan, asin, acos, atan, atan2, exp, log, pow, floor, "
    "ceil, round, sign, radians, degrees, if(condition, then, else).",
)
EMPTY_RANGE = Code(
    "SC263",
    "empty-range",
    "The end of a range is not above its start, or below it where both may be equal: the greatest answer of a scale or "
    "a number item, the latest time of a probe, the fastest driver or the highest speed of traffic, the last of some "
    "lanes.\n\n"
    '    <probe from="14" to="6">...</probe>     from="6" to="14"\n'
    '    <traffic vehicles="20" slowest="1.2" fastest="1"/>     slowest="1" fastest="1.2"\n\n'
    "Exchange the two numbers.",
)
STRAY_TEXT = Code(
    "SC114",
    "stray-text",
    "There is text between elements, where it has no effect. Usually it is a tag without its angle brackets:\n\n"
    "    <criteria> no_collision </criteria>     write <no_collision/>\n\n"
    "Make it a tag, or a comment: <!-- ... -->.",
)
AGAINST_SCHEMA = Code(
    "SC115",
    "against-schema",
    "The reader accepts the file, but schemas/conflict.xsd does not. Both are generated from the same declarations, "
    "so this is probably a fault of this program. Please report it with the file.\n\n"
    "    against the schema: Element 'road': This element is not expected.",
)
