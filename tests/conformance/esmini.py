"""Runs of OpenSCENARIO files against trajectories recorded from esmini 3.6, entity by entity and step by step.

There are two sets of recorded runs: of the scenarios that come with esmini and of ASAM's examples, which are in the
corpus, and of scenarios that were written to show one variant of one feature each.

`python -m tests.conformance.esmini [part of a name ...]` prints one line a run and a summary.
"""

from __future__ import annotations

import csv
import gzip
import math
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import FAULT_NONE, STOP_NONE
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step

STEP = 0.05
LONGEST = 60.0
"""How the trajectories were recorded: length of a step and of the longest run, s."""

FAR_APART = 0.1
TOO_FAST = 0.05
"""Greatest differences of a run that agrees: of position, m, and of speed, m/s."""

STEPS_APART = 2
"""Greatest difference of the ends of two runs that agree, steps."""


@dataclass(frozen=True)
class Worst:
    """The greatest difference of one quantity in a run: how much, when, and whose."""

    size: float = 0.0
    time: float = 0.0
    entity: str = ""

    def __str__(self) -> str:
        """Say it in a few words."""
        return f"{self.size:.4g} ({self.entity} at {self.time:g} s)" if self.entity else f"{self.size:.4g}"


@dataclass(frozen=True)
class Comparison:
    """One run beside its recorded one.

    Attributes:
        scenario: Name of the recorded run.
        error: Why there is no run; empty when there is one.
        position: Greatest difference of position, m.
        speed: Greatest difference of speed, m/s.
        heading: Greatest difference of heading, rad.
        rows: Rows that only one of both has: entities that are there in one only.
        steps: How many steps later than esmini the run ended.
    """

    scenario: str
    error: str = ""
    position: Worst = Worst()
    speed: Worst = Worst()
    heading: Worst = Worst()
    rows: int = 0
    steps: int = 0

    @property
    def agrees(self) -> bool:
        """Whether the run agrees with the recorded one."""
        near = self.position.size <= FAR_APART and self.speed.size <= TOO_FAST
        return not self.error and near and self.rows == 0 and abs(self.steps) <= STEPS_APART

    def __str__(self) -> str:
        """One line: what agrees, and the greatest differences."""
        name = self.scenario.rpartition("/")[2]
        if self.error:
            return f"FAIL {name}: {self.error}"
        told = f"position {self.position}, speed {self.speed}, heading {self.heading}, end {self.steps:+d} steps"
        if self.rows:
            told += f", {self.rows} rows of one only"
        return f"{'ok  ' if self.agrees else 'FAIL'} {name}: {told}"


Row = tuple[float, float, float, float]
"""x, y, heading and speed."""


FEATURES = "esmini_features"
"""Folder of the runs of one feature each, beside that of the others, and what their names begin with."""


@dataclass(frozen=True)
class RecordedRun:
    """A run that esmini has recorded.

    Attributes:
        name: Path of the scenario in the corpus, or in the folder of features with that folder's name before it.
        scenario: Where the scenario is.
        rows: Where the recorded rows are.
        maps: Folders in which its road is looked for beside the scenario's own.
    """

    name: str
    scenario: Path
    rows: Path
    maps: tuple[Path, ...] = ()

    @property
    def of_a_feature(self) -> bool:
        """Whether the scenario was written to show one variant of one feature."""
        return self.name.startswith(FEATURES)


def recorded_runs(corpus: Path) -> Iterator[RecordedRun]:
    """Yield the recorded runs in which no controller of esmini's own drives, those of one feature each last."""
    golden = corpus.parent / "golden" / "esmini"
    for row in _manifest(golden):
        if row["esmini_controllers"] == "no":
            file = corpus / row["scenario"]
            yield RecordedRun(row["scenario"], file, golden / row["golden"], tuple(map_folders(corpus)))
    features = golden.parent / FEATURES
    for row in _manifest(features):
        file = features / row["scenario"]
        yield RecordedRun(f"{FEATURES}/{row['scenario']}", file, features / "golden" / row["golden"])


def _manifest(folder: Path) -> list[dict[str, str]]:
    with (folder / "MANIFEST.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def recorded(path: Path, length: float = STEP) -> list[dict[str, Row]]:
    """Return the rows of a recorded run by step, of a length in s, and entity."""
    steps: list[dict[str, Row]] = []
    with gzip.open(path, "rt", encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            at = round(float(row["t"]) / length)
            while len(steps) <= at:
                steps.append({})
            steps[at][row["name"]] = (float(row["x"]), float(row["y"]), float(row["h"]), float(row["v"]))
    return steps


def map_folders(corpus: Path) -> list[Path]:
    """Return the folders in which esmini looks for maps beside the scenario's own."""
    return [corpus / "esmini" / "EnvironmentSimulator" / "Unittest" / "xodr", corpus / "esmini" / "resources" / "xodr"]


def simulated(scenario: Path, maps: Sequence[Path], length: float = STEP) -> list[dict[str, Row]] | str:
    """Return the rows of our run by step, of a length in s, and entity, or why there is none."""
    sink = Diagnostics()
    overrides = Overrides(perception="ideal", step=length, duration=LONGEST)
    done = compile_target(scenario, {}, sink, maps=list(maps), overrides=overrides)
    if done is None:
        first = next(one for one in sink if one.severity.name == "ERROR")
        return f"{first.code.id} line {first.place.line}: {first.message}"
    program = build_program(done.plan, done.network)
    state = new_state(program)
    state.draw[:] = make_draws(1, 0)
    names = [entity.id for entity in done.plan.entities]
    reset(done.network.tables, program, state)
    steps: list[dict[str, Row]] = []
    going = 1
    while going:
        steps.append(
            {name: (state.x[i], state.y[i], state.h[i], state.v[i]) for i, name in enumerate(names) if state.present[i]}
        )
        going = step(done.network.tables, program, state) if state.stop[0] == STOP_NONE else 0
    if state.flag[0] != FAULT_NONE:
        return f"fault {state.flag[0]} of {state.flag_at[0]} at {state.clock[0]:g} s"
    return steps


def compare(scenario: str, ours: list[dict[str, Row]] | str, theirs: list[dict[str, Row]]) -> Comparison:
    """Return how far a run is from the recorded one."""
    if isinstance(ours, str):
        return Comparison(scenario, ours)
    worst = {"position": Worst(), "speed": Worst(), "heading": Worst()}
    rows = 0
    for at, (mine, other) in enumerate(zip(ours, theirs, strict=False)):
        rows += len(mine.keys() ^ other.keys())
        for name in sorted(mine.keys() & other.keys()):
            x, y, h, v = mine[name]
            there_x, there_y, there_h, there_v = other[name]
            sizes = {
                "position": math.hypot(x - there_x, y - there_y),
                "speed": abs(v - there_v),
                "heading": abs(math.remainder(h - there_h, math.tau)),
            }
            for quantity, size in sizes.items():
                if size > worst[quantity].size:
                    worst[quantity] = Worst(size, at * STEP, name)
    steps = len(ours) - len(theirs)
    return Comparison(scenario, "", worst["position"], worst["speed"], worst["heading"], rows, steps)


def comparisons(corpus: Path, parts: list[str]) -> Iterator[Comparison]:
    """Yield the comparison of every run whose name holds one of the parts; of all when there are none."""
    for run in recorded_runs(corpus):
        if not parts or any(part in run.name for part in parts):
            yield compare(run.name, simulated(run.scenario, run.maps), recorded(run.rows))


def main() -> None:
    """Print one line a run and a summary."""
    done = []
    for comparison in comparisons(Path(os.environ["SCENARIO_COMPILER_CORPUS"]), sys.argv[1:]):
        done.append(comparison)
        sys.stdout.write(f"{comparison}\n")
        sys.stdout.flush()
    sys.stdout.write(f"{sum(one.agrees for one in done)} of {len(done)} agree\n")


if __name__ == "__main__":
    main()
