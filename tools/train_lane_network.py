"""Trains the network of the learned lane detector, fits its confidence and evaluates both, in 20 minutes.

    python tools/train_lane_network.py MAPS OUT [--images N] [--epochs 400] [--jobs 16] [--seconds 1250]

MAPS is a folder of road files. The maps are split in three: `TEST` for the figures, `UNSEEN` for the fit of the
confidence, and all others for the training. For the training and the fit, maps with repainted lane marks and made-up
roads (`training_roads`) are added, with seeds of their own. Every map of the training and every added one has a ground
texture of its own. lane_network.onnx, learned_confidence.json, learned_figures.json, learned_looks.npz (what the
confidence was fitted to and measured on) and the added road files are written to OUT, the network every two minutes
from the start of its training. PyTorch, which the package does not depend on, and XGBoost are needed; PyTorch uses a
GPU if there is one.
"""

from __future__ import annotations

import argparse
import copy
import hashlib
import json
import math
import multiprocessing
import time
from dataclasses import asdict
from functools import lru_cache
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import torch
from fit_confidence import of_evidence
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn
from training_roads import made_up, repainted

from scenario_compiler.perception.calibration.bank import BANK, drawn_situation, picture, pictures
from scenario_compiler.perception.calibration.collect import CONDITIONS, RIGHT, Looks, Taker, numbers_of
from scenario_compiler.perception.calibration.figures import CONFIDENT, FITTED, REMEMBERING, fitted_to, judged, worth
from scenario_compiler.perception.calibration.fit import area_under_curve
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.perception.calibration.truth import Truth, X
from scenario_compiler.perception.confidence import Confidence, confidence_text
from scenario_compiler.perception.lane_detector import LaneState
from scenario_compiler.perception.lane_rows import COLUMNS, PEAK, ROWS, TRAINED_FOR, Rows, ground_of
from scenario_compiler.perception.learned_detector import HEIGHT, NETWORK_FILE, WIDTH, LearnedLaneDetector
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.textures import GROUND_SEED
from scenario_compiler.roads import load_network

UNSEEN, TEST = ("Town05", "fabriksgatan"), ("Town03", "soderleden")
SEED, UNSEEN_SEED, TEST_SEED = 101, 202, 303
PAINTED_ANEW = {"Town01": 4, "Town04": 6, "Town_Safebench_Light": 4, "HRI_custommap": 3, "cubetown": 2, "Town05": 2}
"""Number of repainted copies of a map by its name. A map that is not named has one; a map of `TEST` has none."""

MADE_UP, MADE_UP_UNSEEN = 24, 10
"""Number of files with made-up roads for the training and for the fit of the confidence."""

ANEW, OTHER_ROADS = "-anew-", "other-roads-"
"""Parts of the names of files with repainted marks, and of those with made-up roads for the fit of the confidence."""

CLIPS = 24
"""Clips or situations per job."""

IMAGES, VIEWS = 130_000, 2
"""Images in the training set, and images of each clip; more of a clip would be much alike."""

RATE, WARM_UP, BATCH = 4e-3, 500, 512
"""Greatest learning rate, steps until it is reached, and images per step."""

MEMORY = 0.999
"""Share of the averaged weights that is kept in each step."""

MEASURING, BETWEEN = 180.0, 120.0
"""Time that is reserved for what follows the training, and time between two exports during the training, s."""

BLUR, ABSENT, UNPAINTED = 0.8, 0.3, 0.25
"""Width of a row's target, columns; weight of rows without a boundary; weight of rows with an unpainted boundary."""

THIN = 1.5
"""Half the width of the mask with which overlaps are computed, columns: 3 columns of 128."""

PRESENT = 1.0 / (1.0 + ABSENT)
"""Probability from which a row of a mask has the boundary. A row without one has the weight `ABSENT` in the training,
so the network says this where either is as likely.
"""

OFF, FAR = 0.2, 3.0
"""Weight of the distance of a row's mean column from the true one, and the loss of that distance above which it is
constant.
"""

OVERLAP = 1.0
"""Weight of the masks' overlap in the loss."""

SIZES, MIDDLE = (16, 32, 40, 48, 64), (24, 32, 32, 40)
"""Channels of the encoder's and of the decoder's steps, both from the large feature maps to the small ones."""

Arrays = tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.float32]]


class Layer(nn.Module):
    """A convolution with normalisation, and a ReLU.

    While it is trained, a convolution of 3 x 3 has a branch of 1 x 1 beside it and, if its output has the input's
    shape, the identity, each with a normalisation of its own. `folded` adds them up in one convolution (RepVGG, Ding et
    al., arXiv 2101.03697).
    """

    def __init__(self, before: int, after: int, size: int = 3, stride: int = 1) -> None:
        """Create the branches."""
        super().__init__()
        self.stride = stride
        self.main = nn.Sequential(nn.Conv2d(before, after, size, stride, size // 2, bias=False), nn.BatchNorm2d(after))
        self.point = self.same = None
        if size == 3:
            self.point = nn.Sequential(nn.Conv2d(before, after, 1, bias=False), nn.BatchNorm2d(after))
            self.same = nn.BatchNorm2d(after) if stride == 1 and before == after else None

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Return the output of the layer."""
        total = self.main(x)
        if self.point is not None:
            total = total + self.point(x[:, :, :: self.stride, :: self.stride])
        if self.same is not None:
            total = total + self.same(x)
        return functional.relu(total)

    def folded(self) -> nn.Sequential:
        """Return a convolution and a ReLU that do the same as the layer does after the training."""
        first = self.main[0]
        size, after = first.kernel_size[0], first.out_channels
        one = nn.Conv2d(first.in_channels, after, size, first.stride, size // 2)
        weight, bias = torch.zeros_like(one.weight), torch.zeros(after)
        parts = [(branch[0].weight, branch[1]) for branch in (self.main, self.point) if branch is not None]
        if self.same is not None:
            parts.append((torch.eye(after)[:, :, None, None], self.same))
        for kernel, norm in parts:
            scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            edge = (size - kernel.shape[2]) // 2
            weight += functional.pad(kernel * scale[:, None, None, None], [edge] * 4)
            bias += norm.bias - norm.running_mean * scale
        one.weight.data, one.bias.data = weight.detach(), bias.detach()
        return nn.Sequential(one, nn.ReLU())


class LaneNetwork(nn.Module):
    """An encoder of five steps, a decoder with skip connections up to half the image's size, and a head.

    The head gets the encoder's last step. Most of the time is spent in the layers at half the size, and most parameters
    are in the deep layers. For that reason feature maps are reduced to fewer channels before they are enlarged, and the
    layers at half the size have more channels in the decoder than in the encoder, because there the columns are
    distinguished.
    """

    def __init__(self) -> None:
        """Create the layers."""
        super().__init__()
        before = 3
        self.down = nn.ModuleList()
        for k, size in enumerate(SIZES):
            step = [Layer(before, size, stride=2)] + ([Layer(size, size)] if k else [])
            self.down.append(nn.Sequential(*step))
            before = size
        self.thin, self.up = nn.ModuleList(), nn.ModuleList()
        for skip, size in zip(SIZES[-2::-1], MIDDLE[::-1], strict=True):
            self.thin.append(Layer(before, size, 1))
            self.up.append(Layer(size + skip, size))
            before = size
        self.maps = nn.Conv2d(before, 2, 3, 1, 1)
        self.rest = nn.Sequential(nn.Linear(SIZES[-1] * 4 * 2, 32), nn.ReLU(), nn.Linear(32, 4))

    def forward(self, x: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return the logits of the rows (N, 2, ROWS, COLUMNS), and those of the paint with tilt and width (N, 4)."""
        steps = []
        for layer in self.down:
            x = layer(x)
            steps.append(x)
        pooled = functional.avg_pool2d(x, (2, 2)).flatten(1)
        for thin, layer, skip in zip(self.thin, self.up, steps[-2::-1], strict=True):
            x = layer(torch.cat([functional.interpolate(thin(x), scale_factor=2.0, mode="nearest"), skip], 1))
        return self.maps(x), self.rest(pooled)

    def folded(self) -> LaneNetwork:
        """Return a copy for use after the training, on the CPU, with one convolution in each layer."""
        found: LaneNetwork = copy.deepcopy(self).to("cpu", memory_format=torch.contiguous_format).eval()
        for module in list(found.modules()):
            for name, child in list(module.named_children()):
                if isinstance(child, Layer):
                    setattr(module, name, child.folded())
        return found


def columns_of(pixels: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the column of a boundary in each row from its pixels (n, 2), NaN where it is not visible, (ROWS,)."""
    found = np.full(ROWS, np.nan, np.float32)
    if len(pixels) < 2:
        return found
    u, v = pixels[:, 0], pixels[:, 1]
    back = np.flatnonzero(np.diff(v) > 0.0)
    end = len(v) if not len(back) else int(back[0]) + 1
    if end < 2:
        return found
    rows = (np.arange(ROWS) + 0.5) * TRAINED_FOR.height / ROWS - 0.5
    column = (np.interp(rows, v[:end][::-1], u[:end][::-1]) + 0.5) * COLUMNS / TRAINED_FOR.width - 0.5
    seen = (rows >= v[end - 1]) & (rows <= v[0]) & (column > -0.5) & (column < COLUMNS - 0.5)
    found[seen] = column[seen]
    return found


def example(
    image: NDArray[np.uint8], truth: Truth
) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.float32]]:
    """Return an image (HEIGHT, WIDTH, 3), its columns (2, ROWS), and its scaled paint, tilt and lane width (4,)."""
    small = cv2.resize(image, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    columns = np.stack([columns_of(one) for one in truth.pixels])
    left, right = (truth.y(side, float(X[0])) for side in (0, 1))
    width = left - right if math.isfinite(left) and math.isfinite(right) else 3.5
    rest = [float(truth.there(0)), float(truth.there(1)), truth.tilt / 0.03, width - 3.5]
    return np.asarray(small, np.uint8), columns, np.clip(np.array(rest, np.float32), -3.0, 3.0)


@lru_cache(maxsize=1)
def _roads(path: str, seed: int) -> MapRoads:
    return MapRoads(load_network(path, cache=False), texture=texture_of(seed))


def texture_of(seed: int) -> int:
    """Return the seed of the ground texture for a seed of clips: `GROUND_SEED` for the common seeds, else itself."""
    return GROUND_SEED if seed in (SEED, UNSEEN_SEED, TEST_SEED) else seed


def _begin() -> None:
    cv2.setNumThreads(1)
    torch.set_num_threads(1)


def render(job: tuple[str, int, int, int, int]) -> Arrays:
    """Return the images and the truth of a job: clips of a map, or random situations if the job names no map."""
    path, seed, first, last, count = job
    found = []
    if path:
        for _, _, views in _roads(path, seed).clips(seed, range(first, last)):
            found += [example(view.image, view.truth) for view in islice(views, count)]
    else:
        for number in range(first, last):
            draw = np.random.default_rng([seed, number])
            found.append(example(*picture(drawn_situation(draw), draw, texture_of(seed))))
    if not found:
        return (
            np.empty((0, HEIGHT, WIDTH, 3), np.uint8),
            np.empty((0, 2, ROWS), np.float32),
            np.empty((0, 4), np.float32),
        )
    images, columns, rest = zip(*found, strict=True)
    return np.stack(images), np.stack(columns), np.stack(rest)


def all_maps(paths: list[Path], folder: Path) -> list[Path]:
    """Return the given, the repainted and the made-up maps in a fixed order; the latter two are written to a folder."""
    found = list(paths)
    folder.mkdir(parents=True, exist_ok=True)
    for number, path in enumerate(paths):
        for k in range(0 if path.stem in TEST else PAINTED_ANEW.get(path.stem, 1)):
            found.append(folder / f"{path.stem}{ANEW}{k}.xodr")
            repainted(path, found[-1], 1000 * (UNSEEN_SEED if path.stem in UNSEEN else SEED) + 10 * number + k)
    for k in range(MADE_UP + MADE_UP_UNSEEN):
        found.append(folder / f"{'roads-' if k < MADE_UP else OTHER_ROADS}{k}.xodr")
        made_up(found[-1], 1000 * (SEED if k < MADE_UP else UNSEEN_SEED) + 500 + k)
    return found


def is_unseen(name: str) -> bool:
    """Return whether a map serves for the fit of the confidence and therefore not for the training."""
    return name.split(ANEW)[0] in UNSEEN or name.startswith(OTHER_ROADS)


def jobs_of(maps: list[Path], images: int) -> list[tuple[str, int, int, int, int]]:
    """Return jobs of `CLIPS` clips or situations; a fifth of the images show situations."""
    drawn = images // 5
    clips = -(-(images - drawn) // (VIEWS * max(len(maps), 1)))
    parts = [("", 0, drawn), *((str(path), number, clips) for number, path in enumerate(maps, 1))]
    return [
        (path, 1000 * SEED + number, k, min(k + CLIPS, count), VIEWS)
        for path, number, count in parts
        for k in range(0, count, CLIPS)
    ]


def joined(parts: list[Arrays]) -> Arrays:
    """Return the images and the truth of all jobs."""
    return tuple(np.concatenate([part[k] for part in parts]) for k in range(3))  # type: ignore[return-value]


def augmented(x: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    """Return images in -0.5 to 0.5 with random brightness, contrast, colour and noise, from images in 0 to 1."""
    n = len(x)

    def draw(*shape: int) -> torch.Tensor:
        return torch.rand(shape, generator=generator, device=x.device)

    gain = 0.6 + 0.8 * draw(n, 1, 1, 1)
    tint = 0.9 + 0.2 * draw(n, 3, 1, 1)
    gamma = 0.7 + 0.7 * draw(n, 1, 1, 1)
    x = (x.clamp(0.0, 1.0) ** gamma * gain * tint + 0.1 * (draw(n, 1, 1, 1) - 0.5)).clamp(0.0, 1.0)
    sigma = 0.08 * draw(n, 1, 1, 1) * (draw(n, 1, 1, 1) < 0.3)
    return (x + sigma * torch.randn(x.shape, generator=generator, device=x.device)).clamp(0.0, 1.0) - 0.5


def loss_of(maps: torch.Tensor, rest: torch.Tensor, columns: torch.Tensor, truth: torch.Tensor) -> torch.Tensor:
    """Return the loss.

    It is the sum of the cross-entropies of each row's column and of the paint, of the errors of the column, the tilt
    and the width, and of what the overlap of the masks of painted sides lacks to 1. A side's mask covers `THIN` columns
    on either side of a row's column, which is the mean around the most probable one, and counts as much as it is
    probable that the boundary is in the row.

    Args:
        maps: (N, 2, ROWS, COLUMNS) logits of the columns.
        rest: (N, 4) logits of the paint; tilt and width.
        columns: (N, 2, ROWS) true columns; NaN where a boundary is not visible.
        truth: (N, 4) true paint, 0 or 1; tilt and width.
    """
    logits = torch.cat([maps, torch.zeros_like(maps[..., :1])], 3)
    absent = torch.isnan(columns)
    place = torch.arange(COLUMNS, device=maps.device)
    target = torch.exp(-0.5 * ((place - columns.nan_to_num(-1e3)[..., None]) / BLUR) ** 2)
    target = target / target.sum(3, keepdim=True).clamp_min(1e-6)
    target = torch.cat([target * ~absent[..., None], absent[..., None].float()], 3)
    entropy = -(target * functional.log_softmax(logits, 3)).sum(3)
    painted = truth[:, :2, None]
    weight = torch.where(absent, ABSENT, UNPAINTED + (1.0 - UNPAINTED) * painted)
    rows = (entropy * weight).sum() / weight.sum()
    share = functional.softmax(maps, 3)
    told = (share * place).sum(3)
    off = functional.smooth_l1_loss(told, columns.nan_to_num(0.0), reduction="none", beta=0.5).clamp_max(FAR)
    seen = torch.where(absent, torch.zeros_like(weight), weight)
    rows = rows + OFF * (off * seen).sum() / seen.sum().clamp_min(1.0)
    peak = share * ((place - share.argmax(3, keepdim=True)).abs() <= PEAK)
    middle = (peak * place).sum(3) / peak.sum(3)
    there = 1.0 - functional.softmax(logits, 3)[..., -1]
    both = there * (2.0 * THIN - (middle - columns.nan_to_num(-1e3)).abs()).clamp_min(0.0)
    either = 2.0 * THIN * (there + ~absent) - both
    rows = rows + OVERLAP * (1.0 - (both * painted).sum() / (either * painted).sum().clamp_min(1.0))
    paint = functional.binary_cross_entropy_with_logits(rest[:, :2], truth[:, :2])
    plane = functional.smooth_l1_loss(rest[:, 2:], truth[:, 2:])
    return rows + 0.3 * paint + 0.3 * plane


def train(data: Arrays, epochs: int, seconds: float, device: str, path: Path) -> LaneNetwork:
    """Return the network after `epochs` epochs or `seconds`; on the way it is exported to a path now and then.

    The weights are averaged over the last steps, with exponentially falling shares.
    """
    torch.manual_seed(SEED)
    images, columns, truth = (torch.from_numpy(one).to(device) for one in data)
    images = images.permute(0, 3, 1, 2).contiguous()
    network = LaneNetwork()
    network.to(device, memory_format=torch.channels_last)
    mean = AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(MEMORY), use_buffers=True)
    averaged: LaneNetwork = mean.module
    torch.backends.cuda.matmul.allow_tf32 = torch.backends.cudnn.allow_tf32 = torch.backends.cudnn.benchmark = True
    optimizer = torch.optim.AdamW(network.parameters(), lr=RATE, weight_decay=1e-4)
    batch = min(BATCH, len(images))
    steps = epochs * (len(images) // batch)
    generator = torch.Generator(device=device).manual_seed(SEED)
    flips = np.random.default_rng(SEED).random(steps) < 0.5
    began, exported, step = time.monotonic(), 0.0, 0
    for epoch in range(epochs):
        order = torch.randperm(len(images), generator=generator, device=device)
        losses = []
        for k in range(len(images) // batch):
            # If time is short, the rate falls with the time, so that it is low in the last steps in that case too.
            used = time.monotonic() - began
            if used > seconds:
                print(f"stopped in epoch {epoch + 1}: the time is over", flush=True)
                return averaged.folded()
            done = max(step / steps, used / seconds)
            for group in optimizer.param_groups:
                group["lr"] = RATE * min(step / WARM_UP, 0.5 + 0.5 * math.cos(math.pi * done))
            chosen = order[k * batch : (k + 1) * batch]
            x, c, t = images[chosen].float() / 255.0, columns[chosen], truth[chosen]
            if flips[step]:
                x, c, t = x.flip(3), (COLUMNS - 1 - c).flip(1), t[:, [1, 0, 2, 3]]
            x = augmented(x, generator).contiguous(memory_format=torch.channels_last)
            with torch.autocast(device, torch.bfloat16):
                maps, rest = network(x)
            loss = loss_of(maps.float(), rest.float(), c, t)
            optimizer.zero_grad(set_to_none=True)
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), 5.0)
            optimizer.step()
            mean.update_parameters(network)
            step += 1
            if k % 20 == 0:
                losses.append(float(loss.detach()))
        used = time.monotonic() - began
        print(f"epoch {epoch + 1}: loss {np.mean(losses):.4f}, {used:.0f} s", flush=True)
        if used > exported + BETWEEN:
            export(averaged.folded(), path)
            exported = used
    return averaged.folded()


def look(job: tuple[str, int, int, int, bytes]) -> tuple[str, Looks, NDArray[np.float64]]:
    """Return the job's name, its looks, and (N, 5) overlaps of masks and the softmax's maximum for each side.

    A job is of clips of a map, of random situations or of a situation of the bank.
    """
    which, seed, first, last, network = job
    detector = LearnedLaneDetector(network=network, confidence=of_evidence("learned"))
    taker = Taker(detector)
    overlaps: list[tuple[float, ...]] = []

    def take(
        image: NDArray[np.uint8],
        state: LaneState,
        truth: Truth,
        clip: int,
        about: tuple[float, ...],
        way: tuple[WayPoint, ...] = (),
    ) -> LaneState:
        result = taker.look(image, state, truth, clip, about, way)
        told, _, _, _ = detector.tell(image)
        for side in (0, 1):
            said, columns = Rows.of(told[side]), columns_of(truth.pixels[side])
            thin = overlap(said, columns, np.full(ROWS, THIN))
            wide = overlap(said, columns, as_wide_as_right(truth.tilt))
            overlaps.append((*thin, *wide, float(told[side][:, :-1].max())))
        return state.after(result)

    if which.endswith(".xodr"):
        for clip, conditions, views in _roads(which, seed).clips(seed, range(first, last)):
            state = LaneState()
            for view in views:
                about = (*numbers_of(conditions), float(view.number))
                state = take(view.image, state, view.truth, clip, about, view.way)
    elif which == "drawn":
        for number in range(first, last):
            draw = np.random.default_rng([seed, number])
            image, truth = picture(drawn_situation(draw), draw, texture_of(seed))
            take(image, LaneState(), truth, number, (0.0,) * len(CONDITIONS))
    else:
        for number, (image, truth) in enumerate(pictures(BANK[int(which)], seed, last)):
            take(image, LaneState(), truth, number, (0.0,) * len(CONDITIONS))
    return which, taker.looks, np.array(overlaps).reshape(-1, 5)


def overlap(told: Rows, columns: NDArray[np.float32], half: NDArray[np.float64]) -> tuple[float, float]:
    """Return the number of cells in both masks and in either. A mask has the cells within `half` of a row's column."""
    place = np.arange(COLUMNS)
    ours = (np.abs(place - told.column[:, None]) <= half[:, None]) & (told.there > PRESENT)[:, None]
    true = np.abs(place - np.nan_to_num(columns, nan=-1e3)[:, None]) <= half[:, None]
    return float((ours & true).sum()), float((ours | true).sum())


def as_wide_as_right(tilt: float) -> NDArray[np.float64]:
    """Return half the mask's width in each row, columns, (ROWS,): the image of `RIGHT`, but at least `THIN`."""
    x, _ = ground_of(np.zeros(ROWS), (np.arange(ROWS) + 0.5) * TRAINED_FOR.height / ROWS - 0.5, tilt)
    return np.maximum(THIN, RIGHT * TRAINED_FOR.focal * COLUMNS / TRAINED_FOR.width / x)


def export(network: LaneNetwork, path: Path) -> bytes:
    """Write the network as ONNX and return the file's bytes."""
    torch.onnx.export(
        network, (torch.zeros(1, 3, HEIGHT, WIDTH),), str(path), input_names=["image"], output_names=["rows", "rest"],
        opset_version=13, dynamo=False,
    )  # fmt: skip
    return path.read_bytes()


def jobs_of_looks(paths: list[Path], scale: float, onnx: bytes) -> list[tuple[str, int, int, int, bytes]]:
    """Return the jobs for `look`: clips of maps that the training did not use, random situations, and the bank."""
    jobs: list[tuple[str, int, int, int, bytes]] = []
    for number, path in enumerate(paths):
        if is_unseen(path.stem) or path.stem in TEST:
            seed = TEST_SEED if path.stem in TEST else UNSEEN_SEED
            if path.stem not in (*UNSEEN, *TEST):
                seed = 1000 * UNSEEN_SEED + number
            count = int((600 if path.stem.startswith("Town") else 150) * scale)
            jobs += [(str(path), seed, k, min(k + 24, count), onnx) for k in range(0, count, 24)]
    jobs += [("drawn", UNSEEN_SEED, k, k + 48, onnx) for k in range(0, int(2000 * scale), 48)]
    return jobs + [(str(k), TEST_SEED, 0, max(int(60 * scale), 2), onnx) for k in range(len(BANK))]


def write_looks(seen: list[tuple[str, Looks, NDArray[np.float64]]], path: Path) -> None:
    """Write the looks and overlaps of each map, of the random situations and of the bank, as one table each."""
    tables: dict[str, list[NDArray[np.float32]]] = {}
    for which, looks, overlaps in seen:
        rest = np.stack([looks.error, looks.painted, looks.clip], axis=1)
        table = np.concatenate([looks.rows, looks.p, rest, looks.conditions, overlaps], axis=1)
        tables.setdefault(Path(which).stem, []).append(table.astype(np.float32))
    np.savez_compressed(path, allow_pickle=False, **{name: np.concatenate(parts) for name, parts in tables.items()})


def confidence_of(seen: list[tuple[str, Looks, NDArray[np.float64]]]) -> Confidence:
    """Return the confidence fitted to the looks at its own maps and at random situations."""
    of_maps = Looks.joined([looks for which, looks, _ in seen if is_unseen(Path(which).stem)])
    chosen = of_maps.only(np.isin(of_maps.condition("number"), FITTED))
    drawn = Looks.joined([looks for which, looks, _ in seen if which == "drawn"])
    return fitted_to(chosen, drawn)


def figures_of(seen: list[tuple[str, Looks, NDArray[np.float64]]], confidence: Confidence) -> dict[str, object]:
    """Return the figures of each test map and of the bank."""
    figures: dict[str, object] = {}
    for name in TEST:
        looks = Looks.joined([judged(one, confidence) for which, one, _ in seen if Path(which).stem == name])
        cells = np.concatenate([more for which, _, more in seen if Path(which).stem == name])
        number, painted = looks.condition("number"), looks.labels[:, 1] > 0.5
        trusted = painted & (looks.p[:, 2] > 0.5)
        figures[name] = {
            "single": asdict(worth(name, looks.only(number == 0))),
            "driving": asdict(worth(name, looks.only(number >= REMEMBERING))),
            "overlap": float(cells[painted, 0].sum() / cells[painted, 1].sum()),
            "overlap of sides over 0.5": float(cells[trusted, 0].sum() / max(cells[trusted, 1].sum(), 1)),
            "overlap as wide as right": float(cells[painted, 2].sum() / cells[painted, 3].sum()),
            "right": float((looks.error < RIGHT).mean()),
            "area of the softmax's maximum": area_under_curve(cells[:, 4], looks.labels[:, 2] > 0.5),
            "softmax's maximum over 0.9": float((cells[:, 4] > 0.9).mean()),
        }
    bank = []
    for k, one in enumerate(BANK):
        found = judged(next(looks for which, looks, _ in seen if which == str(k)), confidence)
        wrong = found.error >= RIGHT
        misled = wrong & (found.p[:, 2] > CONFIDENT)
        bank.append((one.name, float(1.0 - wrong.mean()), float(found.p[:, 2].mean()), float(misled.mean())))
    return {**figures, "bank": bank}


def forward_time(onnx: bytes, confidence: Confidence) -> float:
    """Return the CPU time of one forward pass on one thread, ms: the mean of 50."""
    detector = LearnedLaneDetector(network=onnx, confidence=confidence)
    cv2.setNumThreads(1)
    image = np.zeros((TRAINED_FOR.height, TRAINED_FOR.width, 3), np.uint8)
    begin = time.process_time()
    for _ in range(50):
        detector.tell(image)
    return (time.process_time() - begin) * 20.0


def main() -> None:
    """Render, train, export, fit the confidence and evaluate."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--images", type=int, default=IMAGES)
    parser.add_argument("--epochs", type=int, default=400)
    parser.add_argument("--jobs", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=1250.0)
    options = parser.parse_args()
    began = time.monotonic()
    options.out.mkdir(parents=True, exist_ok=True)
    paths = all_maps(sorted(options.maps.glob("*.xodr")), options.out / "maps")
    learnt = [path for path in paths if path.stem not in TEST and not is_unseen(path.stem)]
    with multiprocessing.get_context("spawn").Pool(options.jobs, _begin) as pool:
        data = joined(list(pool.imap(render, jobs_of(learnt, options.images))))
        rendered = time.monotonic() - began
        print(f"{len(data[0])} pictures in {rendered:.0f} s", flush=True)
        device = "cuda" if torch.cuda.is_available() else "cpu"
        path = options.out / NETWORK_FILE
        network = train(data, options.epochs, options.seconds - rendered - MEASURING, device, path)
        trained = time.monotonic() - began
        onnx = export(network, path)
        print(f"trained until {trained:.0f} s", flush=True)
        seen = list(pool.imap(look, jobs_of_looks(paths, min(max(options.images / IMAGES, 0.01), 1.0), onnx)))
    write_looks(seen, options.out / "learned_looks.npz")
    confidence = confidence_of(seen)
    text = confidence_text(confidence, LearnedLaneDetector.features)
    (options.out / LearnedLaneDetector.confidence_file).write_text(text, encoding="utf-8")
    figures = {
        "parameters": sum(one.numel() for one in network.parameters()),
        "bytes": len(onnx),
        "sha256": hashlib.sha256(onnx).hexdigest(),
        "pictures": len(data[0]),
        "seconds": {"rendered": rendered, "trained": trained, "all": time.monotonic() - began},
        "maps": {
            "network": [path.stem for path in learnt],
            "confidence": [path.stem for path in paths if is_unseen(path.stem)],
            "test": TEST,
        },
        "milliseconds a forward": forward_time(onnx, confidence),
        **figures_of(seen, confidence),
    }
    (options.out / "learned_figures.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    print({name: figures[name] for name in ("parameters", "bytes", "sha256", "milliseconds a forward")})


if __name__ == "__main__":
    main()
