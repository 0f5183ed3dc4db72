"""Parts that OpenSCENARIO cannot express, as properties of a controller named `scenario_compiler`.

Words of the conflict language are kept as the attributes of their elements. Each attribute is a property whose name is
its path: `takeover/@budget` or `ego/camera/failure[2]/@kind`. An element without attributes and children is a property
with an empty value. Values are written as in the conflict language, in its units. A value that contains a `$`, which
other programs would interpret as a parameter, begins with a `=` and has `%24` instead.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.markup.writing import write_word
from scenario_compiler.openscenario.conditions import is_by_entity
from scenario_compiler.vocabulary.actions import ControllerProperty
from scenario_compiler.vocabulary.word import Word

OWN = "scenario_compiler"
"""Name of the controller with these properties."""

UNREADABLE_PROPERTY = Code(
    "SC786",
    "unreadable-property",
    "A property of the controller `scenario_compiler`, in a file that this program has exported, is not one that "
    "it writes, so it has no effect:\n\n"
    '    <Property name="takeover/budget" value="7"/>     attributes are written with an @: takeover/@budget\n\n'
    "Correct the name, or export the scenario again.",
    Severity.WARNING,
)

_STEP = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(\[[1-9][0-9]{0,5}\])?\Z")
_ATTRIBUTE = re.compile(r"@[A-Za-z_][A-Za-z0-9_]*\Z")

MOST_STEPS = 12
"""Greatest depth of an attribute."""


def flattened(parent: etree._Element, above: str = "") -> Iterator[tuple[str, str]]:
    """Yield name and value of the properties for everything in an element."""
    tags = [str(one.tag) for one in parent]
    met: dict[str, int] = {}
    for one, tag in zip(parent, tags, strict=True):
        met[tag] = met.get(tag, 0) + 1
        path = above + tag + (f"[{met[tag]}]" if tags.count(tag) > 1 else "")
        for name in map(str, one.attrib):
            yield f"{path}/@{name}", veiled(str(one.get(name)))
        if not len(one.attrib) and not len(one):
            yield path, ""
        yield from flattened(one, f"{path}/")


def veiled(value: str) -> str:
    """Return a text without `$`, which other programs would interpret as parameters; `_unveiled` restores it."""
    return "=" + value.replace("%", "%25").replace("$", "%24") if "$" in value or value.startswith("=") else value


def _unveiled(value: str) -> str:
    return value[1:].replace("%24", "$").replace("%25", "%") if value.startswith("=") else value


def gathered(properties: Iterable[ControllerProperty], sink: Diagnostics) -> etree._Element:
    """Return the element that the properties describe; report properties of another origin."""
    root = etree.Element(OWN)
    known = {"": root}
    for one in properties:
        *steps, last = one.name.split("/")
        attribute = _ATTRIBUTE.match(last) is not None
        way = steps if attribute else [*steps, last]
        if not way or len(way) > MOST_STEPS or not all(map(_STEP.match, way)):
            sink.add(UNREADABLE_PROPERTY, f"'{one.name}' is not a property of this program", one.place_of("name"))
            continue
        element = _at(way, known, one.origin.line)
        if attribute:
            element.set(last[1:], _unveiled(one.value))
    return root


def _at(way: list[str], known: dict[str, etree._Element], line: int) -> etree._Element:
    """Return the element at the end of a path from the root; missing elements are created."""
    path = ""
    for step in way:
        above, path = path, f"{path}/{step}"
        if path not in known:
            known[path] = etree.SubElement(known[above], step.partition("[")[0])
            known[path].sourceline = min(line, 65535)  # type: ignore[assignment]  # lxml takes a line
    return known[path]


def of_nobody(word: Word) -> Word:
    """Return a condition without its triggering entity, which the standard states separately."""
    return word.model_copy(update={"entity": ""}) if is_by_entity(word) else word


def fingerprint(word: Word) -> str:
    """Return a word as text in the conflict language."""
    return etree.tostring(write_word(of_nobody(word)), encoding="unicode")
