"""What the server's functions answer to a file and a cursor, as lines of text: the form of the recorded cases."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from scenario_compiler.editor.analysis import Analysis
from scenario_compiler.editor.completion import offers
from scenario_compiler.editor.draft import Draft
from scenario_compiler.editor.findings import findings
from scenario_compiler.editor.hover import explained
from scenario_compiler.editor.layout import layout_edits
from scenario_compiler.editor.naming import CannotRenameError, renaming, uses_of
from scenario_compiler.editor.outline import Entry, outline

CURSOR = "|"
"""Stands in a case's text where the cursor is; `||` is one in the text itself."""

ROOT = Path(__file__).resolve().parents[2]


def split_cursor(text: str) -> tuple[str, int]:
    """Return a text without the cursor's sign, and the cursor's offset; the end of a text without one."""
    at = text.find(CURSOR)
    return (text, len(text)) if at < 0 else (text[:at] + text[at + 1 :], at)


def completion(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield what is offered: what it takes the place of, its name, what it is, and what is written."""
    for one in offers(analysis, offset):
        replaced = analysis.draft.text[one.start : one.end]
        detail = f"  {relative(one.detail)}" if one.detail else ""
        yield f"{one.kind} {one.label!r} for {replaced!r}: {one.insert!r}{detail}"


def hover(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield what is said of what stands at the cursor."""
    found = explained(analysis, offset)
    if found is not None:
        yield f"{analysis.draft.text[found.start : found.end]!r}"
        yield from relative(found.text).split("\n")


def definition(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield where what is named at the cursor is declared."""
    mention = analysis.mention_at(offset)
    if mention is not None:
        symbol = mention.symbol
        yield f"{symbol.kind} {symbol.name!r} at {relative(symbol.file)}:{symbol.line}:{symbol.column}"


def references(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield every place of the text where the same is named."""
    mention = analysis.mention_at(offset)
    for use in () if mention is None else uses_of(mention.symbol, [analysis]):
        line = analysis.draft.line_of(use.mention.start)
        what = "declares" if use.mention.declares else "names"
        yield f"{line + 1}:{use.mention.start - analysis.draft.line_starts[line] + 1} {what}"


def rename(analysis: Analysis, offset: int, name: str) -> Iterator[str]:
    """Yield the lines that change where the name at the cursor becomes another."""
    mention = analysis.mention_at(offset)
    if mention is None:
        return
    try:
        uses = renaming(mention.symbol, name, [analysis])
    except CannotRenameError as fault:
        yield f"refused: {relative(str(fault))}"
        return
    text = renamed(analysis.draft.text, [(one.mention.start, one.mention.end) for one in uses], name)
    for old, new in zip(analysis.draft.text.split("\n"), text.split("\n"), strict=True):
        if old != new:
            yield new


def diagnostics(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield what is wrong with the text."""
    del offset
    for one in findings(analysis.path, analysis.draft):
        line = analysis.draft.line_of(one.start)
        place = f"{line + 1}:{one.start - analysis.draft.line_starts[line] + 1}"
        covered = analysis.draft.text[one.start : one.end]
        yield f"{place} {one.severity.value} {one.code} {covered!r} {relative(one.message)}"


def laid_out(text: str) -> str:
    """Return a text, formatted."""
    for edit in reversed(layout_edits(Draft(text))):
        text = text[: edit.start] + edit.text + text[edit.end :]
    return text


def formatting(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield the lines of the text as it is laid out."""
    del offset
    yield from laid_out(analysis.draft.text).split("\n")


def symbols(analysis: Analysis, offset: int, _: str) -> Iterator[str]:
    """Yield what has a name in the text, further in what stands in it."""
    del offset

    def lines(entries: tuple[Entry, ...], depth: int) -> Iterator[str]:
        for one in entries:
            yield f"{'  ' * depth}{one.kind} {one.name!r}: {one.detail}"
            yield from lines(one.children, depth + 1)

    yield from lines(outline(analysis), 0)


ANSWERS: dict[str, Callable[[Analysis, int, str], Iterator[str]]] = {
    "completion": completion,
    "hover": hover,
    "definition": definition,
    "references": references,
    "rename": rename,
    "diagnostics": diagnostics,
    "formatting": formatting,
    "symbols": symbols,
}


def renamed(text: str, stretches: list[tuple[int, int]], name: str) -> str:
    """Return a text in which a name takes the place of some stretches."""
    for start, end in sorted(set(stretches), reverse=True):
        text = text[:start] + name + text[end:]
    return text


def relative(text: str) -> str:
    """Return a text without the path of the checkout."""
    return text.replace(f"{ROOT}/", "")


def analysed(text: str, path: Path) -> Analysis:
    """Return the analysis of a text as that of a file."""
    return Analysis(str(path), text)
