"""`report`, `frame` and `export-run`: pages, films and pictures of a run, and its data for other programs."""

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
    needing,
    new_sink,
    refuse_idle,
    show,
    text_stream,
)
from scenario_compiler.cli.terminal import put
from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from scenario_compiler.report.replay import Picture
    from scenario_compiler.report.run import Run

BAD_RECORDING = Code(
    "SC131",
    "unreadable-recording",
    "The file is not a recording of this version, or not one of the plan beside it: it is missing, it is not Parquet, "
    "it lacks a column or its header, or it has other entities than the plan. Run the plan again."
    "\n\n    scenario-compiler run plan.json -o out     writes out/recording.parquet",
)

SHOWS = ("both", "view", "map")
"""What a film can show; the first is the default."""


def add(commands: Commands) -> None:
    """Declare the commands."""
    report = commands.add_parser(
        "report", help="write the report of a run folder again, with pictures, or a film of the run"
    )
    _add_folder(report)
    report.add_argument("--camera", action="store_true", help="draw first-person pictures of the whole run into it")
    report.add_argument(
        "--video",
        nargs="?",
        type=film_path,
        const=Path(),
        metavar="FILE.mp4|FILE.gif",
        help="write a film of the run instead, by default DIR/video.mp4 (needs the extra 'video')",
    )
    add_shows(report)
    report.set_defaults(command=report_command)
    frame = commands.add_parser("frame", help="draw the driver's view of a run at a given time")
    _add_folder(frame)
    frame.add_argument("--t", type=float, required=True, metavar="S", help="time from the start of the run, s")
    frame.add_argument("-o", dest="output", type=Path, required=True, metavar="FILE.png", help="picture to write")
    frame.add_argument("--plain", action="store_true", help="leave out the state, the speed and the messages")
    frame.set_defaults(command=frame_command)
    export = commands.add_parser("export-run", help="write a run as a file for Foxglove (MCAP) or the Rerun viewer")
    _add_folder(export)
    export.add_argument("--mcap", type=Path, metavar="FILE.mcap", help="write an MCAP file (needs the extra 'mcap')")
    export.add_argument("--rerun", type=Path, metavar="FILE.rrd", help="write a Rerun file (needs the extra 'rerun')")
    export.add_argument("--camera", action="store_true", help="draw first-person pictures of the whole run into it")
    export.set_defaults(command=export_command)
    for parser in (report, frame, export):
        add_maps(parser)
        add_diagnostics(parser)


def _add_folder(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a run")


def add_shows(parser: argparse.ArgumentParser) -> None:
    """Add the option for what a film shows."""
    parser.add_argument(
        "--video-shows",
        choices=SHOWS,
        default=SHOWS[0],
        help="what the film shows: the driver's view, the run on the map, or both",
    )


def film_path(text: str) -> Path:
    """Return the file of a film that an option names."""
    if Path(text).suffix.lower() not in (".mp4", ".gif"):
        raise argparse.ArgumentTypeError(f"a film is written as .mp4 or .gif, not as {text}")
    return Path(text)


def stored_run(folder: Path, maps: Sequence[Path], sink: Diagnostics) -> Run | None:
    """Return the run in a folder, judged again; if it cannot be read, report that and return None."""
    from scenario_compiler.plan.maps import open_plan_map
    from scenario_compiler.plan.store import read_plan
    from scenario_compiler.recording.outcome import OtherPlanError, judge
    from scenario_compiler.recording.store import RecordingError, read_recording
    from scenario_compiler.report.run import Run

    plan = read_plan(folder / "plan.json", sink)
    network = None if plan is None else open_plan_map(plan, sink, maps, folder)
    file = folder / "recording.parquet"
    try:
        recording = read_recording(file)
    except RecordingError as error:
        sink.add(BAD_RECORDING, str(error), FilePlace(str(file)))
        return None
    if plan is None or network is None:
        return None
    try:
        return Run(plan, network, recording, judge(plan, recording))
    except OtherPlanError as error:
        sink.add(BAD_RECORDING, str(error), FilePlace(str(file)))
        return None


def read_files(folder: Path) -> list[Path]:
    """Return the files of a run folder that commands may read."""
    return [folder / name for name in ("plan.json", "recording.parquet", "map.xodr", "outcome.json")]


def report_command(options: argparse.Namespace) -> int:
    """Write the report of a run folder again from its plan and recording, or a film of it."""
    if options.video is None:
        refuse_idle(options, "only with --video", "video_shows")
    else:
        refuse_idle(options, "not with --video", "camera")
    sink = new_sink(options)
    run = stored_run(options.folder, options.maps, sink)
    if show(sink, options) or run is None:
        return AT_FAULT
    if options.video is not None:
        path = options.video if options.video.name else options.folder / "video.mp4"
        write_film(run, path, options)
        put(f"video: {path}", text_stream(options))
        return FINE
    from scenario_compiler.report.html import write_report

    write_report([run], options.folder, pictures=[pictures_to_show(run, options)])
    put(f"report: {options.folder / 'report.html'}", text_stream(options))
    return FINE


def write_film(run: Run, path: Path, options: argparse.Namespace) -> None:
    """Write the film of a run.

    Raises:
        WrongUse: The run has no pictures to show, or PyAV is not installed.
    """
    _check_shown(run)
    with needing("av"):
        from scenario_compiler.report.video import write_video
    write_video(run, path, options.video_shows)


def frame_command(options: argparse.Namespace) -> int:
    """Draw one picture of a run."""
    if options.output.suffix.lower() != ".png":
        raise WrongUse(f"{options.output}: a picture of a run is drawn as .png")
    keep_inputs(read_files(options.folder), options.output)
    sink = new_sink(options)
    run = stored_run(options.folder, options.maps, sink)
    if show(sink, options) or run is None:
        return AT_FAULT
    _check_shown(run)
    begin, end = float(run.recording.t[0]), float(run.recording.t[-1])
    if not begin <= options.t <= end + 1e-6:
        raise WrongUse(f"the run lasts from {begin:g} to {end:g} s: there is no picture at {options.t:g} s")
    from scenario_compiler.outputs import write_whole
    from scenario_compiler.perception.overlay import encode_png
    from scenario_compiler.report.pictures import Sights, row_at, stills

    sights = Sights(run)
    still = next(stills(run, [row_at(run, options.t)]))
    write_whole(options.output, encode_png(sights.draw(still, caption=not options.plain)))
    return FINE


def export_command(options: argparse.Namespace) -> int:
    """Write a run in the file formats of other programs."""
    if options.mcap is None and options.rerun is None:
        raise WrongUse("name a file: --mcap FILE.mcap, --rerun FILE.rrd, or both")
    keep_inputs(read_files(options.folder), options.mcap, options.rerun)
    writers: list[tuple[Callable[[Run, Path, tuple[Picture, ...]], None], Path]] = []
    if options.mcap is not None:  # before the pictures, which may take long
        with needing("mcap"):
            from scenario_compiler.report.mcap_file import write_mcap
        writers.append((write_mcap, options.mcap))
    if options.rerun is not None:
        with needing("rerun"):
            from scenario_compiler.report.rerun_file import write_rerun
        writers.append((write_rerun, options.rerun))
    sink = new_sink(options)
    run = stored_run(options.folder, options.maps, sink)
    if show(sink, options) or run is None:
        return AT_FAULT
    pictures = tuple(pictures_to_show(run, options))
    for write, path in writers:
        write(run, path, pictures)
        put(path, text_stream(options))
    return FINE


def pictures_to_show(run: Run, options: argparse.Namespace) -> Sequence[Picture]:
    """Return the pictures in the recording, or pictures of the whole run if --camera asks for them."""
    from scenario_compiler.report.replay import pictures_of

    if not options.camera:
        return pictures_of(run)
    from scenario_compiler.report.pictures import camera_pictures

    _check_shown(run)
    return camera_pictures(run)


def _check_shown(run: Run) -> None:
    """Refuse to draw a run in which the first vehicle, whose view is drawn, is absent for some time."""
    if not len(run.recording.t) or not run.recording.present[:, :1].any(axis=1).all():
        raise WrongUse("pictures show the view of the first vehicle, which is absent for a part of this run")
