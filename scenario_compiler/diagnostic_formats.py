"""Diagnostics in the formats that other programs read: JSON, SARIF 2.1.0 and GitHub's workflow commands."""

from __future__ import annotations

import json
from collections.abc import Iterable

from scenario_compiler.diagnostics import CODES, Diagnostic, Severity, as_record, as_text

FORMATS = ("text", "json", "sarif", "github")

_SARIF_LEVEL = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
_GITHUB_LEVEL = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def formatted(diagnostics: Iterable[Diagnostic], form: str) -> str:
    """Return diagnostics in one of FORMATS; JSON and SARIF are whole documents even when there is none."""
    found = list(diagnostics)
    if form == "json":
        return json.dumps([as_record(d) for d in found], indent=1, ensure_ascii=False)
    if form == "sarif":
        return json.dumps(_sarif(found), indent=1, ensure_ascii=False)
    if form == "github":
        return "\n".join(_github(d) for d in found)
    return "\n".join(as_text(d) for d in found)


def _sarif(found: list[Diagnostic]) -> dict[str, object]:
    used = sorted({d.code.id for d in found})
    rules = [{"id": c, "name": CODES[c].name, "fullDescription": {"text": CODES[c].explanation}} for c in used]
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [
            {
                "tool": {"driver": {"name": "scenario-compiler", "rules": rules}},
                "results": [_sarif_result(d) for d in found],
            }
        ],
    }


def _sarif_result(d: Diagnostic) -> dict[str, object]:
    region = {"startLine": max(d.place.line, 1), "startColumn": max(d.place.column, 1)}
    text = f"{d.message} ({d.hint})" if d.hint else d.message
    return {
        "ruleId": d.code.id,
        "level": _SARIF_LEVEL[d.severity],
        "message": {"text": text},
        "locations": [{"physicalLocation": {"artifactLocation": {"uri": d.place.file}, "region": region}}],
    }


def _github(d: Diagnostic) -> str:
    def escaped(text: str) -> str:
        return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")

    text = f"{d.message} ({d.hint})" if d.hint else d.message
    file = escaped(d.place.file).replace(":", "%3A").replace(",", "%2C")
    position = f"file={file},line={max(d.place.line, 1)},col={max(d.place.column, 1)}"
    return f"::{_GITHUB_LEVEL[d.severity]} {position},title={d.code.id}::{escaped(text)}"
