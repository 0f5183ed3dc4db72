"""The folder of a study: the study to which it belongs, and a lock so that only one program writes to it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from scenario_compiler.outputs import LockedError, locked, make_folder, write_whole
from scenario_compiler.study_plans import StudyCompilation

MANIFEST = Path("sourcedata") / "study.json"

OPTIONS = {"pilot": "--pilot", "perception": "--perception", "step": "--dt"}
"""Entries of a manifest that options of the command give; version 0.1.0 did not write all of them."""


class StudyError(Exception):
    """A study's folder cannot be used; the message says why."""


def manifest_of(compilation: StudyCompilation, *, pilot: bool) -> dict[str, Any]:
    """Return what determines a study's data: its words, its questionnaires and pages, its options, and its plans."""
    plans = {name: done.plan for name, (_, done) in compilation.conditions.items()}
    plans |= {name: done.plan for name, done in compilation.others.items()}
    one = next(iter(plans.values()))
    parts = [compilation.study.model_dump_json()]
    parts += [form.model_dump_json() for form in compilation.file.questionnaires.values()]
    parts += [compilation.file.pages[name] for name in sorted(compilation.file.pages)]
    words = hashlib.sha256("\0".join(parts).encode()).hexdigest()
    return {
        "format": "scenario-compiler/study/1",
        "study": compilation.study.name,
        "pilot": pilot,
        "perception": one.perception,
        "step": one.step,
        "words": words,
        "plans": {name: plan.digest for name, plan in plans.items()},
    }


def kept_manifest(root: Path) -> dict[str, Any] | None:
    """Return the manifest in the folder of a study's data; None if it has none.

    Raises:
        StudyError: The file is damaged.
    """
    file = root / MANIFEST
    if not file.is_file():
        return None
    try:
        found = json.loads(file.read_bytes())
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict) or not isinstance(found.get("study"), str):
        raise StudyError(f"{file} is damaged: it does not describe a study")
    return found


def _other_data(kept: dict[str, Any], manifest: dict[str, Any]) -> str:
    """Return whose data a folder holds if its manifest is not that of the study."""
    other = [name for name in OPTIONS if kept.get(name, manifest[name]) != manifest[name]]
    if not other or kept.get("words") != manifest["words"]:
        return "another study, or of this one before it was changed"
    return f"this study with other options: {', '.join(_as_option(name, kept[name]) for name in other)}"


def _as_option(name: str, value: object) -> str:
    if isinstance(value, bool):
        return OPTIONS[name] if value else f"no {OPTIONS[name]}"
    return f"{OPTIONS[name]} {value}"


@contextmanager
def study_folder(root: Path, compilation: StudyCompilation, *, pilot: bool) -> Iterator[None]:
    """Own the folder of a study's data in this context; existing data are continued.

    Raises:
        StudyError: The folder contains something else, another study or a damaged one, or is in use.
        OSError: It cannot be written.
    """
    manifest = manifest_of(compilation, pilot=pilot)
    file = root / MANIFEST
    make_folder(root)
    kept = kept_manifest(root)
    if kept is not None:
        if manifest != {name: manifest[name] for name in OPTIONS} | kept:
            raise StudyError(f"{root} holds the data of {_other_data(kept, manifest)}")
    elif any(root.iterdir()):
        raise StudyError(f"{root} is not empty and contains no study")
    make_folder(file.parent)
    try:
        with locked(root / "sourcedata" / "study.lock"):
            if not file.is_file():
                write_whole(file, json.dumps(manifest, indent=1) + "\n")
            yield
    except LockedError as error:
        raise StudyError(f"{root} is in use by another program{error}") from None
