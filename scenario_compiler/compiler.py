"""The first five stages in sequence: from a file to a plan on its map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, get_args

from lxml import etree

from scenario_compiler.controllers.named import check_controller
from scenario_compiler.diagnostics import Code, CompileError, Diagnostics, FilePlace, Severity
from scenario_compiler.document import UNREADABLE, Document
from scenario_compiler.files import is_plan_file, split_target
from scenario_compiler.languages import (
    Source,
    declarations,
    drop_allowed,
    expand,
    is_whole,
    map_place,
    parse,
    read_scenario_document,
)
from scenario_compiler.markup.codes import UNKNOWN_ROOT
from scenario_compiler.openscenario.contents import OpenScenario
from scenario_compiler.plan.lower import lower
from scenario_compiler.plan.maps import open_map
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import read_plan, sealed
from scenario_compiler.resources import ConflictNotFoundError, library_target, templates_from
from scenario_compiler.roads import Network
from scenario_compiler.source.building import completed
from scenario_compiler.source.declared import Declaration
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.driver import DriverModel, Person
from scenario_compiler.vocabulary.entities import Controller
from scenario_compiler.vocabulary.scenario import Scenario, parameter_values
from scenario_compiler.vocabulary.sensors import Perception
from scenario_compiler.vocabulary.takeover import Message
from scenario_compiler.vocabulary.variation import Vary
from scenario_compiler.vocabulary.weather import is_clear

ROUNDED_PERIOD = Code(
    "SC256",
    "rounded-control-period",
    "The time between two control steps of the scenario is not a whole number of time steps of the given length, so it "
    "is rounded to one. The automation then looks and decides at other times. Choose a time step that divides the time "
    "between two control steps, or another `control_every` in the scenario.\n\n"
    '    <scenario ... step="0.05">  --dt 0.02     control steps every 0.04 s in place of 0.05 s',
    Severity.NOTE,
)

SLACK = 1.0e-5
"""Largest change of the time between two control steps that is not reported, as a share of it."""


@dataclass(frozen=True)
class Compilation:
    """The result of compiling a scenario: the plan, the map to which it is bound, and the scenario itself."""

    plan: Plan
    network: Network
    scenario: Scenario


@dataclass(frozen=True)
class Overrides:
    """Values that replace those of a scenario; None keeps the scenario's value.

    Attributes:
        perception: Source of the lane confidence: "camera", "ideal" or "surrogate".
        controller: Name of the ego vehicle's controller, package.module:Class or file.py:Class. The properties in the
            scenario belong to the controller that the scenario names; another one does not get them.
        step: Length of a time step, s; 0.001 to 1. The time between two control steps stays that of the scenario,
            rounded to a whole number of time steps: how often the automation looks and decides does not depend on how
            finely motion is computed.
        duration: Latest end of the run, s; above 0 and below 1e6.
        driven_by: Who takes over and drives: a "person", or the driver "model".
        messages: Messages of the automation to the driver.

    Raises:
        ValueError: A value is not possible.
    """

    perception: Perception | None = None
    controller: str | None = None
    step: float | None = None
    duration: float | None = None
    driven_by: Literal["person", "model"] | None = None
    messages: tuple[Message, ...] | None = None

    def __post_init__(self) -> None:
        if self.perception is not None and self.perception not in get_args(Perception):
            raise ValueError(f"perception is one of {', '.join(get_args(Perception))}, not {self.perception!r}")
        if self.step is not None and not 0.001 <= self.step <= 1.0:
            raise ValueError(f"step is from 0.001 to 1 s, not {self.step}")
        if self.duration is not None and not 0.0 < self.duration < 1.0e6:
            raise ValueError(f"duration is above 0 and below 1e6 s, not {self.duration}")

    def trusting(self, trust: Trust, beside: Path) -> Trust:
        """Return a trust that also covers the controller set here, and that looks for code in the scenario's folder."""
        named = trust.named if self.controller is None else (*trust.named, self.controller)
        return Trust(named, trust.beside or beside)

    def applied(self, scenario: Scenario) -> Scenario:
        """Return the scenario with the overrides applied."""
        changes: dict[str, object] = {}
        if self.step is not None:
            changes["step"] = self.step
            changes["control_every"] = max(round(scenario.step * scenario.control_every / self.step), 1)
        if self.duration is not None:
            changes["duration"] = self.duration
        ego = scenario.ego
        own = ego.controller if ego is not None else None
        if self.controller is not None and ego is not None and (own is None or own.model != self.controller):
            named = Controller(model=self.controller).written_at(FilePlace("--controller"))
            changes["ego"] = ego.model_copy(update={"controller": named})
        of_takeover: dict[str, object] = {}
        driver = scenario.takeover.driver
        if self.driven_by is not None and isinstance(driver, DriverModel):
            person = Person() if self.driven_by == "person" else None
            of_takeover["driver"] = driver.model_copy(update={"by_person": person})
        if self.messages is not None:
            of_takeover["messages"] = self.messages
        if of_takeover:
            changes["takeover"] = scenario.takeover.model_copy(update=of_takeover)
        return scenario.model_copy(update=changes)


def read_source(path: str | Path, sink: Diagnostics) -> tuple[Document, Source] | None:
    """Read and parse a scenario file; return None if it cannot be parsed.

    The returned document is that of the scenario. It is not `path` if that file contains values for the parameters of a
    scenario in another file.
    """
    if is_plan_file(path):
        if read_plan(path, sink) is not None:
            message = "the file is a plan, which has been compiled already: `run`, `sweep` and `export` take it"
            sink.add(UNKNOWN_ROOT, message, FilePlace(str(path)))
        return None
    document = read_scenario_document(path, sink)
    source = None if document is None else parse(document, sink)
    return None if source is None else (source.document, source)


def found_target(target: str | Path, sink: Diagnostics) -> str | Path | None:
    """Return FILE#name for the name of a conflict of the library, and any other target unchanged; None if unknown."""
    if not split_target(target)[0]:
        sink.add(UNREADABLE, "no file is named before the '#'", FilePlace(str(target)), hint="write FILE#NAME")
        return None
    try:
        return library_target(target)
    except ConflictNotFoundError as missing:
        sink.add(UNREADABLE, str(missing), FilePlace(str(target)), hint=missing.hint)
        return None


def compile_target(
    target: str | Path,
    arguments: Mapping[str, str],
    sink: Diagnostics,
    *,
    maps: Sequence[Path] = (),
    overrides: Overrides | None = None,
    trust: Trust | None = None,
) -> Compilation | None:
    """Compile FILE, FILE#name or a conflict of the library by its name; return None if the sink has errors.

    Args:
        target: The file, with the name of a scenario if the file has several; or the name of a conflict.
        arguments: Values of the scenario's parameters, as text in XML units.
        sink: Receives the diagnostics.
        maps: Folders in which its map is looked for first.
        overrides: Values that replace those of the scenario; a controller named here is trusted.
        trust: Code that the user trusts; of other code that the file names, only the spelling is checked.

    Raises:
        ConfigurationError: The user's configuration file cannot be read.
        ScenarioNameNeededError: The file has several scenarios and no name is given.
    """
    found = found_target(target, sink)
    if found is None:
        return None
    path, name = split_target(found)
    read = read_source(path, sink)
    if read is None:
        return None
    document, source = read
    scenario = expand(source, name, arguments, sink)
    settings, whole = overrides or Overrides(), is_whole(source, sink)
    trusted = settings.trusting(trust or Trust(), Path(path).parent)
    done = (
        None
        if scenario is None
        else compile_expanded(scenario, document, sink, maps, settings, whole=whole, trust=trusted)
    )
    drop_allowed(sink, source)
    return None if done is None else replace(done, plan=sealed(done.plan))


def variation_of(target: str | Path, arguments: Mapping[str, str], sink: Diagnostics) -> Vary | None:
    """Return the variation that FILE or FILE#name declares; None if it declares none or has errors.

    Raises:
        ScenarioNameNeededError: The file has several scenarios and no name is given.
    """
    path, name = split_target(target)
    read = read_source(path, sink)
    if read is None:
        return None
    source = read[1]
    if isinstance(source, OpenScenario):
        return None if source.variation is None or sink.has_errors else source.variation.vary
    scenario = expand(source, name, arguments, sink)
    return None if scenario is None or sink.has_errors else scenario.vary


def declared_parameters(target: str | Path) -> dict[str, Declaration]:
    """Return the declared parameters of FILE or FILE#name by name; none if the file cannot be read."""
    path, name = split_target(target)
    read = read_source(path, Diagnostics())
    return {} if read is None else declarations(read[1], name)


def compile_expanded(
    scenario: Scenario,
    document: Document,
    sink: Diagnostics,
    maps: Sequence[Path],
    overrides: Overrides,
    *,
    whole: bool = True,
    trust: Trust | None = None,
) -> Compilation | None:
    """Compile an expanded scenario of `document` without sealing the plan; return None if the sink has errors.

    If parts of the scenario could not be read, the plan is not checked for missing parts.
    """
    applied = overrides.applied(scenario)
    _check_period(scenario, applied, sink)
    scenario = applied
    network = open_map(scenario.map, document.folder, map_place(scenario, document), sink, maps)
    if network is None:
        return None
    plan = lower(
        scenario,
        network,
        sink,
        values=parameter_values(scenario.parameters),
        perception=overrides.perception or "camera",
        whole=whole,
    )
    check_controller(plan, sink, trust)
    if plan.perception == "surrogate":
        from scenario_compiler.engine.program.surrogate import check_surrogate

        check_surrogate(plan, sink)
    if sink.has_errors:
        return None
    if plan.controller is not None and _may_see_less(plan):
        from scenario_compiler.engine.at_first import check_at_first

        check_at_first(plan, network, sink)
    return Compilation(plan, network, scenario)


def _check_period(scenario: Scenario, applied: Scenario, sink: Diagnostics) -> None:
    """Report a time between two control steps that another length of the time step has changed."""
    own, period = (one.step * one.control_every for one in (scenario, applied))
    if abs(period - own) > SLACK * own:
        message = (
            f"with time steps of {applied.step:g} s, control steps are {period:.6g} s apart in place of {own:.6g} s"
        )
        hint = f"a time step of {own / applied.control_every:.6g} s keeps their times"
        sink.add(ROUNDED_PERIOD, message, scenario.place_of("step"), hint=hint)


def _may_see_less(plan: Plan) -> bool:
    """Return whether weather or noise may take something from a sensor at the start; if not, no engine is needed."""
    sensor = plan.forward_sensor
    return not is_clear(plan.weather) or bool(plan.camera.failures or plan.camera.sensor_noise or sensor.noise)


def compile_scenario(
    path: str | Path,
    *,
    overrides: Overrides | None = None,
    maps: Sequence[str | Path] = (),
    templates: Sequence[str | Path] = (),
    trust: Trust | None = None,
    **arguments: object,
) -> Plan:
    """Compile FILE, FILE#name or a conflict of the library by its name, with these values of its parameters.

    Args:
        path: The file, with the name of a scenario if the file has several; or the name of a conflict.
        overrides: Values that replace those of the scenario: perception, controller, step, duration.
        maps: Folders in which its map is looked for first.
        templates: Folders in which its templates are looked for first.
        trust: Trusted code; of other code that the file names, only the spelling is checked.
        **arguments: Values of the scenario's parameters, by name.

    Raises:
        CompileError: The input has errors, which are in `diagnostics`.
        ScenarioNameNeededError: The file has several scenarios and no name is given.
        TypeError: `overrides`, `maps`, `templates` or `trust` has the value of a scenario's parameter. For a scenario
            with parameters of these names, use `compile_target`.
    """
    _refuse_values(overrides, maps, templates, trust)
    sink = Diagnostics()
    texts = {name: _as_text(value) for name, value in arguments.items()}
    folders = [Path(one) for one in maps]
    with templates_from([Path(one) for one in templates]):
        compilation = compile_target(path, texts, sink, maps=folders, overrides=overrides, trust=trust)
    if compilation is None:
        raise CompileError(sink)
    return compilation.plan


def compile_built(
    scenario: Scenario,
    *,
    maps: Sequence[str | Path] = (),
    perception: Perception | None = None,
    sink: Diagnostics | None = None,
) -> Compilation:
    """Compile a scenario that a program has built from words; relative paths start from the current folder.

    Args:
        scenario: The scenario; vehicles and drivers of the library's catalogs are filled in.
        maps: Folders in which its map is looked for first.
        perception: Source of the lane confidence; None means the camera.
        sink: Receives the diagnostics, also the warnings of a scenario that compiles.

    Raises:
        CompileError: The scenario has errors, which are in `diagnostics`.
        TypeError: `scenario` is not a Scenario.
    """
    if not isinstance(scenario, Scenario):
        raise TypeError(f"scenario is a Scenario, not {scenario!r}")
    sink = Diagnostics() if sink is None else sink
    whole = completed(scenario, sink)
    nowhere = Document("<python>", "", etree.Element(Scenario.tag()))
    overrides = Overrides(perception=perception)
    done = None if sink.has_errors else compile_expanded(whole, nowhere, sink, [Path(one) for one in maps], overrides)
    if done is None:
        raise CompileError(sink)
    return replace(done, plan=sealed(done.plan))


def _refuse_values(overrides: object, maps: object, templates: object, trust: object) -> None:
    """Raise TypeError for what a caller meant as the value of a scenario's parameter of that name."""
    if not isinstance(overrides, Overrides | None):
        raise TypeError(f"overrides is an Overrides, not {overrides!r}; it does not set a parameter")
    for name, folders in (("maps", maps), ("templates", templates)):
        if isinstance(folders, str) or not isinstance(folders, Sequence):
            raise TypeError(f"{name} is a list of folders, not {folders!r}; it does not set a parameter")
    if not isinstance(trust, Trust | None):
        raise TypeError(f"trust is a Trust, not {trust!r}; it does not set a parameter")


def _as_text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
