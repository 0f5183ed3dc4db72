"""The page on what lane detection sees and how far its confidence can be trusted, in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.perception.calibration.figures import Asked, Figures, Worth
from scenario_compiler.perception.calibration.montage import montage
from scenario_compiler.perception.detectors import DetectorName
from scenario_compiler.perception.machine import drawn_by
from scenario_compiler.report.reliability_plot import write_reliability_plot

PAGES: dict[DetectorName, str] = {"classical": "perception.md", "learned": "perception-learned.md"}

SHOWN = (
    *("straight", "radius 40 m, left", "leader at 10 m", "truck to the left"),
    *("sun ahead, wet road", "ClearNight", "HardRainNoon", "HardRainSunset"),
    *("noise 40", "pitch +2 degrees", "grade begins, 3 degrees up", "no paint"),
)
"""Situations of the bank that the page shows."""

AREA, ERROR, LARGEST, WRONG, FAR_OFF = 0.96, 0.04, 0.08, 0.04, 0.005
"""What is aimed for on maps that took no part in the fit; see `Worth`."""

MISLEADING = 0.1
"""Share of confident and wrong boundaries that no situation of the bank should exceed."""


@dataclass(frozen=True)
class Measured:
    """How the figures were measured.

    Attributes:
        detector: The detector's name.
        command: The command.
        minutes: Time it took.
        processes: On how many cores.
        maps: Names of the maps.
        clips: Clips of each map.
        pictures: Pictures of each situation of the bank.
    """

    detector: DetectorName
    command: str
    minutes: float
    processes: int
    maps: tuple[str, ...]
    clips: int
    pictures: int


def write_perception_page(figures: Figures, measured: Measured, folder: Path) -> None:
    """Write the detector's page and its pictures into a folder."""
    stem = PAGES[measured.detector].removesuffix(".md").replace("-", "_")
    images = folder / "images"
    images.mkdir(parents=True, exist_ok=True)
    write_reliability_plot(figures, images / f"{stem}_reliability.png")
    (images / f"{stem}_bank.jpg").write_bytes(montage(measured.detector, SHOWN))
    (folder / PAGES[measured.detector]).write_text(_page(figures, measured, stem), encoding="utf-8")


def _page(figures: Figures, measured: Measured, stem: str) -> str:
    left_out = figures.left_out
    whose = f"{', '.join(left_out)}: each judged by a fit that it took no part in" if left_out else "all maps"
    worst = sorted((one for one in figures.bank if one.misled > MISLEADING), key=lambda one: -one.misled)
    misled = "In none of them" if not worst else f"In {len(worst)} of them ({'; '.join(one.name for one in worst)})"
    parts = (
        INTRODUCTIONS[measured.detector],
        "## How far it can be trusted\n",
        f"Measured by `{measured.command}` in {measured.minutes:.0f} minutes on {measured.processes} cores, with "
        f"OpenCV {drawn_by()['opencv']}: {measured.clips} clips of six images on each of {len(measured.maps)} maps "
        f"({', '.join(measured.maps)}). The tables are of {whose}. A single image is seen without memory; driving is "
        "what is seen from the fourth image of a clip on.\n",
        f"![Reliability diagram](images/{stem}_reliability.png)\n",
        "*Area* is that under the receiver operating characteristic, *error* the expected calibration error over ten "
        "bins, *largest* the largest error of a bin with at least 100 sides. The last columns are about the sides "
        "with a confidence over 0.8: how many there are, and how many of them are off by more than 0.25 m and 1 m.\n",
        _missed(figures),
        "### Single images\n",
        _worths(figures.single),
        "### Driving\n",
        _worths(figures.driving),
        "### By condition, driving\n",
        _worths(figures.conditions),
        "## The bank of situations\n",
        f"{measured.pictures} single images of each situation, on made-up roads. {misled} more than 10 % of the "
        "boundaries are confident (over 0.6) and wrong (by more than 0.25 m). The confidence was fitted to other "
        "roads of the kind too: the bank shows where the limits are, the maps above how it fares elsewhere.\n",
        f"![Some situations, with the confidence in the left and the right boundary](images/{stem}_bank.jpg)\n",
        _asked(figures.bank),
        LIMITS,
    )
    return "\n".join(parts)


def _missed(figures: Figures) -> str:
    """Return which of the aims are missed, for each map and for single images and driving apart."""
    aims = (
        f"an area of at least {AREA}, an expected error of at most {ERROR}, a largest error of at most {LARGEST}, "
        + (f"and of the sides over 0.8 at most {WRONG:.0%} wrong and {FAR_OFF:.1%} by over 1 m")
    )
    lines = [f"The aims are {aims}; for the confidence in each row:\n"]
    for kind, found in (("single images", figures.single), ("driving", figures.driving)):
        for one in found:
            both = one.outputs[-1]
            held = (
                (both.area >= AREA, "area"),
                (both.expected_error <= ERROR, "expected error"),
                (both.largest_error <= LARGEST, "largest error"),
                (one.wrong <= WRONG, "share of wrong ones"),
                (one.far_off <= FAR_OFF, "share of those far off"),
            )
            missed = [name for good, name in held if not good]
            lines.append(f"* {one.name}, {kind}: {'missed by ' + ', '.join(missed) if missed else 'all met'}")
    return "\n".join(lines) + "\n"


def _worths(found: Sequence[Worth]) -> str:
    head = ("", "sides", "area", "Brier", "error", "largest", "area, geometry", "error", "area, paint", "error",
            "over 0.8", "of them wrong", "by over 1 m")  # fmt: skip
    rows = []
    for one in found:
        geometry, paint, both = one.outputs
        rows.append((
            one.name, str(both.count), f"{both.area:.3f}", f"{both.brier:.3f}", f"{both.expected_error:.3f}",
            f"{both.largest_error:.3f}", f"{geometry.area:.3f}", f"{geometry.expected_error:.3f}", f"{paint.area:.3f}",
            f"{paint.expected_error:.3f}", f"{one.sure:.0%}", f"{one.wrong:.1%}", f"{one.far_off:.1%}",
        ))  # fmt: skip
    return _table(head, rows)


def _asked(bank: Sequence[Asked]) -> str:
    head = ("situation", "right", "mean confidence", "confident and wrong")
    return _table(head, [(one.name, f"{one.right:.0%}", f"{one.confidence:.2f}", f"{one.misled:.0%}") for one in bank])


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] + ["---:"] * (len(head) - 1), *rows)]
    return "\n".join(lines) + "\n"


_CLASSICAL = """\
<!-- Written by `scenario-compiler calibrate`. -->
# What lane detection sees, and how far to trust it

The automation's camera is looked at by a classical detector: the ground is seen from above, brighter stripes are
looked for, pairs of arcs are voted for under what lanes usually are, and the best pair is fitted. In every image it
tells three probabilities for each side of the lane:

* **geometry**: the boundary lies within 0.25 m of the true one from 6 to 18 m ahead;
* **paint**: on more than 60 % of that stretch there is paint of which the wear and the weather leave more than 15 %;
* **confidence**: both. It is what warnings and takeover requests are about, times the sensor's health.

They are outputs of one small network over what the fit shows: how strong, how even and how long the stripes are, how
far the second best arc is behind, how the sides agree, whether they are where they were. It was fitted to rendered
images of the maps below with wear, weather, noise, pitch and traffic.

**Tilt.** A camera that is tilted by one degree puts a boundary 18 m ahead off by half a metre. The detector gets
nothing of the true tilt: it finds it in the image, where the boundaries seem to run together, and weighs that by how
sure it is that both are painted and by what it found before (probabilistic data association); it forgets it where it
sees no lane. Where one side alone is painted nothing tells the tilt, and what the tilt may do to the boundary is doubt
that the confidence keeps. The ego's body pitches as it brakes, by `pitch_gradient` of its
[vehicle](language.md#Vehicle).

**Bends** are driven at the speed that keeps the lateral acceleration at 2.5 m/s2 (the controller's
`lateral_acceleration`), as far as the planned way shows them, 40 m ahead.

**The confidence that comes with the program** is fitted to all of the clips below, with 32 hidden units. The tables
are of fits that took no part in what they judge. On these four towns, which it was fitted to as well, it has an area of
0.966, an expected error of 0.007 and a largest one of 0.037 while driving; the fit before it, with 16 hidden units, had
0.958, 0.018 and 0.101.

[How far it drives on clear roads](lane-keeping.md) was measured too, and there is
[a learned detector](perception-learned.md).
"""

_LEARNED = """\
<!-- Written by `scenario-compiler calibrate`. -->
# The learned lane detector

`<detector model="learned"/>` in the [controller](language.md#Detector) takes a small network in the place of the
classical detector of [lane detection](perception.md). It sees the picture at 256 x 128 and tells, for each side and
each second row, in which of 128 columns the boundary lies or that it is not there; the width of that distribution is
the row's uncertainty. Beside that it tells whether either side is painted, the camera's tilt and the lane's width.
The sides of a lane keep their distance, so what the rows say of the tilt is weighed with what the network says (the
classical detector does the same with its fits). Rows are laid on the ground under the tilt, and a parabola is fitted to
them by their certainty. The three probabilities of each side mean what the classical detector's mean, and are made in
the same way of what the rows say.

It has 238 694 parameters in 962 kB, and OpenCV runs it in 7 ms of one core (AMD EPYC, idle, OpenCV 5.0.0). It was
trained for the default mounting; the picture of another camera is turned to how that one would see it.

**Training.** `python tools/train_lane_network.py MAPS OUT` renders, trains, exports, fits the confidence and
measures: 95 234 pictures in 256 s on 16 cores and 33 epochs in 180 s on an H200, ten minutes in all. The maps are
parted three ways. The network learned on fourteen maps, on 28 files of them painted anew with every line and pair
of lines that OpenDRIVE has, and on 24 files of roads that were made up (`tools/training_roads.py`). Its confidence was
fitted on Town05, fabriksgatan, three files of them painted anew and six of other made-up roads. Town03 and soderleden
took no part, and seeds and textures of the ground that were learned are not those that are measured on. The confidence
that comes with the program was fitted to a part of these looks, after the tilt had come to be told by both sides too.

**Masks.** A mask is three columns of 128 about the boundary, in each row that has it. As trained, the masks overlap the
true ones by 0.78 on Town03, those of sides over 0.5 by 0.83, and by 0.86 on soderleden; the aim is 0.80, so Town03
misses it. Three columns are narrower than the paint near the car, and one column to the side costs half the overlap.
With masks as wide as a boundary may be off and still be right, 0.25 m to either side, the overlap is 0.90 on 296
pictures of Town03, on which it is 0.78 with the narrow ones. On the same pictures the network before this one, which
had learned on no map painted anew, had 0.83 and 0.62: in the middle of Town03's roads a solid and a broken line run
side by side, and it followed the solid one. On 200 pictures of Town04, which it has learned on, this network has 0.82
with narrow masks. So what is left is less about unknown roads than about its size, about noise (0.75 there over 20 grey
levels, 0.84 without) and, on Town03, about junctions, where the picture does not say which way is meant.

**The maximum of the softmax as confidence**, as the AISA toolkit has it, was measured beside: over a side's rows its
area under the curve is 0.83 on Town03 and 0.69 on soderleden. It is not saturated here, because targets are blurred,
but it tells right from wrong far worse than the fitted confidence of the same network.
"""

INTRODUCTIONS: dict[DetectorName, str] = {"classical": _CLASSICAL, "learned": _LEARNED}

LIMITS = """\
## What is not covered

* One renderer made what was fitted and what was measured. The figures say nothing about photographs or other
  simulators.
* Boundaries are parabolas: bends sharper than 40 m are lost, and should have a low confidence.
* A lane that gets wider or narrower looks like a tilt; tapers are found with an error.
* The sensor's health (noise, darkness, blur, dirt, frozen or missing images) is apart and is policy, not probability:
  see [camera failures](language.md#Failure). The tables are without it.
* What is not a line is not reported: vehicles and obstacles are the forward sensor's, whose word is not the camera's.
* Looks of one clip resemble each other: the tables' counts overstate how much was seen.

Own maps are measured by `scenario-compiler calibrate DIR -o OUT`; `--fit` fits the confidence again.
"""
