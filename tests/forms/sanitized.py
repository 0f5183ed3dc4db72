"""Runs the two-form programs on a build that checks indices and overflows, and what the compiler's sanitizers check.

`python tests/forms/sanitized.py FOLDER [-fsanitize=...]` builds it there, with the compiler's options that are given.
With some, the process starts itself again with the address sanitizer's library loaded first, which Python itself is not
linked with.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = 12
FLAGS = ("-O0", "-DENGINE_CHECKED")


def start_with_sanitizer() -> None:
    """Start again with the runtime of the address sanitizer, where the compiler has one."""
    found = subprocess.run(["gcc", "-print-file-name=libasan.so"], capture_output=True, text=True, check=True)
    settings = {"LD_PRELOAD": found.stdout.strip(), "ASAN_OPTIONS": "detect_leaks=0"}
    os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **settings})


def main(folder: Path, *sanitizers: str) -> int:
    """Build, run, compare; return the exit code."""
    from scenario_compiler.engine.columns.state import make_draws
    from scenario_compiler.engine.simulation import Simulation
    from scenario_compiler.forms.language import entries, marked_functions
    from scenario_compiler.forms.machine_code import MachineCode
    from scenario_compiler.forms.making import build
    from scenario_compiler.forms.note import Note
    from scenario_compiler.forms.translation import translated
    from tests.engine.test_two_forms import STEPS, VARIANTS, random_draft, variants_of

    path = folder / "checked.so"
    build(translated(marked_functions(), entries()), path, *FLAGS, *sanitizers)
    note = Note.read()
    assert note is not None
    checked = MachineCode(path, note.entries, note.made_by)
    same = 0
    for number in range(PROGRAMS):
        draft = random_draft(number)
        program, tables = draft.done(), draft.network.tables
        rows, draws = variants_of(draft, number), [make_draws(number, k) for k in range(VARIANTS)]
        usual = Simulation(tables, program).sweep(rows, draws, STEPS, STEPS + 1)
        strict = Simulation(tables, program, machine_code=checked).sweep(rows, draws, STEPS, STEPS + 1)
        same += sum(
            a.tobytes() + b.tobytes() == c.tobytes() + d.tobytes() for a, b, c, d in zip(*usual, *strict, strict=True)
        )
    print(f"{same} of {PROGRAMS * VARIANTS} variants are the same")
    return 0 if same == PROGRAMS * VARIANTS else 1


if __name__ == "__main__":
    if len(sys.argv) > 2 and "LD_PRELOAD" not in os.environ:
        start_with_sanitizer()
    sys.path.insert(0, str(ROOT))
    sys.exit(main(Path(sys.argv[1]), *sys.argv[2:]))
