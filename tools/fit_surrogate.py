"""Fits surrogate perception to runs with camera perception, and evaluates it on runs that were not fitted to.

    python tools/fit_surrogate.py gather MAPS RUNS [--first 0] [--fitted 2000] [--jobs 32] [--seconds 370]
    python tools/fit_surrogate.py fit RUNS MAPS
    python tools/fit_surrogate.py judge RUNS MAPS [--pages docs]

`gather` makes the runs with camera perception: MAPS is a folder of road files, RUNS the folder to which the runs are
written (six minutes on 32 cores). `fit` writes the coefficients beside `engine/program/surrogate.py` (a minute on one
core). `judge` repeats the runs that were not fitted to, with surrogate and with ideal perception, and writes the page
and its figure.

A look is one observation of the lane's boundaries by the perception, at one time of a run.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from surrogate_runs import LOOK_COLUMNS, Made, all_views, cases, keep, kept, make

from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.view import HIDDEN, OUTPUTS, UNITS, VIEW_SIZE
from scenario_compiler.engine.program import surrogate
from scenario_compiler.engine.program.surrogate import Surrogate, surrogate_text
from scenario_compiler.perception.calibration.probes import probes
from scenario_compiler.vocabulary.sensors import MOUNTING, Camera

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

STEPS, WARM_UP, BATCH, RATE, DECAY = 2000, 200, 2048, 1e-2, 1e-3
"""Number of steps of the fit, steps until the learning rate is greatest, looks per step, greatest learning rate, and
the penalty on squared weights.
"""

ABSOLUTE = 3.0
"""Weight of the absolute error of a confidence, relative to its cross-entropy."""

WORN, WORN_WEIGHT, ASKING_WEIGHT = 0.5, 4.0, 0.5
"""Looks at paint of a quality below the first have the second as weight, and those from a takeover request on the
third; both kinds are rare.
"""

PATH_WEIGHT, PATH_BEND, PATH_MOST = 10.0, 0.3, 1.5
"""Weight of the path's error in the loss; the error above which the loss is linear, m; the greatest error that counts,
m.
"""

MARGIN = 0.05
"""Share of the width of the observed range by which the domain extends beyond it at each end."""

LEAST, MOST_OPEN, HALF_LEFT = 1e-3, 4.0, 0.7
"""Least distance of a confidence from 0 and 1 before its logit is taken, and the greatest residual of a logit that
counts.

`HALF_LEFT` is the share of a cell at which the covariance of noise that is linear between cells has fallen to half.
"""

RARE = (0.002, 0.998)
"""Quantiles that bound the domain of features without bounds of their own: the ego's place in its lane, and bends."""
_OF_SIDES = (at.S_BESIDE, at.S_OFFSET, at.S_HEADING, at.S_BEND_NEAR, at.S_BEND_FAR)
UNBOUNDED = (*_OF_SIDES, *(at.SIDE_SIZE + one for one in _OF_SIDES), at.V_CURVED_NEAR, at.V_CURVED_FAR)

MIRRORED = np.r_[at.SIDE_SIZE : at.V_BOTH, : at.SIDE_SIZE, at.V_BOTH : VIEW_SIZE]
"""Which features of the left side's view are those of the right side's, in their order."""


class Looks:
    """The looks of several runs as arrays of N looks; each look has a left and a right side.

    Attributes:
        view: (N, 2, VIEW_SIZE) features.
        p: (N, 2) the detector's confidence, without the factor of the sensor's health.
        path: (N,) how far left of the lane's centre the followed path lies, m; NaN where that is not known.
        asking: (N,) 1 from the takeover request on, else 0.
        s: (N,) the ego's s, m.
        road: (N,) index of the ego's road.
        run: (N,) index of the run.
    """

    def __init__(self, runs: Sequence[Made], views: Sequence[Singles]) -> None:
        """Concatenate the looks of the runs and their features."""
        view = np.concatenate(views).astype(np.float64)
        known = np.isfinite(view).all(axis=1)
        view, looks = view[known], np.concatenate([one.looks for one in runs]).astype(np.float64)[known]
        rest = dict(zip(LOOK_COLUMNS, looks.T, strict=True))
        self.view = np.stack([view, view[:, MIRRORED]], axis=1)
        self.p = np.stack([rest["p_left"], rest["p_right"]], axis=1)
        self.path, self.asking, self.s, self.road = rest["path_error"], rest["asking"], rest["s"], rest["road"]
        self.run = np.repeat(np.arange(len(runs)), [len(one.looks) for one in runs])[known]

    @property
    def leads(self) -> NDArray[np.bool_]:
        """(N,) whether the followed path depends on what was seen: it follows a boundary and the ego is in its lane."""
        seen = self.p.max(axis=1) >= 0.3
        inside = np.abs(self.view[:, 0, at.S_OFFSET]) < 1.2
        return np.asarray(seen & np.isfinite(self.path) & inside & (np.abs(self.path) < 2.0))

    @property
    def weight(self) -> Floats:
        """(N,) the probability of each look in a batch, from the paint and the takeover's state alone; the sum is 1."""
        worn = self.view[:, 0, [at.S_QUALITY, at.SIDE_SIZE + at.S_QUALITY]].min(axis=1) < WORN
        weight = np.where(worn, WORN_WEIGHT, 1.0) * np.where(self.asking > 0.0, ASKING_WEIGHT, 1.0)
        return np.asarray(weight / weight.sum())


def domain_of(looks: Looks) -> tuple[Floats, Floats]:
    """Return the least and the greatest value of each feature in the domain, with the margin."""
    flat = looks.view.reshape(-1, VIEW_SIZE)
    low, high = flat.min(axis=0), flat.max(axis=0)
    for feature in UNBOUNDED:
        low[feature], high[feature] = np.quantile(flat[:, feature], RARE)
    margin = MARGIN * (high - low)
    return low - margin, high + margin


def fit(looks: Looks, steps: int = STEPS, seed: int = 1) -> tuple[Floats, Floats]:
    """Return the weights (VIEW_SIZE + 1, UNITS) and (HIDDEN, OUTPUTS) with the least loss over the looks.

    The loss of a confidence is its cross-entropy plus `ABSOLUTE` times its absolute error. The absolute error is least
    at the median, which is what a threshold needs where the detector is almost certain one way or the other. Adam
    (Kingma and Ba 2015) minimizes the loss on batches; the learning rate falls to 0 along half a cosine.
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
    """Return the derivatives of the mean loss of a batch with respect to each array of weights."""
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
    """Return the logits (N, 2) and the path's error (N,), m, with the engine's arithmetic."""
    inner = np.clip(view, low, high) @ first[:-1] + first[-1]
    units = inner[..., :HIDDEN]
    out = inner[..., HIDDEN:] + units / (1.0 + np.abs(units)) @ second
    return out[..., 0], out[:, 0, 1] - out[:, 1, 1]


def noise_of(residual: Floats, looks: Looks) -> tuple[float, float]:
    """Return the (standard deviation, cell in m) of noise along the road that resembles residuals.

    Each run's mean residual is subtracted first, because it belongs to the run and not to the place. The variance is
    the mean product of residuals 1 to 3 m apart, so that what changes from image to image does not count. The cell is
    the distance at which half of that variance is left, divided by `HALF_LEFT`.

    Args:
        residual: (N,) observed minus fitted values; NaN where a look does not count.
        looks: The looks.
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


def fitted(runs: Sequence[Made], jobs: int) -> Surrogate:
    """Return surrogate perception fitted to the runs, whose features are worked out in `jobs` processes."""
    looks = Looks(runs, all_views(runs, jobs))
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
    """Write every second of the unfitted conflict runs as [number, time of the request in s or null], for a test."""
    some = [one for one in judged if one.case.kind == "conflict"][::2]
    times = [[one.case.number, float(one.outcome["request_time"])] for one in some]
    rows = [[number, None if math.isnan(time) else round(time, 2)] for number, time in times]
    file.write_text(json.dumps(rows) + "\n", encoding="utf-8")


def main() -> None:
    """Run the command of the command line."""
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
    fitting.add_argument("maps", type=Path)
    fitting.add_argument("--jobs", type=int, default=2)
    judging = commands.add_parser("judge")
    judging.add_argument("runs", type=Path)
    judging.add_argument("maps", type=Path)
    judging.add_argument("--pages", type=Path, default=Path("docs"))
    judging.add_argument("--sample", type=Path, default=Path("tests/engine/surrogate_runs.json"))
    options = parser.parse_args()
    if options.command == "gather":
        todo = cases(sorted(options.maps.resolve().glob("*.xodr")), options.first, options.fitted)
        keep(make(todo, options.jobs, options.seconds), options.runs)
    elif options.command == "fit":
        found = fitted([one for one in kept(options.runs, options.maps) if one.case.number >= 0], options.jobs)
        file = Path(surrogate.__file__).with_name(surrogate.FILE)
        file.write_text(surrogate_text(found), encoding="utf-8")
        print(f"{found.runs} runs, noise {found.noise}: {file}")
    else:
        from surrogate_page import write_page

        runs = kept(options.runs, options.maps)
        write_page(runs, options.pages)
        write_sample([one for one in runs if one.case.set == "first" and not one.case.faster], options.sample)


if __name__ == "__main__":
    main()
