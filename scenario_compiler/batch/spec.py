"""The options of a sweep, as one frozen value that can be stored and compared."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from scenario_compiler.batch.distributions import Distribution, SweepError, parse_distribution
from scenario_compiler.compiler import Overrides
from scenario_compiler.files import split_target
from scenario_compiler.randomness import whole_number
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.sensors import Perception

Method = Literal["random", "grid", "latin", "sobol"]

MOST_SEED = 2**62
"""Greatest seed of a sweep: the seeds of all its runs are numbers of 64 bits in its table."""

MAY_CHANGE = frozenset(("traces", "time_limit"))
"""Options that may differ when a sweep is resumed; the others determine its rows."""


@dataclass(frozen=True)
class SweepSpec:
    """A sweep: which parameters vary, how they are sampled, and how the variants run.

    Attributes:
        vary: NAME=DISTRIBUTION of each parameter that varies.
        method: Way to sample the distributions.
        samples: Number of samples; at each point of the grid axes, if any.
        repeat: Number of runs of each sample, each with the next seed.
        seed: Seed of the samples and, with a variant's index, of its first run.
        where: Expressions that every variant fulfils.
        settings: Fixed values of other parameters.
        perception: Lane confidence's source, in place of the scenario's.
        controller: Controller, in place of the scenario's.
        step: Time step, in place of the scenario's, s.
        duration: Duration, in place of the scenario's, s.
        trust: Code that the scenario may name; see `Trust`.
        traces: Variants whose traces are kept: worst:K, random:K, all or none.
        errors: Codes of warnings that are errors; `all`: every warning.
        allowed: Codes of warnings that stay warnings nevertheless.
        time_limit: Greatest time that a variant may take, s.
        interpreted: Whether to run variants without a camera in the interpreted engine.

    Raises:
        SweepError: The method is unknown, or a number is beyond its limits.
        TypeError: An option has a value of another type.
    """

    vary: tuple[str, ...]
    method: Method = "random"
    samples: int = 1
    repeat: int = 1
    seed: int = 1
    where: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)
    perception: Perception | None = None
    controller: str | None = None
    step: float | None = None
    duration: float | None = None
    trust: tuple[str, ...] = ()
    traces: str = ""
    errors: tuple[str, ...] = ()
    allowed: tuple[str, ...] = ()
    time_limit: float | None = None
    interpreted: bool = False

    def __post_init__(self) -> None:
        for name in ("vary", "where", "trust", "errors", "allowed"):
            texts = getattr(self, name)
            if isinstance(texts, str) or not all(isinstance(text, str) for text in texts):
                raise TypeError(f"{name} is a tuple of texts, not {texts!r}")
        if not all(isinstance(text, str) for pair in self.settings.items() for text in pair):
            raise TypeError(f"settings are texts by name, as on the command line, not {self.settings!r}")
        for name in ("samples", "repeat", "seed"):
            object.__setattr__(self, name, whole_number(name, getattr(self, name)))
        if self.method not in get_args(Method):
            raise SweepError(f"method is one of {', '.join(get_args(Method))}, not {self.method!r}")
        if self.samples < 1:
            raise SweepError(f"samples is at least 1, not {self.samples}")
        if not 1 <= self.repeat <= MOST_SEED:
            raise SweepError(f"repeat is from 1 to {MOST_SEED}, not {self.repeat}")
        if not -MOST_SEED <= self.seed <= MOST_SEED:
            raise SweepError(f"seed is from {-MOST_SEED} to {MOST_SEED}, not {self.seed}")
        if self.time_limit is not None and not self.time_limit > 0.0:
            raise SweepError(f"time_limit is above 0 s, not {self.time_limit}")

    @property
    def of_rows(self) -> dict[str, Any]:
        """The options that determine the rows, as JSON has them.

        A variant whose code is not trusted is a row with an error. A trusted file has its name without its folder, so
        that a sweep can be resumed from another one.
        """
        options = {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in vars(self).items()
            if name not in MAY_CHANGE
        }
        return {**options, "trust": sorted({Path(name).name for name in self.trust})}

    @property
    def overrides(self) -> Overrides:
        """The overrides of the scenario."""
        return Overrides(self.perception, self.controller, self.step, self.duration, driven_by="model")

    def trusted(self, target: str | Path) -> Trust:
        """Return the trusted code for a sweep of FILE, FILE#name or a plan's file."""
        return self.overrides.trusting(Trust(self.trust), Path(split_target(target)[0]).parent)

    @property
    def axes(self) -> dict[str, Distribution]:
        """The distributions by the parameter's name; raises SweepError if one cannot be read."""
        axes: dict[str, Distribution] = {}
        for text in self.vary:
            name, equals, written = (part.strip() for part in text.partition("="))
            if not equals or not re.fullmatch(r"[A-Za-z_]\w*", name):
                raise SweepError(f"'{text}' is not NAME=DISTRIBUTION, such as gap=uniform(5,40)")
            if name in axes or name in self.settings:
                raise SweepError(f"the parameter '{name}' is given twice")
            axes[name] = parse_distribution(written)
        return axes

    def traces_wanted(self) -> tuple[str, int]:
        """Return the traces to keep: "", "worst", "random" or "all", and how many (0 for all)."""
        kind, _, count = self.traces.partition(":")
        if kind in ("", "none") and not count:
            return "", 0
        if kind == "all" and not count:
            return "all", 0
        if kind in ("worst", "random") and re.fullmatch("[0-9]{1,9}", count) and int(count) > 0:
            return kind, int(count)
        raise SweepError(f"traces '{self.traces}': give worst:K, random:K or all")
