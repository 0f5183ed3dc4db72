"""The language's reference as a Markdown page, generated from the declarations of its words."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from scenario_compiler.expressions import FUNCTIONS
from scenario_compiler.vocabulary.grammar import AttributeRule, ChildRule, grammar_of, limits_text
from scenario_compiler.vocabulary.schema import default_text, words_below
from scenario_compiler.vocabulary.word import QUANTITIES, Word

_HEAD = (
    "# The language, element by element\n\n"
    "This page is generated from the declarations of the language's words: change those, then run `make generate`.\n"
    "`schemas/conflict.xsd` contains the same information for editors.\n\n"
    "The children of an element must have the order in which they are listed. Any value can be replaced by a\n"
    "parameter, `$name`, or by an expression over parameters, `${...}`. Numbers are decimal, in the given unit.\n"
    "Expressions support `+ - * / % ^`, the comparisons `== != < <= > >=` (in XML, `<` is written `&lt;`), `and`,\n"
    "`or`, `not`, parentheses, and the functions "
)
_EXPRESSIONS = (
    "Parameters have the units of XML, so angles are in degrees, but `sin`, `atan` and the other functions of angles\n"
    "use radians: write `${sin(radians($bend))}`. `^` groups from the left (`2^3^2` is 64) and comes before a sign\n"
    "(`-2^2` is -4), `%` has the sign of its left side (`-7 % 3` is -1), and `round` takes halves away from 0\n"
    "(`round(-2.5)` is -3). `pi` is the constant, and `if(test, a, b)` is `a` or `b`. Texts are written in single\n"
    "quotes, as in `${$kind == 'bus'}`. A list is either written out or one parameter as a whole.\n"
)


LEAST_WORDS, LEAST_PARENTS = 5, 4
"""Words are listed as a group if at least this many words share at least this many parents."""

Examples = Mapping[tuple[str, str], str]
"""Text of an example by the tags of an element and of its parent."""


@dataclass(frozen=True)
class Group:
    """Words that are allowed in the same elements.

    Attributes:
        name: Name of one of them.
        words: The words, in the page's order.
        parents: The elements that may contain them.
    """

    name: str
    words: tuple[type[Word], ...]
    parents: tuple[type[Word], ...]

    @property
    def link(self) -> str:
        """The group's name, with its anchor."""
        return f"[{self.name}](#{self.name.replace(' ', '-')})"


def language_page(roots: Iterable[type[Word]], examples: Examples, head: str = "") -> str:
    """Return the page on documents with these first elements, with an example of each element.

    Args:
        roots: The words of the first elements.
        examples: The examples.
        head: Introduction of the page; that of the conflict language if empty.
    """
    words = words_below(tuple(roots))
    found: dict[type[Word], list[type[Word]]] = {word: [] for word in words}
    for word in words:
        for inner in dict.fromkeys(one for rule in grammar_of(word).children for one in rule.words.values()):
            found[inner].append(word)
    parents = {word: tuple(inner) for word, inner in found.items()}
    groups = _groups(parents)
    functions = ", ".join(f"`{name}`" for name in FUNCTIONS)
    parts = [head or f"{_HEAD}{functions}.\n{_EXPRESSIONS}"]
    parts += ["\n".join(_group_section(group)) for group in groups]
    parts += ["\n".join(_section(word, parents[word], groups, examples)) for word in words]
    return "\n".join(parts)


def _groups(parents: Mapping[type[Word], tuple[type[Word], ...]]) -> list[Group]:
    """Return the groups of words that are allowed in the same places, if these are many, to list them once."""
    counts = Counter(parents.values())
    found = []
    for places, count in counts.items():
        if count >= LEAST_WORDS and len(places) >= LEAST_PARENTS:
            members = tuple(word for word, where in parents.items() if where == places)
            package = members[0].__module__.split(".")[2]
            name = package.removesuffix("s") if package in ("conditions", "positions") else "part of a scenario"
            found.append(Group(name, members, places))
    return found


def _group_section(group: Group) -> Iterator[str]:
    yield f'<a id="{group.name.replace(" ", "-")}"></a>'
    yield ""
    yield f"## A {group.name}"
    yield ""
    yield f"One of {', '.join(map(_link, group.words))}."
    yield ""
    yield f"Allowed in {', '.join(map(_link, group.parents))}."
    yield ""


def _section(
    word: type[Word], parents: tuple[type[Word], ...], groups: list[Group], examples: Examples
) -> Iterator[str]:
    yield f'<a id="{word.__name__}"></a>'
    yield ""
    yield f"## `<{word.tag()}>`{_of(parents)}"
    yield ""
    yield from _paragraphs(word)
    group = next((one for one in groups if word in one.words), None)
    if group is not None:
        yield f"It is a {group.link}."
        yield ""
    elif len(parents) > 1:
        yield f"Allowed in {', '.join(map(_link, parents))}."
        yield ""
    example = next((examples[word.tag(), one] for one in _tags(parents) if (word.tag(), one) in examples), "")
    if example:
        yield from ("```xml", example, "```", "")
    grammar = grammar_of(word)
    if grammar.attributes:
        yield "| attribute | value | meaning |"
        yield "|---|---|---|"
        yield from (_attribute(rule) for rule in grammar.attributes.values())
        yield ""
    if grammar.others:
        yield "Any other attribute sets a parameter of the template."
        yield ""
    if grammar.children:
        yield "Contains, in this order:"
        yield ""
        yield from (_child(rule, groups) for rule in grammar.children)
        yield ""


def _tags(parents: tuple[type[Word], ...]) -> list[str]:
    """Return the tags of elements that may contain a word; the wrapper's tag if it is in one."""
    wrappers = [rule.wrapper for parent in parents for rule in grammar_of(parent).children if rule.wrapper]
    return [*(parent.tag() for parent in parents), *wrappers, ""]


def _of(parents: tuple[type[Word], ...]) -> str:
    return f" in `<{parents[0].tag()}>`" if len(parents) == 1 else ""


def _link(word: type[Word]) -> str:
    return f"[`<{word.tag()}>`](#{word.__name__})"


def _paragraphs(word: type[Word]) -> Iterator[str]:
    for paragraph in (word.__doc__ or "").split("\n\n"):
        yield " ".join(paragraph.split())
        yield ""


def _attribute(rule: AttributeRule) -> str:
    name = f"**{rule.name}**" if rule.required else rule.name
    text = " ".join(part for part in (rule.description, default_text(rule)) if part)
    return f"| {name} | {holds(rule)} | {text.replace('|', chr(92) + '|')} |"


def holds(rule: AttributeRule) -> str:
    """Return the kind of an attribute's values, with unit and limits."""
    spelling = rule.spelling
    kinds = {"number": "number", "fixed_number": "number", "integer": "whole number", "boolean": "`true` or `false`"}
    what = kinds.get(rule.kind, "text")
    if rule.kind == "choice":
        what = ", ".join(f"`{choice}`" for choice in rule.choices)
    quantity = QUANTITIES.get(spelling.quantity)
    if quantity is not None and quantity.unit not in ("", "1"):
        what = f"{what} in {quantity.unit}"
    if spelling.separated:
        what = f"list of {what}" if rule.kind == "choice" else f"{what}s separated by spaces"
    limits = [limits_text(spelling)] if limits_text(spelling) else []
    if spelling.names:
        named = spelling.names.replace("_", " ")
        limits.append(f"names {'an' if named[0] in 'aeiou' else 'a'} {named}")
    return ", ".join([what, *limits])


def _child(rule: ChildRule, groups: list[Group]) -> str:
    count = {
        (True, True): "one or more",
        (True, False): "one",
        (False, True): "any number",
        (False, False): "at most one",
    }
    words = ", ".join(_links(tuple(rule.words.values()), groups))
    if rule.wrapper:
        words = f"`<{rule.wrapper}>` around {words}"
        number = "one" if rule.required else "at most one"
    else:
        number = count[rule.required, rule.many]
    return f"* {words} ({number}): {rule.description}"


def _links(words: tuple[type[Word], ...], groups: list[Group]) -> Iterator[str]:
    """Yield links to words, one link to all of a group."""
    whole = [group for group in groups if set(group.words) <= set(words)]
    for group in whole:
        yield f"a {group.link}"
    yield from (_link(word) for word in words if not any(word in group.words for group in whole))
