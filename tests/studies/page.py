"""docs/validity.md and its figure: the studies of this folder with the papers' results and the results here.

`python -m tests.studies.page` writes both. It runs some 800 conflicts without a camera.
"""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenario_compiler.recording.recording import Floats
from scenario_compiler.report.wording import percent
from tests.studies import (
    test_doubek_2020,
    test_eriksson_2017,
    test_gold_2013,
    test_gold_2016,
    test_happee_2017,
    test_koerber_2016,
    test_merat_2014,
    test_mok_2015,
    test_naujoks_2014,
    test_r157_cut_in,
    test_radlmayr_2014,
)
from tests.studies.study import Sample, compiled, sample

DOCS = Path(__file__).parents[2] / "docs"
SEEDS = range(1, 31)
BLUE, ORANGE, GREY = "#1f6f9f", "#c8641b", "#777777"

HEAD = """# Published studies, run again

<!-- written by python -m tests.studies.page -->

Eleven studies are written as conflicts of 10 to 25 lines (`tests/studies`). Each table shows what the paper reports,
the result here, and what a test asserts, which is never more than the source supports. "Figure not found" means that
the paper was not available and no quotation of the number was found; "from memory, not verified" marks a direction
that was not looked up. The drivers' takeover times are fitted to published distributions ([driver.md](driver.md)), so
their medians are not a result; what happens after the response is.

The tables contain two times to collision. The time to collision *of the path* refers to objects on the path that the
car is steering along at the moment: an obstacle is no longer on the path as soon as the wheel is turned, and is on it
again when the car straightens beside the obstacle. The time to collision *along the lane* refers to objects ahead of
the car in its lane, whatever the steering, until the car has moved aside; takeover studies report this one, and Happee
et al. 2017 prefer it as the more robust. Compare conditions by it: the two can differ in direction. If both adjacent
lanes are full and 5 s are left, a car can only brake, and keeps 1.55 s of both. If it steers around the obstacle into a
free lane, it has 1.36 s of the path, while it straightens beside the obstacle, but 2.15 s along the lane (medians of 15
runs).

![Takeover times, least times to collision, collisions and lateral deviation of six studies](validity.svg)
"""

TAIL = """## What is not modelled

- **Takeover time by traffic.** The density changes the takeover time only by a coefficient that the user gives
  (`<effect of="traffic_density">`), because no published coefficient was found. The density itself is counted at each
  request. Studies in which traffic delays responses are reproduced in their time to collision, but not in this delay.
- **Gaze and mental workload.** The times of eyes on the road and hands on the wheel are random shares of the takeover
  time; gaze at mirrors, fatigue, trust and learning are not modelled, except that the second request has a shorter
  time.
- **Wrong expectations.** A driver who sees the obstacle and does not act (Victor et al. 2018) can only be modelled as a
  lapse, that is, as a driver who never responds.
- **Age and experience** have no effect; a study's regression over them can be written as an expression.
- **Motion.** Cars are kinematic: their tyres do not slide, so no evasion ends in a spin. Friction limits turns and
  braking only where an action sets it; [the weather does not](takeover.md#bends).
- **Other road users** do not cooperate: background traffic follows and keeps its distance, scripted vehicles do what
  the scenario says, and none makes room for the automated vehicle.
- **The driver's sight.** The driver sees 300 m by day in clear air (chosen), less in rain, fog and at night; glare and
  the lights of others are not modelled, and the driver knows of a vehicle that is hidden behind the obstacle.
- **Automatic braking.** By default the automation slows down for the cause of its request, and its minimum-risk
  manoeuvre begins when a limit leaves only the distance to stop. A study in which the car does not brake uses
  `<takeover minimum_risk="false">` and `<automation after="hold_speed"/>`.
"""


@dataclass(frozen=True)
class Part:
    """A study on the page: its module and a table of what came out."""

    module: ModuleType
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def text_of(parts: Sequence[Part]) -> str:
    """Return the page."""
    lines = [HEAD]
    for part in parts:
        title, _, rest = (inspect.getdoc(part.module) or "").partition("\n\n")
        lines += [f"## {title.rstrip('.')}", "", rest, "", "Measured:", ""]
        lines += [f"| {' | '.join(part.columns)} |", "|" + "---|" * len(part.columns)]
        lines += [f"| {' | '.join(row)} |" for row in part.rows]
        lines.append("")
    return "\n".join([*lines, TAIL])


def described(label: str, one: Sample) -> tuple[str, ...]:
    """Return a condition's row: medians, and shares of the runs."""
    medians = (np.median(one.times), np.median(one.inputs), np.median(one.least), np.median(one.along))
    return (label, *(f"{float(value):.2f}" for value in medians), percent(one.crashed))


SAMPLED = (
    *("condition", "takeover time, s", "first input, s"),
    *("least time to collision of the path, s", "along the lane, s", "collide"),
)
"""Columns of a table of samples: medians, and shares of the runs."""


def gold_2013(folder: Path) -> dict[str, Sample]:
    """Return the two budgets of Gold et al. 2013."""
    text = test_gold_2013.GOLD.format(before="follow")
    return {f"{b} s": sample([compiled(folder, text, budget=float(b))], SEEDS) for b in (5, 7)}


def box(axes: Axes, samples: dict[str, Sample], title: str) -> None:
    """Draw the least times to collision along the lane of a study's conditions, and their collisions."""
    axes.boxplot(
        [one.along for one in samples.values()],
        tick_labels=[f"{name}\n{one.crashed:.0%} collide" for name, one in samples.items()],
        widths=0.5,
        medianprops={"color": ORANGE, "linewidth": 2},
        boxprops={"color": BLUE},
        flierprops={"markersize": 3},
    )
    axes.set_ylim(bottom=0)
    axes.set_ylabel("least time to collision along the lane, s")
    axes.set_title(title, fontsize=10)


def figure_of(
    budgets: dict[str, Sample],
    situations: dict[str, Sample],
    densities: dict[str, Sample],
    answers: dict[str, list[float]],
    deviations: Floats,
    verdicts: Sequence[test_r157_cut_in.Verdict],
) -> Figure:
    """Return the figure of six studies."""
    figure = Figure(figsize=(12, 7), layout="constrained")
    (gold, radlmayr, dense), (eriksson, merat, cut_in) = figure.subplots(2, 3)
    box(gold, budgets, "Gold et al. 2013: budget")
    box(radlmayr, situations, "Radlmayr et al. 2014: lanes beside")
    box(dense, densities, "Gold et al. 2016: vehicles per km")
    for (name, times), colour in zip(answers.items(), (BLUE, ORANGE), strict=True):
        eriksson.step(np.sort(times), np.linspace(0, 1, len(times)), where="post", color=colour, label=name)
    for median, colour in zip((4.567, 6.061), (BLUE, ORANGE), strict=True):
        eriksson.axvline(median, color=colour, linestyle=":", linewidth=1)
    eriksson.set(xlabel="takeover time, s (dotted: the paper's medians)", ylabel="share of the drivers")
    eriksson.set_title("Eriksson and Stanton 2017", fontsize=10)
    eriksson.legend(fontsize=8)
    middles = [at + 5 for at in test_merat_2014.WINDOWS]
    merat.axvspan(35, 40, color=GREY, alpha=0.25, label="settled in the paper")
    merat.plot(middles, deviations, marker="o", color=BLUE)
    merat.set(xlabel="time since the response, s", ylabel="lateral deviation in 10 s, m", ylim=(0, None))
    merat.set_title("Merat et al. 2014", fontsize=10)
    merat.legend(fontsize=8)
    for crashed, label, colour, marker in ((False, "no collision", BLUE, "o"), (True, "collision", ORANGE, "x")):
        some = [one for one in verdicts if one.crashed == crashed]
        cut_in.scatter(
            [12 * (one.limit - 0.35) for one in some],
            [one.intrusion for one in some],
            color=colour,
            marker=marker,
            s=22,
            label=label,
        )
    closing = np.linspace(0, 20, 2)
    cut_in.plot(closing, closing / 12 + 0.35, color=GREY, label="5.2.5.2")
    cut_in.set(xlabel="closing speed, m/s", ylabel="time to collision at the intrusion, s", ylim=(-1, 6), xlim=(0, 20))
    cut_in.set_title("UN R157: cut-ins", fontsize=10)
    cut_in.legend(fontsize=8)
    return figure


def radlmayr_2014(folder: Path, situations: dict[str, Sample]) -> Part:
    """Return the part on Radlmayr et al. 2014: its situations, and two of them with a visual task."""
    busy = {
        f"{kind}, visual task": test_radlmayr_2014.situation(folder, kind, "visual", SEEDS)
        for kind in ("free", "both full")
    }
    return Part(test_radlmayr_2014, SAMPLED, tuple(described(*one) for one in {**situations, **busy}.items()))


def koerber_2016(folder: Path) -> Part:
    """Return the part on Körber et al. 2016."""
    found = {how: test_koerber_2016.takeovers(folder, brakes=how == "brakes") for how in ("steers", "brakes")}
    rows = (
        (f"{how}, {k + 1}", *(f"{float(value):.2f}" for value in np.nanmedian(one, axis=0)))
        for how, situations in found.items()
        for k, one in enumerate(situations)
    )
    columns = ("driver, situation", "takeover time, s", "along the lane, s", "greatest lateral acceleration, m/s2")
    return Part(test_koerber_2016, columns, tuple(rows))


def doubek_2020(folder: Path) -> Part:
    """Return the part on Doubek et al. 2020."""
    found = [
        (f"{budget:g} s, {traffic} traffic", test_doubek_2020.condition(folder, budget, traffic))
        for traffic in test_doubek_2020.TRAFFIC
        for budget in test_doubek_2020.BUDGETS
    ]
    columns = ("condition", "along the lane, s", "greatest acceleration along the road, m/s2", "hands on the wheel, s")
    rows = ((name, f"{one.least:.2f}", f"{one.deceleration:.2f}", f"{one.hands:.2f}") for name, one in found)
    return Part(test_doubek_2020, columns, tuple(rows))


def happee_2017(folder: Path) -> Part:
    """Return the part on Happee et al. 2017."""
    found = [(name, test_happee_2017.condition(folder, name)) for name in test_happee_2017.CONDITIONS]
    columns = ("condition", "evasion begins before it, m", "along the lane, s", "greatest lateral acceleration, m/s2")
    rows = ((name, f"{one.away:.0f}", f"{one.least:.2f}", f"{one.lateral:.2f}") for name, one in found)
    return Part(test_happee_2017, columns, tuple(rows))


def mok_2015(folder: Path) -> Part:
    """Return the part on Mok et al. 2015."""
    rows = ((f"{budget:g} s", percent(test_mok_2015.safe(folder, budget))) for budget in test_mok_2015.BUDGETS)
    return Part(test_mok_2015, ("budget", "safe"), tuple(rows))


def naujoks_2014(folder: Path) -> Part:
    """Return the part on Naujoks et al. 2014."""
    found = [
        (f"{situation}, {modality}", test_naujoks_2014.condition(folder, situation, modality, SEEDS))
        for situation in test_naujoks_2014.SITUATIONS
        for modality in test_naujoks_2014.MODALITIES
    ]
    columns = ("condition", "hands on the wheel, s", "greatest offset from the lane's centre, m")
    return Part(
        test_naujoks_2014, columns, tuple((name, f"{one.hands:.2f}", f"{one.offset:.2f}") for name, one in found)
    )


def eriksson_2017(answers: dict[str, list[float]]) -> Part:
    """Return the part on Eriksson and Stanton 2017."""
    rows = (
        (
            kind,
            f"{np.median(times):.2f}",
            " to ".join(f"{value:.2f}" for value in np.quantile(times, (0.25, 0.75))),
            f"{min(times):.2f} to {max(times):.2f}",
        )
        for kind, times in answers.items()
    )
    return Part(test_eriksson_2017, ("condition", "median, s", "quartiles, s", "range, s"), tuple(rows))


def merat_2014(deviations: Floats) -> Part:
    """Return the part on Merat et al. 2014."""
    columns = ("time since the response, s", "median deviation of the lateral position, m")
    rows = (
        (f"{at} to {at + 10}", f"{value:.3f}") for at, value in zip(test_merat_2014.WINDOWS, deviations, strict=True)
    )
    return Part(test_merat_2014, columns, tuple(rows))


def r157_cut_in(verdicts: Sequence[test_r157_cut_in.Verdict]) -> Part:
    """Return the part on the cut-ins of UN R157."""
    groups = {
        "all": list(verdicts),
        "avoidable by 5.2.5.2": [one for one in verdicts if one.intrusion > one.limit],
        "avoided by the careful and competent driver": [one for one in verdicts if one.avoidable],
    }
    rows = ((name, str(len(some)), str(sum(one.crashed for one in some))) for name, some in groups.items())
    return Part(test_r157_cut_in, ("cut-ins", "number", "collisions"), tuple(rows))


def write() -> None:
    """Run the studies and write the page and its figure."""
    mpl.rcParams.update(
        {"svg.hashsalt": "studies", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
    )
    with TemporaryDirectory() as name:
        folder = Path(name)
        budgets = gold_2013(folder)
        situations = {
            kind: test_radlmayr_2014.situation(folder, kind, seeds=SEEDS) for kind in test_radlmayr_2014.SITUATIONS
        }
        densities = {str(d): test_gold_2016.with_density(folder, d) for d in (0, 10, 20)}
        drivers = {"no task": "unhurried", "task": "unhurried_with_task"}
        answers = {kind: test_eriksson_2017.times(folder, driver) for kind, driver in drivers.items()}
        deviations = test_merat_2014.deviations(folder, SEEDS)
        verdicts = [test_r157_cut_in.verdict(folder, *point) for point in test_r157_cut_in.POINTS]
        parts = (
            Part(test_gold_2013, SAMPLED, tuple(described(*one) for one in budgets.items())),
            radlmayr_2014(folder, situations),
            Part(test_gold_2016, SAMPLED, tuple(described(f"{name} per km", one) for name, one in densities.items())),
            koerber_2016(folder),
            doubek_2020(folder),
            happee_2017(folder),
            mok_2015(folder),
            naujoks_2014(folder),
            eriksson_2017(answers),
            merat_2014(deviations),
            r157_cut_in(verdicts),
        )
    (DOCS / "validity.md").write_text(text_of(parts), encoding="utf-8")
    figure = figure_of(budgets, situations, densities, answers, deviations, verdicts)
    figure.savefig(DOCS / "validity.svg", metadata={"Date": None})


if __name__ == "__main__":
    write()
