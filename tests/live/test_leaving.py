"""Pages that are gone: the browser is killed or falls silent, and the run, its marks and its files are whole."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.store import read_recording
from tests.browser import killable_page, opened_page
from tests.live.serving import COARSELY, served, waited_for
from tests.live.test_drive import begun, kinds, seconds_since_leaving
from tests.study import made
from tests.study.test_live import journal, serving, started

LEFT_IN = """\
<scenarios version="1">
  <scenario name="left" map="motorway" duration="{duration}">
    <ego speed="10"><start><spawn_point name="right_lane"/></start></ego>
    {told}
    <takeover escalate_after="1" minimum_risk_after="2"><driver><person/></driver></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""
"""An open road on which the automation tells the driver something at 2 s, or nothing."""

TOLD = '<when><time after="2"/><do>{}</do></when>'


def written(folder: Path, told: str = "", duration: int = 600) -> Path:
    file = folder / "left.xml"
    file.write_text(LEFT_IN.format(told=TOLD.format(told) if told else "", duration=duration), encoding="utf-8")
    return file


def kept(out: Path) -> Recording:
    """Return the run, whose files come when it has ended by itself."""
    waited_for(lambda: (out / "drive-001" / "outcome.json").is_file())
    return read_recording(out / "drive-001" / "recording.parquet")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("state", "told", "after"),
    [
        ("automated", "", "stop"),
        ("warning", "<warn/>", "stop"),
        ("request", "<request/>", "minimum_risk"),
        ("manual", "", "minimum_risk"),
    ],
)
def test_a_browser_that_is_killed_leaves_a_whole_run(
    state: str, told: str, after: str, tmp_path: Path, browser: Browser
) -> None:
    out = tmp_path / "out"
    file = written(tmp_path, told, duration=30)
    with (
        served("drive", file, *COARSELY, "-o", out) as server,
        killable_page(browser, server.address, tmp_path / "profile") as (page, kill),
    ):
        begun(page)
        if state == "manual":
            page.keyboard.press("Enter")
            page.wait_for_function("page.latest.byHand")
        else:
            page.wait_for_function(f"page.latest.state === '{state}' && page.latest.t > 1")
        kill()
        recording = kept(out)
    events = kinds(recording)
    assert "person_left" in events
    assert events.index("person_left") < events.index(after)
    if after == "minimum_risk":
        assert recording.stop_reason == "standstill"
        assert recording.v[-1, 0] == pytest.approx(0.0, abs=0.1)
    else:
        assert recording.stop_reason == "duration"
    rows = len((out / "drive-001" / "inputs.jsonl").read_text(encoding="utf-8").splitlines())
    assert rows == len(recording.t) - 1


@pytest.mark.slow
def test_who_is_killed_before_the_start_leaves_the_wheel_to_the_next(tmp_path: Path, browser: Browser) -> None:
    with served("drive", written(tmp_path), *COARSELY) as server:
        with killable_page(browser, server.address, tmp_path / "profile") as (page, kill):
            expect(page.get_by_role("button", name="Start")).to_be_enabled()
            kill()
        with opened_page(browser, server.address, bypass_csp=True) as page:
            begun(page)
            assert page.evaluate("page.role") == "driver"


@pytest.mark.slow
def test_a_questionnaire_outlives_the_browser(tmp_path: Path, browser: Browser) -> None:
    study = made.study(tmp_path)
    study.write_text(
        study.read_text(encoding="utf-8").replace('<page file="welcome.md"/>', '<ask file="effort.xml"/>'),
        encoding="utf-8",
    )
    with served(*serving(study)) as server:
        started(server, 1)
        address = f"{server.address}participant/1"
        with killable_page(browser, address, tmp_path / "profile") as (page, kill):
            page.get_by_role("button", name="I agree").click()
            page.get_by_role("group", name="I stayed calm.").get_by_label("7").check()
            kill()
        with opened_page(browser, address) as page:
            expect(page.get_by_role("heading", name="This trial")).to_be_visible()
    assert [one["kind"] for one in journal(study, 1)] == ["started", "done"]


SILENT = """
import sys
from websockets.sync.client import connect
from websockets.typing import Origin
address, origin = sys.argv[1:]
with connect(address, origin=Origin(origin), max_size=None) as page:
    page.recv()
    page.send('{"kind": "start"}')
    by_hand = False
    while True:
        by_hand = b'"byHand":true' in page.recv()
        page.send('{"kind": "input", "seq": 1, "take_over": %s}' % ("false" if by_hand else "true"))
        if by_hand:
            print("by hand", flush=True)
"""
"""A page that takes over; then it is stopped, with its connection still open."""


@pytest.mark.slow
def test_a_page_that_falls_silent_lets_go_and_counts_as_gone(tmp_path: Path) -> None:
    """The vehicle stops at once, and the wheel is free for another page when the silence has lasted."""
    out = tmp_path / "out"
    with served("drive", written(tmp_path), *COARSELY, "-o", out) as server:
        here = f"127.0.0.1:{server.host.rpartition(':')[2]}"
        command = [sys.executable, "-c", SILENT, f"ws://{here}/socket", f"http://{here}"]
        page = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            assert page.stdout is not None
            assert page.stdout.readline() == "by hand\n"
            os.kill(page.pid, signal.SIGSTOP)
            with server.connected() as other:
                while other.recv(timeout=60) != '{"role":"driver"}':
                    other.send('{"kind": "ping", "t": 0}')
            waited_for(lambda: seconds_since_leaving(out / "drive-001" / "inputs.jsonl") > 1.0)
        finally:
            page.kill()
            page.communicate()
    recording = read_recording(out / "drive-001" / "recording.parquet")
    events = kinds(recording)
    assert events.index("person_silent") < events.index("minimum_risk")
