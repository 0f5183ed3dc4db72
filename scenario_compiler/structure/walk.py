"""Walks a file along its version's declarations and reports every fault of structure."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import cast

from lxml import etree

from scenario_compiler.diagnostics import MOST_SUGGESTED, Code, Diagnostics, did_you_mean
from scenario_compiler.document import one_of, written_name
from scenario_compiler.structure.content import Content, State
from scenario_compiler.structure.findings import Findings
from scenario_compiler.structure.grammar import Grammar
from scenario_compiler.structure.notation import Attribute, Declaration, Range
from scenario_compiler.structure.values import is_number

_XSI = "{http://www.w3.org/2001/XMLSchema-instance}"


def check_elements(findings: Findings, grammar: Grammar, minor: int) -> None:
    """Report the faults of a document's elements, attributes and values in version 1.`minor` of a format."""
    _Walk(findings, grammar, minor).run(findings.document.root)


def local_name(element: etree._Element) -> str:
    """Return an element's tag without its namespace."""
    return str(element.tag).rpartition("}")[2]


class _Walk:
    """One pass over one document.

    An element that only another version knows is walked along that version's declarations, where the format tells such
    elements from others.
    """

    def __init__(self, findings: Findings, grammar: Grammar, minor: int, *, trial: bool = False) -> None:
        self.trial = trial
        self.findings = findings
        self.grammar = grammar
        self.minor = minor
        self.faults = grammar.faults
        self._fine: set[tuple[str, str, int]] = set()

    def run(self, root: etree._Element) -> None:
        """Check the root and all below it."""
        self.below(root, self.grammar.root)

    def below(self, top: etree._Element, name: str) -> None:
        """Check an element, by the declaration with that name, and everything below it."""
        pending = [(top, name, self.minor)]
        while pending:
            element, name, minor = pending.pop()
            declaration = self.grammar.declaration(name, minor)
            if declaration.switch is not None:
                attribute, cases = declaration.switch
                declaration = self.grammar.declaration(cases.get(element.get(attribute, ""), name), minor)
            self._attributes(element, declaration, minor)
            self._conditions(element, declaration, minor)
            if not declaration.anything:
                pending.extend(reversed(_Children(self, element, declaration, minor).check()))
            elif declaration.text is None:
                self.no_text(element, declaration)

    def _conditions(self, element: etree._Element, declaration: Declaration, minor: int) -> None:
        condition = self.grammar.conditions.get(declaration.name)
        if condition is not None and minor >= self.grammar.conditions_since and self.faults.excluded is not None:
            for fault in condition(element):
                self.findings.report(self.faults.excluded, f"<{local_name(element)}> {fault}", element)

    def _attributes(self, element: etree._Element, declaration: Declaration, minor: int) -> None:
        given = cast(Mapping[str, str], element.attrib)
        for name, value in given.items():
            attribute = declaration.attributes.get(name)
            if attribute is None:
                if not name.startswith(_XSI):
                    self._unknown_attribute(element, name, declaration)
            elif attribute.kind and (attribute.kind, value, minor) not in self._fine:
                self.value(element, name, value, attribute, minor)
            if attribute is not None and attribute.range is not None:
                self._range(element, name, value, attribute.range)
        for name, attribute in declaration.attributes.items():
            if attribute.required and name not in given:
                self._missing_attribute(element, name, declaration)

    def _unknown_attribute(self, element: etree._Element, name: str, declaration: Declaration) -> None:
        tag = local_name(element)
        code, hint = self.faults.unknown_attribute, ""
        if self._names_other_versions(code):
            if self.faults.other_version is None:
                knowing = self.grammar.versions_of(tag, name)
            else:
                knowing = self._versions(lambda minor: name in self._declared(declaration, minor).attributes)
            code, hint = self._elsewhere(code, knowing)
            if not hint and self.findings.lists(code):
                hint = did_you_mean(name[:80], declaration.attributes)
        shown = written_name(element, name)
        self.findings.report(code, f"<{tag}> has no attribute {shown[:60]}", element, name, by_name=True, hint=hint)

    def _missing_attribute(self, element: etree._Element, name: str, declaration: Declaration) -> None:
        code, hint = self.faults.missing_attribute, ""
        if self.faults.other_version is not None:

            def without(minor: int) -> bool:
                attribute = self._declared(declaration, minor).attributes.get(name)
                return attribute is None or not attribute.required

            code, hint = self._elsewhere(code, self._versions(without), "it is optional in")
        self.findings.report(code, f"<{local_name(element)}> lacks {name}", element, hint=hint)

    def value(self, element: etree._Element, name: str | None, value: str, attribute: Attribute, minor: int) -> None:
        """Check a value; `name` None: the element's text."""
        kind = attribute.kind
        if self.grammar.is_value(kind, value, minor):
            self._fine.add((kind, value, minor))
            return
        code, hint = self.faults.bad_value, ""
        words = self.grammar.words_of(kind, minor) if kind in self.grammar.words else None
        expected = "not one of the allowed words" if words is not None else f"not {self.grammar.kinds[kind].described}"
        if self._names_other_versions(code) and (words is not None or self.faults.other_version is not None):
            checked = [one for one in self.grammar.minors if one >= self.grammar.words_since]
            code, hint = self._elsewhere(code, [one for one in checked if self.grammar.is_value(kind, value, one)])
        meant = None if hint else self.grammar.loosely(kind, value, minor)
        if meant is not None and self.faults.loose is not None:
            code, hint = self.faults.loose, f"write '{meant}'"
        elif not hint and words is not None and self.findings.lists(code):
            hint = did_you_mean(value[:80], words)
        where = f"the text of <{local_name(element)}>" if name is None else f"{name} of <{local_name(element)}>"
        self.findings.report(code, f"{where} is '{value[:40]}', {expected}", element, name, hint=hint)

    def _range(self, element: etree._Element, name: str, value: str, allowed: Range) -> None:
        """Report a number that is beyond the attribute's range; parameters and expressions are not evaluated."""
        code = self.faults.out_of_range
        if code is None or not is_number(value.strip()):
            return
        number = float(value)
        if not math.isnan(number) and not allowed.contains(number):
            message = f"{name} of <{local_name(element)}> is {value.strip()[:40]}, but must be {allowed.described}"
            self.findings.report(code, message, element, name)

    def no_text(self, element: etree._Element, declaration: Declaration) -> None:
        """Report text in an element that must not have any."""
        texts = [text for text in (element.text, *(child.tail for child in element)) if text]
        stray = next((text for text in texts if not text.isspace()), None)
        if stray is not None:
            shown = stray.strip()[:40]
            message = f"text in <{local_name(element)}>: '{shown}'"
            self.findings.report(self.faults.stray_text, message, element, text=shown.split("\n")[0].rstrip())
        elif declaration.empty and texts and self.faults.blank is not None:
            message = f"blanks in <{local_name(element)}>, which must be empty"
            self.findings.report(self.faults.blank, message, element)

    def unknown_element(
        self, child: etree._Element, parent: etree._Element, declaration: Declaration
    ) -> tuple[str, int] | None:
        """Report a child that is not known here; return its declaration and version when another version has it."""
        tag = local_name(child)
        code, hint = self.faults.unknown_element, ""
        found = None
        if self._names_other_versions(code):
            knowing = self._versions(
                lambda minor: self._declared(declaration, minor).content.declaration(tag) is not None
            )
            code, hint = self._elsewhere(code, knowing)
            if hint and self.faults.other_version is not None and not self.trial:
                found = self._in_other_version(child, declaration, knowing)
            if not hint and self.findings.lists(code):
                hint = did_you_mean(tag[:80], declaration.content.tags())
        shown = written_name(child)
        self.findings.report(code, f"<{shown[:60]}> is not allowed in <{local_name(parent)}>", child, hint=hint)
        return found

    def _in_other_version(
        self, child: etree._Element, declaration: Declaration, knowing: list[int]
    ) -> tuple[str, int] | None:
        """Return the child's declaration in the nearest version in which it has no fault, else in the nearest."""
        nearest = sorted(knowing, key=lambda minor: abs(minor - self.minor))
        found = None
        for minor in nearest:
            name = self._declared(declaration, minor).content.declaration(local_name(child))
            if name is not None:
                trial = _Walk(Findings(self.findings.document, Diagnostics()), self.grammar, minor, trial=True)
                trial.below(child, name)
                found = found or (name, minor)
                if not trial.findings.total:
                    return name, minor
        return found

    def elsewhere(self, declaration: Declaration, tags: list[str]) -> str:
        """Return a hint that names the versions that would take these children as they are, if there are others."""
        if self.faults.other_version is None:
            return ""
        fitting = self._versions(lambda minor: _fits(self._declared(declaration, minor), tags))
        says = "these children are valid in" if tags else "it may be without a child in"
        return self._elsewhere(self.faults.other_version, fitting, says)[1]

    def _declared(self, declaration: Declaration, minor: int) -> Declaration:
        return self.grammar.declaration(declaration.name, minor)

    def _versions(self, fits: Callable[[int], bool]) -> list[int]:
        return [minor for minor in self.grammar.minors if fits(minor)]

    def _names_other_versions(self, code: Code) -> bool:
        return self.faults.other_version is not None or self.findings.lists(code)

    def _elsewhere(self, code: Code, minors: list[int], says: str = "it belongs to") -> tuple[Code, str]:
        """Return the code and the hint for something that these versions know and the file's perhaps does not."""
        if not minors or self.minor in minors:
            return code, ""
        others = ", ".join(f"1.{minor}" for minor in minors)
        hint = f"{says} {self.grammar.name} {others}; the file's version is 1.{self.minor}"
        return self.faults.other_version or code, hint


def _fits(declaration: Declaration, tags: list[str]) -> bool:
    state = declaration.content.start
    for tag in tags:
        state = declaration.content.move(state, tag)
        if not state:
            return False
    return declaration.content.complete(state)


class _Children:
    """The children of one element, checked from the first to the last."""

    def __init__(self, walk: _Walk, element: etree._Element, declaration: Declaration, minor: int) -> None:
        self.walk = walk
        self.element = element
        self.declaration = declaration
        self.content: Content = declaration.content
        self.minor = minor
        self.known: list[tuple[etree._Element, str]] = []
        self.found: list[tuple[etree._Element, str, int]] = []
        self.all_known = True
        self.other = ""

    def check(self) -> list[tuple[etree._Element, str, int]]:
        """Check their order and number; return those that are declared, with declaration and version."""
        for child in self.element.iterchildren(etree.Element):
            tag = child.tag
            name = self.content.declaration(tag)
            if name is None:
                self.all_known = False
                other = self.walk.unknown_element(child, self.element, self.declaration)
                if other is not None:
                    self.found.append((child, *other))
            else:
                self.known.append((child, tag))
                self.found.append((child, name, self.minor))
        self._order()
        if self.declaration.text is None:
            self.walk.no_text(self.element, self.declaration)
        elif self.declaration.text:
            attribute = Attribute(self.declaration.text, True)
            self.walk.value(self.element, None, self.element.text or "", attribute, self.minor)
        return self.found

    def _order(self) -> None:
        """Report children in a wrong place, and missing ones."""
        tags = [tag for _, tag in self.known]
        if _fits(self.declaration, tags):
            return
        self.other = self.walk.elsewhere(self.declaration, tags) if self.all_known else ""
        if self.content.fits_sorted(tags):
            self._disorder()
            return
        counts = Counter(tags)
        state, before = self.content.start, ""
        for child, tag in self.known:
            where = "occurs too often or too late" if counts[tag] > 1 else f"is not allowed after <{before}>"
            state = self._step(state, child, tag, where)
            before = tag
        if not self.content.complete(state) and (lacking := self.content.choices(state, None)):
            message = f"<{self._name()}> lacks {_listed(lacking)}"
            self._report(self.walk.faults.missing_element, message, self.element)

    def _step(self, state: State, child: etree._Element, tag: str, where: str) -> State:
        """Return the state after a child; a misplaced child is reported and does not change the state."""
        after = self.content.move(state, tag)
        if after:
            return after
        lacking = self.content.missing(state, tag)
        if lacking is not None:
            message = f"<{self._name()}> lacks {_listed(self.content.choices(state, tag))} before <{tag}>"
            self._report(self.walk.faults.missing_element, message, child)
            return lacking[1]
        expected = self.content.expected(state)
        hint = f"allowed here: {', '.join(expected)}" if 0 < len(expected) <= MOST_SUGGESTED else ""
        self._report(self.walk.faults.misplaced, f"<{tag}> {where} in <{self._name()}>", child, hint)
        return state

    def _disorder(self) -> None:
        """Report the first child that is too early or too late, of children that are complete."""
        state = self.content.start
        for child, tag in self.known:
            state = self.content.move(state, tag)
            if not state:
                message = f"<{tag}> is in the wrong place in <{self._name()}>"
                hint = f"the order is: {', '.join(self.content.tags())}"
                self._report(self.walk.faults.order, message, child, hint)
                return

    def _report(self, code: Code, message: str, element: etree._Element, hint: str = "") -> None:
        code = self.walk.faults.other_version or code if self.other else code
        self.walk.findings.report(code, message, element, hint=self.other or hint)

    def _name(self) -> str:
        return local_name(self.element)


def _listed(choices: Sequence[Sequence[str]]) -> str:
    """Return the children that an element lacks, each with the others that could stand in its place."""
    separator = " and " if all(len(tags) == 1 for tags in choices) else ", and "
    return separator.join(one_of(tags) for tags in choices)
