"""Diagnostics in the formats that other programs read.

JSON, SARIF 2.1.0, GitHub's workflow commands, and the Code Quality report of GitLab.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Iterable, Iterator
from hashlib import blake2b
from pathlib import PurePath
from urllib.parse import quote

from scenario_compiler.diagnostics import Diagnostic, Place, Severity, as_record, as_text, position_text
from scenario_compiler.legible import legible_json, legible_line

FORMATS = ("text", "json", "sarif", "github", "gitlab")

_SARIF_LEVEL = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
_GITLAB_LEVEL = {Severity.ERROR: "major", Severity.WARNING: "minor", Severity.NOTE: "info"}
_GITHUB_LEVEL = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def formatted(diagnostics: Iterable[Diagnostic], form: str) -> str:
    """Return diagnostics in one of FORMATS; JSON and SARIF are complete documents even without diagnostics.

    Whatever files and their names contain, a terminal or a build service receives only printable characters, and no
    commands except those of the format `github`.
    """
    found = list(diagnostics)
    if form == "json":
        return legible_json(json.dumps([as_record(d) for d in found], indent=1, ensure_ascii=False))
    if form == "sarif":
        return legible_json(json.dumps(_sarif(found), indent=1, ensure_ascii=False))
    if form == "gitlab":
        return legible_json(json.dumps(_gitlab(found), indent=1, ensure_ascii=False))
    if form == "github":
        return "\n".join(map(_github, found))
    return "\n".join(as_text(d) for d in found)


def _gitlab(found: list[Diagnostic]) -> list[dict[str, object]]:
    """Return findings in the form of GitLab's Code Quality reports.

    GitLab keeps one finding for each fingerprint, and finds it again by the fingerprint after a change of the file. It
    therefore does not depend on the line, and counts the findings that are equal in all but the line.
    """
    counts: Counter[tuple[str, ...]] = Counter()
    issues: list[dict[str, object]] = []
    for d in found:
        what = (d.code.id, d.place.file, d.message, d.place.source_line.strip())
        told = "\0".join((*what, str(counts[what])) if counts[what] else what).encode("utf-8", "replace")
        counts[what] += 1
        issues.append(
            {
                "description": f"{d.message} ({d.hint})" if d.hint else d.message,
                "check_name": f"{d.code.id} {d.code.name}",
                "fingerprint": blake2b(told, digest_size=16).hexdigest(),
                "severity": _GITLAB_LEVEL[d.severity],
                "location": {"path": d.place.file, "lines": {"begin": max(d.place.line, 1)}},
            }
        )
    return issues


def _sarif(found: list[Diagnostic]) -> dict[str, object]:
    used = {d.code.id: d.code for d in found}
    rules = [{"id": c, "name": used[c].name, "fullDescription": {"text": used[c].explanation}} for c in sorted(used)]
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [
            {
                "tool": {"driver": {"name": "scenario-compiler", "rules": rules}},
                "columnKind": "unicodeCodePoints",
                "results": [_sarif_result(d) for d in found],
            }
        ],
    }


def _sarif_result(d: Diagnostic) -> dict[str, object]:
    text = f"{d.message} ({d.hint})" if d.hint else d.message
    result: dict[str, object] = {
        "ruleId": d.code.id,
        "level": _SARIF_LEVEL[d.severity],
        "message": {"text": text},
        "locations": [_sarif_location(d.place)],
    }
    others = [_sarif_location(place) | {"message": {"text": message}} for message, place in _others(d)]
    return result | {"relatedLocations": others} if others else result


def _others(d: Diagnostic) -> Iterator[tuple[str, Place]]:
    """Yield the other places of a finding with their meanings: the uses that led to it, and related places."""
    yield from (("in this use", use) for use in d.chain())
    yield from ((one.message, one.place) for one in d.related)


def _sarif_location(place: Place) -> dict[str, object]:
    region = {"startLine": max(place.line, 1), "startColumn": max(place.column, 1)}
    if place.column > 0 < place.length:
        region["endColumn"] = place.column + place.length
    return {"physicalLocation": {"artifactLocation": {"uri": _uri(place.file)}, "region": region}}


def _uri(file: str) -> str:
    """Return a reference to a file according to RFC 3986, whatever characters its name contains."""
    path = PurePath(file)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))


def _github(d: Diagnostic) -> str:
    def escaped(text: str) -> str:
        return legible_line(text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A"))

    text = f"{d.message} ({d.hint})" if d.hint else d.message
    text = "\n".join([text, *(f"{message}: {position_text(place)}" for message, place in _others(d))])
    file = escaped(d.place.file).replace(":", "%3A").replace(",", "%2C")
    position = f"file={file},line={max(d.place.line, 1)},col={max(d.place.column, 1)}"
    return f"::{_GITHUB_LEVEL[d.severity]} {position},title={d.code.id}::{escaped(text)}"
