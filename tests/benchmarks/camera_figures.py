"""Prints a table of the cost of pictures: `python tests/benchmarks/camera_figures.py`.

Every figure is the median of several rounds, in CPU time (user and system) of one thread; each round measures all of
them one after the other, so that ratios are of one run. Pictures are of a drive along the packaged motorway.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector, LaneState
from scenario_compiler.perception.road_camera import RoadCamera, scene_of
from scenario_compiler.perception.sensor_health import SensorMonitor
from scenario_compiler.perception.solids import Box
from scenario_compiler.roads import Network, Pose, load_network
from scenario_compiler.vocabulary.weather import Weather, weather_preset

MAP = Path(__file__).parents[2] / "maps" / "highway_loop" / "highway_loop.xodr"
ROAD, LANE, START = "1", -1, 300.0
GAPS = (15.0, 25.0, 40.0, 60.0)
"""How far ahead the other vehicles are, m: four, or eight with those of the other lane."""

SMALL, LARGE = Camera(), Camera(width=1024, height=512)
WIDE = Camera(width=1280, height=720, fov=math.radians(70.0), x=0.3, z=1.35, pitch=math.radians(-4.0))

FIGURES = (
    "512 x 256, clear",
    "512 x 256, hard rain, 4 vehicles",
    "512 x 256, clear, 8 vehicles",
    "512 x 256, clear night, 4 vehicles",
    "1024 x 512, clear",
    "1280 x 720, clear",
    "1280 x 720, hard rain, 4 vehicles",
    "1280 x 720, JPEG of quality 80",
    "512 x 256, depth, semantic and instance, 4 vehicles",
    "lane detection, 512 x 256",
    "sensor health, 512 x 256",
)


def preset(name: str) -> Weather:
    """Return a preset of CARLA's."""
    found = weather_preset(name)
    assert found is not None
    return found


class Drive:
    """A drive along a motorway, picture by picture."""

    def __init__(self) -> None:
        """Prepare the scene and the cameras, one for each weather."""
        self.network: Network = load_network(MAP)
        self.scene = scene_of(self.network)
        self.cameras: dict[tuple[Camera, str], RoadCamera] = {}

    def pose(self, k: int) -> Pose:
        """Return where the camera is at picture k: a metre farther each time."""
        return self.network.lane_pose(ROAD, LANE, START + k)

    def boxes(self, k: int, count: int) -> list[Box]:
        """Return the vehicles ahead."""
        found = []
        for n in range(count):
            pose = self.network.lane_pose(ROAD, LANE - (n // len(GAPS) + n) % 2, START + k + GAPS[n % len(GAPS)])
            found.append(Box(pose.x, pose.y, pose.z, pose.heading, 4.4, 1.85, 1.45, (150, 80, 60)))
        return found

    def camera(self, camera: Camera, weather: str) -> RoadCamera:
        """Return the camera that draws one weather only."""
        if (camera, weather) not in self.cameras:
            self.cameras[camera, weather] = RoadCamera(self.scene, camera)
        return self.cameras[camera, weather]

    def image(self, camera: Camera, weather: str, vehicles: int, k: int) -> np.ndarray:
        """Draw picture k."""
        return self.camera(camera, weather).frame(self.pose(k), self.boxes(k, vehicles), preset(weather), 0.0, k)

    def labels(self, k: int) -> tuple[np.ndarray, ...]:
        """Label the pixels of picture k."""
        drawing = self.camera(SMALL, "ClearNoon").draw(self.pose(k), self.boxes(k, 4), preset("ClearNoon"))
        return drawing.depth, drawing.semantic, drawing.instance


def rounds(count: int) -> dict[str, list[float]]:
    """Return what each figure cost in each round, CPU ms."""
    drive, detector, monitor = Drive(), ClassicalLaneDetector(), SensorMonitor()
    images = [drive.image(SMALL, "ClearNoon", 0, k) for k in range(8)]
    memory = LaneState().after(detector.detect(images[0]))
    large = drive.image(WIDE, "HardRainNoon", 4, 0)
    works: dict[str, Callable[[int], object]] = dict(
        zip(
            FIGURES,
            (
                lambda k: drive.image(SMALL, "ClearNoon", 0, k),
                lambda k: drive.image(SMALL, "HardRainNoon", 4, k),
                lambda k: drive.image(SMALL, "ClearNoon", 8, k),
                lambda k: drive.image(SMALL, "ClearNight", 4, k),
                lambda k: drive.image(LARGE, "ClearNoon", 0, k),
                lambda k: drive.image(WIDE, "ClearNoon", 0, k),
                lambda k: drive.image(WIDE, "HardRainNoon", 4, k),
                lambda k: cv2.imencode(".jpg", large, [cv2.IMWRITE_JPEG_QUALITY, 80]),
                drive.labels,
                lambda k: detector.detect(images[k % len(images)], memory),
                lambda k: monitor.observe(images[k % len(images)], 1.0),
            ),
            strict=True,
        )
    )
    found: dict[str, list[float]] = {name: [] for name in works}
    for k in range(-1, count):
        for name, work in works.items():
            begin = time.process_time()
            work(max(k, 0))
            if k >= 0:
                found[name].append(1e3 * (time.process_time() - begin))
    return found


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Print what pictures cost.")
    parser.add_argument("--rounds", type=int, default=60, help="pictures of each kind; the median is printed")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    cost = {name: statistics.median(values) for name, values in rounds(options.rounds).items()}
    console = Console()
    table = Table("figure", "CPU ms", "held to", title="Pictures", title_justify="left")
    for name, value in cost.items():
        table.add_row(name, f"{value:.2f}", "40" if name.startswith("1280") else "")
    vehicle = (cost["512 x 256, clear, 8 vehicles"] - cost["512 x 256, clear"]) / 8.0
    table.add_row("one vehicle, 512 x 256", f"{vehicle:.3f}", "0.3")
    console.print(table)
    small = cost["512 x 256, clear"]
    ratios = Table("ratio", "measured", "at most", title="Ratios", title_justify="left")
    for name, value, held in (
        ("512 x 256: hard rain and 4 vehicles to clear", cost["512 x 256, hard rain, 4 vehicles"] / small, 1.6),
        ("clear: 1024 x 512 to 512 x 256", cost["1024 x 512, clear"] / small, 3.0),
        ("sensor health to lane detection", cost["sensor health, 512 x 256"] / cost["lane detection, 512 x 256"], 0.2),
    ):
        ratios.add_row(name, f"{value:.2f}", f"{held:g}")
    console.print(ratios)


if __name__ == "__main__":
    main()
