"""`map`: summarise, check and draw road files, and export them for other programs."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    keep_inputs,
    show,
    text_stream,
)
from scenario_compiler.cli.terminal import put
from scenario_compiler.diagnostics import Diagnostics, suggestion
from scenario_compiler.files import MAX_BYTES, suffix_of
from scenario_compiler.outputs import write_whole

if TYPE_CHECKING:
    from scenario_compiler.document import Document
    from scenario_compiler.roads import Network


def add(commands: Commands) -> None:
    """Declare the commands."""
    actions = commands.add_parser("map", help="summarise, check, draw or export road files").add_subparsers(
        required=True, metavar="ACTION"
    )
    info = actions.add_parser("info", help="print a summary of a map")
    info.set_defaults(command=map_info_command)
    check = actions.add_parser("check", help="report the faults of a road file")
    check.add_argument("--xsd", type=Path, metavar="DIR", help="check against ASAM's schemas in this folder too")
    check.set_defaults(command=map_check_command)
    plot = actions.add_parser("plot", help="draw a map")
    plot.add_argument(
        "-o", dest="output", type=Path, required=True, metavar="FILE.png|FILE.svg", help="picture to write"
    )
    plot.set_defaults(command=map_plot_command)
    export = actions.add_parser("export", help="export a map for other programs")
    form = export.add_mutually_exclusive_group(required=True)
    form.add_argument("--for", choices=("carla",), dest="client", help="write OpenDRIVE that CARLA can load")
    form.add_argument("--mesh", action="store_true", help="write the surfaces and road marks as .gltf, .glb or .obj")
    export.add_argument("-o", dest="output", type=Path, required=True, metavar="FILE", help="file to write")
    export.set_defaults(command=map_export_command)
    for parser in (info, check, plot, export):
        parser.add_argument("file", metavar="FILE", help="OpenDRIVE file, or the name of a map on the search path")
        add_maps(parser)
        add_diagnostics(parser)


def _map_file(options: argparse.Namespace) -> Path:
    from scenario_compiler.resources import MapNotFoundError, find_map, known_maps

    try:
        return find_map(options.file, folders=options.maps)
    except MapNotFoundError as missing:
        raise WrongUse(f"{missing}{suggestion(options.file, known_maps(options.maps))}") from None


def _loaded_map(options: argparse.Namespace, sink: Diagnostics) -> tuple[Document, Network] | None:
    from scenario_compiler.document import read_document
    from scenario_compiler.roads import load_network

    path = _map_file(options)
    document = read_document(path, sink, MAX_BYTES)
    network = None if document is None else load_network(path, sink=sink)
    return None if document is None or network is None else (document, network)


def map_info_command(options: argparse.Namespace) -> int:
    """Print a summary of a map."""
    from dataclasses import fields

    from scenario_compiler.roads.describe import describe_network

    sink = Diagnostics()
    loaded = _loaded_map(options, sink)
    show(sink, options)
    if loaded is None:
        return AT_FAULT
    description = describe_network(loaded[1])
    for one in fields(description):
        put(f"{one.name.replace('_', ' '):<26}{_listed(getattr(description, one.name))}", text_stream(options))
    return FINE


def _listed(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{_listed(name)}: {_listed(count)}" for name, count in value.items()) or "none"
    if isinstance(value, tuple):
        return ", ".join(_listed(one) for one in value)
    return f"{value:.2f}" if isinstance(value, float) else str(value)


def map_check_command(options: argparse.Namespace) -> int:
    """Print the faults of a road file, and the elements and attributes of it that are not read."""
    from scenario_compiler.document import read_document
    from scenario_compiler.roads.check import check_file
    from scenario_compiler.roads.check.unread import unread
    from scenario_compiler.roads.xsd import validate_with_xsd

    sink = Diagnostics()
    path = _map_file(options)
    check_file(path, sink)
    document = read_document(path, sink, MAX_BYTES)
    if document is not None and options.xsd is not None:
        validate_with_xsd(document, options.xsd, sink)
    failed = show(sink, options)
    if document is not None and options.format == "text":
        for one in unread(document):
            attribute = f" attribute {one.attribute}" if one.attribute else ""
            put(f"{path}:{one.line}: not read: {one.path}{attribute} ({one.count})")
    return AT_FAULT if failed else FINE


def map_plot_command(options: argparse.Namespace) -> int:
    """Draw a map."""
    from scenario_compiler.report.map_plot import plot_map
    from scenario_compiler.roads.spawn_points import read_spawn_points

    if suffix_of(options.output) not in (".png", ".svg"):
        raise WrongUse(f"{options.output}: a map is drawn as .png or .svg")
    sink = Diagnostics()
    loaded = _loaded_map(options, sink)
    spawn_points = {} if loaded is None else read_spawn_points(loaded[1].path, sink)
    show(sink, options)
    if loaded is None:
        return AT_FAULT
    plot_map(loaded[1], options.output, spawn_points=spawn_points)
    return FINE


def map_export_command(options: argparse.Namespace) -> int:
    """Write a map for another program."""
    sink = Diagnostics()
    loaded = _loaded_map(options, sink)
    show(sink, options)
    if loaded is None:
        return AT_FAULT
    document, network = loaded
    keep_inputs([network.path], options.output)
    if options.mesh:
        from scenario_compiler.roads.export_mesh import FORMATS as MESH_FORMATS
        from scenario_compiler.roads.export_mesh import export_mesh

        if suffix_of(options.output) not in MESH_FORMATS:
            raise WrongUse(f"{options.output}: a mesh is written as {', '.join(MESH_FORMATS)}")
        export_mesh(network, options.output)
        return FINE
    from scenario_compiler.roads.export_carla import export_for_carla

    write_whole(options.output, export_for_carla(document, network))
    return FINE
