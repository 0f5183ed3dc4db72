"""A made-up run in a town: a parked car blocks the lane, the driver answers and stops, a car comes the other way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from scenario_compiler.engine.columns import opcodes
from scenario_compiler.plan.model import MapReference, Plan
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Header, Recording, RecordingBuilder
from scenario_compiler.report.run import Run
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.vocabulary.driver import DriverModel
from scenario_compiler.vocabulary.takeover import Cause, Takeover
from tests.recording.made import plan_of

IDS = ("ego", "parked", "oncoming")
ROAD, SPEED, STEP = "1", 13.9, 0.05

RUN_FILES = ("plan.json", "map.xodr", "recording.parquet", "events.csv", "outcome.json", "report.html")
"""What the folder of a run contains."""


def town(repository: Path) -> Network:
    network = load_network(repository / "maps" / "town_grid" / "town_grid.xodr", cache=False)
    assert network is not None
    return network


def plan() -> Plan:
    takeover = Takeover(
        causes=(
            Cause(kind="lane_confidence", warning_below=0.6, request_below=0.3, count=5, of=8),
            Cause(kind="path_blocked", margin=0.4),
        ),
        driver=DriverModel(name="study_means", mu=0.876, sigma=0.5, lapse=0.03),
    )
    return plan_of(*IDS).model_copy(
        update={"takeover": takeover, "map": MapReference(name="town_grid", file="town_grid.xodr", sha256="0" * 64)}
    )


def picture(label: str) -> bytes:
    image = np.full((180, 320, 3), (200, 170, 130), np.uint8)
    image[90:] = (110, 110, 110)
    cv2.line(image, (140, 90), (20, 179), (0, 200, 0), 3)
    cv2.line(image, (180, 90), (300, 179), (0, 200, 0), 3)
    cv2.putText(image, label, (90, 40), cv2.FONT_HERSHEY_SIMPLEX, 0.6, (20, 20, 20), 2)
    return cv2.imencode(".png", image)[1].tobytes()


def recording(network: Network, pictures: bool = True) -> Recording:
    """Record 16 s: warning 3.5 s, request 4 s, response 6.4 s, braking at 5 m/s2 to a standstill."""
    request, response, deceleration = 4.0, 6.4, 5.0
    columns: dict[str, list[float]] = {
        name: [0.0] * 3 for name in ("x", "y", "z", "h", "v", "a", "off", "s", "road", "lane", "brake", "present")
    } | {name: [0.0] for name in ("takeover_state", "cause", "confidence_left", "confidence_right", "blocked_distance")}
    header = Header(
        plan_digest="5f" * 32,
        plan_name="obstacle_ahead",
        seed=1,
        step=STEP,
        entities=IDS,
        perception="camera",
        parameters={"distance": 120.0},
        versions={"scenario-compiler": "0.1.0", "numpy": "2.4.6", "python": "3.11"},
    )
    builder = RecordingBuilder(header, network.road_ids, columns)
    ego_s, v = 30.0, SPEED
    parked_s = 30.0 + SPEED * request + 85.0
    for k in range(321):
        t = k * STEP
        braking = t >= response and v > 0
        places = ((-1, ego_s, 0.03 * math.sin(t)), (-1, parked_s, -0.4), (1, 380 - 11 * t, 0.0))
        for i, (lane, s, off) in enumerate(places):
            pose = network.lane_pose(ROAD, lane, max(s, 0.0), off)
            columns["x"][i], columns["y"][i], columns["z"][i] = pose[:3]
            columns["h"][i] = pose.heading + (math.pi if lane > 0 else 0.0)
            columns["s"][i], columns["off"][i], columns["lane"][i] = s, off, lane
            columns["road"][i] = network.road_index(ROAD)
            columns["present"][i] = 1
        columns["v"][:] = [v, 0.0, 11.0]
        columns["a"][0] = -deceleration if braking else 0.0
        columns["brake"][0] = 0.6 if braking else 0.0
        columns["cause"][0] = opcodes.CAUSE_PATH_BLOCKED if t >= request else opcodes.CAUSE_NONE
        columns["confidence_left"][0] = 0.9 + 0.04 * math.sin(3 * t)
        columns["confidence_right"][0] = 0.75 + 0.1 * math.cos(2 * t)
        ahead = parked_s - 1.0 - ego_s - 3.0
        columns["blocked_distance"][0] = ahead if ahead < 100 else opcodes.FAR
        builder.append(t)
        ego_s += v * STEP
        v = max(0.0, v - deceleration * STEP) if t >= response else v
    _events(builder, request, response)
    for t, label in ((3.5, "warning"), (request, "request"), (response, "response")) if pictures else ():
        builder.frame(t, label, picture(label))
    return builder.finish("standstill")


def _events(builder: RecordingBuilder, request: float, response: float) -> None:
    builder.event(0.0, "activation")
    builder.event(3.5, "warning", cause="path_blocked", message="Something stands in the lane ahead <slow down>")
    builder.event(request, "request", cause="path_blocked", message="Take over: the lane ahead is blocked", value=97.3)
    builder.event(response, "response", entity="ego")
    builder.event(9.2, "standstill", entity="ego")


def run(network: Network, pictures: bool = True) -> Run:
    made, recorded = plan(), recording(network, pictures)
    return Run(made, network, recorded, judge(made, recorded))


def runs(network: Network) -> Sequence[Run]:
    return (run(network), run(network, pictures=False))
