"""`list`, `new`, `preview` and `convert`: from a library to a conflict of your own."""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    add_scenario,
    add_target,
    add_templates,
    compiled,
    folder,
    has_errors,
    inputs_of,
    keep_inputs,
    new_sink,
    show,
    text_stream,
)
from scenario_compiler.cli.terminal import put, put_table, tell
from scenario_compiler.diagnostics import Diagnostics, suggestion
from scenario_compiler.files import files_in, suffix_of
from scenario_compiler.garbage_collection import keep_loaded
from scenario_compiler.outputs import write_whole

if TYPE_CHECKING:
    from scenario_compiler.listing import Listed
    from scenario_compiler.report.gallery import Card


def add(commands: Commands) -> None:
    """Declare the commands."""
    listing = commands.add_parser("list", help="list the conflicts and templates of a library")
    listing.add_argument(
        "paths", nargs="*", type=Path, metavar="PATH", help="file or folder; the packaged library by default"
    )
    listing.add_argument(
        "--templates",
        action="append",
        nargs="?",
        type=folder,
        default=[],
        metavar="DIR",
        help="print each template with its parameters, their units and limits; with DIR, also those of that folder",
    )
    listing.add_argument(
        "--html", type=Path, metavar="FILE.html", help="write a gallery with pictures instead of printing"
    )
    listing.set_defaults(command=list_command)
    new = commands.add_parser("new", help="write a new conflict from a template")
    new.add_argument("name", metavar="NAME", help="name of the scenario; the file is NAME.xml")
    new.add_argument("--from", dest="template", required=True, metavar="TEMPLATE", help="template that it uses")
    new.add_argument("--force", action="store_true", help="overwrite an existing file")
    new.set_defaults(command=new_command)
    preview = commands.add_parser("preview", help="draw a plan without running it")
    add_target(preview)
    preview.add_argument(
        "-o", dest="output", type=Path, required=True, metavar="FILE.png|FILE.svg", help="picture to write"
    )
    add_scenario(preview)
    preview.set_defaults(command=preview_command)
    convert = commands.add_parser("convert", help="convert a file of the AISA toolkit to the conflict language")
    convert.add_argument("file", type=Path, metavar="FILE", help="file of the AISA toolkit")
    convert.add_argument("-o", dest="output", type=Path, required=True, metavar="OUT.xml", help="conflict to write")
    convert.set_defaults(command=convert_command)
    for parser in (listing, preview):
        add_maps(parser)
    for parser in (new, preview):
        add_templates(parser)
    for parser in (listing, new, preview, convert):
        add_diagnostics(parser)


def list_command(options: argparse.Namespace) -> int:
    """Print the conflicts and templates of a library."""
    sink = new_sink(options)
    if options.templates and options.html is None:
        return _list_templates(options, sink)
    listed = list(_listed(options, sink))
    if options.html is not None:
        return _write_gallery(options, listed, sink)
    _print_tables(listed, text_stream(options))
    if not listed and not has_errors(sink, options):
        tell(f"no conflict and no template in {', '.join(map(str, options.paths))}")
    return AT_FAULT if show(sink, options) else FINE


def _list_templates(options: argparse.Namespace, sink: Diagnostics) -> int:
    """Print every template that can be named, or those of the paths that are given, with its parameters."""
    from scenario_compiler.listing import list_templates
    from scenario_compiler.source.parameters import parameter_kind

    found = [one for one in _listed(options, sink) if one.kind == "template"] if options.paths else []
    found = found or list(list_templates(sink))
    rows: list[tuple[str, str, str, str]] = []
    for template in found:
        rows.append((template.name, "", "", template.summary))
        rows += [
            (f"  {one.name}", parameter_kind(one), "(required)" if one.default is None else one.default, one.summary)
            for one in template.parameters
        ]
    put_table(("template, parameters", "values", "default", "description"), rows, text_stream(options))
    return AT_FAULT if show(sink, options) else FINE


def _print_tables(listed: list[Listed], file: TextIO) -> None:
    """Print the conflicts, the templates and the varied parameters as tables, leaving out empty ones."""

    def rows_of(kind: str) -> list[tuple[str, ...]]:
        return [(one.name, _short(one.file), one.gold, one.map, one.summary) for one in listed if one.kind == kind]

    what = ("file", "Gold", "map", "what happens")
    put_table(("conflict", *what), rows_of("conflict"), file)
    put_table(("template", *what), rows_of("template"), file)
    varied = [(one.name, *axis) for one in listed for axis in one.varied]
    put_table(("conflict", "varied", "values"), varied, file)


def _short(path: Path) -> str:
    """Return a path relative to the current folder if it lies below it, else the absolute path."""
    whole = path.resolve()
    return str(whole.relative_to(Path.cwd())) if whole.is_relative_to(Path.cwd()) else str(whole)


def _listed(options: argparse.Namespace, sink: Diagnostics) -> Iterator[Listed]:
    from scenario_compiler.listing import list_library
    from scenario_compiler.resources import library_folder

    keep_loaded()
    for path in options.paths or [library_folder()]:
        if not path.exists():
            raise WrongUse(f"there is no file or folder '{path}'")
        yield from list_library(path, sink)


def _write_gallery(options: argparse.Namespace, listed: list[Listed], sink: Diagnostics) -> int:
    from scenario_compiler.report.gallery import write_gallery

    keep_inputs([*options.paths, *(one.target for one in listed if one.kind == "conflict")], options.html)
    write_gallery(_cards(options, listed, sink), options.html)
    failed = show(sink, options)
    put(f"gallery: {options.html}", text_stream(options))
    return AT_FAULT if failed else FINE


def _cards(options: argparse.Namespace, listed: list[Listed], sink: Diagnostics) -> Iterator[Card]:
    from scenario_compiler.compiler import Overrides, compile_target
    from scenario_compiler.report.gallery import Card, moment_of

    for one in listed:
        if one.kind != "conflict":
            continue
        overrides = Overrides(perception="ideal", driven_by="model")
        found = compile_target(one.target, {}, sink, maps=options.maps, overrides=overrides)
        if found is not None:
            group = one.file.stem.replace("_", " ")
            moment = moment_of(found.plan, found.network)
            yield Card(group, one.name, one.summary, one.source, _command(one), found.plan.map.name, moment)


def _command(one: Listed) -> str:
    """Return the command that runs a conflict: by its name if it is packaged, otherwise from its file's folder."""
    from scenario_compiler.resources import library_folder

    ours = one.file.resolve().is_relative_to(library_folder().resolve())
    return f"scenario-compiler run {shlex.quote(one.name if ours else f'{one.file.name}#{one.name}')}"


def new_command(options: argparse.Namespace) -> int:
    """Write a commented conflict that uses a template."""
    from scenario_compiler.listing import list_templates
    from scenario_compiler.resources import template_folders
    from scenario_compiler.source.authoring import new_conflict
    from scenario_compiler.vocabulary.word import IDENTIFIER

    if not re.fullmatch(IDENTIFIER, options.name):
        raise WrongUse(f"'{options.name}' is not a name: use letters, digits and _ only, and no digit at the start")
    file = Path(f"{options.name}.xml")
    if file.exists() and not options.force:
        raise WrongUse(f"{file} exists already; --force overwrites it")
    sink = new_sink(options)
    templates = {one.name: one for one in list_templates(sink)}
    chosen = templates.get(options.template)
    if chosen is None:
        raise WrongUse(f"there is no template '{options.template}'{suggestion(options.template, templates)}")
    keep_inputs((one for folder in template_folders() for one in files_in(folder, ".xml", deep=True)), file)
    write_whole(file, new_conflict(options.name, chosen.name, chosen.summary, chosen.parameters))
    put(file, text_stream(options))
    return AT_FAULT if show(sink, options) else FINE


def preview_command(options: argparse.Namespace) -> int:
    """Draw the plan: its part of the map, the entities, the route, and the conditions of its events."""
    if suffix_of(options.output) not in (".png", ".svg"):
        raise WrongUse(f"{options.output}: a plan is drawn as .png or .svg")
    sink = new_sink(options)
    compilation = compiled(options, sink)
    if show(sink, options) or compilation is None:
        return AT_FAULT
    from scenario_compiler.report.preview import draw_preview

    keep_inputs(inputs_of(compilation.plan), options.output)
    draw_preview(compilation.plan, compilation.network, options.output)
    return FINE


def convert_command(options: argparse.Namespace) -> int:
    """Convert a file of the AISA toolkit to the conflict language."""
    from scenario_compiler.compiler import read_source
    from scenario_compiler.source.aisa_conversion import convert_aisa
    from scenario_compiler.source.aisa_file import AisaConfig

    sink = new_sink(options)
    keep_inputs([options.file], options.output)
    read = read_source(options.file, sink)
    if read is None:
        show(sink, options)
        return AT_FAULT
    if not isinstance(read[1], AisaConfig):
        raise WrongUse(f"{options.file} is not a file of the AISA toolkit")
    text = convert_aisa(read[1], sink)
    if show(sink, options):
        return AT_FAULT
    write_whole(options.output, text)
    return FINE
