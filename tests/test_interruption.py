"""Ctrl-C in every command, at any moment: a real process, a real signal, one line, exit 130, nothing half written."""

from __future__ import annotations

import compileall
import contextlib
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

import scenario_compiler
from scenario_compiler.interruption import left_to_this_process
from tests.live.serving import waited_for

CONFLICT = """\
<scenarios version="1">
  <scenario name="fade" map="highway_loop" duration="2">
    <parameter name="speed" type="speed" default="20" min="5" max="40"/>
    <ego speed="$speed"><start><spawn_point name="straight"/></start></ego>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""

AISA = """\
<config>
  <scenario type="lanesdefault" town="Town04"><waypoint name="start" x="1" y="2" z="0" yaw="0"/></scenario>
</config>
"""

PROGRAM = """
import contextlib, os, signal, sys
of, at, number = sys.argv[1], int(sys.argv[2]), getattr(signal, sys.argv[3])
del sys.argv[1:4]
count = 0

def counts(event, arguments):
    if of == "writing":
        return event == "open" and isinstance(arguments[2], int) and bool(arguments[2] & os.O_CREAT)
    return event in ("open", "import", "os.mkdir", "os.rename", "compile", "exec")

def interrupt(event, arguments):
    global count
    if counts(event, arguments):
        count += 1
        if count == at:
            os.killpg(0, number)

if __name__ == "__main__":
    from scenario_compiler.__main__ import main
    sys.addaudithook(interrupt)
    try:
        main()
    finally:
        with contextlib.suppress(OSError):
            os.write(2, f"EVENTS {count}\\n".encode())
"""
"""The program itself, which gets a signal at the n-th file that it opens, module that it imports, and so on.

With "writing" only the files count that it makes. The signal goes to the whole group of processes, as a terminal sends
it.
"""

COMMANDS = {
    "validate": "validate mine.xml",
    "validate in processes": "validate many --workers 2",
    "compile": "compile mine.xml -o plan.json",
    "run": "run mine.xml --perception ideal -o out --trajectory t.csv",
    "run with a camera": "run mine.xml -o out --duration 0.3",
    "report": "report made",
    "compare": "compare made made",
    "sweep": "sweep mine.xml --perception ideal --vary speed=values(10,20,30) -o swept",
    "sweep in processes": "sweep mine.xml --perception ideal --time-limit 60 --vary speed=values(10,20,30) --workers 2 "
    "--no-report -o swept",
    "search": "sweep mine.xml --perception ideal --vary speed=uniform(9,20) --minimise final_speed --evaluations 5 "
    "-o found",
    "list": "list mine.xml",
    "gallery": "list mine.xml --html gallery.html",
    "new": "new fresh --from cut_in",
    "preview": "preview mine.xml -o mine.png",
    "convert": "convert aisa.xml -o converted.xml",
    "export": "export mine.xml -o exported.xosc",
    "map info": "map info highway_loop",
    "map check": "map check highway_loop",
    "map plot": "map plot highway_loop -o map.png",
    "map export": "map export highway_loop --mesh -o map.obj",
    "explain": "explain SC401",
    "coverage": "coverage conflict",
}

ALIKE = {
    "run with a camera",
    "convert",
    "map export",
    "report",
    "compare",
    "search",
    "gallery",
    "preview",
    "map info",
    "map check",
    "map plot",
    "explain",
    "coverage",
}
"""Commands that end as others do: they write as `run` does, or a file or nothing, and start no process."""

WHOLE = {
    "out": {"events.csv", "map.xodr", "outcome.json", "plan.json", "recording.parquet", "report.html"},
}
"""Folders that hold all of their files or none."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of a run."""
    from tests.command import call

    compileall.compile_dir(str(Path(scenario_compiler.__file__).parent), quiet=1)  # writing byte code would be events
    folder = tmp_path_factory.mktemp("run")
    (folder / "mine.xml").write_text(CONFLICT, encoding="utf-8")
    assert call("run", folder / "mine.xml", "--perception", "ideal", "-o", folder / "made") == 0
    return folder / "made"


@pytest.fixture
def place(tmp_path: Path, made: Path) -> Path:
    """A folder with what the commands read."""
    (tmp_path / "mine.xml").write_text(CONFLICT, encoding="utf-8")
    (tmp_path / "aisa.xml").write_text(AISA, encoding="utf-8")
    (tmp_path / "many").mkdir()
    for number in range(40):
        (tmp_path / "many" / f"{number}.xml").write_text(CONFLICT, encoding="utf-8")
    (tmp_path / "made").mkdir()
    for file in made.iterdir():
        (tmp_path / "made" / file.name).write_bytes(file.read_bytes())
    return tmp_path


def interrupted(place: Path, command: str, at: int, number: str = "SIGINT", of: str = "all") -> tuple[int, str]:
    """Run a command that is interrupted at its n-th event; return its exit code and what stood on stderr."""
    words = [sys.executable, "-c", PROGRAM, of, str(at), number, *command.split()]
    done = subprocess.run(
        words, cwd=place, capture_output=True, text=True, timeout=300, check=False, start_new_session=True
    )
    return done.returncode, done.stderr


EVENTS: dict[str, int] = {}
"""Number of events of each command, counted once."""


def events_of(place: Path, name: str) -> int:
    """Return the number of events of a command that is not interrupted, counted in a copy of the folder."""
    if name not in EVENTS:
        with tempfile.TemporaryDirectory() as folder:
            copy = shutil.copytree(place, Path(folder) / "copy")
            code, told = interrupted(copy, COMMANDS[name], 10**9)
        assert code in (0, 1), told
        EVENTS[name] = int(told.splitlines()[-1].removeprefix("EVENTS "))
    return EVENTS[name]


def assert_clean(place: Path, before: set[Path], command: str, code: int, told: str) -> None:
    """Check what an interrupted command has left."""
    told = "\n".join(line for line in told.splitlines() if not line.startswith("EVENTS"))
    assert "Traceback" not in told
    assert "Exception ignored" not in told
    left = {path.relative_to(place) for path in place.rglob("*")} - before
    assert [path for path in left if ".tmp" in path.name] == []
    assert code in (0, 130), told
    if code == 130:
        assert [line for line in told.splitlines() if "interrupted" in line] == told.splitlines()[-1:]
        before_it = ("warning[", "in this process", "processes")
        assert told.startswith("scenario-compiler: interrupted") or any(one in told for one in before_it)
        for folder, files in WHOLE.items():
            found = {path.name for path in (place / folder).glob("*")}
            assert found in (set(), files), command


@pytest.mark.parametrize("name", [name for name in COMMANDS if name not in {*ALIKE, "sweep in processes"}])
def test_ctrl_c_prints_one_line(place: Path, name: str) -> None:
    """The signal comes with the first file that is written, or early in a command that writes none."""
    before = {path.relative_to(place) for path in place.rglob("*")}
    writes = not name.startswith(("validate", "list"))
    code, told = interrupted(place, COMMANDS[name], 1 if writes else 300, of="writing" if writes else "all")
    assert_clean(place, before, COMMANDS[name], code, told)
    assert code == 130


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("share", [0.02, 0.2, 0.5, 0.8, 0.99])
def test_ctrl_c_prints_one_line_at_any_moment(place: Path, name: str, share: float) -> None:
    command = COMMANDS[name]
    before = {path.relative_to(place) for path in place.rglob("*")}
    code, told = interrupted(place, command, max(1, int(share * events_of(place, name))))
    assert_clean(place, before, command, code, told)
    assert code == 130 or share > 0.9


def running_in(folder: Path) -> list[str]:
    """Return the processes whose current folder is a folder, by their numbers."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it has ended, or belongs to someone else
            if (process / "cwd").readlink() == folder.resolve():
                found.append(process.name)
    return found


@pytest.mark.parametrize("number", ["SIGINT", pytest.param("SIGTERM", marks=pytest.mark.slow)])
def test_an_interrupted_sweep_is_resumed(place: Path, number: str) -> None:
    """The signal comes with the first variant that is written, after two files and the streams of two processes."""
    command = COMMANDS["sweep in processes"]
    before = {path.relative_to(place) for path in place.rglob("*")}
    code, told = interrupted(place, command, 5, number, of="writing")
    assert_clean(place, before, command, code, told)
    assert code == 130, told
    assert "interrupted; --resume finishes the sweep" in told
    waited_for(lambda: running_in(place) == [])  # its processes end with the program
    code, told = interrupted(place, f"{command} --resume", 10**9)
    assert code == 0, told
    assert (place / "swept" / "results.parquet").is_file()


def test_sigterm_ends_every_command_like_ctrl_c(place: Path) -> None:
    code, told = interrupted(place, COMMANDS["run"], 500, "SIGTERM")
    assert (code, told.splitlines()[0]) == (130, "scenario-compiler: interrupted")
    assert not (place / "out").exists()


def test_the_exit_code_is_the_same_if_nothing_can_be_printed(place: Path) -> None:
    words = [sys.executable, "-c", PROGRAM, "all", "500", "SIGINT", *COMMANDS["run"].split()]
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(words, cwd=place, stderr=full, timeout=300, check=False, start_new_session=True)
    assert done.returncode == 130


def test_ctrl_c_while_a_process_is_started_interrupts_the_program_and_not_the_process() -> None:
    process = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(600,), daemon=True)

    @left_to_this_process()
    def start() -> None:
        signal.raise_signal(signal.SIGINT)
        process.start()
        os.kill(process.pid or 0, signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        start()
    os.kill(process.pid or 0, signal.SIGINT)
    process.terminate()
    process.join()
    assert process.exitcode == -signal.SIGTERM
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


SCRIPT = """
import multiprocessing, sys
from scenario_compiler.interruption import left_to_this_process
print("the script runs", flush=True)
process = multiprocessing.get_context("spawn").Process(target=sys.exit)
with left_to_this_process():
    process.start()
process.join()
print(process.exitcode, sys.modules["__main__"].process is process)
"""


@pytest.mark.parametrize("source", ["a file", "standard input"])
def test_a_script_without_a_guard_does_not_run_again_in_its_processes(tmp_path: Path, source: str) -> None:
    file = tmp_path / "script.py"
    file.write_text(SCRIPT, encoding="utf-8")
    command, given = ([file], None) if source == "a file" else (["-"], SCRIPT)
    done = subprocess.run([sys.executable, *command], input=given, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("the script runs\n0 True\n", "")


def test_the_exit_code_contains_the_signals_number_as_in_shells() -> None:
    assert 128 + signal.SIGINT == 130
