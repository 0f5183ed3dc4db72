"""The page on surrogate perception: its agreement with camera perception in runs that were not fitted to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from numpy.typing import NDArray
from scipy.stats import ks_2samp
from surrogate_runs import CONFLICTS, FASTER, Made, run_case

from scenario_compiler import compile_scenario, load_network, open_world, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.engine.columns.view import HIDDEN, VIEW_NAMES, VIEW_SIZE
from scenario_compiler.engine.program.surrogate import load_surrogate
from scenario_compiler.report.wording import percent
from scenario_compiler.resources import library_folder
from scenario_compiler.vocabulary.sensors import Perception
from tests.benchmarks.surrogate_figures import VARIANTS, Rate, Timed, rate, share_of, whole_sweep

matplotlib.use("Agg")
import matplotlib.pyplot as plt

Floats = NDArray[np.float64]

SAME = 0.5
"""Largest difference between the times of two takeover requests that count as the same answer, s."""

PERCEPTIONS: tuple[Perception, ...] = ("camera", "surrogate", "ideal")
COLOURS = {"camera": "black", "surrogate": "#d55e00", "ideal": "#0072b2"}
COMPARED = ("minimum_time_to_collision", "takeover_time", "maximum_lateral_offset", "request_time")
NOT_ANSWERED = ("minimum_risk", "unanswered")
HEAD = ("runs", "number", *PERCEPTIONS[1:], "camera again")


class Pairs(NamedTuple):
    """Measures of the same runs with camera perception and with another perception."""

    camera: list[dict[str, Any]]
    other: list[dict[str, Any]]

    def times(self) -> tuple[Floats, Floats]:
        """Return the times of the takeover requests with the camera and with the other, s; NaN without a request."""
        camera, other = (np.array([float(one["request_time"]) for one in side]) for side in self)
        return camera, other

    def same(self) -> NDArray[np.bool_]:
        """Return whether the answers of each run agree: requests at most `SAME` apart, or no request in either."""
        camera, other = self.times()
        with np.errstate(invalid="ignore"):
            near = np.abs(camera - other) <= SAME + 1e-9
        return near | (np.isnan(camera) & np.isnan(other))

    def alike(self, name: str) -> float:
        """Return the p-value of Kolmogorov and Smirnov's two-sample test of a measure, without undefined values."""
        sides = (np.array([float(one[name]) for one in side]) for side in self)
        camera, other = (side[~np.isnan(side)] for side in sides)
        return float(ks_2samp(camera, other).pvalue)

    def departed(self) -> tuple[float, float]:
        """Return the camera's and the other's share of lane departures among the runs without a takeover."""
        found = []
        for side in self:
            runs = [one for one in side if one["resolution"] in NOT_ANSWERED]
            found.append(float(np.mean([one["lane_departures"] > 0 for one in runs])) if runs else math.nan)
        return found[0], found[1]


def write_page(runs: Sequence[Made], folder: Path) -> None:
    """Repeat the runs for evaluation with surrogate and ideal perception, and write the page and its figure.

    Args:
        runs: The runs with camera perception, those of the first set also a little faster.
        folder: Folder of the pages.

    Raises:
        RuntimeError: A run can no longer be compiled.
    """
    faster = {one.case.number: one for one in runs if one.case.faster}
    judged = [one for one in runs if one.case.set != "fit" and not one.case.faster]
    judged.sort(key=lambda one: one.case.number not in faster)
    pairs = {perception: _repeated(judged, perception) for perception in PERCEPTIONS[1:]}
    itself = _driven_again(judged[: len(faster)], faster)
    kinds = np.array([one.case.kind for one in judged])
    rates = [rate(name) for name in CONFLICTS]
    _figure(pairs, folder / "images" / "perception_surrogate.png")
    text = _page(pairs, itself, kinds, rates, whole_sweep())
    (folder / "perception-surrogate.md").write_text(text, encoding="utf-8")


def _repeated(judged: Sequence[Made], perception: Perception) -> Pairs:
    made = []
    for one in judged:
        run_again = run_case(one.case, perception, looks=False)
        if run_again is None:
            raise RuntimeError(f"{one.case} cannot be driven any more")
        made.append(run_again.outcome)
    return Pairs([one.outcome for one in judged], made)


def _driven_again(judged: Sequence[Made], faster: dict[int, Made]) -> Pairs:
    return Pairs([one.outcome for one in judged], [faster[one.case.number].outcome for one in judged])


def _planned(name: str, perception: Perception) -> Any:
    file = library_folder() / "conflicts" / f"{name}.xml"
    return compile_scenario(file, overrides=Overrides(perception=perception))


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
    itself: Pairs,
    kinds: NDArray[np.str_],
    rates: list[Rate],
    sweep: Timed,
) -> str:
    surrogate, ideal = pairs["surrogate"], pairs["ideal"]
    fitted, same = load_surrogate(), surrogate.same()
    named = np.array([one["name"] for one in surrogate.camera])
    groups = [("all", np.ones(len(same), np.bool_))]
    groups += [(name, (kinds == "conflict") & (named == name)) for name in CONFLICTS]
    groups += [("drawn roads", kinds == "road"), ("maps", kinds == "map")]
    again = itself.same()
    shares = [
        (
            *(name, str(of.sum()), percent(same[of].mean()), percent(ideal.same()[of].mean())),
            percent(again[of[: len(again)]].mean()),
        )
        for name, of in groups
    ]
    camera, other = surrogate.times()
    asked = f"{int(np.isnan(camera).sum())} of {len(camera)} runs with the camera and {int(np.isnan(other).sum())}"
    alike = [(name, surrogate.alike(name), ideal.alike(name)) for name in COMPARED]
    left, left_so = surrogate.departed()
    total = share_of(rates)
    quantiles = ", ".join(f"{value:.1f}" for value in np.nanquantile(sweep.requests, (0.05, 0.25, 0.5, 0.75, 0.95)))
    missed = [
        *([f"the same answer in 90 % ({same.sum()} of {len(same)} runs have it)"] if same.mean() < 0.9 else []),
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
        faster=percent(FASTER),
        again=len(again),
        ceiling=percent(again.mean()),
        agreement=_table(HEAD, shares),
        asked=asked,
        alike=_table(
            ("measure", "p-value, surrogate", "p-value, ideal"),
            [(f"`{a}`", f"{b:.3f}", f"{c:.3f}") for a, b, c in alike],
        ),
        left=percent(left),
        left_so=percent(left_so),
        missed="; ".join(missed) if missed else "none",
        rates=_table(
            ("conflict", "ideal, steps/s", "surrogate, steps/s", "share"),
            [(name, f"{a / 1e6:.2f} million", f"{b / 1e6:.2f} million", f"{b / a:.2f}") for name, a, b in rates],
        ),
        total=f"{total:.2f}",
        variants=f"{VARIANTS:,}".replace(",", " "),
        seconds=f"{sweep.seconds:.1f}",
        quantiles=quantiles,
        ranges=_table(("feature", "from", "to"), ranges),
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] + ["---:"] * (len(head) - 1), *rows)]
    return "\n".join(lines)


_TEXT = """\
<!-- Written by `python tools/fit_surrogate.py judge`. -->
# Surrogate perception: the camera in a sweep

A run with the camera takes seconds, a run with ideal perception a millisecond; but ideal perception does not know how
a detector reacts to worn paint, noise or a bend. `--perception surrogate` runs in the engine, as ideal perception does,
and gives the confidence that the camera with the classical detector would give:

    scenario-compiler sweep conflict.xml --vary from=uniform(100,400) --samples 10000 --perception surrogate

For each side of the lane, a network with {hidden} hidden units takes {features} features that the engine knows. Paint
is looked at in 13 pieces of 2 m ahead: its quality, the share that its dashes paint, whether it is in the field of view
and not hidden by a vehicle, and how much it stands out of the ground in the light, the air, the camera's noise and
rain.
The other features are the kinds of the lines, rival lines and the pavement beside the lane, the bend, the tilt and the
width of the lane, junctions, the sun, the camera's failures, the speed, the position in the lane, and the vehicles in
the picture. The network gives the confidence in that side, and the offset by which the side moves the followed path
away from the lane's centre. The automation then drives along that path as the [controller](controllers.md)
`lane_detection` does. The sensor's health is that of ideal perception.

The part of the confidence and of the path that the features do not explain is modelled as noise that belongs to the
place: a camera that drives along a road twice sees the same twice, whatever the seed. The noise depends only on the
road, the lane, the side and the cell along the road, and is linear between cells. Fitted to the residuals of the
network, its standard deviation is {noise} for the logit of the confidence, in cells of {cell} m, and {path} m for the
path, in cells of {path_cell} m.

## How far it agrees

The surrogate was fitted to {runs} runs with the camera and an earlier confidence of the detector, on randomly drawn
roads and on maps, with randomly drawn wear, weather, noise, failures, traffic and speeds. The {judged} runs below were
made with today's. None of them was used for the fit: they are variants of five conflicts of the library on maps without
a run in the fit, randomly drawn roads with other seeds, and lanes of other maps.

The table shows the share of runs with the same answer as the camera: no request in either run, or requests within 0.5 s
of each other. The last column is the camera in the first {again} of these runs driven {faster} faster: it too comes to
slightly other pictures, and agrees with itself in {ceiling}.

{agreement}

There is no request in {asked} with the surrogate.
Aims that are missed: {missed}.

With an earlier detector and its surrogate, which had the camera's answer in 93 % of the runs above, 436 more runs were
made on other drawn roads (247) and on lanes of 43 road files of other projects (189), among them roundabouts, steep
bends and bridges; their numbers were not in the fit, but many of these maps were. There the surrogate had the camera's
answer in 357 (82 %: 84 % on drawn roads, 79 % on maps), ideal perception in 257 (59 %). Of the 79 others, 25 had a
request more than 0.5 s later than with the camera, 27 earlier, 12 none, and 16 one that the camera did not have.

What is left was looked for in runs of the fit alone, in a cross-validation over maps and drawn roads: 3429 runs with an
earlier state of the detector, of which each third was answered by a fit to the other two. With boosted trees in place
of the network, so that its size does not count, 77 % of the answers were the camera's with the paint's mean quality in
five stretches; 81 % with dashes where they lie, the field of view, what vehicles hide, rival lines and the pavement;
and 82 % with the contrast of paint over the roughness of the ground. Of 622 wrong answers then, 247 were in runs where
only broken lines were in sight (29 % of such runs), 238 in runs with a vehicle in the picture (24 %), and 203 on worn
paint (23 %); a run can be in several groups. If the mean error of each run were known, 85 % would be the camera's
answers; if its mean over each 4 s, 87 %; 2 s, 91 %. So 90 % of such runs would need what belongs to some 30 m of road.
It is not the texture: in 45 runs (5876 looks at a side), the renderer's own wear and brightness of the ground under and
beside both lines, piece by piece, have a correlation of at most 0.12 with the error, and explain none of it on roads
that were left out. The network loses another 2 to 3 points to the trees, which are too slow for a sweep.

Rain on a slow leader needs no feature of its own: among the runs of the fit, the answer is the camera's in 73 % of 71
runs with rain and a leader, 77 % of 212 with a leader in dry air, 86 % of 308 in rain without a leader, and 83 % of 803
with neither. The leader is what counts: near one, the mean error of the confidence is 0.14 instead of 0.05.

![Camera, surrogate and ideal perception](images/perception_surrogate.png)

*The confidence of the better side in the five conflicts as they are in the library, with dotted lines at the requests;
last, the times of the requests in runs that took no part in the fit.*

The Kolmogorov-Smirnov test compares the distribution of each measure with that in the runs with the camera. A p-value
below 0.01 means that the distributions differ:

{alike}

Of the runs in which the driver does not respond, {left} leave the lane with the camera, {left_so} with the surrogate.

## What it costs

Steps of a sweep per CPU second, with both perceptions measured alternately in one process by
`python tests/benchmarks/surrogate_figures.py`:

{rates}

Over all five, the surrogate runs at {total} of the rate of ideal perception. While the driver drives, only every fifth
image is looked at, until 4 s before the driver may hand back: the confidence is only recorded then. Of the looks in
these conflicts, four of five had been such. A sweep of {variants} variants of `markings_missing`, with the start (100
to 400 m) and the length (1 to 250 m) of the stretch on which the paint fades, took {seconds} CPU seconds, including the
table of results; the 5, 25, 50, 75 and 95 % quantiles of its request times are {quantiles} s.

## Where it is valid

* It stands for the controller `lane_detection` with the classical detector and the default camera mounting. Another
  controller, detector or mounting is refused (SC514). So are motion blur and misalignment, which were not in the fit.
* It is valid in the ranges below. If a feature leaves its range while the automation drives, the event `outside_domain`
  is logged, the table of a sweep has the time in `outside_domain_time`, and the sweep's summary counts such variants.
  The value is then limited to its range.
* The sensor's health is that of ideal perception: [camera
  failures](camera-failures.md#the-sensors-health-without-a-camera) compares it with the camera's, and lists what the
  engine does not know.
* Secondary lines, drops on the windscreen, objects beside the road and the texture of the ground and of worn paint are
  not among the features.

The file of coefficients contains the detector's answers for some pictures. A test draws and detects these pictures
again, and fails if the renderer or the detector now gives other answers. Then the surrogate has to be fitted again:

    python tools/fit_surrogate.py gather MAPS RUNS
    python tools/fit_surrogate.py fit RUNS MAPS
    python tools/fit_surrogate.py judge RUNS MAPS

{ranges}

Shares are from 0 to 1, lengths are in m. Contrast, light, air and clutter are logarithms; the strength of paint is its
contrast over the roughness of the ground. The other units are 1/40 m for curvatures, 20 m/s for the speed, 1/5 rad for
the heading, 1/50 rad for pitch, tilt and change of grade, 10 degrees of the sun below the horizon for the darkness, and
40 grey levels for the noise.
"""
