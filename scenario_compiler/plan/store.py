"""The file format of plans (plan.json), and the digest."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace, did_you_mean
from scenario_compiler.document import UNREADABLE
from scenario_compiler.expressions import Expression
from scenario_compiler.files import read_file
from scenario_compiler.outputs import write_whole
from scenario_compiler.plan.model import Plan
from scenario_compiler.records import Record
from scenario_compiler.vocabulary.grammar import limits_broken

UNDECLARED = Code(
    "SC132",
    "undeclared-in-plan",
    "An expression in a plan names a parameter that the plan does not declare, so it has no value. Plans are written "
    "by `compile`; a plan that was changed by hand or by a program must declare the parameters that it uses.\n\n"
    '    "speed": {"expr": "$v"}     and no parameter v in "parameters"',
)
BAD_PLAN = Code(
    "SC130",
    "unreadable-plan",
    "The file is not a plan of this version: it is not JSON, lacks a field or has one that plans do not have. Compile "
    "the scenario again."
    "\n\n    scenario-compiler compile conflict.xml -o plan.json     writes one that can be read",
)


_NOT_UTF_8 = re.compile("[\udc80-\udcff]")
"""Python's characters for the bytes of a file's name that are not UTF-8 (PEP 383)."""

OUTSIDE = ("limits", "origins", "derived", "digest")
"""Parts of a plan that its digest does not cover, because they do not affect a run."""


def digest_of(plan: Plan) -> str:
    """Return the SHA-256 of the plan's canonical JSON, without the parts that are `OUTSIDE` it."""
    content = {name: value for name, value in vars(plan).items() if name not in OUTSIDE}
    content["map"] = {name: value for name, value in vars(plan.map).items() if name != "file"}
    canonical = json.dumps(content, default=_plain, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(canonical.encode(errors="backslashreplace")).hexdigest()


def sealed(plan: Plan) -> Plan:
    """Return a plan with its digest."""
    return plan.model_copy(update={"digest": digest_of(plan)})


def write_plan(plan: Plan, path: str | Path) -> None:
    """Write a plan as JSON."""
    write_whole(path, plan_text(plan) + "\n")


def plan_text(plan: Plan) -> str:
    """Return a plan as JSON; a byte of a file's name that is not UTF-8 becomes an escape, because JSON is Unicode."""
    text = json.dumps(plan, default=_plain, indent=1, ensure_ascii=False)
    return _NOT_UTF_8.sub(lambda found: f"\\\\u{ord(found[0]):04x}", text)


def _plain(value: Record | Expression) -> dict[str, Any]:
    """Return a record or an expression as JSON values; creating pydantic's serializers would take longer."""
    return {"expr": value.text} if isinstance(value, Expression) else vars(value)


def read_plan(path: str | Path, sink: Diagnostics) -> Plan | None:
    """Read a plan; report each fault and return None if it is not a plan.

    Its digest is that of its content, also if the file states another one because somebody has edited it.
    """
    try:
        raw = read_file(path)
    except OSError as error:
        sink.add(UNREADABLE, f"cannot read the file: {error.strerror}", FilePlace(str(path)))
        return None
    except ValueError:
        sink.add(UNREADABLE, "cannot read the file: no file can have such a name", FilePlace(str(path)))
        return None
    plan = _parsed(raw, FilePlace(str(path)), sink)
    if plan is not None:
        _check_parameters(plan, FilePlace(str(path)), sink)
        _check_ego(plan, FilePlace(str(path)), sink)
        for word in (plan.controller, None if plan.controller is None else plan.controller.detector):
            if word is not None:  # a relative path of a Python file starts from the folder of the file that names it
                word.written_at(FilePlace(str(path)))
    return None if plan is None or sink.has_errors else sealed(plan)


def _parsed(raw: bytes, place: FilePlace, sink: Diagnostics) -> Plan | None:
    try:
        content = json.loads(raw)
    except (ValueError, RecursionError) as error:
        line, column = (error.lineno, error.colno) if isinstance(error, json.JSONDecodeError) else (0, 0)
        why = error.msg if isinstance(error, json.JSONDecodeError) else "it is not text, or nested too deeply"
        sink.add(BAD_PLAN, f"the file is not a plan: it is not JSON: {why}", FilePlace(place.file, line, column))
        return None
    if not isinstance(content, dict) or content.get("format") != Plan.model_fields["format"].default:
        sink.add(BAD_PLAN, "the file is not a plan: it is JSON, but not marked as a plan of this version", place)
        return None
    from pydantic import ValidationError

    try:
        return Plan.model_validate_json(raw)
    except ValidationError as error:
        for fault in error.errors(include_url=False):
            where = "/".join(str(part) for part in fault["loc"])
            sink.add(BAD_PLAN, f"{where or 'plan'}: {fault['msg']}", place)
    except (ValueError, RecursionError) as error:
        sink.add(BAD_PLAN, f"the file is not a plan: {error}", place)
    return None


def _check_parameters(plan: Plan, place: FilePlace, sink: Diagnostics) -> None:
    """Report names in the plan's expressions that are not parameters of the plan."""
    declared = {one.name for one in plan.parameters}
    for name in sorted(_names_in(plan) - declared):
        message = f"the plan uses a parameter '{name}' that it does not declare"
        sink.add(UNDECLARED, message, place, hint=did_you_mean(name, declared))


def _check_ego(plan: Plan, place: FilePlace, sink: Diagnostics) -> None:
    """Report a controller without a vehicle, and a camera whose images cannot be made."""
    if plan.controller is not None and not plan.entities:
        sink.add(BAD_PLAN, "entities: a plan with a controller needs a vehicle that it drives", place)
    for broken in limits_broken(plan.camera, {}):
        sink.add(BAD_PLAN, f"camera: {broken}", place)


def _names_in(value: object) -> set[str]:
    """Return the names of the parameters on which expressions anywhere in a plan depend."""
    if isinstance(value, Expression):
        return set(value.names)
    if isinstance(value, Record):
        return _names_in(tuple(vars(value).values()))
    if isinstance(value, dict):
        return _names_in(tuple(value.values()))
    if isinstance(value, tuple):
        return set().union(*map(_names_in, value))
    return set()
