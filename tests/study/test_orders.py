"""A study's pages when things come in another order than usual; each order is forced, not waited for."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from scenario_compiler.study.tables import read_table
from tests.browser import free_page, opened_page
from tests.live.serving import served
from tests.study import made
from tests.study.test_live import LONG, begun, journal, left, ordered, probed, row_of, serving, started
from tests.study.test_server import origin

pytestmark = pytest.mark.slow


@pytest.fixture
def driving(tmp_path: Path) -> Path:
    """A study that begins with a run, which ends only when somebody ends it."""
    study = made.study(tmp_path)
    (tmp_path / "conflicts.xml").write_text(LONG, encoding="utf-8")
    head, _, rest = study.read_text(encoding="utf-8").partition("  <before>")
    study.write_text(head + rest.partition("</before>\n")[2], encoding="utf-8")
    return study


def test_a_run_that_is_started_while_the_session_is_paused_waits(driving: Path, browser: Browser) -> None:
    with (
        served(*serving(driving)) as server,
        opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk,
    ):
        ordered(desk, 1, "Start")
        expect(row_of(desk, 1)).to_contain_text("started")
        with opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page:
            expect(page.locator("#go")).to_be_enabled()
            ordered(desk, 1, "Pause")
            expect(row_of(desk, 1)).to_contain_text("paused")
            begun(page)
            expect(page.get_by_role("heading", name="Please wait")).to_be_visible()
            ordered(desk, 1, "Start")
            begun(page)
            page.wait_for_function("globalThis.page?.latest !== undefined")


def test_what_is_pressed_and_passes_in_a_probe_is_neither_a_takeover_nor_latency(
    driving: Path, browser: Browser
) -> None:
    with served(*serving(driving)) as server:
        started(server, 1)
        with (
            opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page,
            opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk,
        ):
            expect(page.locator("#go")).to_be_enabled()
            page.evaluate(MEASURE)
            begun(page)
            speed = page.get_by_label("How fast were you, in km/h?")
            speed.fill("36")
            page.evaluate("lasted = 1e7")  # the probe takes long
            page.get_by_label("the automation").focus()
            page.keyboard.press("h")
            page.keyboard.press("Enter")  # a field is still empty: nothing is sent
            page.keyboard.press("ArrowDown")
            expect(page.get_by_label("I", exact=True)).to_be_checked()
            page.evaluate("dispatchEvent(new KeyboardEvent('keydown', { code: 'Enter' }))")  # beside the form
            probed(page)
            page.wait_for_function("page.latest.t > 2 && measured.length > 0")
            assert page.evaluate("Math.max(...measured)") < 1e6
            assert not page.evaluate("page.latest.byHand")
            ordered(desk, 1, "Abort")
            left(page)
            expect(page.get_by_role("heading", name="This trial")).to_be_visible()
    (table,) = (driving.parent / "data").glob("sub-01/ses-01/beh/*_run-01_events.tsv")
    assert "override" not in [one["trial_type"] for one in read_table(table)]


MEASURE = """
() => {
  const [now, say] = [performance.now.bind(performance), page.say.bind(page)];
  Object.assign(globalThis, { lasted: 0, measured: [] });
  performance.now = () => now() + lasted;
  page.say = (message) => {
    if (message.kind === "latency") measured.push(...message.samples);
    say(message);
  };
}
"""
"""Let the page's clock go on by `lasted` at once, and keep the latencies that it reports."""


def test_a_press_on_a_picture_that_is_answered_is_not_sent(driving: Path, browser: Browser) -> None:
    with served(*serving(driving)) as server:
        started(server, 1)
        with opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page:
            begun(page)
            page.wait_for_function("document.querySelectorAll('#search circle').length === 6")
            sent = page.evaluate(
                """() => {
                  const sent = [];
                  const say = page.search.tell;
                  page.search.tell = (told) => (sent.push(told.number), say(told));
                  const press = () => new PointerEvent("pointerdown", { bubbles: true, cancelable: true });
                  for (const circle of document.querySelectorAll("#search circle")) circle.dispatchEvent(press());
                  return sent;
                }"""
            )
            page.wait_for_function("page.search.number === 1")
    assert sent == [0]
    assert [one["kind"] for one in journal(driving, 1)].count("search") == 1


def test_answers_whose_page_was_not_received_stand_in_the_form_again(tmp_path: Path, browser: Browser) -> None:
    study = made.study(tmp_path)
    study.write_text(
        study.read_text(encoding="utf-8").replace("<before>", '<before><ask file="effort.xml"/>'), encoding="utf-8"
    )
    with served(*serving(study)) as server:
        started(server, 1)
        page = free_page(browser)
        page.goto(f"{server.address}participant/1")
        page.get_by_role("group", name="Taking over was hard.").get_by_label("2").check()
        page.get_by_role("group", name="I stayed calm.").get_by_label("7").check()
        page.get_by_label("A sound").check()
        page.route("**/participant/1", lambda one: one.abort())  # as when the network is gone
        page.get_by_role("button", name="Continue").click()
        page.wait_for_url("chrome-error://**")
        page.unroute_all()
        page.goto(f"{server.address}participant/1")
        expect(page.get_by_role("group", name="Taking over was hard.").get_by_label("2")).to_be_checked()
        page.get_by_role("button", name="Continue").click()
        page.get_by_role("button", name="I agree").click()
        page.wait_for_function("sessionStorage.length === 0")
        page.close()


def test_rows_that_were_asked_for_before_an_order_do_not_replace_its_answer(driving: Path, browser: Browser) -> None:
    with (
        served(*serving(driving)) as server,
        opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk,
    ):
        expect(row_of(desk, 1)).to_contain_text("waiting")
        desk.evaluate(
            """() => {
              const ask = fetch;
              globalThis.fetch = async (path, ...rest) => {
                const answer = await ask(path, ...rest);
                if (path.endsWith("state") && !globalThis.held) await new Promise((let) => (globalThis.held = let));
                return answer;
              };
              globalThis.seen = [];
              const look = () => seen.push(document.querySelector("#sub-01").children[3].textContent);
              const rows = document.querySelector("#participants");
              new MutationObserver(look).observe(rows, { subtree: true, childList: true });
            }"""
        )
        desk.wait_for_function("globalThis.held !== undefined")
        ordered(desk, 1, "Start")
        expect(row_of(desk, 1)).to_contain_text("started")
        desk.evaluate("seen.length = 0; held()")
        desk.wait_for_function("seen.length > 0")  # the rows that are asked for next
        assert set(desk.evaluate("seen")) == {"started"}


def test_a_page_of_another_step_gets_no_wheel(driving: Path) -> None:
    with served(*serving(driving)) as server:
        here = origin(server)
        for step in ("1", "", "x", "9" * 5000):
            with (
                pytest.raises(InvalidStatus),
                connect(f"{here.replace('http', 'ws')}/participant/1/socket?step={step}", origin=Origin(here)),
            ):
                pass
