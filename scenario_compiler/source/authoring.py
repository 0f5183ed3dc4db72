"""Writes the first text of a new conflict: a commented scenario that uses one template."""

from __future__ import annotations

from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

from scenario_compiler.vocabulary.scenario import Parameter


@dataclass(frozen=True, slots=True)
class Place:
    """The place of a new conflict: a map, one of its spawn points, a speed there in m/s, and the id of a road ahead."""

    map: str
    spawn_point: str
    speed: float
    road: str


MOTORWAY = Place("highway_loop", "straight", 22.0, "1")
RAMP = Place("highway_loop", "acceleration_lane", 20.0, "11")
TOWN = Place("town_grid", "main_street", 12.0, "1")

PLACES = {
    "ramp": RAMP,
    "crossing": TOWN,
    "wrong": TOWN,
    "oncoming": TOWN,
    "narrow": TOWN,
    "sign": TOWN,
    "work": TOWN,
    "lane": TOWN,
}
"""Places by a word in the template's name; the first match counts, and a motorway is the default."""

TEXT = """<?xml version="1.0" encoding="UTF-8"?>
<!-- A conflict of your own. Check it:  scenario-compiler validate {file}
     Look at it:                        scenario-compiler preview {file} -o {name}.png
     Run it:                            scenario-compiler run {file} -o out -->
<scenarios version="1">
  <scenario name={name_text} map={map} weather="ClearNoon" duration="30" control_every="2"
            summary="What happens, in one sentence" source="Where the situation comes from">
    <!-- The automated car, where it starts, and its speed in m/s. The map's map.toml names its spawn points. -->
    <ego speed="{speed:g}">
      <start><spawn_point name={spawn_point}/></start>
      <forward_sensor kind="camera" range="200"/>
    </ego>
    <!-- {summary}. What is not written takes the value named here. -->
{use}
    <!-- When the car asks: the time budget in s, its causes, and who answers (study_means, unhurried, absent, ...). -->
    <takeover budget="7">
      <cause kind="lane_confidence"/>
      <cause kind="sensor_health"/>
      <cause kind="path_blocked"/>
      <cause kind="lane_ends"/>
      <driver preset="study_means"/>
      <message modality="text tone" content="what why"/>
    </takeover>
    <!-- What the run is judged by. -->
    <criteria><no_collision/><stay_on_road/></criteria>
  </scenario>
</scenarios>
"""


def new_conflict(name: str, template: str, summary: str, parameters: tuple[Parameter, ...]) -> str:
    """Return the text of a file with one scenario that uses a template of the library.

    Args:
        name: Name of the scenario and, with the suffix .xml, of the file.
        template: Name of the template.
        summary: Summary of the template.
        parameters: The template's parameters, each of which is explained.
    """
    place = _place(template)
    return TEXT.format(
        file=f"{name}.xml",
        name=name,
        name_text=quoteattr(name),
        map=quoteattr(place.map),
        speed=place.speed,
        spawn_point=quoteattr(place.spawn_point),
        summary=summary.replace("--", "- -"),
        use=_use(template, parameters, place),
    )


def _place(template: str) -> Place:
    return next((place for word, place in PLACES.items() if word in template), MOTORWAY)


def _use(template: str, parameters: tuple[Parameter, ...], place: Place) -> str:
    lines = [f"    <!-- {_explained(one)} -->" for one in parameters]
    given = "".join(f' {one.name}="{_value(one, place)}"' for one in parameters if one.default is None)
    return "\n".join([*lines, f'    <use template="{template}"{given}/>'])


def _value(parameter: Parameter, place: Place) -> str:
    """Return a value for a parameter without a default: the road ahead, or the least value."""
    if parameter.name == "road":
        return place.road
    return f"{parameter.min:g}" if isinstance(parameter.min, float) else "1"


def _explained(parameter: Parameter) -> str:
    limits = ""
    if parameter.min is not None and parameter.max is not None:
        limits = f", {parameter.min:g} to {parameter.max:g}"
    default = "to be given" if parameter.default is None else f'"{parameter.default}"'
    return f"{parameter.name} ({parameter.type}{limits}): {default}. {parameter.summary}".replace("--", "- -")
