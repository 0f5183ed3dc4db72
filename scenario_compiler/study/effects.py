"""What a pilot says of the study to come: means by condition, differences within participants, and power.

For two levels of a factor each participant gives one difference of means. Its interval is Student's, the effect size
is d_z (mean over standard deviation of the differences), and power is that of the two-sided paired t test at 5 %, from
the noncentral t distribution (Cohen 1988).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import nct
from scipy.stats import t as student

from scenario_compiler.compiler import StudyCompilation
from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.report.templates import page_environment
from scenario_compiler.study.dataset import seats_of
from scenario_compiler.study.tables import MISSING, read_table

SHOWN = (
    *("takeover_time", "minimum_time_to_collision", "minimum_lane_time_to_collision", "minimum_distance"),
    *("maximum_lateral_acceleration", "maximum_longitudinal_acceleration", "maximum_lateral_offset"),
)
"""Measures of the page."""

ALPHA, POWER = 0.05, 0.8

MOST = 1000
"""Number of participants up to which one that gives the power is looked for."""


@dataclass(frozen=True)
class Mean:
    """A mean with its interval of 95 %; `low` and `high` are NaN for a single value."""

    name: str
    count: int
    missing: int
    mean: float
    deviation: float
    low: float
    high: float


@dataclass(frozen=True)
class Difference:
    """How much a measure differs between two levels of a factor, within participants.

    Attributes:
        factor: The factor.
        levels: The two levels; the second less the first is meant.
        mean: The mean difference, with its interval of 95 %.
        effect: Effect size d_z; NaN where the differences do not vary.
        power: Power of the test with as many participants as there are.
        needed: Number of participants for a power of 80 %; None above `MOST`.
    """

    factor: str
    levels: tuple[str, str]
    mean: Mean
    effect: float
    power: float
    needed: int | None


def mean_of(name: str, values: Sequence[float]) -> Mean:
    """Return the mean of values, NaN for those that are missing, with Student's interval."""
    there = np.array([one for one in values if math.isfinite(one)])
    count, missing = len(there), len(values) - len(there)
    if not count:
        return Mean(name, 0, missing, *[math.nan] * 4)
    mean = float(there.mean())
    if count < 2:
        return Mean(name, count, missing, mean, *[math.nan] * 3)
    deviation = float(there.std(ddof=1))
    half = float(student.ppf(1 - ALPHA / 2, count - 1)) * deviation / math.sqrt(count)
    return Mean(name, count, missing, mean, deviation, mean - half, mean + half)


def power_of(effect: float, count: int) -> float:
    """Return the power of the two-sided paired t test at 5 % for an effect size d_z and a number of pairs."""
    if count < 2 or not math.isfinite(effect):
        return math.nan
    limit, shift = float(student.ppf(1 - ALPHA / 2, count - 1)), effect * math.sqrt(count)
    return float(nct.sf(limit, count - 1, shift) + nct.cdf(-limit, count - 1, shift))


def needed_for(effect: float) -> int | None:
    """Return the least number of pairs that gives a power of 80 %; None above `MOST`."""
    if not math.isfinite(effect) or effect == 0.0:
        return None
    return next((count for count in range(2, MOST + 1) if power_of(abs(effect), count) >= POWER), None)


Rows = Sequence[Mapping[str, str]]


def means_by_condition(rows: Rows, measure: str) -> list[Mean]:
    """Return the mean of a measure over all trials of each condition."""
    names = dict.fromkeys(row["condition"] for row in rows)
    return [
        mean_of(name, [_number(row, measure) for row in rows if row["condition"] == name]) for name in sorted(names)
    ]


def differences(rows: Rows, factor: str, measure: str) -> list[Difference]:
    """Return the difference between each two levels of a factor, within participants."""
    levels = list(dict.fromkeys(sorted(row[factor] for row in rows)))
    people = list(dict.fromkeys(row["participant_id"] for row in rows))
    means: dict[tuple[str, str], float] = {}
    for person, level in itertools.product(people, levels):
        own = [_number(row, measure) for row in rows if row["participant_id"] == person and row[factor] == level]
        means[person, level] = mean_of("", own).mean
    found = []
    for first, second in itertools.combinations(levels, 2):
        mean = mean_of(f"{second} − {first}", [means[one, second] - means[one, first] for one in people])
        effect = mean.mean / mean.deviation if mean.deviation > 0 else math.nan
        power = power_of(effect, mean.count)
        found.append(Difference(factor, (first, second), mean, effect, power, needed_for(effect)))
    return found


def _number(row: Mapping[str, str], measure: str) -> float:
    return math.nan if row[measure] == MISSING else float(row[measure])


def trials_of(compilation: StudyCompilation, root: Path) -> list[dict[str, str]]:
    """Return the rows of all trials of a study that are neither practice nor foil."""
    study = compilation.study
    rows: list[dict[str, str]] = []
    for seat in seats_of(study, root):
        rows += read_table(seat.table(study.name, "beh"))
    return [row for row in rows if row["role"] == "trial"]


def write_effects(compilation: StudyCompilation, root: Path) -> Path:
    """Write the page of a pilot's expected effects; return its file."""
    rows = trials_of(compilation, root)
    factors = [one for one in ("scenario", "hmi", "setting") if len({row[one] for row in rows}) > 1]
    units = {one.name: one for one in MEASURES}
    measured = []
    for name in SHOWN:
        means = means_by_condition(rows, name)
        if any(one.count for one in means):
            found = [one for factor in factors for one in differences(rows, factor, name)]
            measured.append((units[name], means, found, _axis(means)))
    environment = page_environment(Path(__file__).parent)
    environment.filters["number"] = lambda value: "–" if not math.isfinite(value) else f"{value:.2f}"
    page = environment.get_template("effects.html.jinja")
    people = len({row["participant_id"] for row in rows})
    file = root / "expected.html"
    write_whole(file, page.render(study=compilation.study, measured=measured, people=people, runs=len(rows)))
    return file


def _axis(means: Sequence[Mean]) -> tuple[float, float]:
    """Return the least and the greatest number of a plot of means."""
    ends = [end for one in means for end in (one.mean, one.low, one.high) if math.isfinite(end)]
    low, high = min(ends), max(ends)
    room = 0.08 * (high - low or 1.0)
    return low - room, high + room
