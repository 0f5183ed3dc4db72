"""Counts of the results of a sweep's runs, and the progress of a sweep."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal

from scenario_compiler.recording.resolution import WITHOUT_REQUEST

TALLIED = ("result", "resolution", "outside_domain_time", "short_start_time")
"""Columns of a sweep's table that `Tally.of` counts from, in its order."""


@dataclass(frozen=True)
class Tally:
    """Numbers of runs.

    Attributes:
        passed: All criteria held.
        failed: A criterion did not hold.
        broken_off: There is no result: the values were refused, or the run could not continue.
        unasked: Of those with a result, runs without a takeover request.
        outside: Runs that left the domain for which surrogate perception was fitted.
        short: Runs that began within the time budget of a limit ahead.
    """

    passed: int = 0
    failed: int = 0
    broken_off: int = 0
    unasked: int = 0
    outside: int = 0
    short: int = 0

    @classmethod
    def of(
        cls, results: Iterable[Any], resolutions: Iterable[Any], outside: Iterable[Any], short: Iterable[Any]
    ) -> Tally:
        """Count runs by their columns `TALLIED`; a time is NaN or None if its event did not happen."""
        pairs = list(zip(results, resolutions, strict=True))
        passed, failed, broken_off = (sum(one == kind for one, _ in pairs) for kind in ("pass", "fail", "error"))
        unasked = sum(end in WITHOUT_REQUEST and one != "error" for one, end in pairs)
        left, late = (sum(t is not None and not math.isnan(t) for t in times) for times in (outside, short))
        return cls(passed, failed, broken_off, unasked, left, late)

    def __add__(self, other: Tally) -> Tally:
        """Return the numbers of both together."""
        return Tally(
            self.passed + other.passed,
            self.failed + other.failed,
            self.broken_off + other.broken_off,
            self.unasked + other.unasked,
            self.outside + other.outside,
            self.short + other.short,
        )

    @property
    def runs(self) -> int:
        """Number of runs."""
        return self.passed + self.failed + self.broken_off

    def in_words(self, *, automated: bool) -> str:
        """Return the numbers in words; requests are counted where an automated vehicle could make one."""
        words = f"{self.passed} passed, {self.failed} failed, {self.broken_off} broken off"
        if automated:
            words = f"{words}; {self.unasked} without a request"
        if self.outside:
            words = f"{words}; {self.outside} outside the domain of surrogate perception"
        return f"{words}; {self.short} that begin within the time budget" if self.short else words


Stage = Literal["variants", "traces", "cases", "evaluations"]
"""The stage of a sweep: its variants, the traces that it keeps, the cases that its report shows, or a search's runs."""


@dataclass(frozen=True)
class Progress:
    """The progress of a sweep.

    Attributes:
        stage: The present stage.
        done: Finished units of the stage.
        total: All units of the stage.
        tally: Counts of the results of all rows so far.
    """

    stage: Stage
    done: int
    total: int
    tally: Tally = Tally()


OnProgress = Callable[[Progress], None]
"""A function that receives the progress."""
