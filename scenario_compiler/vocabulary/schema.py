"""The XML schema (XSD 1.0) of a language with documentation, generated from the declarations of its words.

A number is a union of a literal with limits and an expression; any other value is a union of its own kind and an
expression. The reader and the schema accept the same documents, except for references and the values of expressions.
"""

from collections.abc import Iterable, Iterator
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from scenario_compiler.expressions import format_value
from scenario_compiler.vocabulary.grammar import (
    EXPRESSION,
    INTEGER,
    NUMBER,
    AttributeRule,
    ChildRule,
    grammar_of,
)
from scenario_compiler.vocabulary.word import QUANTITIES, Word

_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<!-- Made from the declarations of the language's words: change those, then `make generate`. -->
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" elementFormDefault="qualified">
"""

_NOTHING = """
  <xs:element name="nothing" abstract="true">
    <xs:annotation>
      <xs:documentation>Never present: it allows white space in elements without children.</xs:documentation>
    </xs:annotation>
  </xs:element>
"""

_SIMPLE_TYPES = f"""
  <xs:simpleType name="expression">
    <xs:annotation>
      <xs:documentation>A parameter, $name, or an expression, ${{...}}; the reader checks its value.</xs:documentation>
    </xs:annotation>
    <xs:restriction base="xs:token"><xs:pattern value={quoteattr(EXPRESSION)}/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="number">
    <xs:annotation><xs:documentation>A decimal number with a point.</xs:documentation></xs:annotation>
    <xs:restriction base="xs:double"><xs:pattern value={quoteattr(NUMBER)}/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="integer">
    <xs:annotation><xs:documentation>A whole number.</xs:documentation></xs:annotation>
    <xs:restriction base="xs:int"><xs:pattern value={quoteattr(INTEGER)}/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="something">
    <xs:annotation><xs:documentation>A text that is not empty.</xs:documentation></xs:annotation>
    <xs:restriction base="xs:string"><xs:minLength value="1"/></xs:restriction>
  </xs:simpleType>
"""


def xsd_of(roots: Iterable[type[Word]]) -> str:
    """Return the schema of documents with these first elements."""
    roots = tuple(roots)
    parts = [_HEAD]
    parts += [f'  <xs:element name="{root.tag()}" type="{root.__name__}"/>\n' for root in roots]
    parts += [_NOTHING, _SIMPLE_TYPES]
    parts += ["\n" + "\n".join(_complex_type(word)) + "\n" for word in words_below(roots)]
    parts.append("</xs:schema>\n")
    return "".join(parts)


def words_below(roots: Iterable[type[Word]]) -> list[type[Word]]:
    """Return the words that can occur in documents with these first elements, each once, outermost first."""
    found: dict[type[Word], None] = {}
    waiting = list(roots)
    while waiting:
        word = waiting.pop(0)
        if word not in found:
            found[word] = None
            waiting += [inner for rule in grammar_of(word).children for inner in rule.words.values()]
    return list(found)


def _complex_type(word: type[Word]) -> Iterator[str]:
    grammar = grammar_of(word)
    yield f'  <xs:complexType name="{word.__name__}">'
    yield from _documentation(_summary(word), 4)
    yield "    <xs:sequence>"
    if not grammar.children:
        yield '      <xs:element ref="nothing" minOccurs="0"/>'
    for rule in grammar.children:
        yield from _child(rule)
    yield "    </xs:sequence>"
    for attribute in grammar.attributes.values():
        yield from _attribute(attribute)
    if grammar.others:
        yield '    <xs:anyAttribute namespace="##local" processContents="skip"/>'
    yield "  </xs:complexType>"


def _child(rule: ChildRule) -> Iterator[str]:
    occurs = _occurs(rule.required, rule.many)
    if not rule.wrapper:
        yield from _choice(rule, occurs, 6)
        return
    yield f'      <xs:element name="{rule.wrapper}"{_occurs(rule.required, False)}>'
    yield from _documentation(rule.description, 8)
    yield "        <xs:complexType>"
    yield "          <xs:sequence>"
    yield from _choice(rule, _occurs(not rule.many, rule.many), 12, documented=False)
    yield "          </xs:sequence>"
    yield "        </xs:complexType>"
    yield "      </xs:element>"


def _choice(rule: ChildRule, occurs: str, indent: int, documented: bool = True) -> Iterator[str]:
    space = " " * indent
    documentation = list(_documentation(rule.description, indent + 2)) if documented else []
    if len(rule.words) == 1:
        tag, word = next(iter(rule.words.items()))
        element = f'{space}<xs:element name="{tag}" type="{word.__name__}"{occurs}'
        yield from [f"{element}>", *documentation, f"{space}</xs:element>"] if documentation else [f"{element}/>"]
        return
    yield f"{space}<xs:choice{occurs}>"
    yield from documentation
    for tag, word in rule.words.items():
        yield f'{space}  <xs:element name="{tag}" type="{word.__name__}">'
        yield from _documentation(_summary(word), indent + 4)
        yield f"{space}  </xs:element>"
    yield f"{space}</xs:choice>"


def _occurs(required: bool, many: bool) -> str:
    return ("" if required else ' minOccurs="0"') + (' maxOccurs="unbounded"' if many else "")


def _attribute(rule: AttributeRule) -> Iterator[str]:
    use = ' use="required"' if rule.required else ""
    yield f'    <xs:attribute name="{rule.name}"{use}>'
    yield from _documentation(_described(rule), 6)
    yield "      <xs:simpleType>"
    if rule.kind == "text" and not rule.spelling.pattern and not rule.spelling.separated:
        base = "something" if rule.required else "xs:string"
        yield f'        <xs:restriction base="{base}"/>'
    else:
        yield '        <xs:union memberTypes="expression">'
        yield "          <xs:simpleType>"
        yield from _literal(rule)
        yield "          </xs:simpleType>"
        yield "        </xs:union>"
    yield "      </xs:simpleType>"
    yield "    </xs:attribute>"


def _literal(rule: AttributeRule) -> Iterator[str]:
    space = " " * 12
    if rule.spelling.separated:
        yield f"{space}<xs:restriction>"
        yield f"{space}  <xs:simpleType>"
        yield f"{space}    <xs:list>"
        yield f"{space}      <xs:simpleType>"
        yield from (f"{space}    {line}" for line in _restriction(rule))
        yield f"{space}      </xs:simpleType>"
        yield f"{space}    </xs:list>"
        yield f"{space}  </xs:simpleType>"
        yield f'{space}  <xs:minLength value="1"/>'
        yield f"{space}</xs:restriction>"
    else:
        yield from (f"{space}{line}" for line in _restriction(rule))


def _restriction(rule: AttributeRule) -> list[str]:
    bases = {"number": "number", "fixed_number": "number", "integer": "integer", "boolean": "xs:token"}
    facets = [
        f'  <xs:enumeration value="{choice}"/>'
        for choice in (("true", "false") if rule.kind == "boolean" else rule.choices)
    ]
    if rule.spelling.pattern:
        facets.append(f"  <xs:pattern value={quoteattr(rule.spelling.pattern)}/>")
    low, high = rule.spelling.minimum, rule.spelling.maximum
    if low is not None:
        facet = "minExclusive" if rule.spelling.exclusive else "minInclusive"
        facets.append(f'  <xs:{facet} value="{format_value(float(low))}"/>')
    if high is not None:
        facets.append(f'  <xs:maxInclusive value="{format_value(float(high))}"/>')
    base = bases.get(rule.kind, "xs:token")
    if not facets:
        return [f'<xs:restriction base="{base}"/>']
    return [f'<xs:restriction base="{base}">', *facets, "</xs:restriction>"]


def _described(rule: AttributeRule) -> str:
    return " ".join(part for part in (rule.description, default_text(rule)) if part)


def default_text(rule: AttributeRule) -> str:
    """Return a sentence on an attribute's default value; empty if there is none."""
    default: Any = rule.default
    if rule.required or default in (None, "", ()):
        return ""
    if isinstance(default, tuple):
        return f"Default: {' '.join(map(str, default))}."
    if isinstance(default, float | int) and not isinstance(default, bool):
        quantity = QUANTITIES.get(rule.spelling.quantity)
        default = float(f"{default / quantity.factor:.12g}") if quantity else default
        return f"Default: {format_value(float(default))}."
    return f"Default: {format_value(default)}."


def _summary(word: type[Word]) -> str:
    return (word.__doc__ or "").strip().split("\n\n")[0].replace("\n", " ")


def _documentation(text: str, indent: int) -> Iterator[str]:
    if text:
        space = " " * indent
        yield f"{space}<xs:annotation><xs:documentation>{escape(text)}</xs:documentation></xs:annotation>"
