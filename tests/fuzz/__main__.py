"""`make fuzz`: mutants of real files through `validate` and `compile`, and short runs of those that compile.

    python -m tests.fuzz --slice 3/10 --mutants 20000 --runs 3000

does the third tenth of the whole. A mutant depends on its number alone, so that a slice is the same everywhere and a
fault can be looked at again: `--only 1234` does one mutant and keeps its file. With SCENARIO_COMPILER_CORPUS the files
of the corpus are mutated too; what they name is found beside them.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from tests.fuzz.mutants import Mirrors, Mutant, mutant, originals
from tests.fuzz.trial import Trial, run_trial

WHAT_IS_DONE = {"mutants": ("validate", "compile"), "runs": ("run",)}


def main() -> int:
    """Do a slice and print its figures; return 1 when a mutant was not dealt with cleanly."""
    options = _options()
    corpus = os.environ.get("SCENARIO_COMPILER_CORPUS")
    sources = originals(Path(__file__).resolve().parent.parent.parent, Path(corpus) if corpus else None)
    resource.setrlimit(resource.RLIMIT_AS, (options.memory * 2**30, resource.RLIM_INFINITY))
    folder = tempfile.TemporaryDirectory()
    os.environ["XDG_CONFIG_HOME"] = folder.name
    mirrors, faults = Mirrors(Path(folder.name)), 0
    for kind, commands in WHAT_IS_DONE.items():
        total = getattr(options, kind)
        numbers = [options.only] if options.only is not None else _slice(total, options.slice)
        started = time.process_time()
        results: Counter[str] = Counter()
        slowest = (0.0, "")
        for number in numbers:
            made = mutant(number, kind, sources, mirrors)
            trial = run_trial(made, commands)
            results.update(trial.results)
            slowest = max(slowest, (trial.seconds, made.name))
            faults += len(trial.faults)
            _tell(made, trial, keep=options.only is not None)
        spent = time.process_time() - started
        print(f"{kind}: {len(numbers)} of {total}, {spent:.0f} s of CPU, slowest {slowest[0]:.1f} s ({slowest[1]})")
        print("  " + ", ".join(f"{name}: {count}" for name, count in sorted(results.items())))
    folder.cleanup()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"faults: {faults}; peak memory {peak:.0f} MB; {len(sources)} originals")
    return 1 if faults else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__.partition("\n")[0])
    parser.add_argument("--mutants", type=int, default=20_000, metavar="N", help="mutants through validate and compile")
    parser.add_argument("--runs", type=int, default=3_000, metavar="N", help="mutants that are run")
    parser.add_argument("--slice", default="1/1", metavar="K/N", help="do the K-th of N equal parts")
    parser.add_argument("--only", type=int, metavar="NUMBER", help="do one mutant of each kind and keep its file")
    parser.add_argument("--memory", type=int, default=8, metavar="GB", help="address space that the process may take")
    return parser.parse_args()


def _slice(total: int, text: str) -> range:
    part, _, parts = text.partition("/")
    return range(int(part) - 1, total, int(parts))


def _tell(made: Mutant, trial: Trial, *, keep: bool) -> None:
    for fault in trial.faults:
        print(f"{made.name}: {fault}", file=sys.stderr)
    if keep:
        kept = Path(tempfile.mkdtemp()) / made.path.name
        kept.write_bytes(made.content)
        print(f"{made.name}: {kept}")


if __name__ == "__main__":
    sys.exit(main())
