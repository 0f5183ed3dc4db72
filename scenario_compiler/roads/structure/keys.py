"""Attributes that must be unique, and attributes that must refer to one of them, by version.

Versions up to 1.4 define neither. A missing attribute is ignored.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from lxml import etree

from scenario_compiler.roads.structure.codes import LOST_REFERENCE, REPEATED_KEY
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.notation import in_versions


@dataclass(frozen=True, slots=True)
class Key:
    """Elements `path` within each `scope` have different values of `attribute`."""

    scope: str
    path: str
    attribute: str
    versions: str = "1.5-"


@dataclass(frozen=True, slots=True)
class Reference:
    """`attribute` of the elements `path` within each scope of the key must be a value of the key."""

    path: str
    attribute: str
    key: Key
    versions: str = "1.5-"


ROAD = Key("", "road", "id")
SIGNAL = Key("", "road/signals/signal", "id")
SWITCH = Key("", "road/railroad/switch", "id")
OUTLINE = Key("road/objects/object", "outlines/outline", "id", "1.6-1.7")
SINGLE_OUTLINE = Key("road/objects/object", "outline", "id", "1.5")
CONNECTION = Key("junction", "connection", "id", "1.5-1.7")

KEYS = (
    ROAD,
    SIGNAL,
    SWITCH,
    OUTLINE,
    SINGLE_OUTLINE,
    CONNECTION,
    Key("", "road/objects/object", "id"),
    Key("", "road/objects/tunnel", "id"),
    Key("", "road/objects/bridge", "id"),
    Key("", "road/railroad/switch", "name"),
    Key("", "controller", "id"),
    Key("", "junction", "id"),
    Key("", "junctionGroup", "id"),
    Key("", "station", "id"),
    Key("", "station/platform", "id"),
    Key("road/lanes/laneSection", "*/lane", "id", "1.5-1.7"),
    Key("", "junction/controller", "id", "1.8-"),
    Key("", "junction/crossPath", "id", "1.8-"),
    Key("", "junction/roadSection", "id", "1.8-"),
)

REFERENCES = (
    Reference("junction/connection", "incomingRoad", ROAD),
    Reference("junction/connection", "connectingRoad", ROAD),
    Reference("junction/connection", "linkedRoad", ROAD, "1.8-"),
    Reference("junction/crossPath", "roadAtStart", ROAD, "1.8-"),
    Reference("junction/crossPath", "roadAtEnd", ROAD, "1.8-"),
    Reference("junction/roadSection", "roadId", ROAD, "1.8-"),
    Reference("road/signals/signal/positionRoad", "roadId", ROAD),
    Reference("road/railroad/switch/mainTrack", "id", SWITCH, "1.5"),
    Reference("road/railroad/switch/sideTrack", "id", SWITCH, "1.5"),
    Reference("road/railroad/switch/mainTrack", "id", ROAD, "1.6-"),
    Reference("road/railroad/switch/sideTrack", "id", ROAD, "1.6-"),
    Reference("road/railroad/switch/partner", "id", SWITCH),
    Reference("station/platform/segment", "roadId", ROAD),
    Reference("road/signals/signal/dependency", "id", SIGNAL),
    Reference("road/signals/signalReference", "id", SIGNAL),
    Reference("controller/control", "signalId", SIGNAL),
    Reference("borders/border", "outlineId", OUTLINE, "1.6-1.7"),
    Reference("borders/border", "outlineId", SINGLE_OUTLINE, "1.5"),
)


def check_keys(findings: Findings, root: etree._Element, minor: int) -> None:
    """Report repeated keys and references to unknown keys of a version."""
    known: dict[Key, list[tuple[etree._Element, set[str]]]] = {}
    for key in KEYS:
        if in_versions(key.versions, minor):
            known[key] = [(scope, _values(findings, scope, key)) for scope in _scopes(root, key)]
    for reference in REFERENCES:
        if in_versions(reference.versions, minor):
            for scope, values in known[reference.key]:
                _check_reference(findings, scope, reference, values)


def _scopes(root: etree._Element, key: Key) -> Iterator[etree._Element]:
    return root.iterfind(key.scope) if key.scope else iter((root,))


def _values(findings: Findings, scope: etree._Element, key: Key) -> set[str]:
    values: set[str] = set()
    for element in scope.iterfind(key.path):
        value = element.get(key.attribute)
        if value in values:
            message = f"a second <{element.tag}> has the {key.attribute} '{value[:40]}'"
            findings.report(REPEATED_KEY, message, element, key.attribute)
        if value is not None:
            values.add(value)
    return values


def _check_reference(findings: Findings, scope: etree._Element, reference: Reference, values: set[str]) -> None:
    target = reference.key.path.rpartition("/")[2]
    for element in scope.iterfind(reference.path):
        value = element.get(reference.attribute)
        if value is not None and value not in values:
            message = f"{reference.attribute} names the {target} '{value[:40]}', which does not exist"
            findings.report(LOST_REFERENCE, message, element, reference.attribute)
