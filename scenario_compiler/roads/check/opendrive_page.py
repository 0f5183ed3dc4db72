"""The page that lists which parts of OpenDRIVE are used, kept or not read (docs/opendrive.md).

It is made from the declarations of elements (`structure.grammar`) and from the list of parts that are read (`unread`).
"""

from __future__ import annotations

from scenario_compiler.roads.check.unread import NOT_READ_IN, READ_ATTRIBUTES
from scenario_compiler.roads.structure.grammar import FIRST_MINOR, LAST_MINOR, declarations
from scenario_compiler.structure.notation import Declaration

KEPT = """
header
geoReference
offset
access
restriction
material
rule
visibility
left_lane advisory dynamicLaneDirection dynamicLaneType roadWorks
right_lane advisory dynamicLaneDirection dynamicLaneType roadWorks
objects
object
repeat
outlines
outline
cornerRoad
cornerLocal
markings
marking
cornerReference
validity
tunnel
bridge
signals
signal
signalReference
controller
control
junction name type mainRoad sStart sEnd orientation
direct_junction name type
virtual_junction name type mainRoad sStart sEnd orientation
connection id
direct_connection id
virtual_connection id
bypassing_connection
connection_end
priority
junction_controller
"""
"""Elements in `unread.READ` that are read and available through `Network.model` and `Network.lane_details`. Positions
and routes do not depend on them; the camera draws some of the objects and signals. A name alone stands for all of its
attributes that are read.
"""

KEPT_ATTRIBUTES = {
    name: frozenset(attributes) or READ_ATTRIBUTES[name]
    for name, *attributes in (line.split() for line in KEPT.split("\n") if line)
}
"""The same for attributes, by name."""

_HEAD = """# The parts of OpenDRIVE that are read

`make generate` makes this page from the reader's own tables; tests compare the tables with the reader.

*Used*: positions, routes, triggers or pictures depend on it. *Kept*: `Network.model()` and `Network.lane_details()`
return it; the camera draws kept objects and signals. *Not read*: `map check` lists each place in a file. Additional
data (`userData`, `include`, `dataQuality`) is allowed in most elements; `userData` of the header, lanes, objects,
signals and junctions is kept, and `marking_quality` of a road mark is used. Versions are given for elements and
attributes that not all versions from 1.1 to 1.8 have.

The `direction` of a lane holds for its lane section. A lane that may be used in both directions (`both`, or the type
`bidirectional`) is driven in the direction of its side only.

A mark without `laneChange` allows lane changes by its type: `solid`, `solid solid`, `curb` and `edge` forbid them,
though the standard's default is `both`. Many real files leave it out at solid lines, which routes would cross.
"""

_EVERY = list(range(FIRST_MINOR, LAST_MINOR + 1))
_WITHOUT_ROW = frozenset({"include", "dataQuality", "error", "rawData"})


def coverage_page() -> str:
    """Return the page, in Markdown."""
    lines = [_HEAD, "| element | in | used | kept | not read |", "|---|---|---|---|---|"]
    for name, (tags, parents, minors) in _places().items():
        given = _attributes(name)
        read, kept = READ_ATTRIBUTES.get(name), KEPT_ATTRIBUTES.get(name, frozenset())
        columns: dict[str, list[str]] = {"used": [], "kept": [], "not read": []}
        for attribute, known in given.items():
            state = "not read" if read is None or attribute not in read else "kept" if attribute in kept else "used"
            columns[state].append(attribute + _span(known, minors))
        if not given:
            columns["not read" if read is None else "kept" if name in KEPT_ATTRIBUTES else "used"].append("yes")
        element = ", ".join(f"`{tag}`" for tag in tags) + _span(minors, _EVERY)
        cells = [element, ", ".join(parents), *(", ".join(names) for names in columns.values())]
        lines.append("| " + " | ".join(cells) + " |")
    for parent, apart in NOT_READ_IN.items():
        for tag in sorted(apart):
            minors = [minor for minor in _EVERY if declarations(minor)[parent].content.declaration(tag) is not None]
            if minors:
                lines.append(f"| `{tag}`{_span(minors, _EVERY)} | {parent.replace('_', ' ')} |  |  | yes |")
    return "\n".join(lines) + "\n"


def _places() -> dict[str, tuple[list[str], list[str], list[int]]]:
    """Return each declaration's tags, its parents' tags, and the versions that have it."""
    found: dict[str, tuple[list[str], list[str], list[int]]] = {"OpenDRIVE": (["OpenDRIVE"], [], [])}
    for minor in range(LAST_MINOR, FIRST_MINOR - 1, -1):
        known = declarations(minor)
        pending, seen = ["OpenDRIVE"], {"OpenDRIVE"}
        found["OpenDRIVE"][2].insert(0, minor)
        while pending:
            parent = pending.pop(0)
            for tag, child in _children(known, parent):
                tags, parents, minors = found.setdefault(child, ([], [], []))
                above = found[parent][0][0]
                for names, one in ((tags, tag), (parents, above)):
                    if one not in names:
                        names.append(one)
                if minor not in minors:
                    minors.insert(0, minor)
                if child not in seen:
                    seen.add(child)
                    pending.append(child)
    return {name: found[name] for name in declarations(LAST_MINOR) if name in found and name != "userData"}


def _children(known: dict[str, Declaration], parent: str) -> list[tuple[str, str]]:
    """Return (tag, declaration) of the children, including declarations that replace one depending on an attribute."""
    found = []
    for one in known[parent].content.names[1:]:
        switch = known[one.declaration].switch
        found.append((one.tag, one.declaration))
        if switch is not None:
            found.extend((f'{one.tag} {switch[0]}="{value}"', case) for value, case in switch[1].items())
    apart = NOT_READ_IN.get(parent, frozenset())
    return [(tag, name) for tag, name in found if name not in _WITHOUT_ROW and tag not in apart]


def _attributes(name: str) -> dict[str, list[int]]:
    """Return the attributes of a declaration with the versions that have them."""
    found: dict[str, list[int]] = {}
    for minor in range(FIRST_MINOR, LAST_MINOR + 1):
        for attribute in declarations(minor)[name].attributes:
            found.setdefault(attribute, []).append(minor)
    return found


def _span(minors: list[int], all_of: list[int]) -> str:
    """Return the versions as " (1.4 to 1.7)", or an empty text if they are all of the declaration's."""
    known = [minor for minor in minors if minor in all_of]
    if known == all_of or not known:
        return ""
    first, last = f"1.{known[0]}", f"1.{known[-1]}"
    if known[-1] == all_of[-1]:
        return f" (from {first})"
    if known[0] == all_of[0]:
        return f" (until {last})"
    return f" ({first})" if first == last else f" ({first} to {last})"
