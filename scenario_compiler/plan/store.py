"""The plan's file form (plan.json) and its digest."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace
from scenario_compiler.expressions import Expression
from scenario_compiler.files import read_file
from scenario_compiler.outputs import write_whole
from scenario_compiler.plan.model import Plan

BAD_PLAN = Code(
    "SC130",
    "unreadable-plan",
    "The file is not a plan of this version: it is not JSON, lacks a field or has one that plans do not have. Compile "
    "the scenario again."
    "\n\n    scenario-compiler compile conflict.xml -o plan.json     writes one that can be read",
)


def digest_of(plan: Plan) -> str:
    """Return the SHA-256 of the plan's canonical JSON, without provenance, derived values and the digest itself."""
    content = {name: value for name, value in vars(plan).items() if name not in ("origins", "derived", "digest")}
    content["map"] = {name: value for name, value in vars(plan.map).items() if name != "file"}
    canonical = json.dumps(content, default=_plain, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def sealed(plan: Plan) -> Plan:
    """Return a plan with its digest."""
    return plan.model_copy(update={"digest": digest_of(plan)})


def write_plan(plan: Plan, path: str | Path) -> None:
    """Write a plan as JSON."""
    text = json.dumps(plan, default=_plain, indent=1, ensure_ascii=False)
    write_whole(path, text + "\n")


def _plain(value: BaseModel | Expression) -> dict[str, Any]:
    """Return a model or an expression as JSON has it; pydantic's serializers of all words take longer to make."""
    return {"expr": value.text} if isinstance(value, Expression) else vars(value)


def read_plan(path: str | Path, sink: Diagnostics) -> Plan | None:
    """Read a plan; None and a diagnostic for each fault when it is none."""
    try:
        return Plan.model_validate_json(read_file(path))
    except OSError as error:
        sink.add(BAD_PLAN, f"cannot read the plan: {error.strerror}", FilePlace(str(path)))
    except ValidationError as error:
        for fault in error.errors(include_url=False)[:20]:
            where = "/".join(str(part) for part in fault["loc"])
            sink.add(BAD_PLAN, f"{where or 'plan'}: {fault['msg']}", FilePlace(str(path)))
    return None
