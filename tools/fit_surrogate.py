"""Fits surrogate perception to runs with the camera, and judges it by runs that took no part.

    python tools/fit_surrogate.py gather MAPS RUNS [--first 0] [--fitted 2000] [--jobs 32] [--seconds 370]
    python tools/fit_surrogate.py fit RUNS
    python tools/fit_surrogate.py judge RUNS MAPS [--pages docs]

`gather` makes the runs with the camera: MAPS is a folder of road files, RUNS the folder for what came of them (six
minutes on 32 cores). `fit` writes the coefficients beside `engine/program/surrogate.py` (a minute on one core). `judge`
makes the runs that took no part again, with surrogate and with ideal perception, and writes the page and the figure.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from surrogate_runs import LOOK_COLUMNS, Made, cases, keep, kept, make

from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.view import HIDDEN, OUTPUTS, UNITS, VIEW_SIZE
from scenario_compiler.engine.program import surrogate
from scenario_compiler.engine.program.surrogate import MOUNTING, Surrogate, surrogate_text
from scenario_compiler.perception.calibration.probes import probes
from scenario_compiler.vocabulary.sensors import Camera

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

STEPS, WARM_UP, BATCH, RATE, DECAY = 2000, 200, 2048, 1e-2, 1e-3
"""Steps of the fit, those until its greatest rate, looks of a step, that rate, and the penalty on squared weights."""

ABSOLUTE = 3.0
"""How much the absolute error of a confidence counts beside its cross-entropy."""

WORN, WORN_WEIGHT, ASKING_WEIGHT = 0.5, 4.0, 0.5
"""Looks at paint of less than this quality count more, and looks from a request on less: few are of either kind."""

PATH_WEIGHT, PATH_BEND, PATH_MOST = 10.0, 0.3, 1.5
"""Weight of the path's error, the error from which it counts linearly, and the greatest that counts, m."""

MARGIN = 0.05
"""How far the domain reaches beyond what was seen, as a share of its width."""

LEAST, MOST_OPEN, HALF_LEFT = 1e-3, 4.0, 0.7
"""Bounds of the confidence and of what is left open of its logit; and, of noise that is linear between cells, the share
of a cell at which half of what neighbours have in common is left."""

RARE = (0.002, 0.998)
"""Quantiles that bound the domain in what has no bounds of its own: where the ego is in the lane, and bends."""
_OF_SIDES = (at.S_BESIDE, at.S_OFFSET, at.S_HEADING, at.S_BEND_NEAR, at.S_BEND_FAR)
UNBOUNDED = (*_OF_SIDES, *(at.SIDE_SIZE + one for one in _OF_SIDES), at.V_CURVED_NEAR, at.V_CURVED_FAR)

MIRRORED = np.r_[at.SIDE_SIZE : at.V_BOTH, : at.SIDE_SIZE, at.V_BOTH : VIEW_SIZE]
"""Which features of the left side's view are those of the right side's, in their order."""


class Looks:
    """The looks of runs as arrays: N looks, two sides.

    Attributes:
        view: (N, 2, VIEW_SIZE) features.
        p: (N, 2) the detector's confidence, without the sensor's health.
        path: (N,) how far left of the lane's centre the followed path lies, m; NaN where that is not known.
        asking: (N,) 1 from the request on.
        s: (N,) place along the road, m; `road` its number.
        run: (N,) number of the run.
    """

    def __init__(self, runs: list[Made]) -> None:
        """Put the looks of the runs together."""
        looks = np.concatenate([one.looks for one in runs]).astype(np.float64)
        rest = dict(zip(LOOK_COLUMNS, looks[:, VIEW_SIZE:].T, strict=True))
        self.view = np.stack([looks[:, :VIEW_SIZE], looks[:, MIRRORED]], axis=1)
        self.p = np.stack([rest["p_left"], rest["p_right"]], axis=1)
        self.path, self.asking, self.s, self.road = rest["path_error"], rest["asking"], rest["s"], rest["road"]
        self.run = np.repeat(np.arange(len(runs)), [len(one.looks) for one in runs])

    @property
    def leads(self) -> NDArray[np.bool_]:
        """(N,) whether the followed path tells of what was seen: a boundary leads it, and the ego is in its lane."""
        seen = self.p.max(axis=1) >= 0.3
        return seen & np.isfinite(self.path) & (np.abs(self.view[:, 0, at.S_OFFSET]) < 1.2) & (np.abs(self.path) < 2.0)

    @property
    def weight(self) -> Floats:
        """(N,) how much each look counts, by what is there to be seen alone."""
        worn = self.view[:, 0, [at.S_QUALITY, at.SIDE_SIZE + at.S_QUALITY]].min(axis=1) < WORN
        weight = np.where(worn, WORN_WEIGHT, 1.0) * np.where(self.asking > 0.0, ASKING_WEIGHT, 1.0)
        return weight / weight.sum()


def domain_of(looks: Looks) -> tuple[Floats, Floats]:
    """Return the least and the greatest value of each feature in the domain."""
    flat = looks.view.reshape(-1, VIEW_SIZE)
    low, high = flat.min(axis=0), flat.max(axis=0)
    for feature in UNBOUNDED:
        low[feature], high[feature] = np.quantile(flat[:, feature], RARE)
    margin = MARGIN * (high - low)
    return low - margin, high + margin


def fit(looks: Looks, steps: int = STEPS, seed: int = 1) -> tuple[Floats, Floats]:
    """Return the weights (VIEW_SIZE + 1, UNITS) and (HIDDEN, OUTPUTS) with the least loss over looks.

    The loss of a confidence is its cross-entropy and `ABSOLUTE` times its absolute error: the latter is least at the
    median, which is what a threshold asks for where the detector is sure of one thing or the other. It is brought
    down by Adam (Kingma and Ba 2015) on batches, the rate falling to 0 by half a cosine.
    """
    low, high = domain_of(looks)
    view = np.clip(looks.view, low, high)
    flat = view.reshape(-1, VIEW_SIZE)
    middle, scale = flat.mean(axis=0), np.maximum(flat.std(axis=0), 1e-3)
    known, p = ((view - middle) / scale).astype(np.float32), looks.p.clip(0.0, 1.0).astype(np.float32)
    leads, chance = looks.leads, looks.weight
    path = np.where(leads, np.clip(looks.path, -PATH_MOST, PATH_MOST), 0.0).astype(np.float32)
    path_weight = (leads / (leads * chance).sum()).astype(np.float32)
    draw = np.random.default_rng(seed)
    first = np.zeros((VIEW_SIZE, UNITS), np.float32)
    first[:, :HIDDEN] = draw.normal(0.0, 0.3 / math.sqrt(VIEW_SIZE), (VIEW_SIZE, HIDDEN))
    weights = [first, np.zeros(UNITS, np.float32), np.zeros((HIDDEN, OUTPUTS), np.float32)]
    mean, square = ([np.zeros_like(one) for one in weights] for _ in range(2))
    for step in range(1, steps + 1):
        batch = draw.choice(len(known), BATCH, p=chance)
        slopes = _slopes(weights, known[batch], p[batch], path[batch], path_weight[batch])
        rate = RATE * min(step / WARM_UP, 0.5 + 0.5 * math.cos(math.pi * step / steps))
        for k, slope in enumerate(slopes):
            mean[k] += 0.1 * (slope - mean[k])
            square[k] += 0.001 * (slope * slope - square[k])
            size = np.sqrt(square[k] / (1.0 - 0.999**step)) + 1e-8
            weights[k] -= np.float32(rate / (1.0 - 0.9**step)) * mean[k] / size
    found, shift, after = (one.astype(np.float64) for one in weights)
    raw = found / scale[:, None]
    return np.concatenate([raw, (shift - middle @ raw)[None]]), after


def _slopes(
    weights: list[Singles], known: Singles, p: Singles, path: Singles, path_weight: Singles
) -> tuple[Singles, Singles, Singles]:
    """Return the derivative of the mean loss of a batch by each of the weights."""
    first, bias, second = weights
    rows, count = known.reshape(-1, VIEW_SIZE), len(known)
    inner = rows @ first + bias
    below = 1.0 + np.abs(inner[:, :HIDDEN])
    units = inner[:, :HIDDEN] / below
    out = inner[:, HIDDEN:] + units @ second
    said = 1.0 / (1.0 + np.exp(-np.clip(out[:, 0], -30.0, 30.0)))
    off = said - p.reshape(-1)
    towards = np.empty_like(out)
    towards[:, 0] = (off + ABSOLUTE * np.sign(off) * said * (1.0 - said)) / (2.0 * count)
    drawn = out[:, 1].reshape(count, 2)
    error = np.clip(drawn[:, 0] - drawn[:, 1] - path, -PATH_BEND, PATH_BEND)
    towards[:, 1] = np.outer(PATH_WEIGHT * path_weight * error / count, (1.0, -1.0)).reshape(-1)
    back = np.concatenate([towards @ second.T / (below * below), towards], axis=1)
    return (
        rows.T @ back + 2.0 * DECAY * first,
        back.sum(axis=0),
        units.T @ towards + 2.0 * DECAY * second,
    )


def answers(view: Floats, low: Floats, high: Floats, first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """Return the logits (N, 2) and the path's error (N,), m, as the engine works them out."""
    inner = np.clip(view, low, high) @ first[:-1] + first[-1]
    units = inner[..., :HIDDEN]
    out = inner[..., HIDDEN:] + units / (1.0 + np.abs(units)) @ second
    return out[..., 0], out[:, 0, 1] - out[:, 1, 1]


def noise_of(residual: Floats, looks: Looks) -> tuple[float, float]:
    """Return (deviation, cell in m) of noise like what is left open, (N,), NaN where it does not count.

    Of each run what is left open on the whole way is taken out: it is of the run, not of the place. The deviation is
    that which looks 1 to 3 m apart have in common, so that what changes from image to image does not count. The cell is
    the distance at which half of it is left, over `HALF_LEFT`.
    """
    rest = residual.copy()
    for number in np.unique(looks.run):
        mine = looks.run == number
        if np.isfinite(rest[mine]).any():
            rest[mine] -= np.nanmean(rest[mine])
    apart, product = [], []
    for step in range(1, 80):
        same = (looks.run[step:] == looks.run[:-step]) & (looks.road[step:] == looks.road[:-step])
        both = rest[step:] * rest[:-step]
        use = same & np.isfinite(both)
        apart.append(np.abs(looks.s[step:] - looks.s[:-step])[use])
        product.append(both[use])
    distance, common = np.concatenate(apart), np.concatenate(product)
    near = max(float(common[(distance >= 1.0) & (distance < 3.0)].mean()), 0.0)
    for least in range(2, 40):
        there = common[(distance >= least) & (distance < least + 2)]
        if len(there) and there.mean() < 0.5 * near:
            return math.sqrt(near), (least + 1.0) / HALF_LEFT
    return math.sqrt(near), 40.0 / HALF_LEFT


def fitted(runs: list[Made]) -> Surrogate:
    """Return surrogate perception fitted to runs."""
    looks = Looks(runs)
    low, high = domain_of(looks)
    first, second = fit(looks)
    logit, drawn = answers(looks.view, low, high, first, second)
    automated = looks.asking == 0.0
    true = np.clip(looks.p, LEAST, 1.0 - LEAST)
    left_open = np.clip(np.log(true / (1.0 - true)) - logit, -MOST_OPEN, MOST_OPEN)
    sides = [noise_of(np.where(automated, left_open[:, side], np.nan), looks) for side in range(2)]
    path = noise_of(np.where(automated & looks.leads, looks.path - drawn, np.nan), looks)
    noise = (float(np.mean([one[0] for one in sides])), float(np.mean([one[1] for one in sides])), *path)
    camera = Camera.model_construct()
    return Surrogate(
        detector="classical",
        camera={name: getattr(camera, name) for name in MOUNTING},
        runs=len(runs),
        probes=probes("classical"),
        low=_rounded(low),
        high=_rounded(high),
        first=tuple(_rounded(row) for row in first),
        second=tuple(_rounded(row) for row in second),
        noise=_rounded(np.array(noise)),
    )


def _rounded(values: Floats) -> tuple[float, ...]:
    return tuple(float(f"{value:.6g}") for value in values)


def write_sample(judged: list[Made], file: Path) -> None:
    """Write every second of the judged variants of conflicts, as [number, time of the request or null], for a test."""
    some = [one for one in judged if one.case.kind == "conflict"][::2]
    times = [[one.case.number, float(one.outcome["request_time"])] for one in some]
    rows = [[number, None if math.isnan(time) else round(time, 2)] for number, time in times]
    file.write_text(json.dumps(rows) + "\n", encoding="utf-8")


def main() -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    gathering = commands.add_parser("gather")
    gathering.add_argument("maps", type=Path)
    gathering.add_argument("runs", type=Path)
    gathering.add_argument("--first", type=int, default=0)
    gathering.add_argument("--fitted", type=int, default=2000)
    gathering.add_argument("--jobs", type=int, default=2)
    gathering.add_argument("--seconds", type=float, default=36000.0)
    fitting = commands.add_parser("fit")
    fitting.add_argument("runs", type=Path)
    judging = commands.add_parser("judge")
    judging.add_argument("runs", type=Path)
    judging.add_argument("maps", type=Path)
    judging.add_argument("--pages", type=Path, default=Path("docs"))
    judging.add_argument("--sample", type=Path, default=Path("tests/engine/surrogate_runs.json"))
    options = parser.parse_args()
    if options.command == "gather":
        todo = cases(sorted(options.maps.glob("*.xodr")), options.first, options.fitted)
        keep(make(todo, options.jobs, options.seconds), options.runs)
    elif options.command == "fit":
        found = fitted([one for one in kept(options.runs) if one.case.number >= 0])
        file = Path(surrogate.__file__).with_name(surrogate.FILE)
        file.write_text(surrogate_text(found), encoding="utf-8")
        print(f"{found.runs} runs, noise {found.noise}: {file}")
    else:
        from surrogate_page import write_page

        of_no_fit = [one for one in kept(options.runs) if one.case.number < 0]
        judged = [one for one in of_no_fit if not one.case.faster]
        write_page(judged, [one for one in of_no_fit if one.case.faster], options.maps, options.pages)
        write_sample(judged, options.sample)


if __name__ == "__main__":
    main()
