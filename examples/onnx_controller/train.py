"""Trains the network of `steering.py` on pictures that the built-in camera draws, and writes it as ONNX.

python examples/onnx_controller/train.py [FILE]          (FILE is lane_ahead.onnx beside this script unless given)

It needs `onnx` (`pip install scenario-compiler[examples]`); the controller does not. The network has one hidden layer
and is trained with Adam (Kingma and Ba 2015) in numpy.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper
from steering import DISTANCES, HEIGHT, WIDTH, network_input  # type: ignore[import-not-found]

from scenario_compiler import Network, Weather, find_map, load_network, weather_preset
from scenario_compiler.perception import RoadCamera, scene_of
from scenario_compiler.roads import Pose

Floats = NDArray[np.float64]

ROADS = ("1", "2", "6", "8")
"""Roads of highway_loop with perfect marks; the scenario drives on another one."""

LANES = (-1, -2)
WEATHERS = ("ClearNoon", "CloudyNoon", "ClearSunset")
HIDDEN = 24


def offsets_ahead(network: Network, pose: Pose, road: str, lane: int, s: float) -> list[float]:
    """Return how far left of the vehicle's axis the lane's middle is at each of the distances, m."""
    points = [network.lane_pose(road, lane, s + d) for d in np.arange(0.0, DISTANCES[-1] + 4.0, 1.0)]
    along = [math.cos(pose.heading) * (p.x - pose.x) + math.sin(pose.heading) * (p.y - pose.y) for p in points]
    left = [math.cos(pose.heading) * (p.y - pose.y) - math.sin(pose.heading) * (p.x - pose.x) for p in points]
    return [float(np.interp(d, along, left)) for d in DISTANCES]


def pictures(count: int, draw: np.random.Generator) -> tuple[Floats, Floats]:
    """Return inputs (count, HEIGHT * WIDTH) and answers (count, distances), m, from poses around the lane's middle."""
    network = load_network(find_map("highway_loop"))
    camera = RoadCamera(scene_of(network))
    lengths = {road: network.road(road).length for road in ROADS}
    inputs, answers = [], []
    for number in range(count):
        road, lane = str(draw.choice(ROADS)), int(draw.choice(LANES))
        s = float(draw.uniform(0.0, lengths[road] - DISTANCES[-1] - 5.0))
        middle = network.lane_pose(road, lane, s, float(draw.uniform(-1.0, 1.0)))
        pose = Pose(middle.x, middle.y, middle.z, middle.heading + float(draw.uniform(-0.12, 0.12)), 0.0, 0.0)
        weather = weather_preset(str(draw.choice(WEATHERS))) or Weather()
        image = camera.frame(pose, [], weather, float(draw.uniform(0.0, 6.0)), number)
        inputs.append(network_input(image).ravel())
        answers.append(offsets_ahead(network, pose, road, lane, s))
    return np.array(inputs, float), np.array(answers)


def trained(x: Floats, y: Floats, rounds: int, draw: np.random.Generator) -> list[Floats]:
    """Return the weights and biases of both layers, trained on inputs and answers."""
    weights = [
        draw.normal(0.0, math.sqrt(2.0 / x.shape[1]), (x.shape[1], HIDDEN)),
        np.zeros(HIDDEN),
        draw.normal(0.0, math.sqrt(1.0 / HIDDEN), (HIDDEN, y.shape[1])),
        y.mean(axis=0),
    ]
    first, second = [np.zeros_like(w) for w in weights], [np.zeros_like(w) for w in weights]
    step = 0
    for number in range(rounds):
        rate = 2e-3 * 0.5 * (1.0 + math.cos(math.pi * number / rounds))
        order = draw.permutation(len(x))
        for rows in np.array_split(order, max(1, len(x) // 64)):
            step += 1
            hidden = np.maximum(x[rows] @ weights[0] + weights[1], 0.0)
            error = 2.0 * (hidden @ weights[2] + weights[3] - y[rows]) / len(rows)
            back = (error @ weights[2].T) * (hidden > 0.0)
            slopes = [x[rows].T @ back + 1e-3 * weights[0], back.sum(0), hidden.T @ error, error.sum(0)]
            for w, m, v, slope in zip(weights, first, second, slopes, strict=True):
                m += 0.1 * (slope - m)
                v += 0.001 * (slope * slope - v)
                w -= rate * (m / (1 - 0.9**step)) / (np.sqrt(v / (1 - 0.999**step)) + 1e-8)
    return weights


def answered(weights: list[Floats], x: Floats) -> Floats:
    """Return what the network answers."""
    return np.maximum(x @ weights[0] + weights[1], 0.0) @ weights[2] + weights[3]


def as_onnx(weights: list[Floats]) -> onnx.ModelProto:
    """Return the network as ONNX: flatten, linear, ReLU, linear."""
    names = ("weights_1", "bias_1", "weights_2", "bias_2")
    kept = [numpy_helper.from_array(w.astype(np.float32), name) for w, name in zip(weights, names, strict=True)]
    nodes = [
        helper.make_node("Flatten", ["image"], ["flat"]),
        helper.make_node("Gemm", ["flat", "weights_1", "bias_1"], ["sum"]),
        helper.make_node("Relu", ["sum"], ["hidden"]),
        helper.make_node("Gemm", ["hidden", "weights_2", "bias_2"], ["offsets"]),
    ]
    image = helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 1, HEIGHT, WIDTH])
    offsets = helper.make_tensor_value_info("offsets", TensorProto.FLOAT, [1, len(DISTANCES)])
    graph = helper.make_graph(nodes, "lane_ahead", [image], [offsets], kept)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
    onnx.checker.check_model(model)
    return model


def main() -> None:
    """Train, say how far off the network is on pictures that it has not seen, write it."""
    parser = argparse.ArgumentParser(description="Train the network of steering.py and write it as ONNX.")
    parser.add_argument("file", nargs="?", type=Path, default=Path(__file__).with_name("lane_ahead.onnx"))
    parser.add_argument("--pictures", type=int, default=5000, help="pictures that it is trained on")
    parser.add_argument("--rounds", type=int, default=60, help="how often each picture is shown")
    options = parser.parse_args()
    draw = np.random.default_rng(1)
    x, y = pictures(options.pictures, draw)
    weights = trained(x, y, options.rounds, draw)
    fresh_x, fresh_y = pictures(max(1, options.pictures // 10), draw)
    errors = np.sqrt(((answered(weights, fresh_x) - fresh_y) ** 2).mean(axis=0))
    said = ", ".join(f"{error:.2f} m at {d:g} m" for error, d in zip(errors, DISTANCES, strict=True))
    print(f"root mean square error on {len(fresh_x)} fresh pictures: {said}")
    options.file.write_bytes(as_onnx(weights).SerializeToString(deterministic=True))
    print(f"{options.file}: {options.file.stat().st_size} bytes")


if __name__ == "__main__":
    main()
