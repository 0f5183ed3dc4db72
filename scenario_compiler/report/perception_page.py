"""The page of `calibrate`: how a lane detector works and how well its confidence is calibrated, in Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.perception.calibration.figures import Asked, Figures, Worth
from scenario_compiler.perception.calibration.montage import montage
from scenario_compiler.perception.confidence import Confidence
from scenario_compiler.perception.detectors import DetectorName
from scenario_compiler.recording.versions import versions
from scenario_compiler.report.reliability_plot import write_reliability_plot
from scenario_compiler.report.wording import percent

PAGES: dict[DetectorName, str] = {"classical": "perception.md", "learned": "perception-learned.md"}

SHOWN = (
    *("straight", "radius 40 m, left", "leader at 10 m", "truck to the left"),
    *("sun ahead, wet road", "ClearNight", "HardRainNoon", "HardRainSunset"),
    *("noise 40", "pitch +2 degrees", "grade begins, 3 degrees up", "no paint"),
)
"""Situations whose pictures the page shows."""

AREA, ERROR, LARGEST, WRONG, FAR_OFF = 0.96, 0.04, 0.08, 0.04, 0.005
"""Targets for maps that were not part of the confidence's fit; see `Worth`."""

MISLEADING = 0.1
"""Target for the greatest share of confident and wrong boundaries in a situation of the bank."""


@dataclass(frozen=True)
class Measured:
    """Conditions of the measurement.

    Attributes:
        detector: The detector's name.
        command: The command that measured them.
        minutes: Duration of the measurement, min.
        processes: Number of cores.
        looks: What was seen, as a part of a sentence.
        pictures: Number of pictures of each situation of the bank.
    """

    detector: DetectorName
    command: str
    minutes: float
    processes: int
    looks: str
    pictures: int


def write_perception_page(
    figures: Figures, measured: Measured, folder: Path, confidence: Confidence | None = None
) -> None:
    """Write the detector's page and its pictures into a folder.

    Args:
        figures: The figures.
        measured: How they were measured.
        folder: The folder.
        confidence: The confidence that is new, if the figures are not of the packaged one.
    """
    stem = PAGES[measured.detector].removesuffix(".md").replace("-", "_")
    images = folder / "images"
    images.mkdir(parents=True, exist_ok=True)
    write_reliability_plot(figures, images / f"{stem}_reliability.png")
    (images / f"{stem}_bank.jpg").write_bytes(montage(measured.detector, SHOWN, confidence))
    (folder / PAGES[measured.detector]).write_text(_page(figures, measured, stem), encoding="utf-8")


def _page(figures: Figures, measured: Measured, stem: str) -> str:
    left_out = figures.left_out
    whose = f"{', '.join(left_out)}: each judged by a fit to all other maps" if left_out else "all maps"
    worst = sorted((one for one in figures.bank if one.misled > MISLEADING), key=lambda one: -one.misled)
    names = "; ".join(one.name for one in worst)
    misled = f"In {len(worst)} of them ({names})" if worst else "In none of them"
    parts = (
        INTRODUCTIONS[measured.detector],
        "## How far it can be trusted\n",
        f"Measured by `{measured.command}` in {measured.minutes:.0f} minutes on {measured.processes} cores, with "
        f"OpenCV {versions()['opencv']}: {measured.looks}. The tables show {whose}. *Single images* are detected "
        "without memory of earlier ones; *driving* counts the images of a clip from the fourth on, detected with "
        "memory.\n",
        f"![Reliability diagram](images/{stem}_reliability.png)\n",
        "Each image has two *sides*, the left and the right boundary. *Area* is the area under the receiver operating "
        "characteristic, *error* the expected calibration error over ten bins, *largest* the largest error of a bin "
        "with at least 100 sides. A flawless confidence also has a largest error, because the clips are a sample; it "
        "exceeds the one *by chance* in one of ten such measurements. The last columns describe the sides with a "
        "confidence over 0.8: their share of all sides, and how many of them are wrong by more than 0.25 m and by more "
        "than 1 m.\n",
        _missed(figures),
        "### Single images\n",
        _worths(figures.single),
        "### Driving\n",
        _worths(figures.driving),
        "### By condition, driving\n",
        _worths(figures.conditions),
        "## The bank of situations\n",
        f"{measured.pictures} single images of each situation, on synthetic roads. {misled} are more than 10 % of the "
        "boundaries confident (over 0.6) and wrong (by more than 0.25 m). The confidence was also fitted to other "
        "synthetic roads like these, so this table shows where the limits of the detector are; how it performs on "
        "roads that it does not know is shown by the maps above.\n",
        f"![Some situations, with the confidence in the left and the right boundary](images/{stem}_bank.jpg)\n",
        _asked(figures.bank),
        LIMITS,
    )
    return "\n".join(parts)


def _missed(figures: Figures) -> str:
    """Return which targets are missed, for each map, separately for single images and for driving."""
    aims = (
        f"an area of at least {AREA}, an expected error of at most {ERROR}, a largest error of at most {LARGEST}, "
        f"and, of the sides with a confidence over 0.8, at most {percent(WRONG)} wrong and "
        f"{percent(FAR_OFF, 1)} by over 1 m"
    )
    lines = [f"The aims are {aims}. Which of them the confidence misses in each row:\n"]
    for kind, found in (("single images", figures.single), ("driving", figures.driving)):
        for one in found:
            both = one.outputs[-1]
            held = (
                (both.area >= AREA, "area"),
                (both.expected_error <= ERROR, "expected error"),
                (both.largest_error <= LARGEST, "largest error"),
                (not one.wrong > WRONG, "share of wrong sides"),
                (not one.far_off > FAR_OFF, "share of sides over 1 m off"),
            )
            missed = [name for good, name in held if not good]
            lines.append(f"* {one.name}, {kind}: {'misses ' + ', '.join(missed) if missed else 'all aims are met'}")
    return "\n".join(lines) + "\n"


def _worths(found: Sequence[Worth]) -> str:
    head = ("", "sides", "area", "Brier", "error", "largest", "by chance", "area, geometry", "error", "area, paint",
            "error", "over 0.8", "of them wrong", "by over 1 m")  # fmt: skip
    rows = []
    for one in found:
        geometry, paint, both = one.outputs
        numbers = (both.area, both.brier, both.expected_error, both.largest_error, one.by_chance)
        rows.append((
            one.name, str(both.count),
            *(_number(value) for value in numbers),
            *(_number(value) for of in (geometry, paint) for value in (of.area, of.expected_error)),
            percent(one.sure), percent(one.wrong, 1), percent(one.far_off, 1),
        ))  # fmt: skip
    return _table(head, rows)


def _asked(bank: Sequence[Asked]) -> str:
    head = ("situation", "right", "mean confidence", "confident and wrong")
    rows = [(one.name, percent(one.right), f"{one.confidence:.2f}", percent(one.misled)) for one in bank]
    return _table(head, rows)


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.3f}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] + ["---:"] * (len(head) - 1), *rows)]
    return "\n".join(lines) + "\n"


_CLASSICAL = """\
<!-- Written by `scenario-compiler calibrate` or `tools/fit_confidence.py`. -->
# Lane detection and its confidence

A classical detector finds the lane in the images of the automation's camera. It transforms the image to a view of the
ground from above, searches for bright stripes, lets them vote for pairs of arcs that could bound a usual lane, and fits
the best pair. For each side of the lane, every image gives three probabilities:

* **geometry**: the true boundary, from 6 to 18 m ahead along the lane, is nowhere more than 0.25 m away from the
  detected one;
* **paint**: on more than 60 % of that stretch there is paint, of which wear and weather leave more than 15 % visible;
* **confidence**: both of these hold. Warnings and takeover requests depend on the confidence, multiplied by the
  sensor's health.

The three are sums of 500 small decision trees, as logits, that were fitted one after the other (gradient boosting, with
XGBoost 3.2). Their inputs describe the stripes (how strong, even and long they are, how
much brighter than the ground beside them, their gaps, and whether they go on from 18 to 30 m ahead), the fit (how much
worse the second best arc is, how well the two sides agree, and how far the boundary may be off at 6 and 18 m, given the
scatter of its rows and the uncertainty of the tilt), the memory (whether the boundaries are where they were in the last
image, and running means of the stripes' strength), and the route (how it bends, and how far the next junction is, where
lines end). The trees were fitted to rendered images of maps with wear, weather, noise, pitch and traffic, and of
synthetic roads.

**Tilt.** A camera that is tilted by one degree moves a boundary 18 m ahead by half a metre. The detector does not know
the true tilt. It estimates the tilt from the image, from the point where the boundaries seem to meet, and weights each
estimate by the probability that the two sides belong to one lane, and by the estimates before it (probabilistic data
association): both have to be painted, as far apart as a lane is wide, and bend alike. An estimate also counts less if a
second look at the image, under the tilt that it gave, shows another one. The detector drops the estimate where it sees
no lane. Where only one side is painted, the image does not show the tilt; the confidence is then lower, by what an
unknown tilt may do to the boundary. The ego's body pitches as it brakes, by the `pitch_gradient` of its
[vehicle](language.md#Vehicle).

**The planned route.** The automation knows the route ahead from a map that has each lane's width, heights and banks.
The detector views the ground along the route, in three dimensions: a lane that follows it is straight there, as wide as
expected, and no crest or superelevation distorts it. The search begins with such lanes, and then goes to where the
paint is. The map never gives the lane's position, and without paint there is no confidence. A boundary that a bend
moves out of the picture is remembered until it can be seen again.

The route also shows the tilt: a tilt moves the far part of a bend sideways, so that a boundary leaves the route's
direction and bends differently. One boundary suffices for this; where the two signs contradict each other because the
lane does not follow the map, the tilt counts as unknown. A boundary is returned along the route, because no parabola
follows an arc of 10 m. The automation lowers the probabilities of geometry and confidence for a boundary that leaves
the route, to 0 if it leaves it within 60 % of the stretch. The tables show the probabilities as the automation uses
them. In one of five clips the automation does not know the route, and the detector has nothing but the picture.

On 240 other clips of each of 70 files of the fit (the towns, the road files and the winding roads), with a known route
and in clear weather, this share of the painted boundaries is right; *before* is the detector that used the route's
shape only, near junctions and in sharp bends. [What counts as painted](perception-learned.md) was not yet corrected:

| radius of the road, m | outside junctions | before | near junctions | before |
|---|---:|---:|---:|---:|
| over 200 | 94 % | 80 % | 95 % | 86 % |
| 60 to 200 | 95 % | 76 % | 94 % | 89 % |
| 40 to 60 | 94 % | 82 % | 95 % | 72 % |
| 25 to 40 | 71 % | 50 % | 86 % | 76 % |
| 15 to 25 | 78 % | 39 % | 83 % | 62 % |
| 8 to 15 | 56 % | 9 % | 69 % | 41 % |

Half of the boundaries with a radius of 25 to 40 m lie on two roads that are superelevated by up to 0.75 rad or run on
several levels, and on those 28 % and 44 % are right in all weather.

**Bends.** The controller reduces the speed so that the lateral acceleration stays at 2.5 m/s2 (its property
`lateral_acceleration`). It knows the bends of the planned route as far ahead as it needs to brake comfortably
([the law](takeover.md#bends)).

**The packaged confidence** is fitted by `python tools/fit_confidence.py classical MAPS OUT` to 29 064 clips of 204
files: 2880 of each of CARLA's towns 01, 03, 04 and 05, which have more junctions than all other files together; 120 of
each of 46 other road files, four of them packaged with the program; and 60 to 108 of each of 46 copies of these with
other lines and of 108 made-up files: twenty of winding roads, twelve of streets with sharp bends, twelve of such
streets with wide lanes, 24 of level roads with bends of 50 to 250 m, twenty of main streets with crossings, and twenty
of motorways with ramps. `python tools/training_roads.py OUT --repaint MAPS` makes copies and made-up files. Off the
towns, one clip in eight has a lorry close ahead. 3500 random situations are added. The road files are
12_map_integration, Crossing8Course, Figure8, HRI_custommap, Highway, Issue295a, MultiLevelArcRoad, Road2_20,
Roundabout, SShapeSuperelevatedRoad, Town_Safebench_Light, TwoWayRoadWithDoubleYellowCurve, X-Intersection_NCAP,
alks_road_different_curvatures, circular_road, cubetown, curves_elevation, dual_opposing_dedicated_right_turn_lanes,
e6mini, fabriksgatan, highway_exit, highway_loop, highway_split, intersection_3m_width_crosswalk, jolengatan,
lane_offset_intersection, motorway, multi_intersections, multi_lane_3way_intersection, mw_100m, parking_demo,
positive18, road_straight_curve_junction, route_strategy_test_road, scenario_nurb_curved_road, signal_crossing,
simple_3way_intersection_lht, simple_4way_intersection, soderleden, star, straight_500_superelevation_elevation_curve,
t_intersection_300m_approach, town_grid, tunnels, two_plus_one and velodrome.

Each file's clips have weather, noise and traffic of their own: if all files shared them, a fit would learn those few by
heart. Each clip was seen with a confidence that was fitted to other files, because the confidence decides what is
remembered from one image to the next, and the memory is an input of the next confidence (cross-fitting). If a
confidence is fitted to clips that it has seen itself, it is up to 0.15 off on a town that it does not know, and tables
that are made in the same way do not show that.

The command was run in parts, which together took 35 minutes of 16 cores: what is remembered in the clips of the fit was
decided by fits to the other files without wide lanes and motorways, and of these clips twelve share the wear of the
paint, not 24.

In the tables below, each town is seen and judged with a fit to the other files, on three times as many clips as are in
the fit: the largest error moves by up to 0.07 between thirds of these clips. Areas, expected errors and shares of wrong
sides meet their aims everywhere, and all aims are met on the towns together. The largest error misses its aim in three
of eight rows, by 0.001 to 0.005, with a standard error of 0.02 to 0.025 (whole clips drawn with replacement): on single
images of Town01 and on Town04 while driving, boundaries are right 0.085 and 0.081 more often than the confidence says,
on single images of Town03 0.085 less often. The command was run once more, without Town05's table and the bank, in 28
minutes on 16 cores: the largest errors of its fits on Town01, Town03 and Town04 are 0.097, 0.058 and 0.050 on single
images, and 0.037, 0.068 and 0.065 while driving, with Brier scores up to 0.001 below those of the tables. So two of the
three misses are chance. The one on Town01 is not: its lanes are painted on one side only, and where boundaries with a
confidence of 0.5 to 0.9 are seen once, they are right 0.06 to 0.10 more often than it says.

Roads differ in what they paint: outside junctions, in bends of 60 to 200 m, boundaries with a confidence of 0.1 to 0.6
are right 0.10 to 0.14 more often than it says on the towns, and about as often on the other road files.

The errors on the towns also showed where the detector had to be corrected, and which roads are rare in road files.
Usual lanes in sharp bends are, and so are level roads with bends of medium radius: a confidence without them in its fit
was up to 0.26 off there. Behind a vehicle 6 to 12 m ahead, boundaries of medium confidence are right up to 0.1 more
often than it says, and beside a truck 0.1 less often.

**Wide lanes.** In road files a lane of 4 to 7 m is mostly one of a junction, where lines end. A fit without the files
of streets with such lanes takes theirs for those of a junction: on these files, boundaries of medium confidence are
right 0.1 to 0.3 more often than it says, with an expected error of 0.064 and a Brier score of 0.070 while driving. If
only a quarter of them is left out, as below, these are 0.023 and 0.060.

Other roads, while driving, with an area (A), an expected error (E), a largest error (L), and shares of wrong sides
among those with a confidence over 0.8 (W), as the tables explain them; a quarter of all files and their copies was left
out of the fit at a time:

* The 46 other road files: A 0.980, E 0.010, L 0.059, W 1.4 % by more than 0.25 m and 0.1 % by more than 1 m; single
  images: A 0.976, E 0.009, L 0.049, W 1.7 % and 0.1 %. All aims are met.
* Their repainted copies: A 0.973, E 0.021, L 0.097, W 3.9 %; single images: A 0.973, E 0.020, L 0.042, W 4.2 %.
* The twenty files of winding roads: A 0.979, E 0.010, L 0.109, W 3.2 %; single images: A 0.970, E 0.019, L 0.056,
  W 4.2 %. They have up to seven lanes with all kinds of lines, hills and bends, and no junctions.
* The twelve files of streets: A 0.973, E 0.013, L 0.040, W 2.9 %; single images: A 0.966, E 0.013, L 0.068, W 4.5 %.
* The twelve files of streets with wide lanes: A 0.976, E 0.023, L 0.154, W 2.8 %; single images: A 0.972, E 0.027,
  L 0.050, W 2.0 %.
* The 24 files of level roads: A 0.984, E 0.010, L 0.084, W 2.4 %; single images: A 0.987, E 0.015, L 0.021, W 2.1 %.
* The twenty files of crossings: A 0.983, E 0.017, L 0.147, W 2.9 %; single images: A 0.984, E 0.015, L 0.043, W 3.4 %.
  There boundaries of medium confidence are right less often than it says: few of their lines go on.
* The twenty files of motorways: A 0.988, E 0.014, L 0.050, W 1.2 %; single images: A 0.985, E 0.013, L 0.046, W 1.5 %.
* Chance alone explains 0.1 of the largest errors of made-up files: their bins have a hundred to a few hundred sides.
* The worst of the road files: an S-shaped road with a superelevation of 0.75 rad (A 0.759, W 11 %), a map with lanes of
  6 m (0.910, W 0 %), a town on hills (0.933, W 15 %), cubetown (0.942, W 2 %), and a car park (0.945, W 18 %).

See also [how far it drives on clear roads](lane-keeping.md) and [the learned detector](perception-learned.md).
"""

_LEARNED = """\
<!-- Written by `scenario-compiler calibrate` or `tools/fit_confidence.py`. -->
# The learned lane detector

`<detector model="learned"/>` in the [controller](language.md#Detector) uses a small network in place of the classical
detector of [lane detection](perception.md). The network sees the picture at 256 x 128 pixels. For each side and every
second row it gives a distribution over 128 columns for the position of the boundary, and the probability that there is
no boundary; the width of the distribution is the row's uncertainty. It also gives, for each side, the probability that
the side is painted, and it estimates the camera's tilt and the lane's width. The lane through the rows and the tilt are
determined together, along the planned route if it is known (see below). The three probabilities of each side have the
same meaning as those of the classical detector; they are computed in the same way from the rows, and from the paint
along the boundary.

The network has 245 446 parameters in 991 kB, and OpenCV runs it in 7 ms on one core (AMD EPYC, idle, OpenCV 5.0.0). It
was trained for the default mounting; the picture of another camera is first warped to the default camera's view.

**Training.** `python tools/train_lane_network.py MAPS OUT` renders, trains and exports: 126 644 pictures in 337 s on 16
cores and 79 epochs in 726 s on an H200. The overlap of the masks is part of the loss, the weights are averaged over the
last steps, and during the training each convolution has two more branches, which are added up into it at the end
(RepVGG, arXiv 2101.03697). The network was trained on fourteen maps (Figure8, HRI_custommap, Highway, Town01, Town04,
Town_Safebench_Light, alks_road_different_curvatures, cubetown, curves_elevation, e6mini, highway_loop, jolengatan,
multi_intersections, town_grid), on 28 repainted versions of them, which have every kind of line and every pair of lines
that OpenDRIVE has, and on 24 files of synthetic roads (`tools/training_roads.py`). All other maps, seeds of clips and,
but for the random situations, textures of the ground are those of the confidence and of the tables.

**Paint.** The longer the network is trained, the surer it is of the paint without being right: behind a lorry 6 m
ahead, which no picture of the training has, it took painted lines for unpainted, and both sides had a confidence below
0.3 in 15 to 37 % of the images. So `python tools/fit_lane_head.py MAPS NETWORK OUT` fits the layers that give the paint
once more, 16 548 weights behind the encoder, to 3526 other pictures: 2000 random situations, and 1526 of the training's
maps, three of ten with a lorry 4 to 14 m ahead. Rows, tilt and width stay as they were. The packaged network was made
in parts, with rows that were stored with half precision; when the whole command was run on another processor, the
boundaries lay within 0.02 mm of its. On a third of the maps, left out of a fit of the paint, its cross-entropy fell
from 0.23 to 0.13, and with a vehicle less than 9 m ahead from 0.93 to 0.31. In 96 images behind a lorry 6 to 8 m ahead,
with each of two kinds of dashes on one side, the better side has at least 0.44; the solid line has a mean confidence of
0.80, and the dashes have 0.63 and 0.73.

**The confidence** is fitted by `python tools/fit_confidence.py learned MAPS OUT`, trees like those of the classical
one, to files on which the network was not trained: 2753 clips of Town03, 2880 of Town05, and 13 824 of 176 other files,
60 to 120 of most: the 34 others of the road files of [lane detection](perception.md), 34 repainted copies, and 108
made-up files of the same kinds as there. One in eight of these clips has a lorry close ahead. 3500 random situations
are added. Each clip was seen with a confidence that did not know its file, as for the classical detector, and in the
tables each map is judged with a fit to all the other files. All of it was made by one call of the command.

An earlier confidence was fitted to one town and few other files, and had no input for the next junction. On
Town03 it was up to 0.18 off while driving: the network says that a side is painted if it sees paint, but near a
junction a line often begins or ends within the stretch on which it has to be there. Near junctions, sides with a
probability of paint of 0.7 were painted in a third of the cases. Now the confidence knows how far the next junction is
along the route, whether the rows leave the route, and what the network said in the images before. Most of the rest came
from the towns, which have more junctions than all other files together: with 720 instead of 2880 clips of the other
town, the largest error while driving was 0.07 on either of them.

**The paint along the boundary.** A network takes a boundary for painted where boundaries usually are. So a strip of the
ground along each boundary is looked at, from 6 to 30 m ahead: paint is brighter than the ground on both its sides. How
much of either half of the stretch shows paint, how strong and even it is, the longest gap, and whether it goes on
beyond are inputs of the confidence, for the other side the first of these. While most boundaries of a bend were wrong,
such inputs changed nothing. Now they lower the Brier score of the same clips, 2880 of each map: on single images of
Town03 from 0.065 to 0.059, of Town05 from 0.055 to 0.051 and of soderleden from 0.014 to 0.012; while driving from
0.065 to 0.060, from 0.051 to 0.047 and from 0.013 to 0.012.

**The lane through the rows.** A row's place on the ground depends on the tilt of the camera, so the lane and the tilt
are searched together. Expected are two lines a lane's width apart that are nearly parallel to each other and, if the
route is known, to the route, a tilt near the one before and near the network's own estimate of it, and boundaries that
are remembered; the best agreement with the rows is found by least squares, in which rows far from their line count
less. With the route, the rows are projected to the road as the map has it, with its bends, heights and banks. A tilt
moves what is far away, in a bend sideways, so that one line suffices to tell it from a bend. The map never gives the
lane's position. Where the route is not known, the inner of two parallel lines bends more than the outer one.

Before, a parabola was fitted to the rows of each side with the tilt at which the two sides were parallel, and the route
was not used. On 100 clips, not those of the tables, of each of 17 files (nine road files, five of which the network was
trained on, and eight synthetic ones) this share of the painted boundaries is right, while driving with a known route in
all weather but hard rain towards a low sun:

| radius of the road, m | along the route | before | now, without the route |
|---|---:|---:|---:|
| over 200 | 99 % | 96 % | 97 % |
| 60 to 200 | 99 % | 93 % | 94 % |
| 40 to 60 | 100 % | 83 % | 88 % |
| 25 to 40 | 95 % | 65 % | 65 % |
| 15 to 25 | 95 % | 38 % | 39 % |
| under 15 | 75 % | 21 % | 18 % |

In one of five clips of the tables the automation does not know the route. In bends with a radius of 40 m without it,
most errors are errors of the tilt. The confidence knows how far an error of the tilt moves the boundary (`lever`), how
far the uncertainty of the tilt does (`deviation_tilt`), how many of the rows lie on their line (`on_line`), and to
which side the others are (`astray_far`).

**What counts as painted.** A border is painted where the picture shows a line on it. Before, the truth missed two kinds
of lines: the last gap of a broken line at the end of a road counted as unpainted though the line goes on behind it, and
in junctions, where connecting roads lie on one another, only the line of the lane's own road counted. On Town03, 2.6 %
of all sides counted as unpainted and are painted, on Town05 1.6 %, on soderleden none.

**Crossings.** With this truth too, boundaries of medium confidence were right less often than it said where a junction
begins 6 to 15 m ahead, on Town03 by up to 0.18 and on Town05 by up to 0.36: if a vehicle or the night hides the
junction, nothing shows whether the line goes on there, and in towns it seldom does. So twenty files of made-up main
streets with six crossings each, in some of which lines go on, are part of the fit (`tools/training_crossings.py`). On
the same clips, the corrected truth and the crossings lowered the Brier score while driving from 0.0545 to 0.0523 on
Town03 and from 0.0451 to 0.0419 on Town05, and the largest errors from 0.054 to 0.035 and from 0.062 to 0.032. The
corrected truth alone lowered the scores to 0.0539 and 0.0444, with largest errors of 0.089 and 0.033.

**What the tables say.** All aims are met on both towns, on single images and while driving. On soderleden, one boundary
in sixteen has a confidence of 0.3 to 0.9, and those are right more often than it says, by 0.22 in one bin of 277 sides:
the road has no junction, so its lines go on, but where the automation does not know the route, as in one of five clips,
nothing tells that. There the boundaries of 0.3 to 0.8 are right 0.27 more often than it says, with the route 0.08. The
largest error also depends on chance: the same fit, made on another machine from features in single precision, has one
of 0.19.

The confidence before this one had twice as many clips of most files, but no streets with wide lanes and no motorways
in its fit. It had Brier scores of 0.052 and 0.042 on the towns while driving, now 0.053 and 0.044, and largest errors
of 0.135 and 0.143 on soderleden. Fitted to half of the present clips of all files but the towns, the confidence has a
cross-entropy that is 2 % greater on the towns and 6 % greater on soderleden; with half the weight on the made-up files
it is 1 % and 4 % greater.

Other roads, while driving, each with a fit to other files (area, expected error, largest error, share of wrong sides
over 0.8): 34 road files 0.973, 0.011, 0.068, 1.0 %; their repainted copies 0.984, 0.010, 0.096 (by chance 0.091),
0.8 %; winding roads 0.993, 0.011, 0.053, 0.6 %; level roads with bends of medium radius 0.996, 0.010, 0.076, 0.4 %;
streets with sharp bends 0.977, 0.013, 0.074, 1.2 %; such streets with wide lanes 0.981, 0.021, 0.109 (by chance 0.106),
0.9 %; crossings 0.992, 0.009, 0.083 (by chance 0.118), 0.1 %; motorways 0.989, 0.009, 0.070, 1.1 %. On single images
of the road files the largest error is 0.103 (by chance 0.095), on those of the streets with wide lanes 0.155, of the
others less than 0.08.

**Wide lanes.** The confidence before this one took lanes of 4 to 7 m for those of junctions, as
[the classical one](perception.md) does without such streets in its fit: on twelve other files of them (24 clips each),
boundaries of 0.2 to 0.7 were right 0.2 to 0.3 more often than it said while driving, with an expected error of 0.088.
If only a quarter of them is left out, as above, it is 0.021.

**Masks.** A mask is three columns of 128 around the boundary, in every row that has the boundary. On 600 clips of
Town03 and 150 of soderleden, which have other seeds than those of the tables, the masks overlap the true ones by 0.81
and by 0.89; the aim is 0.80. Rows without a boundary count less than others in the training, so a row is taken to have
the boundary where the network says at least 0.77, which then means one half. If it is taken to have it from 0.5 on, the
overlaps are 0.800 and 0.885. The network before had 0.790 and 0.867 from 0.77 on, 0.783 and 0.865 from 0.5 on. On the
first 480 clips of the tables the overlaps are 0.801 and 0.846 from 0.77 on, 0.795 and 0.846 from 0.5 on. On Town03's
600 clips the overlap is 0.81 without noise and 0.78 under noise of over 20 grey levels, 0.82 outside junctions and 0.78
near them, where the picture does not show which way is meant. Near the car three columns are narrower than the paint,
and a mask that is one column off loses half of its overlap: with masks that are as wide as the tolerance of a right
boundary, 0.25 m to either side, the overlap on Town03 is 0.92.

**The maximum of the softmax as confidence**, as the AISA toolkit uses it, was measured for comparison: over the rows of
a side its area under the curve is 0.83 on Town03 and 0.73 on soderleden. It does not saturate here, because the
training targets are blurred, but it separates right from wrong far worse than the fitted confidence of the same
network.
"""

INTRODUCTIONS: dict[DetectorName, str] = {"classical": _CLASSICAL, "learned": _LEARNED}

LIMITS = """\
## What is not covered

* The images for the fit and for the measurement come from the same renderer. The figures say nothing about photographs
  or other simulators.
* The default camera has a field of view of 45 degrees. In a bend with a radius below 33 m the inner boundary leaves the
  picture before it is 18 m ahead, below 20 m the outer one does: where the planned route is not known, such bends are
  lost, and should have a low confidence.
* A vehicle close ahead hides most of both lines. Behind a lorry about 8 m ahead at 5 m/s, on a clear day and a straight
  motorway, the classical detector loses the broken line, takes what is left for a tilt of the camera, and the car
  requests a takeover; with the learned detector it does not.
* A lane that gets wider or narrower looks like a tilt of the camera; tapers are detected with an error. The same holds
  for the lane beside one that ends: at the taper of a motorway's third lane the car in the second one moved 0.1 to 0.4
  m towards it, and warned.
* On a crest, the classical detector loses a broken line if the line on the other side is worn away; it requested a
  takeover there, and the learned detector did not.
* The sensor's health (noise, darkness, blur, dirt, frozen or missing images) is a separate factor, set by rules; it is
  not a probability. See [camera failures](camera-failures.md). The tables do not include it.
* The detector reports nothing but lines: vehicles and obstacles are detected by the forward sensor, which does not use
  the camera.
* The images of one clip resemble each other, so the counts in the tables overstate the amount of evidence.

`scenario-compiler calibrate DIR -o OUT` measures your own maps; with `--fit` it fits the confidence again, which
needs the extra `fit`.
"""
