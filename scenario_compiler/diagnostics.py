"""Diagnostics are values: codes, the places they speak of, the sink that collects them, and their text forms.

An author's mistake never raises out of a stage. A stage adds a `Diagnostic` to a `Diagnostics` sink and goes on; only
`compile_scenario` raises `CompileError` at its end. Codes are declared beside the check that reports them.
"""

from __future__ import annotations

import difflib
import enum
import importlib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeAlias

from scenario_compiler.legible import legible, legible_line


class Severity(enum.Enum):
    """How much a diagnostic weighs: an error stops the compilation after the stage, the others do not."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Place(Protocol):
    """A place in a source file. Columns are found only when asked for (see `document.Origin`)."""

    @property
    def file(self) -> str:
        """Path of the file as the user named it."""
        ...

    @property
    def line(self) -> int:
        """Line, counted from 1; 0 when the diagnostic speaks of the whole file."""
        ...

    @property
    def column(self) -> int:
        """Column, counted from 1; 0 when unknown."""
        ...

    @property
    def length(self) -> int:
        """Number of characters that the place covers, 0 when unknown."""
        ...

    @property
    def source_line(self) -> str:
        """Text of the line, empty when unknown."""
        ...

    @property
    def within(self) -> Place | None:
        """The use (of a template, an include, a catalog) that brought this place in."""
        ...


@dataclass(frozen=True, slots=True)
class FilePlace:
    """A place given by numbers, for whole files and for places read back from a plan."""

    file: str
    line: int = 0
    column: int = 0
    length: int = 0
    source_line: str = ""
    within: Place | None = None


@dataclass(frozen=True, slots=True)
class Code:
    """A kind of diagnostic.

    Attributes:
        id: "SC" and three digits: 1xx reading, 2xx names and references, 3xx roads and positions, 4xx storyboard,
            5xx controllers and takeover, 6xx running, 9xx part of a standard that is not supported.
        name: The fault in kebab case, e.g. "unknown-lane".
        explanation: The page that `scenario-compiler explain` prints: what it means, why it matters, what to do.
        severity: What it weighs unless the command line moves it.
    """

    id: str
    name: str
    explanation: str
    severity: Severity = Severity.ERROR

    def __post_init__(self) -> None:
        """Register the code; two codes with one id are a programming error."""
        if self.id in CODES:
            raise ValueError(f"diagnostic code {self.id} is declared twice")
        CODES[self.id] = self


CODES: dict[str, Code] = {}
"""The codes of all modules that have been loaded, by their ids."""

CODE_HOMES = (
    "cli.run",
    "engine.at_first",
    "engine.program.surrogate",
    "roads.check",
    "roads.parse",
    "roads.xsd",
    "runtime.failures",
    "source.aisa",
    "source.study",
    "openscenario.export.files",
    "openscenario.validation",
    "openscenario.xsd",
    "recording.break_off",
    "validation",
    "worlds.carla",
    "worlds.model",
)
"""Modules that bring in all others that declare codes. They are loaded only for who asks about a code by its name."""


def all_codes() -> Mapping[str, Code]:
    """Return every code that there is by its id, whatever has been loaded so far."""
    for home in CODE_HOMES:
        importlib.import_module(f"scenario_compiler.{home}")
    return CODES


def code_named(text: str) -> Code | None:
    """Return the code with an id, in capitals or not; None when there is none."""
    name = text.strip().upper()
    return CODES.get(name) or all_codes().get(name)


@dataclass(frozen=True, slots=True)
class Related:
    """Another place that a finding speaks of, and what is there."""

    message: str
    place: Place


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding: what is wrong, where, what the author can do about it, and which other places it speaks of."""

    code: Code
    message: str
    place: Place
    hint: str = ""
    severity: Severity = Severity.ERROR
    related: tuple[Related, ...] = ()

    def chain(self) -> Iterator[Place]:
        """Yield the uses that brought the place in, innermost first."""
        place = self.place.within
        while place is not None:
            yield place
            place = place.within


MANY_FINDINGS = Code(
    "SC307",
    "many-findings",
    "The file has too many faults of one kind to list: 100 of each kind are shown, the others are only counted.\n\n"
    '    <lane id="-1" typ="driving">...</lane>     in each of 2000 lanes: 1900 are counted\n\n'
    "So many equal faults usually have a single cause, such as the program that wrote the file or the version in "
    "its header. Correct the cause, and check the file again.",
    Severity.WARNING,
)

MOST_OF_A_KIND = 100
"""Most findings of one code and severity that are kept of a file; the others are counted."""

LONGEST_TEXT = 2000
"""Most characters of a message or a hint; an attribute that it repeats may have many megabytes."""


@dataclass(slots=True)
class _Beyond:
    """Findings of a kind that are counted alone: the first of them, their number, and what is kept of the kind."""

    first: Diagnostic
    kept: frozenset[tuple[object, ...]]
    count: int = 0


@dataclass(slots=True)
class Diagnostics:
    """The sink that every stage reports into. Its size is bounded: of each file, code and severity it keeps some.

    Attributes:
        found: What was reported and is kept. Findings go in by `add`, `take` and `absorb`, which keep it bounded.
        insisted: Codes of warnings that whoever asks wants to know of, even where a file allows them.
        reported: Number of findings that were reported so far, kept or not.
    """

    found: list[Diagnostic] = field(default_factory=list)
    insisted: frozenset[str] = frozenset()
    reported: int = 0
    _kept: dict[_Kind, int] = field(default_factory=dict)
    _beyond: dict[_Kind, _Beyond] = field(default_factory=dict)

    def add(
        self,
        code: Code,
        message: str,
        place: Place,
        *,
        hint: str = "",
        severity: Severity | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        """Report one finding with the code's severity, unless another is given."""
        self.take((Diagnostic(code, _bounded(message), place, _bounded(hint), severity or code.severity, related),))

    def take(self, findings: Iterable[Diagnostic]) -> None:
        """Report findings made elsewhere."""
        for one in findings:
            self.reported += 1
            kind = _kind_of(one)
            if self._kept.get(kind, 0) >= MOST_OF_A_KIND and kind not in self._beyond:
                self._drop_repeated(kind)
                if self._kept[kind] >= MOST_OF_A_KIND:
                    same = [_rough_spot(other) for other in self.found if _kind_of(other) == kind]
                    told_apart = len(set(same)) == len(same)
                    self._beyond[kind] = _Beyond(one, frozenset(same if told_apart else ()))
            if kind not in self._beyond:
                self._kept[kind] = self._kept.get(kind, 0) + 1
                self.found.append(one)
            elif _rough_spot(one) not in self._beyond[kind].kept:
                self._beyond[kind].count += 1

    def _drop_repeated(self, kind: _Kind) -> None:
        """Drop findings of a kind that say the same of the same place, as each use of a faulty template does."""
        found, seen = [], set()
        for one in self.found:
            spot = (one.place.line, one.place.column, one.message)
            if _kind_of(one) == kind:
                if spot in seen:
                    continue
                seen.add(spot)
            found.append(one)
        self.found[:] = found
        self._kept[kind] = len(seen)

    def absorb(self, other: Diagnostics) -> None:
        """Report all findings of another sink."""
        self.take(other.found)
        self.reported += other.reported - len(other.found)
        for kind, beyond in other._beyond.items():
            self._beyond.setdefault(kind, _Beyond(beyond.first, beyond.kept)).count += beyond.count

    def retain(self, wanted: Callable[[Diagnostic], bool]) -> None:
        """Take back all findings but those that are wanted."""
        self.found[:] = [one for one in self.found if wanted(one)]
        self._beyond = {kind: beyond for kind, beyond in self._beyond.items() if wanted(beyond.first)}

    @property
    def has_errors(self) -> bool:
        """True when at least one finding is an error."""
        return any(one.severity is Severity.ERROR for one in self.found)

    def __iter__(self) -> Iterator[Diagnostic]:
        """Yield the findings by file, line and column, each once, and how many of a kind are not kept."""
        unique = {(d.place.file, d.place.line, d.place.column, d.code.id, d.message): d for d in self.found}
        for key in sorted(unique):
            yield unique[key]
        for (file, code, _), beyond in self._beyond.items():
            if not beyond.count:
                continue
            message = f"{beyond.count} more findings of {code} are not listed"
            yield Diagnostic(MANY_FINDINGS, message, FilePlace(file), severity=MANY_FINDINGS.severity)


_Kind: TypeAlias = tuple[str, str, Severity]
"""File, id of the code, severity."""


def _kind_of(one: Diagnostic) -> _Kind:
    return one.place.file, one.code.id, one.severity


def _rough_spot(one: Diagnostic) -> tuple[object, ...]:
    """Return what tells findings of a kind apart well enough to count them, without looking for a column."""
    element = getattr(one.place, "element", None)
    if element is None:
        return one.message, one.place.line, one.place.column
    return one.message, element.sourceline, getattr(one.place, "attribute", None)


def _bounded(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}..."


def weighed(
    found: Iterable[Diagnostic], errors: Collection[str], allowed: Collection[str], *, strict: bool = False
) -> Iterator[Diagnostic]:
    """Yield findings as someone wants them weighed.

    Args:
        found: The findings.
        errors: Codes that are errors, or `all` for every warning.
        allowed: Codes that are left out, but for errors.
        strict: Every warning is an error.
    """
    for one in found:
        if one.code.id in allowed and one.severity is not Severity.ERROR:
            continue
        lifted = one.severity is Severity.WARNING and (strict or "all" in errors)
        yield replace(one, severity=Severity.ERROR) if lifted or one.code.id in errors else one


class CompileError(Exception):
    """The input is at fault; `diagnostics` says how."""

    def __init__(self, diagnostics: Diagnostics) -> None:
        """Keep the diagnostics and put the errors' texts into the message."""
        self.diagnostics = diagnostics
        super().__init__("\n".join(as_text(d) for d in diagnostics if d.severity is Severity.ERROR))


MOST_COMPARED = 200
"""Most names that a word is compared with; among more, those that begin alike."""

MOST_KNOWN = 2000
"""Most names among which one is looked for: a file that has more may have as many faults."""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return a hint naming the nearest of `known`, or listing them when none is near and they are few.

    A name that is empty, as where an author has left it out, is not offered.
    """
    offered = list(known)
    if len(offered) > MOST_KNOWN:
        return ""
    names = sorted({name for name in offered if name.strip()})
    alike = names if len(names) <= MOST_COMPARED else [name for name in names if name[:1] == word[:1]][:MOST_COMPARED]
    near = difflib.get_close_matches(word, alike, n=1, cutoff=0.6)
    if near:
        return f"did you mean '{near[0]}'?"
    if 0 < len(names) <= 12:
        return "known: " + ", ".join(names)
    return ""


WIDEST_LINE = 240
"""Most characters that are shown of a source line: a file may be one line of many megabytes, with many findings."""


def as_text(diagnostic: Diagnostic) -> str:
    """Format as a compiler does: position, code, message, the source line with carets, hint, chain, other places.

    Whatever the file and its name are made of, each is a line, and all characters can be seen.
    """
    place = diagnostic.place
    lines = [f"{position_text(place)}: {diagnostic.severity.value}[{diagnostic.code.id}]: {diagnostic.message}"]
    lines.extend(_source(place))
    if diagnostic.hint:
        lines.append(f"      = help: {diagnostic.hint}")
    lines.extend(f"      = in this use: {position_text(use)}" for use in diagnostic.chain())
    for other in diagnostic.related:
        lines.append(f"      = {other.message}: {position_text(other.place)}")
        lines.extend(_source(other.place))
    return "\n".join(map(legible_line, lines))


def _source(place: Place) -> Iterator[str]:
    """Yield the line of a place and the carets below it, where they are known."""
    if place.source_line:
        gutter = f"{place.line:>5} | "
        text, before = _excerpt(place)
        ahead, marked = text[:before], text[before : before + max(1, place.length)]
        left, middle, right = (
            legible(part.replace("\t", " ")) for part in (ahead, marked, text[before + len(marked) :])
        )
        yield gutter + left + middle + right
        if place.column:
            yield " " * (len(gutter) + len(left)) + "^" * max(1, len(middle))


def _excerpt(place: Place) -> tuple[str, int]:
    """Return what is shown of a place's line, and the number of characters before the place in it."""
    text, before = place.source_line, max(0, place.column - 1)
    if len(text) <= WIDEST_LINE:
        return text, before
    start = max(0, before - WIDEST_LINE // 4)
    left, right = "..." * (start > 0), "..." * (start + WIDEST_LINE < len(text))
    return left + text[start : start + WIDEST_LINE] + right, before - start + len(left)


def as_record(diagnostic: Diagnostic) -> dict[str, object]:
    """Return the diagnostic as plain values for JSON."""
    place = diagnostic.place
    return {
        "code": diagnostic.code.id,
        "name": diagnostic.code.name,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "file": place.file,
        "line": place.line,
        "column": place.column,
        "length": place.length,
        "hint": diagnostic.hint,
        "chain": [{"file": use.file, "line": use.line, "column": use.column} for use in diagnostic.chain()],
        "related": [
            {"message": one.message, "file": one.place.file, "line": one.place.line, "column": one.place.column}
            for one in diagnostic.related
        ],
    }


def position_text(place: Place) -> str:
    """Return a place as FILE:LINE:COLUMN, without what is not known."""
    parts = [place.file]
    if place.line:
        parts.append(str(place.line))
        if place.column:
            parts.append(str(place.column))
    return ":".join(parts)
