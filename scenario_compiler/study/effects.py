"""The effects to expect from a pilot: means by condition, differences within participants, and power.

The participant is the unit of analysis. Trials of one participant are not independent of each other, so those of a
condition are averaged first, and each participant counts once, with one number: a summary measure (Matthews et al.
1990, BMJ 300:230-235). Counting trials instead is pseudoreplication (Hurlbert 1984).

For two levels of a factor each participant contributes one difference: that of the means of the two levels with all
other factors equal, averaged over these. A cell without a value thus excludes both of its sides. The interval of the
mean difference is Student's, the effect size is d_z (mean over standard deviation of the differences), and power is
that of the two-sided paired t test at 5 % (Cohen 1988), from the noncentral F distribution of the squared t.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import ncf
from scipy.stats import t as student

from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.report.templates import page_environment
from scenario_compiler.report.wording import fixed, unit_words
from scenario_compiler.study.dataset import seats_of
from scenario_compiler.study.tables import MISSING, read_table
from scenario_compiler.study_plans import StudyCompilation

SHOWN = (
    *("takeover_time", "minimum_time_to_collision", "minimum_lane_time_to_collision", "minimum_distance"),
    *("maximum_lateral_acceleration", "maximum_longitudinal_acceleration", "maximum_lateral_offset"),
)
"""Measures of the page."""

FACTORS = ("scenario", "hmi", "setting")
"""Columns whose levels define the conditions."""

ALPHA, POWER = 0.05, 0.8

TINY = 1e-12
"""Noncentrality below which the power is that of no effect: scipy's distribution fails near 0."""

ROUNDING = 1e-8
"""Numbers that differ by less are equal: tables have nine decimals, and differences of their numbers are rounded."""

MOST = 1000
"""Greatest number of participants for which the power is computed."""


@dataclass(frozen=True)
class Mean:
    """A mean over participants with its interval of 95 %; `low` and `high` are NaN for a single value."""

    count: int
    mean: float
    deviation: float
    low: float
    high: float


@dataclass(frozen=True)
class Condition:
    """The result of a condition's trials.

    Attributes:
        name: The condition.
        trials: Number of its trials that have a value.
        missing: Number of its trials that have none.
        mean: The mean of the participants' means.
        within: Standard deviation of the trials of one participant, pooled over participants; NaN if nobody has two.
    """

    name: str
    trials: int
    missing: int
    mean: Mean
    within: float


@dataclass(frozen=True)
class Difference:
    """The difference of a measure between two levels of a factor, within participants.

    Attributes:
        factor: The factor.
        levels: The two levels; the difference is the second minus the first.
        mean: The mean difference, with its interval of 95 %.
        effect: Effect size d_z; NaN if the differences do not vary.
        power: Power of the test with the present number of participants.
        needed: Number of participants for a power of 80 %; None above `MOST`.
    """

    factor: str
    levels: tuple[str, str]
    mean: Mean
    effect: float
    power: float
    needed: int | None


def mean_of(values: Sequence[float]) -> Mean:
    """Return the mean of values, one for each participant, with Student's interval."""
    count = len(values)
    if not count:
        return Mean(0, *[math.nan] * 4)
    mean = float(np.mean(values))
    if count < 2:
        return Mean(count, mean, *[math.nan] * 3)
    deviation = float(np.std(values, ddof=1)) if max(values) - min(values) > ROUNDING else 0.0
    half = float(student.ppf(1 - ALPHA / 2, count - 1)) * deviation / math.sqrt(count)
    return Mean(count, mean, deviation, mean - half, mean + half)


def deviation_within(groups: Iterable[Sequence[float]]) -> float:
    """Return the standard deviation within groups of values, pooled over the groups; NaN if no group has two values."""
    repeated = [one for one in groups if len(one) > 1]
    degrees = sum(len(one) - 1 for one in repeated)
    squares = sum((len(one) - 1) * float(np.var(one, ddof=1)) for one in repeated)
    return math.sqrt(squares / degrees) if degrees else math.nan


def power_of(effect: float, count: int) -> float:
    """Return the power of the two-sided paired t test at 5 % for an effect size d_z and a number of pairs."""
    if count < 2 or not math.isfinite(effect):
        return math.nan
    shift = effect * effect * count
    if shift < TINY:
        return ALPHA
    limit = float(student.ppf(1 - ALPHA / 2, count - 1))
    return float(ncf.sf(limit * limit, 1, count - 1, shift))


def needed_for(effect: float) -> int | None:
    """Return the least number of pairs that gives a power of 80 %; None above `MOST`."""
    if not math.isfinite(effect) or effect == 0.0:
        return None
    return next((count for count in range(2, MOST + 1) if power_of(abs(effect), count) >= POWER), None)


Rows = Sequence[Mapping[str, str]]


def by_condition(rows: Rows, measure: str) -> list[Condition]:
    """Return the result of each condition, in which each participant counts once."""
    found = []
    for name in sorted({row["condition"] for row in rows}):
        own = [row for row in rows if row["condition"] == name]
        people = _values(own, ["participant_id"], measure)
        trials = sum(map(len, people.values()))
        mean = mean_of([float(np.mean(values)) for values in people.values()])
        found.append(Condition(name, trials, len(own) - trials, mean, deviation_within(people.values())))
    return found


def differences(rows: Rows, factor: str, measure: str) -> list[Difference]:
    """Return the difference between each two levels of a factor, within participants."""
    others = tuple(one for one in FACTORS if one != factor)
    cells = _values(rows, (factor, "participant_id", *others), measure)
    means = {cell: float(np.mean(values)) for cell, values in cells.items()}
    found = []
    for first, second in itertools.combinations(sorted({row[factor] for row in rows}), 2):
        people: dict[str, list[float]] = {}
        for (level, person, *same), value in means.items():
            if level == first and (second, person, *same) in means:
                people.setdefault(person, []).append(means[(second, person, *same)] - value)
        mean = mean_of([float(np.mean(values)) for values in people.values()])
        effect = mean.mean / mean.deviation if mean.deviation > 0 else math.nan
        power = power_of(effect, mean.count)
        found.append(Difference(factor, (first, second), mean, effect, power, needed_for(effect)))
    return found


def _values(rows: Rows, keys: Sequence[str], measure: str) -> dict[tuple[str, ...], list[float]]:
    """Return the values of a measure by the values of some columns, without missing ones."""
    found: dict[tuple[str, ...], list[float]] = {}
    for row in rows:
        if row[measure] != MISSING:
            found.setdefault(tuple(row[key] for key in keys), []).append(float(row[measure]))
    return found


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
    factors = [one for one in FACTORS if len({row[one] for row in rows}) > 1]
    units = {one.name: one for one in MEASURES}
    measured = []
    for name in SHOWN:
        conditions = by_condition(rows, name)
        if any(one.trials for one in conditions):
            found = [one for factor in factors for one in differences(rows, factor, name)]
            measured.append((units[name], conditions, found, _axis([one.mean for one in conditions])))
    environment = page_environment(Path(__file__).parent)
    environment.filters |= {"number": _number, "interval": _interval, "shown": unit_words}
    page = environment.get_template("effects.html.jinja")
    people = len({row["participant_id"] for row in rows})
    file = root / "expected.html"
    write_whole(file, page.render(study=compilation.study, measured=measured, people=people, runs=len(rows)))
    return file


def _number(value: float) -> str:
    """Return a number with two decimals; a dash if it is NaN."""
    return fixed(value) if math.isfinite(value) else "–"


def _interval(one: Mean) -> str:
    """Return the interval of a mean; a dash if it has none."""
    return f"{_number(one.low)} to {_number(one.high)}" if math.isfinite(one.low) else "–"


def _axis(means: Sequence[Mean]) -> tuple[float, float]:
    """Return the least and the greatest number on a plot of means."""
    ends = [end for one in means for end in (one.mean, one.low, one.high) if math.isfinite(end)]
    low, high = min(ends), max(ends)
    room = 0.08 * (high - low or 1.0)
    return low - room, high + room
