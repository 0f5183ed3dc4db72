"""Takes the pictures of pages that docs/ shows, at the widths of a desktop's window and of a phone.

    python -m tests.benchmarks.page_pictures docs/images

The reports, the comparison and the gallery (docs/replay.md): `obstacle_ahead` is run twice with ideal perception, as it
is, and with a driver who responds late. The pictures show both runs at the same moment.

The driving page (docs/drive.md): `drive obstacle_ahead`, at its request, and with the profile of a steering wheel.

The pages of a study (docs/study.md, docs/your-first-study.md): the study of docs/your-first-study.md with its pilot,
and the same study with a probe.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Page, expect

from scenario_compiler.cli import main as command
from tests.browser import opened_browser, opened_page
from tests.live.serving import Served, served
from tests.pages import code_blocks
from tests.study.test_server import ordered

DESKTOP, PHONE = 1400, 390
"""Widths of the window, pixels."""

REPORT_HEIGHTS = {DESKTOP: 1180, PHONE: 1600}
DRIVE_HEIGHTS = {DESKTOP: 870, PHONE: 780}
STUDY_HEIGHTS = {DESKTOP: 900, PHONE: 900}
"""Heights of the pictures at each width, pixels."""

MOMENT = 10.0
"""Time that is shown, s: the first driver has taken over, the second one has not."""

SHOWN = ("obstacle_ahead.xml", "narrowing_variants.xml", "ramp_variants.xml")
"""Files of the library that the gallery shows."""

IDEAL = ("--perception", "ideal")

PARTICIPANTS = {DESKTOP: 3, PHONE: 7}
"""Participants whose first trial has an obstacle, which is announced with its reason."""

PROBE = """\
  <probe from="1" to="2">
    <query name="speed" about="speed" text="How fast were you, in km/h?" tolerance="10"/>
    <query name="driver" about="control" text="Who was driving?"/>
  </probe>
  <search_task"""

WHEEL = """
() => {
  const wheel = {id: "Logitech G29 (Vendor: 046d Product: c24f)", connected: true, axes: [-0.31, 0, 1, 0],
                 buttons: Array.from({length: 16}, () => ({value: 0, pressed: false}))};
  globalThis.wheel = wheel;
  navigator.getGamepads = () => [wheel];
}
"""
"""A steering wheel, turned a little; its third axis is the brake pedal, which is released."""

SEEN = "() => new Promise((seen) => requestAnimationFrame(() => requestAnimationFrame(seen)))"


@dataclass(frozen=True)
class Camera:
    """Takes pictures of pages at one width.

    Attributes:
        images: Folder for the pictures.
        browser: The browser.
        width: Width of the window, pixels.
    """

    images: Path
    browser: Browser
    width: int

    def take(self, page: Page, name: str) -> None:
        """Take a picture of an open page."""
        page.screenshot(path=str(self.images / f"{name}_{self.width}.jpg"), type="jpeg", quality=80)

    @contextmanager
    def opened(self, address: str, heights: dict[int, int]) -> Iterator[Page]:
        """Yield an open page, with a touch screen at the width of a phone."""
        with opened_page(self.browser, address, self.width, heights[self.width], bypass_csp=True) as page:
            if self.width == PHONE:
                touch = page.context.new_cdp_session(page)
                touch.send("Emulation.setTouchEmulationEnabled", {"enabled": True})
                page.reload()
            yield page


def done(*arguments: str | Path) -> None:
    """Run a command that succeeds; a comparison of runs that differ ends with 1."""
    code = command([str(one) for one in arguments])
    if code != (1 if arguments[0] == "compare" else 0):
        raise RuntimeError(f"{arguments[0]} ended with {code}")


def reports(folder: Path) -> dict[str, Path]:
    """Run the conflict twice and write the three pages to a folder; return them by the names of their pictures."""
    one, other = folder / "attentive", folder / "late"
    conflict = Path("library/conflicts/obstacle_ahead.xml")
    late = folder / "late.xml"
    text = conflict.read_text(encoding="utf-8")
    late.write_text(text.replace('preset="study_means"', 'takeover_time="5.5"'), encoding="utf-8")
    for file, out in ((conflict, one), (late, other)):
        done("run", file, *IDEAL, "-o", out)
    done("report", one, "--camera")
    done("compare", one, other, "--html", folder / "both.html", "--camera")
    done("list", *(conflict.with_name(name) for name in SHOWN), "--html", folder / "gallery.html")
    return {"player": one / "report.html", "compare": folder / "both.html", "gallery": folder / "gallery.html"}


def take_report(camera: Camera, name: str, path: Path) -> None:
    """Take a picture of a report: of its player, if it has one, at the moment that is shown."""
    with camera.opened(path.as_uri(), REPORT_HEIGHTS) as page:
        if name != "gallery":
            page.locator(".player.ready").first.wait_for()
            page.evaluate("(t) => document.querySelector('.player').player.show(t)", MOMENT)
            page.evaluate("document.querySelector('.player').scrollIntoView({block: 'start', behavior: 'instant'})")
            page.wait_for_function("[...document.querySelectorAll('.player img')].every((one) => one.complete)")
        camera.take(page, name)


def begin(page: Page) -> None:
    """Start a run, and wait for its first picture."""
    page.get_by_role("button", name="Start").click()
    page.wait_for_function("globalThis.page?.latest !== undefined")


def take_drive(camera: Camera) -> None:
    """Take the driving page with the profile of a steering wheel whose brake is being assigned, and at a request."""
    with (
        served("drive", "obstacle_ahead", *IDEAL) as server,
        camera.opened(server.address, DRIVE_HEIGHTS) as page,
    ):
        page.wait_for_function("globalThis.page?.role === 'driver'")
        page.evaluate(WHEEL)
        page.get_by_role("button", name="Gamepad or wheel").click()
        brake = page.locator("#profile tbody tr", has_text="brake")
        brake.click()
        for value in (1, -1, 1, 0.2):
            page.evaluate("(value) => (wheel.axes[2] = value)", value)
            page.evaluate(SEEN)
        expect(brake.locator("td").nth(4)).to_have_text("0.40")
        camera.take(page, "drive_profile")
        page.get_by_role("button", name="Done").click()
        page.evaluate("navigator.getGamepads = () => []")
        begin(page)
        page.wait_for_function("page.latest.state === 'request'")
        expect(page.locator("#told")).to_be_visible()
        camera.take(page, "drive")
        page.evaluate("page.say({kind: 'stop'})")
        expect(page.locator("#ended")).not_to_have_text("")


def study_in(folder: Path, *, probed: bool = False) -> Path:
    """Write the study of docs/your-first-study.md into a new folder, with a probe or without one; return its file."""
    folder.mkdir()
    text = Path("docs/your-first-study.md").read_text(encoding="utf-8")
    for block in (*code_blocks(text, "xml"), *code_blocks(text, "markdown")):
        named = re.match(r"<!-- (\S+) -->\n", block)
        if named is None:
            raise RuntimeError("a file of docs/your-first-study.md has no name")
        (folder / named.group(1)).write_text(block, encoding="utf-8")
    study = folder / "study.xml"
    if probed:
        study.write_text(study.read_text(encoding="utf-8").replace("  <search_task", PROBE), encoding="utf-8")
    return study


def abort(server: Served, page: Page, participant: int) -> None:
    """Abort a participant's run, and go on to the next step."""
    ordered(server, participant=participant, action="abort")
    expect(page.locator("#go")).to_have_text("Continue")
    page.locator("#go").click()


def take_study(camera: Camera, server: Served) -> None:
    """Take the pages that a participant sees up to the first questionnaire, and the experimenter's page in a trial."""
    participant = PARTICIPANTS[camera.width]
    with camera.opened(server.address, STUDY_HEIGHTS) as page:
        camera.take(page, "study_first")
        page.get_by_label("Your participant number").fill(str(participant))
        page.get_by_role("button", name="Continue").click()
        expect(page.get_by_role("heading", name="Please wait")).to_be_visible()
        camera.take(page, "study_waiting")
        ordered(server, participant=participant, action="start")
        expect(page.get_by_role("button", name="I agree")).to_be_visible()
        camera.take(page, "study_consent")
        page.get_by_role("button", name="I agree").click()
        page.get_by_role("button", name="Continue").click()
        begin(page)
        abort(server, page, participant)
        begin(page)
        expect(page.locator("#told")).to_contain_text("Take over now")
        camera.take(page, "study_drive")
        with camera.opened(f"{server.address}experimenter", STUDY_HEIGHTS) as desk:
            expect(desk.locator(f"#sub-{participant:02d}")).to_contain_text("request")
            camera.take(desk, "study_experimenter")
        abort(server, page, participant)
        page.get_by_role("group", name="Taking over was hard.").get_by_label("2").check()
        camera.take(page, "study_questionnaire")


def take_probe(camera: Camera, server: Served) -> None:
    """Take the page of a trial that a probe has stopped."""
    participant = PARTICIPANTS[camera.width]
    ordered(server, participant=participant, action="start")
    with camera.opened(f"{server.address}participant/{participant}", STUDY_HEIGHTS) as page:
        page.get_by_role("button", name="I agree").click()
        page.get_by_role("button", name="Continue").click()
        begin(page)
        abort(server, page, participant)
        begin(page)
        page.get_by_label("How fast were you, in km/h?").fill("50")
        camera.take(page, "study_probe")


def main(images: Path, browser: Browser) -> None:
    """Take all pictures."""
    cameras = [Camera(images, browser, width) for width in (DESKTOP, PHONE)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for shown, path in reports(folder).items():
            for camera in cameras:
                take_report(camera, shown, path)
        for camera in cameras:
            take_drive(camera)
        study = study_in(folder / "study")
        done("study", study, "--pilot", *IDEAL, "-o", study.parent / "pilot")
        with served("study", study, *IDEAL, "-o", study.parent / "data") as server:
            for camera in cameras:
                take_study(camera, server)
                with camera.opened((study.parent / "pilot" / "expected.html").as_uri(), STUDY_HEIGHTS) as page:
                    camera.take(page, "study_expected")
        probed = study_in(folder / "probed", probed=True)
        with served("study", probed, *IDEAL, "-o", probed.parent / "data") as server:
            for camera in cameras:
                take_probe(camera, server)


if __name__ == "__main__":
    with opened_browser() as opened:
        main(Path(sys.argv[1]), opened)
