"""Finds the files that use a word or an element, and the evidence for an element, in a checkout that has them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from lxml import etree

from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.word import Word


def files_with(files: Iterable[Path], roots: Iterable[type[Word]]) -> Counter[type[Word]]:
    """Return how many of some files use each word; files of another language, or without XML, use none."""
    known = {root.tag(): root for root in roots}
    found: Counter[type[Word]] = Counter()
    for file in files:
        element = _root_of(file)
        root = None if element is None else known.get(str(element.tag))
        if element is not None and root is not None:
            found.update(set(words_in(element, root)))
    return found


def _root_of(file: Path) -> etree._Element | None:
    try:
        return etree.parse(str(file), etree.XMLParser(resolve_entities=False)).getroot()
    except etree.XMLSyntaxError:
        return None


def words_in(element: etree._Element, word: type[Word]) -> Iterator[type[Word]]:
    """Yield an element's word and those of all elements below it, as far as the language knows them."""
    yield word
    for rule in grammar_of(word).children:
        homes = element.findall(rule.wrapper) if rule.wrapper else [element]
        for home in homes:
            for child in home.iterchildren(*rule.words):
                yield from words_in(child, rule.words[str(child.tag)])


def files_naming(files: Iterable[Path]) -> Counter[str]:
    """Return how many of some text files have the start tag of an element, by tag."""
    found: Counter[str] = Counter()
    for file in files:
        found.update(set(re.findall(r"<([A-Z]\w+)\b", file.read_text(encoding="utf-8", errors="replace"))))
    return found


def backing_of(page: str) -> dict[str, str]:
    """Return the evidence for each feature in the table of variants of docs/conformance.md.

    "yes" where every variant agrees with a recorded run or has its law stated in a test, else how many have.
    """
    verdicts: dict[str, Counter[str]] = {}
    for line in page.partition("## Variants of features")[2].partition("## ")[0].splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) > VERDICT and cells[VERDICT] in BACKED | UNBACKED:
            verdicts.setdefault(cells[FEATURE], Counter())[cells[VERDICT]] += 1
    return {feature: _said(counts) for feature, counts in verdicts.items()}


FEATURE = 1
VERDICT = 3
"""Columns of that table."""

BACKED = {"agrees", "not recorded, law stated"}
UNBACKED = {"differs by decision", "not recorded"}
"""Its text for a variant."""


def _said(counts: Counter[str]) -> str:
    backed, total = sum(counts[one] for one in BACKED), counts.total()
    if backed == total:
        return f"yes, {total} of {total} variants"
    rest = [f"{counts[one]} {one}" for one in ("differs by decision", "not recorded") if counts[one]]
    return f"{backed} of {total} variants; {', '.join(rest)}"
