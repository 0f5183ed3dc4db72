"""Fits the paint outputs of a trained lane network again, with lorries close ahead.

    python tools/fit_lane_head.py MAPS NETWORK OUT [--jobs 16]

MAPS is a folder of road files, which are split and repainted as `train_lane_network` does it; NETWORK is the ONNX file
that it wrote. Only the layers behind the last step of the encoder are fitted, to pictures with seeds of their own of
the maps of the training: the longer the whole network is trained, the surer it is of the paint without being right.
The tilt and the lane's width are kept as they were, and the rows have other layers. lane_network.onnx is written to
OUT; the confidence is fitted afterwards (`fit_confidence`). The packages `onnx` and `torch` are needed.
"""

from __future__ import annotations

import argparse
import multiprocessing
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper
from torch.nn import functional
from train_lane_network import SEED, TEST, all_maps, example, is_unseen

from scenario_compiler.perception.calibration.bank import drawn_situation, picture
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.learned_detector import HEIGHT, NETWORK_FILE, WIDTH
from scenario_compiler.roads import load_network

HEAD_SEED = 404
"""Of the pictures for the paint."""

CLIPS, SITUATIONS, LORRIES = 24, 2000, 0.3
"""Clips of each map for the paint, of which the first image is used; random situations; share of clips with a lorry."""

STEPS, BATCH, RATE = 1500, 512, 2e-3
DROPPED, PULL, KEEP = 0.2, 1e-4, 3.0
"""Steps of the fit, images per step and greatest learning rate; share of the features that are left out in each step;
weight of the squared change of the weights, and of the change of the tilt and the width.
"""

POOLED = "/Flatten_output_0"
"""The encoder's last step, as the fitted layers receive it."""

LAYERS = ("rest.0.weight", "rest.0.bias", "rest.2.weight", "rest.2.bias")

Layers = list[torch.Tensor]


class Clips(NamedTuple):
    """Clips of a map, or random situations without one."""

    path: str
    seed: int
    texture: int
    first: int
    last: int


@lru_cache(maxsize=1)
def _roads(path: str, texture: int) -> MapRoads:
    return MapRoads(load_network(path, cache=False), texture=texture, lorries=LORRIES)


def pictures(job: Clips) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return images (N, HEIGHT, WIDTH, 3) and their scaled paint, tilt and width (N, 4)."""
    found = []
    if job.path:
        clips = _roads(job.path, job.texture).clips(job.seed, range(job.first, job.last))
        found = [example(one.image, one.truth) for _, _, views in clips for one in islice(views, 1)]
    else:
        for number in range(job.first, job.last):
            draw = np.random.default_rng([job.seed, number])
            found.append(example(*picture(drawn_situation(draw), draw, job.texture)))
    images = np.array([image for image, _, _ in found], np.uint8).reshape(-1, HEIGHT, WIDTH, 3)
    return images, np.array([rest for _, _, rest in found], np.float32).reshape(-1, 4)


def jobs_of_paint(maps: list[Path]) -> list[Clips]:
    """Return the jobs for `pictures`."""
    jobs = [
        Clips(str(path), 1000 * HEAD_SEED + k, 1000 * SEED + 1 + k, 0, CLIPS)
        for k, path in enumerate(maps)
        if path.stem not in TEST and not is_unseen(path.stem)
    ]
    drawn = range(0, SITUATIONS, 100)
    return jobs + [Clips("", 1000 * HEAD_SEED + 900, 1000 * SEED, k, k + 100) for k in drawn]


def pooled(network: onnx.ModelProto, images: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return the features of images (N, HEIGHT, WIDTH, 3) that the fitted layers receive, (N, F)."""
    shown = onnx.ModelProto()
    shown.CopyFrom(network)
    size = layers_of(network)[0].shape[1]
    shown.graph.output.append(helper.make_tensor_value_info(POOLED, TensorProto.FLOAT, [1, size]))
    net = cv2.dnn.readNetFromONNX(np.frombuffer(shown.SerializeToString(), np.uint8))
    found = []
    for image in images:
        blob = image.transpose(2, 0, 1)[None].astype(np.float32) / np.float32(255.0) - np.float32(0.5)
        net.setInput(np.ascontiguousarray(blob))
        found.append(net.forward(["rows", "rest", POOLED])[2].ravel())
    return np.array(found, np.float32)


def layers_of(network: onnx.ModelProto) -> Layers:
    """Return the weights of `LAYERS`."""
    found = {one.name: numpy_helper.to_array(one) for one in network.graph.initializer}
    return [torch.tensor(found[name].copy()) for name in LAYERS]


def with_layers(network: onnx.ModelProto, layers: Layers) -> bytes:
    """Return the ONNX file of a network with other weights of `LAYERS`."""
    for one in network.graph.initializer:
        if one.name in LAYERS:
            weights = layers[LAYERS.index(one.name)].numpy()
            one.CopyFrom(numpy_helper.from_array(weights, one.name))
    return bytes(network.SerializeToString())


def outputs(layers: Layers, features: torch.Tensor) -> torch.Tensor:
    """Return the logits of the paint, the tilt and the width, (N, 4)."""
    return functional.relu(features @ layers[0].T + layers[1]) @ layers[2].T + layers[3]


def fit(features: torch.Tensor, truth: torch.Tensor, before: Layers) -> Layers:
    """Return layers whose paint has the least cross-entropy, and whose tilt and width are those of the layers before.

    Args:
        features: (N, F).
        truth: (N, 4) true paint, 0 or 1, in the first two columns.
        before: The layers from which the fit starts.
    """
    generator = torch.Generator().manual_seed(1)
    kept = outputs(before, features)[:, 2:]
    layers = [one.clone().requires_grad_() for one in before]
    optimizer = torch.optim.Adam(layers, lr=RATE)
    for step in range(STEPS):
        for group in optimizer.param_groups:
            group["lr"] = RATE * 0.5 * (1.0 + np.cos(np.pi * step / STEPS))
        chosen = torch.randint(len(features), (BATCH,), generator=generator)
        whole = features[chosen]
        part = whole * (torch.rand(whole.shape, generator=generator) > DROPPED) / (1.0 - DROPPED)
        paint = functional.binary_cross_entropy_with_logits(outputs(layers, part)[:, :2], truth[chosen, :2])
        off = functional.smooth_l1_loss(outputs(layers, whole)[:, 2:], kept[chosen], beta=0.1)
        change = sum(((one - old) ** 2).sum() for one, old in zip(layers, before, strict=True))
        loss = 0.3 * paint + KEEP * off + PULL * change
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    return [one.detach() for one in layers]


def _begin() -> None:
    cv2.setNumThreads(1)


def main() -> None:
    """Render and fit the paint."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path)
    parser.add_argument("network", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--jobs", type=int, default=16)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    maps = all_maps(sorted(options.maps.glob("*.xodr")), options.out / "maps")
    network = onnx.load(options.network)
    with multiprocessing.get_context("spawn").Pool(options.jobs, _begin) as pool:
        parts = pool.map(pictures, jobs_of_paint(maps), chunksize=1)
        images, truth = (np.concatenate([part[k] for part in parts]) for k in range(2))
        features = np.concatenate([pooled(network, images), pooled(network, images[:, :, ::-1])])
        both = np.concatenate([truth, truth[:, [1, 0, 2, 3]]])
        layers = fit(torch.from_numpy(features), torch.from_numpy(both), layers_of(network))
    (options.out / NETWORK_FILE).write_bytes(with_layers(network, layers))
    print(f"{len(images)} pictures")


if __name__ == "__main__":
    main()
