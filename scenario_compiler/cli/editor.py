"""`schema` and `lsp`: the XML schemas and the language server for editors."""

from __future__ import annotations

import argparse
import os
import sys

from scenario_compiler.cli.options import FINE, Commands, WrongUse, add_maps, add_templates
from scenario_compiler.cli.terminal import put_raw
from scenario_compiler.garbage_collection import stay_small


def add(commands: Commands) -> None:
    """Declare the commands."""
    schema = commands.add_parser("schema", help="print the XML schema of the conflict language or of studies")
    schema.add_argument(
        "language", nargs="?", choices=("conflict", "study"), default="conflict", help="language of the schema"
    )
    schema.set_defaults(command=schema_command)
    server = commands.add_parser(
        "lsp", help="run the language server for an editor on stdin and stdout (needs the extra 'editor')"
    )
    server.add_argument(
        "--stdio",
        action="store_true",
        help="accepted because some editors pass it; the server always uses stdin and stdout",
    )
    add_maps(server)
    add_templates(server)
    server.set_defaults(command=lsp_command)


def schema_command(options: argparse.Namespace) -> int:
    """Print the schema."""
    from scenario_compiler.resources import schema_file

    put_raw(schema_file(f"{options.language}.xsd").read_text(encoding="utf-8").removesuffix("\n"))
    return FINE


def lsp_command(options: argparse.Namespace) -> int:
    """Serve one editor until it ends the connection."""
    try:
        from scenario_compiler.editor.server import make_server
    except ModuleNotFoundError as missing:
        if (missing.name or "").partition(".")[0] not in ("pygls", "lsprotocol"):
            raise
        raise WrongUse("the language server needs pygls: pip install 'scenario-compiler[editor]'") from None
    stay_small()
    with os.fdopen(os.dup(sys.stdin.fileno()), "rb") as asked, os.fdopen(os.dup(sys.stdout.fileno()), "wb") as told:
        make_server(options.maps).start_io(asked, told)
    return FINE
