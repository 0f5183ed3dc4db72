"""The driving page when things come in another order than usual; each order is forced, not waited for."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.browser import free_page, opened_page
from tests.live.serving import COARSELY, served
from tests.live.test_drive import begun, driven, ended

pytestmark = pytest.mark.slow


def given(folder: Path, number: int) -> list[tuple[str, str]]:
    """Return the messages of a run that are heard, and by what they were given."""
    events = driven(folder, number).events
    return [(one.cause, one.message) for one in events if one.kind == "message_given" and one.cause == "speech"]


def test_a_page_that_is_hidden_while_it_waits_for_the_screen_goes_on(open_road: Path, browser: Browser) -> None:
    with (
        served("drive", open_road, *COARSELY) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        begun(page)
        page.evaluate("waiting = 0; globalThis.requestAnimationFrame = () => (waiting += 1)")
        page.wait_for_function("waiting >= 2", polling=50)  # pictures; the server sends no more while two are waiting
        page.evaluate(
            """() => {
              page.run.clear();
              Object.defineProperty(document, "hidden", { value: true });
              document.dispatchEvent(new Event("visibilitychange"));
            }"""
        )
        page.wait_for_function("page.run.t.length > 5", polling=50)
        times = page.evaluate("page.run.t")
    assert times == sorted(times)


def test_a_run_is_started_when_its_sounds_can_be_played(told: Path, browser: Browser) -> None:
    with served("drive", told, *COARSELY) as server:
        page = free_page(browser)
        held: list[Route] = []
        let = threading.Event()
        page.route("**/sounds/**", lambda one: one.continue_() if let.is_set() else held.append(one))
        page.goto(server.address)
        page.wait_for_function("globalThis.page?.role === 'driver'")
        expect(page.locator("#go")).to_be_disabled()
        assert held
        let.set()
        for one in held:
            one.continue_()
        expect(page.locator("#go")).to_be_enabled()
        page.close()


def test_a_page_whose_data_have_gone_is_loaded_again(open_road: Path, browser: Browser) -> None:
    """A study's page is loaded at the very moment at which its run ends."""
    with served("drive", open_road, *COARSELY) as server:
        page = free_page(browser)
        page.route("**/about", lambda one: one.fulfill(status=404), times=1)
        page.goto(server.address)
        begun(page)
        page.close()


def spoken_later(page: Page) -> None:
    """Let the browser begin to speak when the test says so; it is not taken to be mute until then."""
    page.evaluate(
        """() => {
          const set = setTimeout;
          globalThis.setTimeout = (what, ms, ...more) => (ms === 1500 ? 0 : set(what, ms, ...more));
          speechSynthesis.speak = (words) => (globalThis.utterance = words);
        }"""
    )


def test_speech_that_begins_late_is_not_counted_for_the_next_run(told: Path, tmp_path: Path, browser: Browser) -> None:
    out = tmp_path / "out"
    with (
        served("drive", told, *COARSELY, "-o", out) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        spoken_later(page)
        page.get_by_role("button", name="Aloita").click()
        page.wait_for_function("globalThis.utterance !== undefined")
        ended(page)
        page.get_by_role("button", name="Uudelleen").click()
        page.wait_for_function("page.latest.run === 2")
        page.evaluate("utterance.dispatchEvent(new Event('start')); utterance = undefined")
        page.wait_for_function("globalThis.utterance !== undefined")
        page.keyboard.down("ArrowDown")
        page.wait_for_function("page.told.length === 0")
        page.evaluate(
            "utterance.dispatchEvent(new Event('error'))"
        )  # as when the browser cancels what it has not begun
        page.wait_for_function("page.latest.speed < 1")
        ended(page)
    assert given(out, 1) == [("speech", "file")]
    assert given(out, 2) == [("speech", "file"), ("speech", "none")]


def test_speech_begins_when_the_tone_of_the_same_moment_has_ended(soon: Path, browser: Browser) -> None:
    message = '<message modality="speech tone" content="what"/>'
    soon.write_text(
        soon.read_text(encoding="utf-8").replace('<message modality="text icon" content="what why"/>', message)
    )
    with (
        served("drive", soon, *COARSELY) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        page.evaluate(
            """() => {
              globalThis.sounded = [];
              const start = AudioBufferSourceNode.prototype.start;
              AudioBufferSourceNode.prototype.start = function (at) {
                sounded.push([at, at + this.buffer.duration]);
                return start.call(this, at);
              };
            }"""
        )
        begun(page)
        page.wait_for_function("page.latest?.state === 'request' && sounded.length >= 2")
        tone, speech = page.evaluate("sounded.slice(-2)")
        ended(page)
    assert speech[0] > tone[1]


def test_a_page_that_watches_sees_each_run_alone_and_drives_when_nobody_does(open_road: Path, browser: Browser) -> None:
    with served("drive", open_road, *COARSELY) as server:
        with opened_page(browser, server.address, bypass_csp=True) as page:
            page.wait_for_function("globalThis.page?.role === 'driver'")
            other = free_page(browser)
            other.goto(server.address)
            other.wait_for_function("globalThis.page?.role === 'viewer'")
            expect(other.locator("#go")).to_be_hidden()
            begun(page)
            other.wait_for_function("page.latest?.t > 1")
            ended(page)
            page.get_by_role("button", name="Again").click()
            other.wait_for_function("page.latest.run === 2 && page.run.t.length > 3")
            times = other.evaluate("page.run.t")
            assert times == sorted(times)
            ended(page)
        other.wait_for_function("page.role === 'driver'")
        other.locator("#go").click()
        other.wait_for_function("page.latest.run === 3")
        assert other.evaluate("page.run.t[0]") == 0.0
        other.close()
