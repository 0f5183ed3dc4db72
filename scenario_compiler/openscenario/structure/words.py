"""The values that OpenSCENARIO's attributes may have: types, and words with the versions that have them.

The names are the standard's. A word is followed by its versions ("override@1.2-"). A parameter ($name) may replace any
value, and an expression (${...}) since 1.1 numbers and booleans.
"""

from __future__ import annotations

import re

from scenario_compiler.structure.values import Kind, Test, is_date_time, is_integer_within, is_number

WORDS = {
    "AngleType": "heading | pitch | roll",
    "AutomaticGearType": "n | p | r | d",
    "CloudState": "cloudy | free | overcast | rainy | skyOff",
    "ColorType": "other | red | yellow | green | blue | violet | orange | brown | black | grey | white",
    "ConditionEdge": "falling | none | rising | risingOrFalling",
    "ControllerType": "lateral | longitudinal | lighting | animation | movement | appearance | all",
    "CoordinateSystem": "entity | lane | road | trajectory | world@1.3-",
    "DirectionalDimension": "longitudinal | lateral | vertical",
    "DynamicsDimension": "distance | rate | time",
    "DynamicsShape": "cubic | linear | sinusoidal | step",
    "FollowingMode": "follow | position",
    "FractionalCloudCover": "zeroOktas | oneOktas | twoOktas | threeOktas | fourOktas | fiveOktas | sixOktas | "
    "sevenOktas | eightOktas | nineOktas",
    "LateralDisplacement": "any | leftToReferencedEntity | rightToReferencedEntity",
    "LightMode": "on | off | flashing",
    "LongitudinalDisplacement": "any | trailingReferencedEntity | leadingReferencedEntity",
    "MiscObjectCategory": "barrier | building | crosswalk | gantry | none | obstacle | parkingSpace | patch | pole | "
    "railing | roadMark | soundBarrier | streetLamp | trafficIsland | tree | vegetation | wind",
    "ObjectType": "miscellaneous | pedestrian | vehicle | external@1.1-",
    "ParameterType": "boolean | dateTime | double | integer | string | unsignedInt | unsignedShort | int@1.2-",
    "PedestrianCategory": "animal | pedestrian | wheelchair",
    "PedestrianGestureType": "phoneCallRightHand | phoneCallLeftHand | phoneTextRightHand | phoneTextLeftHand | "
    "wavingRightArm | wavingLeftArm | umbrellaRightHand | umbrellaLeftHand | crossArms | coffeeRightHand | "
    "coffeeLeftHand | sandwichRightHand | sandwichLeftHand",
    "PedestrianMotionType": "standing | sitting | lying | squatting | walking | running | reeling | crawling | "
    "cycling | jumping | ducking | bendingDown",
    "PrecipitationType": "dry | rain | snow",
    "Priority": "overwrite | parallel | skip | override@1.2-",
    "ReferenceContext": "absolute | relative",
    "RelativeDistanceType": "cartesianDistance | lateral | longitudinal | euclidianDistance@1.1-",
    "Role": "none | ambulance | civil | fire | military | police | publicTransport | roadAssistance",
    "RouteStrategy": "fastest | leastIntersections | random | shortest",
    "RoutingAlgorithm": "assignedRoute | fastest | leastIntersections | shortest | undefined",
    "Rule": "equalTo | greaterThan | lessThan | greaterOrEqual@1.1- | lessOrEqual@1.1- | notEqualTo@1.1-",
    "SpeedTargetValueType": "delta | factor",
    "StoryboardElementState": "completeState | endTransition | runningState | skipTransition | standbyState | "
    "startTransition | stopTransition",
    "StoryboardElementType": "act | action | event | maneuver | maneuverGroup | story",
    "TriggeringEntitiesRule": "all | any",
    "VehicleCategory": "bicycle | bus | car | motorbike | semitrailer | trailer | train | tram | truck | van",
    "VehicleComponentType": "hood | trunk | doorFrontRight | doorFrontLeft | doorRearRight | doorRearLeft | "
    "windowFrontRight | windowFrontLeft | windowRearRight | windowRearLeft | sideMirrors | sideMirrorRight | "
    "sideMirrorLeft",
    "VehicleLightType": "daytimeRunningLights | lowBeam | highBeam | fogLights | fogLightsFront | fogLightsRear | "
    "brakeLights | warningLights | indicatorLeft | indicatorRight | reversingLights | licensePlateIllumination | "
    "specialPurposeLights",
    "Wetness": "dry | moist | wetWithPuddles | lowFlooded | highFlooded",
}

_PARAMETER = re.compile(r"[$][A-Za-z_][A-Za-z0-9_]*")
_EXPRESSION = re.compile(r"[$][{][ A-Za-z0-9_+\-*/%$().,]*[}]")
_BLANKS = " \t\n\r"


def is_parameter(text: str) -> bool:
    """Return whether a text is a parameter: $name."""
    return _PARAMETER.fullmatch(text) is not None


def _or_expression(test: Test) -> Test:
    """Return a test for a literal, a parameter, or since 1.1 an expression."""

    def check(text: str, minor: int) -> bool:
        if text.startswith("$"):
            return is_parameter(text) or (minor >= 1 and _EXPRESSION.fullmatch(text) is not None)
        return test(text.strip(_BLANKS), minor)

    return check


def _integer(low: int, high: int) -> Test:
    return _or_expression(lambda text, _: is_integer_within(text, low, high))


KINDS = {
    "Boolean": Kind("true or false", _or_expression(lambda text, _: text in {"true", "false", "1", "0"}), blanks=True),
    "DateTime": Kind(
        "a date and time like 2020-10-01T12:00:00",
        lambda text, _: is_parameter(text) or is_date_time(text.strip(_BLANKS)),
        blanks=True,
    ),
    "Double": Kind("a number", _or_expression(lambda text, _: is_number(text)), blanks=True),
    "Int": Kind("an integer from -2147483648 to 2147483647", _integer(-(2**31), 2**31 - 1), blanks=True),
    "UnsignedInt": Kind("an integer from 0 to 4294967295", _integer(0, 2**32 - 1), blanks=True),
    "UnsignedShort": Kind("an integer from 0 to 65535", _integer(0, 2**16 - 1), blanks=True),
}
"""Name and test of each type."""

MISSPELT = {"euclideandistance": "euclidianDistance", "bool": "boolean"}
"""Frequent other spellings of words, in lower case."""

_LOOSE_DATE = re.compile(
    r"(\d{4})-(\d{1,2})-(\d{1,2})(?:[T ](\d{1,2}):(\d{1,2})(?::(\d{1,2})(\.\d+)?)?(Z|[+-]\d\d:\d\d)?)?", re.ASCII
)


def loosely(kind: str, text: str, minor: int) -> str | None:
    """Return the value that a wrongly written text probably means in version 1.`minor`; None if it is not obvious."""
    plain = text.strip()
    if kind in WORDS:
        return _word(kind, plain, minor)
    if kind == "DateTime":
        meant = _date(plain)
    elif kind == "Boolean":
        meant = plain.lower()
    else:
        meant = plain.removesuffix(".0") if kind != "Double" else plain
    return meant if meant and meant != text and KINDS[kind].test(meant, minor) else None


def _word(kind: str, text: str, minor: int) -> str | None:
    del minor
    if is_parameter(text):
        return text
    known = {word.partition("@")[0].lower(): word for word in WORDS[kind].split(" | ")}
    word = known.get(MISSPELT.get(text.lower(), text).lower())
    return None if word is None else word.partition("@")[0]


def _date(text: str) -> str:
    match = _LOOSE_DATE.fullmatch(text)
    if match is None:
        return ""
    year, month, day, hour, minute, second = (int(part or 0) for part in match.groups()[:6])
    rest = (match[7] or "") + (match[8] or "")
    return f"{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{rest}"
