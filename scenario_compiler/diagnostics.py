"""Diagnostics as values: their codes and places, the sink that collects them, and their formats as text.

A stage never raises an exception for an author's mistake. It adds a `Diagnostic` to a `Diagnostics` sink and continues;
only `compile_scenario` raises `CompileError` at its end. Codes are declared beside the check that reports them.
"""

from __future__ import annotations

import enum
import importlib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol, TypeAlias

from scenario_compiler.legible import legible, legible_line


class Severity(enum.Enum):
    """The severity of a diagnostic: an error ends the compilation after the current stage, the others do not."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Place(Protocol):
    """A place in a source file. The column is computed when it is first read (see `document.Origin`)."""

    @property
    def file(self) -> str:
        """Path of the file as the user named it."""
        ...

    @property
    def line(self) -> int:
        """Line, counted from 1; 0 if the diagnostic is about the whole file."""
        ...

    @property
    def column(self) -> int:
        """Column, counted from 1; 0 if unknown."""
        ...

    @property
    def length(self) -> int:
        """Number of characters that the place covers; 0 if unknown."""
        ...

    @property
    def source_line(self) -> str:
        """Text of the line; empty if unknown."""
        ...

    @property
    def within(self) -> Place | None:
        """The use of a template, an include or a catalog through which this place became part of the scenario."""
        ...


@dataclass(frozen=True, slots=True)
class FilePlace:
    """A place with known line and column, for whole files and for places in a stored plan."""

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
        explanation: The text that `scenario-compiler explain` prints: the meaning, the reason, and what to do.
        severity: The severity, which the command line can change.
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
    "controllers.camera_view",
    "engine.at_first",
    "engine.program.surrogate",
    "roads.check",
    "roads.model",
    "roads.parse",
    "roads.xsd",
    "runtime.engine_fault",
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
"""Modules that import all modules with codes. They are loaded only if a code is looked for by its name."""


def all_codes() -> Mapping[str, Code]:
    """Return all codes by their ids, also those of modules that have not been loaded yet."""
    for home in CODE_HOMES:
        importlib.import_module(f"scenario_compiler.{home}")
    return CODES


def code_named(text: str) -> Code | None:
    """Return the code with an id, in upper or lower case, or with a number alone; None if there is none."""
    name = text.strip().upper()
    name = f"SC{name}" if name.isdigit() else name
    return CODES.get(name) or all_codes().get(name)


class Related(NamedTuple):
    """Another place that a finding refers to, with a message about it."""

    message: str
    place: Place


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding: the fault, its place, a hint for the author, and other places that it refers to."""

    code: Code
    message: str
    place: Place
    hint: str = ""
    severity: Severity = Severity.ERROR
    related: tuple[Related, ...] = ()

    @property
    def identity(self) -> tuple[str, int, int, str, str]:
        """Place, code and message; two findings with the same identity are one, even if two files led to it."""
        place = self.place
        return place.file, place.line, place.column, self.code.id, self.message

    def chain(self) -> Iterator[Place]:
        """Yield the uses through which the place became part of the scenario, innermost first."""
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
"""Greatest number of findings with the same file, code and severity that are kept; the others are counted."""

LONGEST_TEXT = 2000
"""Greatest length of a message or a hint in characters; an attribute quoted in it may have many megabytes."""


@dataclass(slots=True)
class _Beyond:
    """Findings of a kind that are only counted: the first one, their number, and the places of those that are kept."""

    first: Diagnostic
    kept: frozenset[tuple[object, ...]]
    count: int = 0


@dataclass(slots=True)
class Diagnostics:
    """The sink to which every stage reports. Its size is bounded: it keeps `MOST_OF_A_KIND` findings of each kind.

    Attributes:
        found: The findings that are kept. `add`, `take` and `absorb` add findings and limit their number.
        insisted: Codes of warnings that are kept even if a file allows them.
        reported: Number of findings so far, kept or not.
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
        """Report one finding, by default with the code's severity."""
        self.take((Diagnostic(code, _bounded(message), place, _bounded(hint), severity or code.severity, related),))

    def take(self, findings: Iterable[Diagnostic]) -> None:
        """Report existing findings."""
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
        """Drop findings of a kind with the same message and place, such as those of each use of a faulty template."""
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
        """Remove all findings except the wanted ones."""
        self.found[:] = [one for one in self.found if wanted(one)]
        self._beyond = {kind: beyond for kind, beyond in self._beyond.items() if wanted(beyond.first)}

    @property
    def has_errors(self) -> bool:
        """True if at least one finding is an error."""
        return any(one.severity is Severity.ERROR for one in self.found)

    def __iter__(self) -> Iterator[Diagnostic]:
        """Yield the findings by file, line and column, each once, and how many of a kind are not kept."""
        unique = {one.identity: one for one in self.found}
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
    """Return a key that distinguishes findings of a kind, without computing a column."""
    element = getattr(one.place, "element", None)
    if element is None:
        return one.message, one.place.line, one.place.column
    return one.message, element.sourceline, getattr(one.place, "attribute", None)


def _bounded(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}..."


def weighed(
    found: Iterable[Diagnostic], errors: Collection[str], allowed: Collection[str], *, strict: bool = False
) -> Iterator[Diagnostic]:
    """Yield findings with the severities that the user wants.

    Args:
        found: The findings.
        errors: Codes whose warnings become errors, or `all` for every warning.
        allowed: Codes whose warnings are left out; errors stay.
        strict: Whether every warning becomes an error.
    """
    for one in found:
        if one.code.id in allowed and one.severity is not Severity.ERROR:
            continue
        lifted = one.severity is Severity.WARNING and (strict or "all" in errors)
        yield replace(one, severity=Severity.ERROR) if lifted or one.code.id in errors else one


class CompileError(Exception):
    """The input has errors, which are in `diagnostics`."""

    def __init__(self, diagnostics: Diagnostics) -> None:
        """Keep the diagnostics and put the errors' texts into the message."""
        self.diagnostics = diagnostics
        super().__init__("\n".join(as_text(d) for d in diagnostics if d.severity is Severity.ERROR))

    def __reduce__(self) -> tuple[type[CompileError], tuple[Diagnostics]]:
        """Pickle with the diagnostics: a pool of processes never ends if it cannot unpickle an exception."""
        return CompileError, (self.diagnostics,)


MOST_COMPARED = 200
"""Greatest number of names with which a word is compared; if there are more, those with the same beginning."""

MOST_KNOWN = 2000
"""Greatest number of names in which a similar one is looked for: a file with more may have as many faults."""

MOST_SUGGESTED = 12
"""Greatest number of names that a message or its hint lists."""

LEAST_PART = 3
"""Least number of characters of a word that is looked for inside names."""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return a hint with the most similar of `known`, else with all if they are few, else with those around the word.

    Empty names, which an author has left out, are not suggested.
    """
    import difflib  # only a mistake needs it

    offered = list(known)
    if len(offered) > MOST_KNOWN:
        return ""
    names = sorted({name for name in offered if name.strip()})
    alike = names if len(names) <= MOST_COMPARED else [name for name in names if name[:1] == word[:1]][:MOST_COMPARED]
    near = difflib.get_close_matches(word, alike, n=1, cutoff=0.6)
    if near:
        return f"did you mean '{near[0]}'?"
    if 0 < len(names) <= MOST_SUGGESTED:
        return "known: " + ", ".join(names)
    around = [name for name in names if word.casefold() in name.casefold()] if len(word) >= LEAST_PART else []
    if 0 < len(around) <= MOST_SUGGESTED:
        return f"known with '{word}' in it: {', '.join(around)}"
    return ""


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return the likely spelling of an unknown word, in brackets, to write after it; "" if no known word is similar."""
    hint = did_you_mean(word, known)
    return f" ({hint})" if hint else ""


WIDEST_LINE = 240
"""Greatest number of characters of a source line that are shown: a file may have one line of many megabytes."""


def as_text(diagnostic: Diagnostic) -> str:
    """Return the diagnostic as text: position, code, message, source line with carets, hint, uses, other places.

    Each part is one line, and invisible characters in the file or its name are shown as escapes.
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
    """Return the shown part of a place's line, and the number of characters before the place in it."""
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
    """Return a place as FILE:LINE:COLUMN, without parts that are unknown."""
    parts = [place.file]
    if place.line:
        parts.append(str(place.line))
        if place.column:
            parts.append(str(place.column))
    return ":".join(parts)
