"""Finds the word that corresponds to an element of a draft, by the declarations of the words around it."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from scenario_compiler.editor.draft import Draft, Tag
from scenario_compiler.languages import OPENSCENARIO
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.source.study import STUDIES
from scenario_compiler.vocabulary.grammar import AttributeRule, ChildRule, grammar_of
from scenario_compiler.vocabulary.word import Word

ROOTS: Mapping[str, type[Word]] = {word.tag(): word for word in (LibraryElement, CatalogElement, *STUDIES)}
"""The first elements of files that are edited word by word; for other files only findings are shown."""


AISA = "config"
"""First element of the AISA toolkit's files, and of many files that are not the toolkit's."""


def is_scenario_file(draft: Draft) -> bool:
    """Return whether an XML file is in one of the scenario languages, by its first element.

    An editor also has other XML files open; nothing is shown for those and for files without an element.
    """
    root = draft.root
    if root is None:
        return False
    if root.name == AISA:
        return any(one.name == LibraryElement.tag() for one in root.children)
    name = root.name.rpartition(":")[2]
    return bool(difflib.get_close_matches(name, (*ROOTS, *OPENSCENARIO), n=1, cutoff=0.8))


@dataclass(frozen=True, slots=True)
class Meaning:
    """The meaning of an element: a word, or the wrapper of a choice of words.

    Attributes:
        word: The word; None for a wrapper.
        rule: The parent's rule for it; None for a first element.
    """

    word: type[Word] | None
    rule: ChildRule | None = None

    def child(self, name: str) -> Meaning | None:
        """Return the meaning of a child with a name; None if none is allowed."""
        if self.word is None:
            inner = None if self.rule is None else self.rule.words.get(name)
            return None if inner is None else Meaning(inner, self.rule)
        for rule in grammar_of(self.word).children:
            if rule.wrapper == name and name:
                return Meaning(None, rule)
            if not rule.wrapper and name in rule.words:
                return Meaning(rule.words[name], rule)
        return None

    @property
    def rules(self) -> tuple[ChildRule, ...]:
        """The rules of its children; a wrapper has one, that of its choice."""
        if self.word is not None:
            return grammar_of(self.word).children
        return () if self.rule is None else (self.rule,)

    def tags(self, rule: ChildRule) -> tuple[str, ...]:
        """Return the names of the children that one of its rules takes."""
        return tuple(rule.words) if self.word is None else rule.tags

    @property
    def attributes(self) -> Mapping[str, AttributeRule]:
        """The attributes that it may have."""
        return {} if self.word is None else grammar_of(self.word).attributes

    @property
    def text(self) -> str:
        """Its kind, as a text for people."""
        return described(self.word) if self.word is not None else "" if self.rule is None else self.rule.description


def described(word: type[Word]) -> str:
    """Return the text of a word's declaration, with one line for each paragraph."""
    paragraphs = (word.__doc__ or "").split("\n\n")
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)


def meaning_of(tag: Tag) -> Meaning | None:
    """Return the meaning of an element; None if it is not allowed at its place."""
    path = [one.name for one in tag.ancestors()]
    root = ROOTS.get(path.pop()) if path else None
    meaning = None if root is None else Meaning(root)
    while path and meaning is not None:
        meaning = meaning.child(path.pop())
    return meaning


def meanings(root: Tag) -> Iterator[tuple[Tag, Meaning]]:
    """Yield the elements that are words or wrappers of words, each with its kind, in document order."""
    word = ROOTS.get(root.name)
    waiting = [] if word is None else [(root, Meaning(word))]
    while waiting:
        tag, meaning = waiting.pop()
        yield tag, meaning
        inner = ((child, meaning.child(child.name)) for child in reversed(tag.children))
        waiting += [(child, found) for child, found in inner if found is not None]
