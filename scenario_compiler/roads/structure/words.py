"""The values that OpenDRIVE's attributes may have: kinds of numbers, and words with the versions that have them.

A word is followed by its versions ("curb@1.6-"). Words are checked since 1.4 (before, the standard's schema allowed any
text), limits of numbers since 1.5.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from scenario_compiler.structure.values import Kind, Test, is_integer, is_number

WORDS = {
    "access": "simulator | autonomous traffic@1.4 | autonomousTraffic@1.5- | pedestrian | passengerCar@1.5- | "
    "bus@1.5- | "
    "delivery@1.5- | emergency@1.5- | taxi@1.5- | throughTraffic@1.5- | truck@1.5- | bicycle@1.5- | motorcycle@1.5- "
    "| none | "
    "trucks@1.5- | HOV@1.8-",
    "access_rule": "allow | deny",
    "any_unit": "m | km | ft | mile | m/s | mph | km/h | kg | t | %",
    "boolean": "true | false",
    "border_type": "concrete | curb | paint@1.8-",
    "bridge_type": "concrete | steel | brick | wood",
    "connection_type": "default | virtual",
    "contact_point": "start | end",
    "crg_mode": "attached | attached0 | genuine | global@1.5-",
    "crg_purpose": "elevation | friction",
    "display_type": "LED | monochromGraphic | rotatingPrismHorizontal | rotatingPrismVertical | simpleMatrix | other",
    "distance_semantics": "for | in",
    "distance_unit": "m | km | ft | mile",
    "environment_semantics": "fog | rain | snow",
    "fill": "grass | concrete | cobble | asphalt | pavement | gravel | soil | paint@1.8-",
    "global_only": "global",
    "road_only": "road",
    "junction_group_type": "roundabout | unknown | complexJunction@1.8- | highwayInterchange@1.8-",
    "junction_type": "default | virtual | direct@1.7- | crossing@1.8-",
    "lane_advisory": "none | inner | outer | both",
    "lane_change": "increase | decrease | both | none",
    "lane_direction": "standard | reversed | both",
    "lane_semantics": "noOvertakeCars | noOvertakeCarsEnd | noOvertakeTrucks | noOvertakeTrucksEnd | "
    "priorityOverOncoming | "
    "roundabout | yieldForOncoming",
    "lane_type": "none | driving | stop | shoulder | biking | sidewalk | border | restricted | parking | "
    "bidirectional | median | "
    "special1 | special2 | special3 | roadWorks | tram | rail | entry | exit | offRamp | onRamp | "
    "connectingRamp@1.5- | bus@1.5- | "
    "taxi@1.5- | HOV@1.5- | mwyEntry@1.5- | mwyExit@1.5- | curb@1.6- | shared@1.8- | walking@1.8- | slipLane@1.8-",
    "link_direction": "+ | -",
    "link_kind": "road | junction",
    "mark_colour": "standard | blue | green | red | white | yellow | orange@1.5- | violet@1.7- | black@1.8-",
    "mark_rule": "no passing | caution | none",
    "mark_type": "none | solid | broken | solid solid | solid broken | broken solid | broken broken | botts dots | "
    "grass | curb | "
    "custom@1.5- | edge@1.5-",
    "mark_weight": "standard | bold",
    "object_type": "none | obstacle | car | pole | tree | vegetation | barrier | building | parkingSpace | patch | "
    "railing | "
    "trafficIsland | crosswalk | streetLamp | gantry | soundBarrier | truck@1.5 | van | bus | trailer | bike | "
    "motorbike | tram | "
    "train | pedestrian | wind | roadMark@1.6- | roadSurface@1.8-",
    "orientation": "+ | - | none",
    "parameter_range": "arcLength | normalized",
    "parking_access": "all | car | women | handicapped | bus | truck | electric | residents",
    "parking_side": "left | right | front | rear",
    "priority_semantics": "4way | keepClearLine | noParkingLine | noTurnOnRed | priorityRoad | priorityRoadEnd | "
    "priorityToTheRightRule | stop | stopLine | turnOnRedAllowed | trafficLight | waitingLine | yield",
    "quality_processing": "raw | cleaned | processed | fused",
    "quality_source": "sensor | cadaster | custom",
    "reference_kind": "object | signal",
    "road_type": "unknown | rural | motorway | town | lowSpeed | pedestrian | bicycle | townExpressway@1.5- | "
    "townCollector@1.5- | "
    "townArterial@1.5- | townPrivate@1.5- | townLocal@1.5- | townPlayStreet@1.5-",
    "same_or_opposite": "same | opposite",
    "segment_type": "joint | lane",
    "side": "left | right",
    "side_or_both": "left | right | both",
    "speed_semantics": "maximum | maximumEnd | minimum | minimumEnd | recommended | recommendedEnd | zone | zoneEnd",
    "speed_unit": "m/s | mph | km/h",
    "station_type": "small | medium | large",
    "strip_mode": "independent | relative",
    "switch_position": "dynamic | straight | turn",
    "time_semantics": "day | time",
    "traffic_rule": "RHT | LHT",
    "tunnel_type": "standard | underpass",
    "yes_or_no": "yes | no",
}

COUNTRIES = {"OpenDRIVE", "Austria", "Brazil", "China", "France", "Germany", "Italy", "Switzerland", "USA"}
"""Names of countries in 1.4; later versions keep them beside the codes of ISO 3166."""


def _number(text: str, _: int) -> bool:
    return is_number(text)


def _integer(text: str, _: int) -> bool:
    return is_integer(text)


def _limited(test: Test, fits: Callable[[float], bool]) -> Test:
    """Return a test for a number that also satisfies a limit, since 1.5."""

    def check(text: str, minor: int) -> bool:
        return test(text, minor) and (minor < 5 or fits(float(text)))

    return check


def _positive(text: str, minor: int) -> bool:
    """Return whether a text is a length: at least 0 in 1.5, any text in 1.6 (by its schema), above 0 since 1.7."""
    if minor == 6:
        return True
    return _number(text, minor) and (minor < 5 or float(text) > 0.0 or (minor == 5 and float(text) == 0.0))


def _road_speed(text: str, minor: int) -> bool:
    if text in {"no limit", "undefined"}:
        return True
    return (_integer if minor == 4 else _number)(text, minor) and float(text) >= 0.0


def _country(text: str, minor: int) -> bool:
    return text in COUNTRIES or re.fullmatch("[A-Z]{3}" if minor == 5 else "[A-Z]{2,3}", text) is not None


def _boundary_station(text: str, minor: int) -> bool:
    return text in {"start", "end"} or (_number(text, minor) and float(text) > 0.0)


def _header_version(text: str, minor: int) -> bool:
    if minor == 5:
        return re.fullmatch(r"\d\.\d{2}", text) is not None
    return minor > 5 or _number(text, minor)


KINDS: dict[str, Kind] = {
    "number": Kind("a number", _number),
    "not_negative": Kind("a number of at least 0", _limited(_number, lambda value: value >= 0.0)),
    "above_zero": Kind("a number above 0", _limited(_number, lambda value: value > 0.0)),
    "positive": Kind("a number above 0", _positive),
    "fraction": Kind("a number from 0 to 1", _limited(_number, lambda value: 0.0 <= value <= 1.0)),
    "int": Kind("an integer", _integer),
    "count": Kind("an integer of at least 0", _limited(_integer, lambda value: value >= 0.0)),
    "zero_int": Kind("0", _limited(_integer, lambda value: value == 0.0)),
    "positive_int": Kind("an integer above 0", _limited(_integer, lambda value: value > 0.0)),
    "negative_int": Kind("an integer below 0", _limited(_integer, lambda value: value < 0.0)),
    "road_speed": Kind("a speed, 'no limit' or 'undefined'", _road_speed),
    "country": Kind("a country's code by ISO 3166", _country),
    "boundary_station": Kind("a number above 0, 'start' or 'end'", _boundary_station),
    "header_version": Kind("a version like 1.00", _header_version),
}
"""Name and test of each kind of value."""
