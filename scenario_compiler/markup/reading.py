"""Reads an XML element as a word, from the word's declaration; all languages use this reader.

All faults of an element and everything below it are reported in one pass, each at its attribute or tag.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Place, did_you_mean
from scenario_compiler.document import one_of, written_name
from scenario_compiler.markup import codes
from scenario_compiler.markup.environment import ReadingContext
from scenario_compiler.markup.values import SPACE, UnreadError, read_attribute
from scenario_compiler.vocabulary.grammar import ChildRule, grammar_of
from scenario_compiler.vocabulary.traversal import AnyWord
from scenario_compiler.vocabulary.word import Word

_SCHEMA_HINTS = (
    "{http://www.w3.org/2001/XMLSchema-instance}schemaLocation",
    "{http://www.w3.org/2001/XMLSchema-instance}noNamespaceSchemaLocation",
)

_FOREIGN = "the language has nothing from the namespace '{}': remove it"

MOST_LISTED = 40
"""Greatest number of children listed in a hint."""

SIMILAR = 0.8
"""Similarity to an expected name, 0 to 1, from which another name counts as its misspelling; chosen."""

STANDARD_SUFFIXES = ("condition", "action", "position")
"""Suffixes that ASAM OpenSCENARIO appends to a term to name its elements, as in `SimulationTimeCondition`."""


def read_word(element: etree._Element, word: type[AnyWord], reading: ReadingContext) -> AnyWord | None:
    """Return the word for an element; None if something required is missing or wrong, and `reading` has nothing for it.

    An optional part with a fault is reported and left out, so that later stages can find more faults. The values are
    not validated again: the validators of the storyboard's words are large, and a command that checks a file builds
    none of them.
    """
    fields, complete = read_fields(element, word, reading)
    if not complete:
        fields = {**reading.unread.get(word, {}), **fields}
        if any(one.is_required() and name not in fields for name, one in word.model_fields.items()):
            return None
    return word.model_construct(**fields).written_at(reading.origin(element))


def read_fields(element: etree._Element, word: type[Word], reading: ReadingContext) -> tuple[dict[str, Any], bool]:
    """Return the fields of a word that can be read, and whether everything required is among them."""
    fields, complete = _read_attributes(element, word, reading)
    for rule, elements in place_children(element, word, reading):
        read = [read_word(child, rule.words[str(child.tag)], reading) for child in elements]
        words = [one for one in read if one is not None]
        if rule.required and not words:
            complete = False
        elif rule.many:
            fields[rule.field] = tuple(words)
        elif words:
            fields[rule.field] = words[0]
        else:
            _add_default(fields, word, rule, reading.origin(element))
    return fields, complete


def _add_default(fields: dict[str, Any], word: type[Word], rule: ChildRule, origin: Place) -> None:
    """Set the default word for a missing child, with the parent's place."""
    factory: Any = word.model_fields[rule.field].default_factory
    if factory is not None:
        fields[rule.field] = factory().written_at(origin)


def read_attributes(element: etree._Element, word: type[Word], reading: ReadingContext) -> dict[str, Any] | None:
    """Return the values of the word's attributes by field; None when a required one is missing or wrong."""
    fields, complete = _read_attributes(element, word, reading)
    return fields if complete else None


def _read_attributes(element: etree._Element, word: type[Word], reading: ReadingContext) -> tuple[dict[str, Any], bool]:
    """Return the attributes that can be read, by field, and whether the required ones are among them."""
    grammar = grammar_of(word)
    fields: dict[str, Any] = {}
    complete = True
    written: dict[str, str] = dict(element.items())  # type: ignore[arg-type]  # str, as Python 3's lxml gives
    for name, text in written.items():
        if name in grammar.attributes:
            rule = grammar.attributes[name]
            try:
                fields[rule.field] = read_attribute(text, rule, reading, reading.origin(element, name))
            except UnreadError:
                complete = complete and not rule.required
        elif grammar.others and not name.startswith("{"):
            fields.setdefault(grammar.others, {})[name] = text
        elif name not in _SCHEMA_HINTS:
            reading.sink.add(
                codes.UNKNOWN_ATTRIBUTE,
                f"<{element.tag}> has no attribute '{written_name(element, name)}'",
                reading.origin(element).name_of(name),
                hint=_hint_for_attribute(element, name, word),
            )
    for name, rule in grammar.attributes.items():
        if rule.required and name not in written:
            complete = False
            reading.sink.add(
                codes.MISSING_ATTRIBUTE,
                f"<{element.tag}> needs the attribute '{name}'",
                reading.origin(element),
                hint=f"{name}: {rule.description}",
            )
    return fields, complete


def _hint_for_attribute(element: etree._Element, name: str, word: type[Word]) -> str:
    namespace = etree.QName(name).namespace
    if namespace:
        return _FOREIGN.format(namespace)
    if name in word.moved:
        return f"write {word.moved[name]}"
    return did_you_mean(name, set(grammar_of(word).attributes) - set(map(str, element.attrib)))


def place_children(
    element: etree._Element, word: type[Word], reading: ReadingContext
) -> Iterator[tuple[ChildRule, list[etree._Element]]]:
    """Yield every rule of the word's children with the elements that follow it; report children that fit none."""
    _report_text(element, reading)
    rules = grammar_of(word).children
    owner = {tag: i for i, rule in enumerate(rules) for tag in rule.tags}
    found: list[list[etree._Element]] = [[] for _ in rules]
    furthest = 0
    unknown = False
    for child in element.iterchildren(etree.Element):
        index = owner.get(str(child.tag))
        if index is None:
            _report_unknown_child(element, child, rules, reading)
            unknown = True
            continue
        if index < furthest:
            before = next(
                tag
                for tag in map(str, (c.tag for c in element.iterchildren(etree.Element)))
                if owner.get(tag, -1) > index
            )
            reading.sink.add(
                codes.ELEMENT_ORDER,
                f"<{child.tag}> must come before <{before}> in <{element.tag}>",
                reading.origin(child),
                hint="the order is " + ", ".join("|".join(f"<{tag}>" for tag in rule.tags) for rule in rules),
            )
        furthest = max(furthest, index)
        if found[index] and (rules[index].wrapper or not rules[index].many):
            reading.sink.add(codes.REPEATED_ELEMENT, _repeated(element, found[index][0], child), reading.origin(child))
            continue
        found[index].append(child)
    for rule, elements in zip(rules, found, strict=True):
        if elements or not (unknown and len(rules) == 1):  # an unknown child can only be meant for the single rule
            elements = _unwrapped(element, rule, elements, reading)
        yield rule, elements


def misspelt(parent: etree._Element, tags: Iterable[str]) -> bool:
    """Return whether a child's tag is similar but not equal to one of `tags`, so that only its spelling is wrong."""
    meant = tuple(tags)
    found = {str(child.tag) for child in parent.iterchildren(etree.Element)}.difference(meant)
    likely = [(tag, one) for tag in found for one in meant if _shared_letters(tag, one) >= SIMILAR]
    if not likely:
        return False
    import difflib  # only needed for mistakes

    return any(difflib.get_close_matches(tag, (one,), n=1, cutoff=SIMILAR) for tag, one in likely)


def _shared_letters(first: str, second: str) -> float:
    """Return the share of the letters that two names have in common in any order: no less than their similarity."""
    return 2.0 * (Counter(first) & Counter(second)).total() / max(len(first) + len(second), 1)


def _repeated(parent: etree._Element, first: etree._Element, second: etree._Element) -> str:
    if first.tag == second.tag:
        return f"<{parent.tag}> takes one <{second.tag}>"
    return f"<{parent.tag}> takes either <{first.tag}> or <{second.tag}>"


def _unwrapped(
    parent: etree._Element, rule: ChildRule, elements: list[etree._Element], reading: ReadingContext
) -> list[etree._Element]:
    """Return the elements of words inside their wrapper; report missing and surplus ones."""
    if not elements:
        if rule.required and not misspelt(parent, rule.tags) and not _meant_by_a_child(parent, rule):
            _report_missing(parent, rule.tags, rule.description, reading)
        return []
    if not rule.wrapper:
        return elements
    wrapper = elements[0]
    for name in map(str, wrapper.attrib):
        reading.sink.add(
            codes.UNKNOWN_ATTRIBUTE,
            f"<{wrapper.tag}> has no attributes",
            reading.origin(wrapper).name_of(name),
            hint=f"it contains {one_of(rule.words)}",
        )
    _report_text(wrapper, reading)
    inner: list[etree._Element] = []
    for child in wrapper.iterchildren(etree.Element):
        if str(child.tag) not in rule.words:
            _report_unknown_child(wrapper, child, (rule._replace(wrapper=""),), reading)
        elif inner and not rule.many:
            reading.sink.add(codes.REPEATED_ELEMENT, _repeated(wrapper, inner[0], child), reading.origin(child))
        else:
            inner.append(child)
    if not inner and not rule.many:
        _report_missing(wrapper, tuple(rule.words), rule.description, reading)
    return inner


def _report_missing(parent: etree._Element, tags: tuple[str, ...], description: str, reading: ReadingContext) -> None:
    reading.sink.add(
        codes.MISSING_ELEMENT,
        f"<{parent.tag}> needs {one_of(tags)}",
        reading.origin(parent),
        hint=description,
    )


def _report_unknown_child(
    parent: etree._Element, child: etree._Element, rules: tuple[ChildRule, ...], reading: ReadingContext
) -> None:
    name, namespace = _short_name(str(child.tag)), etree.QName(child).namespace
    reading.sink.add(
        codes.UNKNOWN_ELEMENT,
        f"<{written_name(child)}> is not known in <{parent.tag}>",
        reading.origin(child),
        hint=_FOREIGN.format(namespace) if namespace else _hint_for_unknown(name, parent, rules),
    )


def _hint_for_unknown(name: str, parent: etree._Element, rules: tuple[ChildRule, ...]) -> str:
    known = [tag for rule in rules for tag in rule.tags]
    if not known:
        return f"<{parent.tag}> has no child elements"
    for rule in rules:
        if rule.wrapper and name in rule.words:
            return f"put <{name}> into a <{rule.wrapper}> in <{parent.tag}>"
        meant = {} if rule.wrapper else dict(_standard_terms(rule.words))
        if _term(name) in meant:
            return f"did you mean '{meant[_term(name)]}'?"
    hint = did_you_mean(name, known)
    return hint if hint or len(known) > MOST_LISTED else "known: " + ", ".join(known)


def _term(name: str) -> str:
    return name.replace("_", "").replace("-", "").lower()


def _standard_terms(words: Mapping[str, type[Word]]) -> Iterator[tuple[str, str]]:
    """Yield ASAM OpenSCENARIO's terms for words, with and without their suffix, and the words' tags."""
    for tag, word in words.items():
        term = word.__name__.lower()
        yield term, tag
        for suffix in STANDARD_SUFFIXES:
            if term.endswith(suffix):
                yield term.removesuffix(suffix), tag


def _meant_by_a_child(parent: etree._Element, rule: ChildRule) -> bool:
    """Return whether an unknown child was meant for `rule`; the child is reported, so that nothing is missing."""
    meant = rule.words if rule.wrapper else dict(_standard_terms(rule.words))
    names = (_short_name(str(child.tag)) for child in parent.iterchildren(etree.Element))
    return any((name if rule.wrapper else _term(name)) in meant for name in names)


def _report_text(element: etree._Element, reading: ReadingContext) -> None:
    pieces = [element.text, *(child.tail for child in element)]
    stray = next((piece.strip(SPACE) for piece in pieces if piece and piece.strip(SPACE)), "")
    if stray:
        shown = stray.split("\n")[0][:40]
        reading.sink.add(
            codes.STRAY_TEXT,
            f"text '{shown}' is not allowed in <{element.tag}>, which has child elements only",
            reading.document.text_place(element, shown, reading.within),
        )


def _short_name(name: str) -> str:
    return name.rsplit("}", 1)[-1]
