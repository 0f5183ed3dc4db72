"""The first five stages in a row: a file to a plan on its map."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from lxml import etree

from scenario_compiler.controllers import check_controller
from scenario_compiler.diagnostics import Code, CompileError, Diagnostic, Diagnostics, FilePlace
from scenario_compiler.document import UNREADABLE, Document, read_document
from scenario_compiler.plan.lower import Perception, lower
from scenario_compiler.plan.maps import open_map
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import sealed
from scenario_compiler.roads import Network
from scenario_compiler.source import Source, check_source, drop_allowed, expand, parse
from scenario_compiler.source.building import completed
from scenario_compiler.source.documents import map_place, read_scenario_document
from scenario_compiler.structure.schemas import Schemas
from scenario_compiler.vocabulary.entities import Controller
from scenario_compiler.vocabulary.scenario import Scenario, parameter_values
from scenario_compiler.vocabulary.variation import Vary

UNCHECKED = Code(
    "SC117",
    "unchecked-file",
    "Checking the file failed for a reason that lies in this program or the machine, not in the file: a fault of the "
    "the program, or no memory left. The other files were checked.\n\n"
    "    the file could not be checked: MemoryError\n\n"
    "Check the file alone; if that fails too, please report it with the file.",
)


@dataclass(frozen=True)
class Compilation:
    """What compiling a scenario yields: the plan, the map that it is bound to, and the scenario itself."""

    plan: Plan
    network: Network
    scenario: Scenario


@dataclass(frozen=True)
class Overrides:
    """What a command sets in place of the scenario; None leaves it to the scenario.

    Attributes:
        perception: What the lane confidence comes from.
        controller: Name of the ego vehicle's controller.
        step: Length of a time step, s.
        duration: When the run ends at the latest, s.
    """

    perception: Perception | None = None
    controller: str | None = None
    step: float | None = None
    duration: float | None = None

    def applied(self, scenario: Scenario) -> Scenario:
        """Return the scenario with the overrides in it."""
        changes: dict[str, object] = {}
        if self.step is not None:
            changes["step"] = self.step
        if self.duration is not None:
            changes["duration"] = self.duration
        if self.controller is not None and scenario.ego is not None:
            named = Controller(model=self.controller).written_at(scenario.ego.controller.origin)
            changes["ego"] = scenario.ego.model_copy(update={"controller": named})
        return scenario.model_copy(update=changes)


def split_target(target: str | Path) -> tuple[str, str | None]:
    """Split FILE#name into the file and the scenario's name; a file whose own name has a '#' stays whole."""
    text = str(target)
    if "#" not in text or Path(text).is_file():
        return text, None
    path, _, name = text.rpartition("#")
    return path, name


def read_source(path: str | Path, sink: Diagnostics) -> tuple[Document, Source] | None:
    """Read and parse a scenario file; None when nothing can be made of it.

    The document is the scenario's: another file than `path` when that gives values for the scenario's parameters.
    """
    document = read_scenario_document(path, sink)
    source = None if document is None else parse(document, sink)
    return None if source is None else (source.document, source)


def compile_target(
    target: str | Path,
    arguments: Mapping[str, str],
    sink: Diagnostics,
    *,
    maps: Sequence[Path] = (),
    overrides: Overrides | None = None,
) -> Compilation | None:
    """Compile FILE or FILE#name; None when the sink has errors.

    Raises:
        ScenarioNameNeededError: The file has several scenarios and no name is given.
    """
    path, name = split_target(target)
    read = read_source(path, sink)
    if read is None:
        return None
    document, source = read
    scenario = expand(source, name, arguments, sink)
    done = None if scenario is None else compile_expanded(scenario, document, sink, maps, overrides or Overrides())
    drop_allowed(sink, source)
    return None if done is None else replace(done, plan=sealed(done.plan))


def variation_of(target: str | Path, arguments: Mapping[str, str], sink: Diagnostics) -> Vary | None:
    """Return how FILE or FILE#name says that a sweep varies it; None when it says nothing, or is at fault.

    Raises:
        ScenarioNameNeededError: The file has several scenarios and no name is given.
    """
    path, name = split_target(target)
    read = read_source(path, sink)
    scenario = None if read is None else expand(read[1], name, arguments, sink)
    return None if scenario is None or sink.has_errors else scenario.vary


def compile_expanded(
    scenario: Scenario, document: Document, sink: Diagnostics, maps: Sequence[Path], overrides: Overrides
) -> Compilation | None:
    """Compile an expanded scenario that was written in `document` but for the seal; None when the sink has errors."""
    scenario = overrides.applied(scenario)
    network = open_map(scenario.map, document.folder, map_place(scenario, document), sink, maps)
    if network is None:
        return None
    plan = lower(
        scenario,
        network,
        sink,
        values=parameter_values(scenario.parameters),
        perception=overrides.perception or "camera",
    )
    if plan is None:
        return None
    check_controller(plan, sink)
    return None if sink.has_errors else Compilation(plan, network, scenario)


def compile_scenario(path: str | Path, **arguments: object) -> Plan:
    """Compile FILE or FILE#name with these values of its parameters.

    Raises:
        CompileError: The input is at fault; its `diagnostics` say how.
    """
    sink = Diagnostics()
    texts = {name: _as_text(value) for name, value in arguments.items()}
    compilation = compile_target(path, texts, sink)
    if compilation is None:
        raise CompileError(sink)
    return compilation.plan


def compile_built(
    scenario: Scenario, *, maps: Sequence[str | Path] = (), perception: Perception | None = None
) -> Compilation:
    """Compile a scenario that a program has built from words; relative paths start from the current folder.

    Args:
        scenario: The scenario; what it leaves to the library's catalogs is filled in.
        maps: Folders that its map is looked for in first.
        perception: What the lane confidence comes from; the camera when None.

    Raises:
        CompileError: The scenario is at fault; its `diagnostics` say how.
    """
    sink = Diagnostics()
    whole = completed(scenario, sink)
    nowhere = Document("<python>", "", etree.Element(Scenario.tag()))
    overrides = Overrides(perception=perception)
    done = None if sink.has_errors else compile_expanded(whole, nowhere, sink, [Path(one) for one in maps], overrides)
    if done is None:
        raise CompileError(sink)
    return replace(done, plan=sealed(done.plan))


SUFFIXES = (".xml", ".xosc", ".xodr")
"""Endings of the files that `validate` takes from a folder."""


def files_below(path: Path) -> list[Path]:
    """Return a file itself, or all scenario and road files below a folder, sorted."""
    if not path.is_dir():
        return [path]
    return sorted(file for file in path.rglob("*") if file.suffix in SUFFIXES and file.is_file())


MOST_SCENARIO_BYTES = 16 * 1024 * 1024
"""Largest scenario file that `validate` looks into, bytes; the library's largest has 10 kB."""

FILES_A_TASK = 8
"""Files that a process checks before it hands its findings over."""


def validate_file(path: Path, sink: Diagnostics, maps: Sequence[Path] = (), xsd: Schemas | None = None) -> None:
    """Report every fault of one file: of all its templates and scenarios, or of the roads that it holds.

    `xsd` is where ASAM's schemas are: where there is one of the version of a road file, or of a file in OpenSCENARIO,
    that schema judges the file's structure, else what our readers declare does. Of a file in OpenSCENARIO, the
    structure alone decides: what its meaning lacks is a warning, and so is a fault of this program in telling that.
    """
    if path.suffix == ".xodr":
        document = read_document(path, sink)
        if document is not None and (xsd is None or _by_schema(document, xsd, sink) is None):
            from scenario_compiler.roads.structure import check_structure

            check_structure(document, sink)
        return
    if path.is_file() and path.stat().st_size > MOST_SCENARIO_BYTES:
        message = f"the file has {path.stat().st_size} bytes; scenario files have at most {MOST_SCENARIO_BYTES}"
        sink.add(UNREADABLE, message, FilePlace(str(path)))
        return
    if path.suffix == ".xosc":
        from scenario_compiler.source.openscenario.validation import add_meaning, validate_openscenario

        meaning = Diagnostics()
        validate_openscenario(path, sink, xsd)
        try:
            _check_scenarios(path, meaning, maps)
        except Exception as fault:
            meaning.found.append(_unchecked(path, f"{type(fault).__name__}: {fault}"[:300]))
        add_meaning(meaning, sink)
    else:
        _check_scenarios(path, sink, maps)


def _check_scenarios(path: Path, sink: Diagnostics, maps: Sequence[Path]) -> None:
    """Report every fault of all templates and scenarios of a file."""
    read = read_source(path, sink)
    if read is None:
        return
    document, source = read
    for scenario in check_source(source, sink):
        compile_expanded(scenario, document, sink, maps, Overrides())
    drop_allowed(sink, source)


def _by_schema(document: Document, schemas: Schemas, sink: Diagnostics) -> bool | None:
    from scenario_compiler.roads.xsd import validate_with_xsd

    return None if schemas.folder is None else validate_with_xsd(document, schemas.folder, sink)


def validate_files(
    files: Sequence[Path],
    maps: Sequence[Path] = (),
    processes: int = 1,
    xsd: Schemas | None = None,
    insisted: frozenset[str] = frozenset(),
) -> Iterator[list[Diagnostic]]:
    """Yield the findings of each file, in the order of the files.

    Args:
        files: The files.
        maps: Folders that maps are looked for in first.
        processes: Number of processes to spread the files over; few files are checked in this one.
        xsd: Where ASAM's schemas are, None to do without.
        insisted: Codes of warnings that are reported even where a file allows them.
    """
    tasks = [files[at : at + FILES_A_TASK] for at in range(0, len(files), FILES_A_TASK)]
    if processes < 2 or len(tasks) < 2 * processes:
        for file in files:
            yield _findings([file], maps, xsd, insisted)[0]
        return
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    with ProcessPoolExecutor(processes, mp_context=get_context("spawn"), initializer=_spare_collector) as pool:
        for task, found in [(task, pool.submit(_findings, task, maps, xsd, insisted)) for task in tasks]:
            try:
                yield from found.result()
            except BrokenProcessPool:
                message = "a process that checked this file, or one beside it, was ended by the system"
                yield from ([_unchecked(file, message)] for file in task)


def _spare_collector() -> None:
    """Let the garbage collector of a process that checks files look seldom, and never at what is loaded by now."""
    gc.set_threshold(100_000, 50, 50)
    gc.freeze()


def _findings(
    files: Sequence[Path], maps: Sequence[Path], xsd: Schemas | None, insisted: frozenset[str]
) -> list[list[Diagnostic]]:
    """Return the findings of each file; a fault of this program is a finding too, and the other files go on."""
    found = []
    for file in files:
        sink = Diagnostics(insisted=insisted)
        try:
            validate_file(file, sink, maps, xsd)
        except Exception as fault:
            sink.found.append(_unchecked(file, f"{type(fault).__name__}: {fault}"[:300]))
        found.append(list(sink))
    return found


def _unchecked(file: Path, message: str) -> Diagnostic:
    return Diagnostic(UNCHECKED, f"the file could not be checked: {message}", FilePlace(str(file)))


def _as_text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
