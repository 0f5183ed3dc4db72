"""Traversal of words: every word below a word, the names in it, and a copy with some words replaced."""

from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from scenario_compiler.expressions import Expression
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.word import Word

AnyWord = TypeVar("AnyWord", bound=Word)


def walk(word: Word) -> Iterator[Word]:
    """Yield a word and every word below it, in document order."""
    yield word
    for name in type(word).model_fields:
        for inner in _words_in(getattr(word, name)):
            yield from walk(inner)


def parameters_in(word: Word) -> set[str]:
    """Return the names of the parameters on which numbers of a word and of the words below it depend."""
    found: set[str] = set()
    for inner in walk(word):
        for name in type(inner).model_fields:
            value = getattr(inner, name)
            if isinstance(value, Expression):
                found.update(value.names)
    return found


def entities_named(word: Word) -> Iterator[tuple[str, Word]]:
    """Yield the id of each entity that a word, or a word below it, names, with the word that names it."""
    for inner in walk(word):
        for rule in grammar_of(type(inner)).attributes.values():
            if rule.spelling.names == "entity":
                value = getattr(inner, rule.field)
                for name in value if isinstance(value, tuple) else (value,):
                    if name:
                        yield name, inner


def replaced(word: AnyWord, replace: Callable[[Word], Word]) -> AnyWord:
    """Return a copy in which each word below `word` is replaced by the result of `replace`. Origins are kept."""
    changes = {name: _replaced_value(getattr(word, name), replace) for name in type(word).model_fields}
    changes = {name: value for name, value in changes.items() if value is not getattr(word, name)}
    return word.model_copy(update=changes) if changes else word


def _replaced_value(value: Any, replace: Callable[[Word], Word]) -> Any:
    if isinstance(value, Word):
        return replaced(replace(value), replace)
    if isinstance(value, tuple) and any(isinstance(item, Word) for item in value):
        return tuple(_replaced_value(item, replace) for item in value)
    return value


def _words_in(value: Any) -> Iterator[Word]:
    if isinstance(value, Word):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _words_in(item)
