"""Compares the sensor's health that the camera measures with the one that the engine computes, for all failures.

    python -m tests.benchmarks.failure_health docs

Each failure is there from the start of a run of 1 s at 15 m/s with 10 images a second, on three maps, once with camera
perception and once with ideal perception. The health is the mean of the last 0.2 s and over the maps. Writes the table
between the markers of `camera-failures.md` in the folder.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from scenario_compiler import compile_scenario, load_network, open_world, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.vocabulary.sensors import Perception
from tests.benchmarks.failure_curves import amounts_of

PLACES = (("highway_loop", "straight"), ("town_grid", "main_street"), ("motorway", "right_lane"))
"""Maps, and the names of the spawn points on them."""

KINDS = (
    "noise",
    "blur",
    "impulse_noise",
    "overexposure",
    "motion_blur",
    "blackout",
    "dirt",
    "dead_rows",
    "quantisation",
)
WEATHERS = ("ClearNoon", "CloudySunset", "HardRainNoon", "ClearNight")
LAST = 4
"""Number of rows at the end of a run whose health is averaged."""

BEGINNING, ENDING = "<!-- health -->", "<!-- end of health -->"

SCENARIO = """<scenarios version="1"><scenario name="failing" map="{map}" weather="{weather}" duration="1" step="0.05"
 control_every="2"><ego speed="15"><start><spawn_point name="{place}"/></start>
 <camera><failure kind="{kind}" {severity}/></camera></ego>
 <takeover budget="7"><cause kind="sensor_health"/></takeover></scenario></scenarios>"""


def health(folder: Path, perception: Perception, **parts: str) -> float:
    """Return the health at the end of a run."""
    path = folder / "failing.xml"
    path.write_text(SCENARIO.format(**parts), encoding="utf-8")
    plan = compile_scenario(path, overrides=Overrides(perception=perception))
    network = load_network(plan.map.file)
    assert network is not None
    with open_world("kinematic", plan, network) as world:
        return float(np.mean(run(plan, world).sensor_health[-LAST:]))


def table(folder: Path) -> str:
    """Return the table: a row for each kind and weather."""
    lines = ["| kind | weather | amounts | camera | without a camera |", "|---|---|---|---|---|"]
    for kind in KINDS:
        amounts = amounts_of(kind)
        graded = amounts != amounts_of("dirt")
        for weather in WEATHERS:
            seen: dict[Perception, list[str]] = {"camera": [], "ideal": []}
            for k, amount in enumerate(amounts):
                severity = f'severity="{k + 1}"' if graded else f'amount="{amount}"'
                for perception, cells in seen.items():
                    found = [
                        health(folder, perception, map=name, place=place, weather=weather, kind=kind, severity=severity)
                        for name, place in PLACES
                    ]
                    cells.append(f"{np.mean(found):.2f}")
            named = ", ".join(f"{one:.3g}" for one in amounts)
            lines.append(f"| {kind} | {weather} | {named} | {', '.join(seen['camera'])} | {', '.join(seen['ideal'])} |")
    return "\n".join(lines)


def main(docs: Path) -> None:
    """Measure, and write the table."""
    page = docs / "camera-failures.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGINNING)
    after = rest.split(ENDING)[1]
    with TemporaryDirectory() as folder:
        page.write_text(f"{before}{BEGINNING}\n\n{table(Path(folder))}\n\n{ENDING}{after}", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
