"""Write the files of this folder from the models that they describe; with `--check`, say which are stale.

Run `python schemas/generate.py`, or `make generate`.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

from pydantic import BaseModel

from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.source.form import conflict_xsd

FOLDER = Path(__file__).resolve().parent


def json_schema(model: type[BaseModel]) -> str:
    """Return the JSON schema of a model's file form."""
    return json.dumps(model.model_json_schema(mode="serialization"), indent=1, sort_keys=True) + "\n"


GENERATED: dict[str, Callable[[], str]] = {
    "conflict.xsd": conflict_xsd,
    "events.schema.json": lambda: json_schema(EventRow),
    "outcome.schema.json": lambda: json_schema(Outcome),
    "plan.schema.json": lambda: json_schema(Plan),
}
"""File name to what writes its text."""


def main() -> int:
    """Write the files, or with `--check` compare them; return 1 when one is stale."""
    stale = [name for name, text in GENERATED.items() if not _is_fresh(FOLDER / name, text())]
    if "--check" in sys.argv[1:]:
        for name in stale:
            print(f"{name} is stale: `make generate` rewrites it")
        return 1 if stale else 0
    for name in stale:
        (FOLDER / name).write_text(GENERATED[name](), encoding="utf-8")
        print(f"wrote {name}")
    return 0


def _is_fresh(path: Path, text: str) -> bool:
    return path.is_file() and path.read_text(encoding="utf-8") == text


if __name__ == "__main__":
    sys.exit(main())
