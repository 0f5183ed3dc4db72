"""The options of a sweep, as one frozen value that can be stored and compared."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.batch.distributions import Distribution, SweepError, parse_distribution
from scenario_compiler.compiler import Overrides
from scenario_compiler.files import split_target
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.sensors import Perception

Method = Literal["random", "grid", "latin", "sobol"]

MOST_SEED = 2**62
"""Greatest seed of a sweep: the seeds of all its runs are numbers of 64 bits in its table."""


class SweepSpec(BaseModel):
    """A sweep: which parameters vary, how they are sampled, and how the variants run."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    vary: tuple[str, ...] = Field(description="NAME=DISTRIBUTION of each parameter that varies.")
    method: Method = Field(default="random", description="Way to sample the distributions.")
    samples: int = Field(default=1, ge=1, description="Number of samples; at each point of the grid axes, if any.")
    repeat: int = Field(
        default=1, ge=1, le=MOST_SEED, description="Number of runs of each sample, each with the next seed."
    )
    seed: int = Field(
        default=1,
        ge=-MOST_SEED,
        le=MOST_SEED,
        description="Seed of the samples and, with a variant's index, of its first run.",
    )
    where: tuple[str, ...] = Field(default=(), description="Expressions that every variant fulfils.")
    settings: dict[str, str] = Field(default={}, description="Fixed values of other parameters.")
    perception: Perception | None = Field(
        default=None, description="Lane confidence's source, in place of the scenario's."
    )
    controller: str | None = Field(default=None, description="Controller, in place of the scenario's.")
    step: float | None = Field(default=None, description="Time step, in place of the scenario's, s.")
    duration: float | None = Field(default=None, description="Duration, in place of the scenario's, s.")
    trust: tuple[str, ...] = Field(default=(), description="Code that the scenario may name; see `Trust`.")
    traces: str = Field(default="", description="Variants whose traces are kept: worst:K, random:K, all or none.")
    errors: tuple[str, ...] = Field(default=(), description="Codes of warnings that are errors; `all`: every warning.")
    allowed: tuple[str, ...] = Field(default=(), description="Codes of warnings that stay warnings nevertheless.")
    time_limit: float | None = Field(default=None, gt=0, description="Greatest time that a variant may take, s.")
    interpreted: bool = Field(default=False, description="Run variants without a camera in the interpreted engine.")

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
