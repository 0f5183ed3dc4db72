"""The language's reference as a page of Markdown, made from the declarations of its words."""

from collections.abc import Iterable, Iterator

from scenario_compiler.expressions import FUNCTIONS
from scenario_compiler.vocabulary.grammar import AttributeRule, ChildRule, grammar_of, limits_text
from scenario_compiler.vocabulary.schema import default_text, words_below
from scenario_compiler.vocabulary.word import QUANTITIES, Word

_HEAD = """# The language, word by word

Made from the declarations of the language's words: change those, then `make generate`. `schemas/conflict.xsd` says the
same to an editor.

The children of an element stand in the order in which they are listed. In place of any value, `$name` is a parameter
and `${...}` an expression over parameters. Numbers are decimal, in the unit that is given. Expressions know
`+ - * / % ^`, comparisons, `and`, `or`, `not`, brackets, and the functions """


def language_page(roots: Iterable[type[Word]]) -> str:
    """Return the page on the documents whose first elements are these words."""
    words = words_below(tuple(roots))
    parents: dict[type[Word], list[type[Word]]] = {word: [] for word in words}
    for word in words:
        for inner in dict.fromkeys(one for rule in grammar_of(word).children for one in rule.words.values()):
            parents[inner].append(word)
    functions = ", ".join(f"`{name}`" for name in FUNCTIONS)
    parts = [f"{_HEAD}{functions}.\n"]
    parts += ["\n".join(_section(word, parents[word])) for word in words]
    return "\n".join(parts)


def _section(word: type[Word], parents: list[type[Word]]) -> Iterator[str]:
    yield f'<a id="{word.__name__}"></a>'
    yield ""
    yield f"## `<{word.tag()}>`{_of(parents)}"
    yield ""
    yield from _paragraphs(word)
    if len(parents) > 1:
        yield f"Stands in {', '.join(map(_link, parents))}."
        yield ""
    grammar = grammar_of(word)
    if grammar.attributes:
        yield "| attribute | holds | |"
        yield "|---|---|---|"
        yield from (_attribute(rule) for rule in grammar.attributes.values())
        yield ""
    if grammar.others:
        yield "Any other attribute gives a parameter of the template its value."
        yield ""
    if grammar.children:
        yield "Holds, in this order:"
        yield ""
        yield from (_child(rule) for rule in grammar.children)
        yield ""


def _of(parents: list[type[Word]]) -> str:
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
    """Return what an attribute holds, with its unit and limits."""
    spelling = rule.spelling
    kinds = {"number": "number", "fixed_number": "number", "integer": "whole number", "boolean": "`true` or `false`"}
    what = kinds.get(rule.kind, "text")
    if rule.kind == "choice":
        what = ", ".join(f"`{choice}`" for choice in rule.choices)
    quantity = QUANTITIES.get(spelling.quantity)
    if quantity is not None and quantity.unit not in ("", "1"):
        what = f"{what} in {quantity.unit}"
    if spelling.separated:
        what = f"list of {what}" if rule.kind == "choice" else f"{what}s with spaces between"
    limits = [limits_text(spelling)] if limits_text(spelling) else []
    if spelling.names:
        named = spelling.names.replace("_", " ")
        limits.append(f"names {'an' if named[0] in 'aeiou' else 'a'} {named}")
    return ", ".join([what, *limits])


def _child(rule: ChildRule) -> str:
    count = {
        (True, True): "one or more",
        (True, False): "one",
        (False, True): "any number",
        (False, False): "at most one",
    }
    words = ", ".join(map(_link, rule.words.values()))
    if rule.wrapper:
        words = f"`<{rule.wrapper}>` around {words}"
        number = "one" if rule.required else "at most one"
    else:
        number = count[rule.required, rule.many]
    return f"* {words} ({number}): {rule.description}"
