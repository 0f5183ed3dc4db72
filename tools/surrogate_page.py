"""The page on surrogate perception: how its answers agree with the camera's in runs that took no part in the fit."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from numpy.typing import NDArray
from scipy.stats import ks_2samp
from surrogate_runs import CONFLICTS, Made, run_case

from scenario_compiler import compile_scenario, load_network, open_world, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.columns.view import HIDDEN, VIEW_NAMES, VIEW_SIZE
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.program.surrogate import load_surrogate
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.resources import library_folder
from scenario_compiler.vocabulary.sensors import Perception

matplotlib.use("Agg")
import matplotlib.pyplot as plt

Floats = NDArray[np.float64]

SAME = 0.5
"""Requests that are no further apart are the same answer, s."""

PERCEPTIONS: tuple[Perception, ...] = ("camera", "surrogate", "ideal")
COLOURS = {"camera": "black", "surrogate": "#d55e00", "ideal": "#0072b2"}
COMPARED = ("minimum_time_to_collision", "takeover_time", "maximum_lateral_offset", "request_time")
NOT_ANSWERED = ("minimum_risk", "unanswered")

VARIANTS = 10_000
"""Variants of the sweep that is timed."""


class Pairs(NamedTuple):
    """Outcomes of the same runs with the camera and with another perception."""

    camera: list[dict[str, Any]]
    other: list[dict[str, Any]]

    def times(self) -> tuple[Floats, Floats]:
        """Return the times of the requests, NaN without one, s."""
        camera, other = (np.array([float(one["request_time"]) for one in side]) for side in self)
        return camera, other

    def same(self) -> NDArray[np.bool_]:
        """Return whether each run has the same answer."""
        camera, other = self.times()
        with np.errstate(invalid="ignore"):
            near = np.abs(camera - other) <= SAME + 1e-9
        return near | (np.isnan(camera) & np.isnan(other))

    def alike(self, name: str) -> float:
        """Return the probability of two samples of a measure as different as these from one distribution."""
        sides = (np.array([float(one[name]) for one in side]) for side in self)
        camera, other = (side[~np.isnan(side)] for side in sides)
        return float(ks_2samp(camera, other).pvalue)

    def departed(self) -> tuple[float, float]:
        """Return the shares of the runs without an answer of the driver in which the lane was left."""
        found = []
        for side in self:
            runs = [one for one in side if one["resolution"] in NOT_ANSWERED]
            found.append(float(np.mean([one["lane_departures"] > 0 for one in runs])) if runs else math.nan)
        return found[0], found[1]


def write_page(judged: Sequence[Made], maps: Path, folder: Path) -> None:
    """Make the judged runs again with surrogate and ideal perception, and write the page and its figure."""
    pairs: dict[Perception, Pairs] = {}
    for perception in PERCEPTIONS[1:]:
        made = []
        for one in judged:
            case = one.case
            if case.map:
                case = case._replace(map=str(maps / Path(case.map).name))
            again = run_case(case, perception, looks=False)
            if again is None:
                raise RuntimeError(f"{case} cannot be driven any more")
            made.append(again.outcome)
        pairs[perception] = Pairs([one.outcome for one in judged], made)
    kinds = np.array([one.case.kind for one in judged])
    rates = [_rates(name) for name in CONFLICTS]
    _figure(pairs, folder / "images" / "perception_surrogate.png")
    (folder / "perception-surrogate.md").write_text(_page(pairs, kinds, rates, _sweep()), encoding="utf-8")


def _rates(name: str) -> tuple[str, float, float]:
    """Return a conflict's name and the steps in a CPU second of its sweep with ideal and surrogate perception."""
    best = {}
    for perception in PERCEPTIONS[:0:-1]:
        plan = _planned(name, perception)
        network = load_network(plan.map.file)
        assert network is not None
        program = build_program(plan, network)
        simulation = Simulation(network.tables, program)
        rows, draws = [list(program.const)] * 100, [make_draws(k) for k in range(100)]
        seconds = []
        for _ in range(3):
            began = time.process_time()
            summaries, _ = simulation.sweep(rows, draws, plan.step_limit)
            seconds.append(time.process_time() - began)
        best[perception] = float(summaries[:, SUMMARY.index("rows")].sum()) / min(seconds)
    return name, best["ideal"], best["surrogate"]


def _planned(name: str, perception: Perception) -> Any:
    file = library_folder() / "conflicts" / f"{name}.xml"
    return compile_scenario(file, overrides=Overrides(perception=perception))


def _sweep() -> tuple[float, Floats]:
    """Return the CPU seconds of a sweep of `markings_missing` over where the paint fades, and its request times."""
    from tempfile import TemporaryDirectory

    import pyarrow.parquet as pq

    from scenario_compiler.batch.execute import run_sweep
    from scenario_compiler.batch.spec import SweepSpec

    with TemporaryDirectory() as folder:
        vary = ("from=uniform(100,400)", "over=uniform(1,250)")
        spec = SweepSpec(vary=vary, samples=VARIANTS, perception="surrogate")
        began = time.process_time()
        target = library_folder() / "conflicts" / "markings_missing.xml"
        result = run_sweep(target, spec, Path(folder) / "sweep", report=False, workers=1)
        seconds = time.process_time() - began
        column = pq.read_table(result.table, columns=["request_time"])["request_time"]
        return seconds, np.array([math.nan if one is None else one for one in column.to_pylist()])


def _figure(pairs: dict[Perception, Pairs], file: Path) -> None:
    figure, axes = plt.subplots(2, 3, figsize=(11.0, 5.6), constrained_layout=True)
    for name, axis in zip(CONFLICTS, axes.flat[:5], strict=True):
        for perception in PERCEPTIONS:
            plan = _planned(name, perception)
            network = load_network(plan.map.file)
            assert network is not None
            with open_world("kinematic", plan, network) as world:
                recording = run(plan, world, seed=1)
            better = np.fmax(recording.confidence_left, recording.confidence_right)
            axis.plot(recording.t, better, color=COLOURS[perception], linewidth=1.0, label=perception)
            for event in recording.events:
                if event.kind == "request":
                    axis.axvline(event.t, color=COLOURS[perception], linewidth=1.0, linestyle=":")
        axis.set_title(name, fontsize=10)
        axis.set_ylim(-0.02, 1.04)
        axis.set_xlabel("time, s")
    axes[0, 0].set_ylabel("confidence of the better side")
    axes[1, 0].set_ylabel("confidence of the better side")
    axes[0, 0].legend(frameon=False, fontsize=9)
    axis = axes.flat[5]
    sides = {"camera": pairs["surrogate"].camera, **{name: pairs[name].other for name in PERCEPTIONS[1:]}}
    for perception, runs in sides.items():
        times = np.sort([one["request_time"] for one in runs if not math.isnan(one["request_time"])])
        axis.step(times, np.arange(1, len(times) + 1) / len(runs), color=COLOURS[perception], linewidth=1.2)
    axis.set_title(f"{len(pairs['surrogate'].camera)} runs that took no part in the fit", fontsize=10)
    axis.set_xlabel("time of the request, s")
    axis.set_ylabel("share that has asked")
    figure.savefig(file, dpi=100)
    plt.close(figure)


def _page(
    pairs: dict[Perception, Pairs],
    kinds: NDArray[np.str_],
    rates: list[tuple[str, float, float]],
    sweep: tuple[float, Floats],
) -> str:
    surrogate, ideal = pairs["surrogate"], pairs["ideal"]
    fitted, same = load_surrogate(), surrogate.same()
    agreement = [("all", len(same), same.mean(), ideal.same().mean())]
    named = np.array([one["name"] for one in surrogate.camera])
    groups = [(name, (kinds == "conflict") & (named == name)) for name in CONFLICTS]
    groups += [("drawn roads", kinds == "road"), ("maps", kinds == "map")]
    agreement += [(name, int(of.sum()), same[of].mean(), ideal.same()[of].mean()) for name, of in groups]
    camera, other = surrogate.times()
    asked = f"{int(np.isnan(camera).sum())} of {len(camera)} runs with the camera and {int(np.isnan(other).sum())}"
    alike = [(name, surrogate.alike(name), ideal.alike(name)) for name in COMPARED]
    left, left_so = surrogate.departed()
    total = sum(1.0 / one[1] for one in rates) / sum(1.0 / one[2] for one in rates)
    seconds, times = sweep
    quantiles = ", ".join(f"{value:.1f}" for value in np.nanquantile(times, (0.05, 0.25, 0.5, 0.75, 0.95)))
    missed = [
        *(["the same answer in 90 %"] if same.mean() < 0.9 else []),
        *(f"Kolmogorov and Smirnov's test at 1 % for `{name}`" for name, p, _ in alike[:3] if p < 0.01),
        *(["lane departures within 5 percentage points"] if abs(left - left_so) > 0.05 else []),
        *(["0.7 of ideal perception's rate"] if total < 0.7 else []),
    ]
    ranges = [
        (name, f"{low:.3g}", f"{high:.3g}") for name, low, high in zip(VIEW_NAMES, fitted.low, fitted.high, strict=True)
    ]
    return _TEXT.format(
        runs=fitted.runs,
        features=VIEW_SIZE,
        hidden=HIDDEN,
        noise=f"{fitted.noise[0]:.2f}",
        cell=f"{fitted.noise[1]:.1f}",
        path=f"{fitted.noise[2]:.3f}",
        path_cell=f"{fitted.noise[3]:.1f}",
        judged=len(same),
        agreement=_table(
            ("runs", "number", "surrogate", "ideal"), [(a, str(b), f"{c:.0%}", f"{d:.0%}") for a, b, c, d in agreement]
        ),
        asked=asked,
        alike=_table(("measure", "surrogate", "ideal"), [(f"`{a}`", f"{b:.3f}", f"{c:.3f}") for a, b, c in alike]),
        left=f"{left:.0%}",
        left_so=f"{left_so:.0%}",
        missed="; ".join(missed) if missed else "none",
        rates=_table(
            ("conflict", "ideal, steps/s", "surrogate, steps/s", "share"),
            [(name, f"{a / 1e6:.2f} million", f"{b / 1e6:.2f} million", f"{b / a:.2f}") for name, a, b in rates],
        ),
        total=f"{total:.2f}",
        variants=f"{VARIANTS:,}".replace(",", " "),
        seconds=f"{seconds:.1f}",
        quantiles=quantiles,
        ranges=_table(("feature", "from", "to"), ranges),
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] + ["---:"] * (len(head) - 1), *rows)]
    return "\n".join(lines)


_TEXT = """\
<!-- Written by `python tools/fit_surrogate.py judge`. -->
# Surrogate perception: the camera in a sweep

A camera in the loop takes seconds a run, ideal perception a millisecond, but ideal perception knows nothing of what
a detector makes of worn paint, noise or a bend. `--perception surrogate` runs in the engine as ideal perception does,
and answers as the camera with the classical detector would:

    scenario-compiler sweep conflict.xml --vary from=uniform(100,400) --samples 10000 --perception surrogate

For each side of the lane a network with {hidden} hidden units goes over {features} numbers that the engine knows: the
paint's quality in five stretches ahead on this side and on the other, what kind of lines they are, the bend, the grade
and the width of the lane, junctions, the light and the weather, the camera's noise and failures, the speed, the place
in the lane, and whom the picture shows. It gives the confidence in that side and how far it draws the followed path off
the lane's centre. The automation then drives as the [controller](controllers.md) `lane_detection` does, along that
path. The sensor's health is that of ideal perception.

What the network leaves open belongs to the place: a camera that drives the same way twice sees the same, whatever the
seed. It is noise that depends on the road, the lane, the side and the cell along the road alone, linear between cells:
of deviation {noise} of the confidence's logit in cells of {cell} m, and of {path} m of the path in cells of
{path_cell} m, as fitted to what the network leaves open.

## How far it agrees

It was fitted to {runs} runs with the camera, on drawn roads and on maps, with drawn wear, weather, noise, failures,
traffic and speeds. The {judged} runs below took no part: variants of five conflicts of the library on maps that no run
of the fit was on, drawn roads of other numbers, and lanes of other maps. They were looked at while the features were
chosen, but never fitted to. The same answer is: no request in both, or requests within 0.5 s.

{agreement}

There is no request in {asked} with the surrogate. Floors that are missed: {missed}.

![Camera, surrogate and ideal perception](images/perception_surrogate.png)

*The better side's confidence in the five conflicts as they are, dotted the requests; and when the judged runs ask.*

Kolmogorov and Smirnov's test compares the distributions of measures with those of the camera's runs; below 0.01 they
differ:

{alike}

Of the runs in which the driver does not answer, {left} leave the lane with the camera, {left_so} with the surrogate.

## What it costs

Steps of a sweep in a CPU second, measured in one run, both perceptions in turn:

{rates}

Together the surrogate has {total} of ideal perception's rate. A sweep of {variants} variants of `markings_missing` over
where the paint begins to fade (100 to 400 m) and along which length (1 to 250 m) took {seconds} CPU seconds, the
table of results included; the 5, 25, 50, 75 and 95 % quantiles of its request times are {quantiles} s.

## What it is for

* The controller `lane_detection` with the classical detector and a camera mounted as by default. Another controller,
  detector or mounting is refused (SC514), and so are motion blur and misalignment, which took no part in the fit.
* The ranges below. Where one is left while the automation drives, the event `outside_domain` is logged, the table of a
  sweep has the time in `outside_domain_time`, and the sweep's summary counts such variants. The value is then held at
  the end of its range.
* Secondary lines, colours of paint but yellow, drops on the windscreen and other lines beside the lane are not among
  the features.

The file of coefficients keeps what the detector says of some pictures. A test makes them again: it fails where the
renderer or the detector has come to another answer, and then the surrogate has to be fitted anew:

    python tools/fit_surrogate.py gather MAPS RUNS
    python tools/fit_surrogate.py fit RUNS
    python tools/fit_surrogate.py judge RUNS MAPS

{ranges}

Shares are of 0 to 1, lengths in m, curvatures in 1/40 m, the contrast and the last two as logarithms, the speed in
20 m/s, the heading in 1/5 rad, the pitch in 1/50 rad, the darkness in 10 degrees of the sun below the horizon, the
noise in 40 grey levels.
"""
