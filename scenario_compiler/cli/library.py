"""`library`: which situations a library of scenarios covers."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    PERCEPTIONS,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    add_templates,
    add_workers,
    new_sink,
    refuse_filled,
    refuse_idle,
    show,
    text_stream,
    whole_number,
)
from scenario_compiler.cli.terminal import put, put_table, shown_progress

if TYPE_CHECKING:
    from scenario_compiler.survey.survey import Survey


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "library", help="show which situations a library of scenarios covers, and which it lacks"
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of scenario files, or one file")
    parser.add_argument(
        "-o", dest="output", type=Path, metavar="DIR", help="folder for library.html, library.json and openlabel/"
    )
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument(
        "--runs",
        type=whole_number(0, 10_000),
        default=0,
        metavar="N",
        help="run each scenario N times with ideal perception",
    )
    parser.add_argument(
        "--separation",
        type=Path,
        metavar="PAGE",
        help="run each scenario with an attentive, a slow, an absent and a reference driver, and write the table to "
        "PAGE as Markdown",
    )
    parser.add_argument(
        "--perception",
        choices=PERCEPTIONS,
        default="ideal",
        help="source of the lane confidence in the runs of --separation",
    )
    add_workers(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=library_command)


def library_command(options: argparse.Namespace) -> int:
    """Survey a library, print what it covers, and write the page and its data."""
    from scenario_compiler.survey.survey import survey

    if options.separation is None:
        refuse_idle(options, "only with --separation", "perception")
    if not options.folder.exists():
        raise WrongUse(f"there is no file or folder '{options.folder}'")
    if options.output is not None:
        refuse_filled(options.output, force=options.force)
    sink = new_sink(options)
    with shown_progress("scenarios") as progress:
        found = survey(
            options.folder, sink, runs=options.runs, processes=options.workers, maps=options.maps, progress=progress
        )
    failed = show(sink, options)
    if not found.scenarios and not failed:
        raise WrongUse(f"there is no scenario in '{options.folder}'")
    _print(found, text_stream(options))
    if options.output is not None:
        from scenario_compiler.survey.page import PAGE, write_survey

        write_survey(found, options.output)
        put(f"page: {options.output / PAGE}", text_stream(options))
    if options.separation is not None:
        _separate(found, options)
    return AT_FAULT if failed or found.broken else FINE


def _print(found: Survey, file: TextIO) -> None:
    """Print the coverage of each taxonomy, near-duplicates, the result of the runs, and what is missing."""
    rows = []
    for taxonomy in found.taxonomies:
        shown = sum(bool(one.scenarios) for one in taxonomy.situations)
        scenarios = sum(len(one.scenarios) for one in taxonomy.situations)
        rows.append((taxonomy.title, f"{shown} of {len(taxonomy.situations)}", str(scenarios)))
    put_table(("taxonomy", "situations shown", "scenarios"), rows, file)
    for one in found.scenarios:
        if one.fault:
            put(f"at fault: {one.target}: {one.fault}", file)
    for group in found.alike:
        put(f"the same except for {len(group.differ)} numbers: {', '.join(group.scenarios)}", file)
    if found.runs:
        put(f"never request a takeover: {', '.join(found.never_ask) or 'none'}", file)
        put(f"never fail: {', '.join(found.never_fail) or 'none'}", file)
    for sentence in found.missing:
        put(sentence, file)


def _separate(found: Survey, options: argparse.Namespace) -> None:
    """Run the scenarios with the four drivers, write the page, and print how many separate the drivers."""
    from scenario_compiler.outputs import write_whole
    from scenario_compiler.survey.separating import separate_all
    from scenario_compiler.survey.separation_page import separation_page

    targets = [one.target for one in found.scenarios if not one.fault]
    with shown_progress("scenarios") as progress:
        runs = separate_all(
            targets,
            processes=options.workers,
            maps=options.maps,
            perception=options.perception,
            progress=progress,
        )
        separated = list(runs)
    write_whole(options.separation, separation_page(separated, options.perception))
    apart = sum(one.separates for one in separated)
    put(f"{apart} of {len(separated)} fail for the slow or the absent driver", text_stream(options))
    put(f"page: {options.separation}", text_stream(options))
