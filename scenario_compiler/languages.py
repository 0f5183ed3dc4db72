"""The languages of scenarios, and one way to read, expand and check a file of any of them.

`source` has our conflict language and the AISA toolkit's file, `openscenario` has ASAM's. Neither imports the other, so
the decision between them is made here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple, TypeAlias

from scenario_compiler.diagnostics import Diagnostic, Diagnostics, Place, Severity, did_you_mean
from scenario_compiler.document import Document, read_document
from scenario_compiler.files import suffix_of
from scenario_compiler.markup import codes, names
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.openscenario.contents import OpenScenario, parameter_kinds
from scenario_compiler.resources import library_folder
from scenario_compiler.source.aisa_file import AisaConfig, read_aisa
from scenario_compiler.source.catalogs import CatalogElement, load_catalogs, read_catalog
from scenario_compiler.source.conflict import Library, LibraryElement, read_library
from scenario_compiler.source.declared import Declaration, declared_in
from scenario_compiler.source.expansion import around, catalog_driver, check_template, expand_scenario
from scenario_compiler.source.form import judge_form
from scenario_compiler.source.study_file import QUESTIONNAIRE, STUDY, StudyFile
from scenario_compiler.source.unused import report_unused_templates
from scenario_compiler.vocabulary.driver import Driver
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.word import AttributeSpelling


class ScenarioNameNeededError(Exception):
    """A file contains several scenarios and no name is given; `names` lists them."""

    def __init__(self, names: tuple[str, ...]) -> None:
        """Keep the names, in the file's order."""
        super().__init__(f"name one of the file's scenarios: {', '.join(names)}")
        self.names = names


Source: TypeAlias = Library | AisaConfig | OpenScenario | StudyFile
"""The parsed files of all languages."""

OPENSCENARIO = ("OpenSCENARIO", "OpenScenario")
"""Names of the first element of ASAM's files; the schemas also allow the second one."""


def read_scenario_document(path: str | Path, sink: Diagnostics) -> Document | None:
    """Read a scenario file; in OpenSCENARIO files, comments with two hyphens are corrected, with a warning."""
    if suffix_of(path) == ".xosc":
        from scenario_compiler.openscenario.files import read_forgiving

        return read_forgiving(path, sink)
    return read_document(path, sink)


def parse(document: Document, sink: Diagnostics) -> Source | None:
    """Return the parsed file, by its first element; None, with a diagnostic, if it is not a scenario file."""
    root = str(document.root.tag)
    if root == LibraryElement.tag():
        return read_library(document, sink)
    if root == CatalogElement.tag():
        return Library(document, catalogs=read_catalog(ReadingContext(document, sink, Environment())))
    if root in (STUDY, QUESTIONNAIRE):
        from scenario_compiler.source.study_reading import read_questionnaire, read_study

        return read_study(document, sink) if root == STUDY else read_questionnaire(document, sink)
    if root == "config":
        return read_aisa(document, sink)
    place = document.origin(document.root)
    if root.rpartition("}")[2] in OPENSCENARIO:
        from scenario_compiler.openscenario.expansion import read_openscenario

        return read_openscenario(document, sink)
    known = [LibraryElement.tag(), CatalogElement.tag(), STUDY, QUESTIONNAIRE, "config", "OpenSCENARIO"]
    namespace, _, name = root.removeprefix("{").rpartition("}")
    if name in known and namespace:
        message = f"the elements are in the namespace '{namespace}', which this language does not have"
        sink.add(codes.UNKNOWN_ROOT, message, place, hint=f"remove xmlns from <{name}>")
        return None
    sink.add(
        codes.UNKNOWN_ROOT,
        f"<{root}> is not the first element of a scenario file",
        place,
        hint=did_you_mean(root, known),
    )
    return None


def expand(
    source: Source,
    name: str | None,
    arguments: Mapping[str, str],
    sink: Diagnostics,
) -> Scenario | None:
    """Return one expanded scenario of a file; None if too much of it is faulty.

    A scenario may be returned although the sink has errors, so that later stages can find more faults.

    Args:
        source: The file.
        name: Name of the scenario; None for a file's only one.
        arguments: Values of the scenario's parameters, as text in XML units.
        sink: Receives the diagnostics.

    Raises:
        ScenarioNameNeededError: The file contains several scenarios and no name is given.
    """
    known = tuple(source.scenarios)
    if name is None and len(known) > 1:
        raise ScenarioNameNeededError(tuple(name for name in known if name))
    chosen = known[0] if name is None and known else name
    if isinstance(source, StudyFile) or chosen is None or chosen not in source.scenarios:
        message = f"there is no scenario '{chosen}'" if chosen else "the file contains no scenario"
        if chosen == "":
            message = "the name of the scenario after the '#' is missing"
        place = source.document.origin(source.document.root)
        sink.add(names.UNKNOWN_SCENARIO, message, place, hint=did_you_mean(chosen or "", known))
        return None
    if isinstance(source, OpenScenario):
        from scenario_compiler.openscenario.expansion import expand_openscenario

        return _with_driver(expand_openscenario(source, chosen, arguments, sink), sink)
    catalogs = load_catalogs(library_folder() / "catalogs", sink)
    if isinstance(source, AisaConfig):
        from scenario_compiler.source.aisa import expand_aisa

        return expand_aisa(source, chosen, arguments, sink, catalogs)
    return expand_scenario(source.scenarios[chosen], arguments, sink, around(source, catalogs))


def _with_driver(scenario: Scenario, sink: Diagnostics) -> Scenario:
    """Return a scenario with the model of its driver, or of the default driver, if it has an automated vehicle."""
    driver = scenario.takeover.driver
    if scenario.ego is None or not isinstance(driver, Driver):
        return scenario
    catalogs = load_catalogs(library_folder() / "catalogs", sink)
    takeover = scenario.takeover.model_copy(update={"driver": catalog_driver(driver, catalogs, sink)})
    return scenario.model_copy(update={"takeover": takeover})


def drop_allowed(sink: Diagnostics, source: Source) -> None:
    """Remove the warnings and notes that a file allows for itself and for what it uses, except those insisted on."""
    allowed = (source.allowed if isinstance(source, Library) else frozenset()) - sink.insisted
    path = source.document.path

    def kept(one: Diagnostic) -> bool:
        if one.code.id not in allowed or one.severity is Severity.ERROR:
            return True
        return path not in {one.place.file, *(use.file for use in one.chain())}

    sink.retain(kept)


class Expanded(NamedTuple):
    """A scenario of a file, and whether all of it could be read (see `is_whole`)."""

    scenario: Scenario
    whole: bool


def is_whole(source: Source, found: Iterable[Diagnostic]) -> bool:
    """Return whether a scenario has all that its author wrote, so that its plan can be checked for missing parts.

    Unknown names do not make it incomplete. `found` has the findings of its expansion, and for a file in OpenSCENARIO
    also those of its reading.
    """
    complete = source.complete if isinstance(source, Library) else True
    return complete and all(one.code in names.LEAVING_WHOLE for one in found if one.severity is Severity.ERROR)


def check_source(source: Source, sink: Diagnostics) -> list[Expanded]:
    """Report every fault of every template and scenario of a file; return the scenarios at their defaults.

    A template is expanded once on its own, at its defaults; parts that depend on a parameter without a default stay
    open. A file without faults is also checked against its schema, if it has one.
    """
    if isinstance(source, Library):
        surroundings = around(source, load_catalogs(library_folder() / "catalogs", sink))
        for template in source.own_templates:
            check_template(source.templates[template], sink, surroundings)
    expanded, read = [], list(sink.found)
    for name in source.scenarios:
        found = Diagnostics()
        scenario = expand(source, name, {}, found)
        if scenario is not None:
            known = [*read, *found.found] if isinstance(source, OpenScenario) else found.found
            expanded.append(Expanded(scenario, is_whole(source, known)))
        sink.absorb(found)
    read_without_fault = all(one.place.file != source.document.path for one in sink.found)
    if isinstance(source, Library | StudyFile) and read_without_fault:
        judge_form(source.document, sink)
    if isinstance(source, Library) and is_whole(source, sink):
        report_unused_templates(source, sink)
    return expanded


def map_place(scenario: Scenario, document: Document) -> Place:
    """Return the place at which a scenario's file names the map."""
    logic = document.root.find("{*}RoadNetwork/{*}LogicFile")
    return scenario.place_of("map") if logic is None else document.origin(logic, "filepath")


def declarations(source: Source, name: str | None) -> dict[str, Declaration]:
    """Return the declarations of a scenario's parameters by name; none if there is no such scenario.

    Args:
        source: The file.
        name: Name of the scenario; None for a file's only one.
    """
    if isinstance(source, OpenScenario):
        return {one: Declaration(kind, AttributeSpelling()) for one, kind in parameter_kinds(source).items()}
    return declared_in(source, name) if isinstance(source, Library) else {}
