"""The player in a real browser: it plays, steps, zooms, is linked to, shows values, and keeps labels apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from scenario_compiler.recording.comparison import compare
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import COLUMNS
from scenario_compiler.report.compare_page import write_comparison
from scenario_compiler.report.html import write_report
from scenario_compiler.report.replay import pictures_of
from scenario_compiler.report.run import Run
from scenario_compiler.roads.network import Network
from tests.browser import free_page, opened_page
from tests.report import made

STEP = made.STEP


@pytest.fixture(scope="module")
def report(finished: Run, tmp_path_factory: pytest.TempPathFactory) -> str:
    return write_report([finished], tmp_path_factory.mktemp("report")).as_uri()


@pytest.fixture(scope="module")
def both(network: Network, tmp_path_factory: pytest.TempPathFactory) -> str:
    """A report of two runs."""
    return write_report(made.runs(network), tmp_path_factory.mktemp("both")).as_uri()


@pytest.fixture(scope="module")
def opened(browser: Browser, report: str) -> Iterator[Page]:
    with opened_page(browser, report) as page:
        page.locator(".player.ready").wait_for()
        yield page


@pytest.fixture
def player(opened: Page) -> Page:
    """The page of the report at its start, as it is when it has been opened."""
    opened.mouse.move(0, 0)
    opened.get_by_label("Speed").select_option("1")
    opened.evaluate(
        """() => {
            const player = document.querySelector('.player').player;
            player.pause();
            player.maps[0].follow(true);
            document.activeElement?.blur();
            scrollTo(0, 0);
        }"""
    )
    opened.keyboard.press("Home")
    return opened


def time_of(page: Page) -> float:
    return float(page.locator(".player .clock").inner_text().removesuffix(" s"))


def test_it_plays_at_the_chosen_speed_and_pauses(player: Page) -> None:
    player.get_by_label("Speed").select_option("2")
    player.get_by_role("button", name="Play").click()
    player.wait_for_function("document.querySelector('.player').player.t > 0.5")
    player.get_by_role("button", name="Pause").click()
    stopped = time_of(player)
    assert stopped > 0.5
    player.evaluate("() => new Promise((later) => requestAnimationFrame(() => requestAnimationFrame(later)))")
    assert time_of(player) == stopped


def test_it_plays_at_one_speed_however_often_it_was_paused_within_a_frame(player: Page) -> None:
    """Two presses of a key between two frames of the screen."""
    player.evaluate(
        """() => {
          const [ask, drop] = [requestAnimationFrame, cancelAnimationFrame];
          globalThis.asked = new Set();
          globalThis.requestAnimationFrame = (what) => {
            const number = ask((now) => (asked.delete(number), what(now)));
            asked.add(number);
            return number;
          };
          globalThis.cancelAnimationFrame = (number) => (asked.delete(number), drop(number));
        }"""
    )
    asked = player.evaluate(
        """() => {
          const { player } = document.querySelector(".player");
          player.play();
          player.pause();
          player.play();
          const count = asked.size;
          player.pause();
          return count;
        }"""
    )
    assert asked == 1


@pytest.mark.slow
def test_the_last_moment_asked_for_is_shown_however_long_a_run_is_unpacked(browser: Browser, both: str) -> None:
    page = free_page(browser)
    page.add_init_script(
        """
        const read = Response.prototype.text;
        let first = new Promise((resolve) => (globalThis.release = resolve));
        Response.prototype.text = async function () {
          const before = first;
          first = undefined;
          const found = await read.call(this);
          await before;
          return found;
        };
        """
    )
    page.goto(f"{both}#run-1&t=3")
    page.evaluate("location.hash = '#run-2&t=5'")
    expect(page.locator("#run-2 .clock")).to_have_text("5.00 s")
    page.evaluate("release()")
    expect(page.locator("#run-1 .clock")).to_have_text("0.00 s")
    assert page.evaluate("location.hash") == "#run-2&t=5"
    page.close()


def test_it_stops_at_the_end_and_starts_again(player: Page) -> None:
    player.keyboard.press("End")
    assert time_of(player) == pytest.approx(16.0)
    player.keyboard.press("Space")
    player.wait_for_function("document.querySelector('.player').player.t < 5")
    player.keyboard.press("Space")


def test_keys_step_through_recorded_rows(player: Page) -> None:
    for _ in range(3):
        player.keyboard.press("ArrowRight")
    assert time_of(player) == pytest.approx(3 * STEP)
    player.keyboard.press("ArrowLeft")
    assert time_of(player) == pytest.approx(2 * STEP)
    player.keyboard.press("Shift+ArrowRight")
    assert time_of(player) == pytest.approx(2 * STEP + 1)
    player.keyboard.press("Home")
    assert time_of(player) == 0


def test_an_address_leads_to_a_moment_and_back(browser: Browser, report: str, player: Page) -> None:
    with opened_page(browser, f"{report}#t=8.2") as page:
        expect(page.locator(".clock")).to_have_text("8.20 s")
        page.evaluate("location.hash = '#t=4'")
        expect(page.locator(".clock")).to_have_text("4.00 s")
        expect(page.locator(".values")).to_contain_text("blocked by parked")
    player.keyboard.press("ArrowRight")
    player.wait_for_function("location.hash === '#t=0.05'")


def test_of_several_runs_an_address_names_one(browser: Browser, both: str) -> None:
    with opened_page(browser, f"{both}#run-2&t=6.4") as page:
        expect(page.locator("#run-2 .clock")).to_have_text("6.40 s")
        expect(page.locator("#run-2 .values")).to_contain_text("driver in control")


def test_a_click_into_a_curve_goes_there_and_a_drag_zooms(player: Page) -> None:
    chart = player.locator(".u-over").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box is not None
    player.mouse.click(box["x"] + box["width"] / 2, box["y"] + 40)
    assert time_of(player) == pytest.approx(8.0, abs=0.1)
    player.mouse.move(box["x"] + box["width"] / 4, box["y"] + 40)
    player.mouse.down()
    player.mouse.move(box["x"] + box["width"] / 2, box["y"] + 40, steps=4)
    player.mouse.up()
    shown = player.evaluate("document.querySelector('.player').player.curves.range")
    assert shown == pytest.approx([4.0, 8.0], abs=0.1)
    ranges = player.evaluate("document.querySelector('.player').player.curves.charts.map((one) => one.scales.x.max)")
    assert ranges == pytest.approx([shown[1]] * len(ranges))
    assert float(player.get_by_label("time, s").get_attribute("max") or 0) == pytest.approx(shown[1])
    player.get_by_role("button", name="Show all times").click()
    assert player.evaluate("document.querySelector('.player').player.curves.range") == pytest.approx([0.0, 16.0])


def test_the_pointer_shows_values_with_units(player: Page) -> None:
    chart = player.locator(".u-over").nth(1)
    chart.scroll_into_view_if_needed()
    chart.hover(position={"x": 5, "y": 30})
    expect(player.locator(".u-legend").nth(1)).to_contain_text("13.90 m/s")
    player.keyboard.press("Home")
    place = player.evaluate(
        """() => {
            const map = document.querySelector('.player').player.maps[0];
            map.canvas.scrollIntoView({block: "center", behavior: "instant"});
            const box = map.canvas.getBoundingClientRect();
            const [east, north] = [map.run.value("x", 0) - map.centre[0], map.run.value("y", 0) - map.centre[1]];
            return [box.left + box.width / 2 + east * map.scale, box.top + box.height / 2 - north * map.scale];
        }"""
    )
    player.mouse.move(*place)
    expect(player.locator(".tip")).to_contain_text("speed 13.90 m/s (50 km/h)")
    expect(player.locator(".tip")).to_contain_text("lane -1")


def test_the_map_zooms_by_wheel_and_moves_by_drag(player: Page) -> None:
    canvas = player.locator(".chart canvas")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box is not None
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    state = """(({scale, centre, following}) => ({scale, centre, following}))(
        document.querySelector('.player').player.maps[0])"""
    before = player.evaluate(state)
    player.mouse.move(*middle)
    player.mouse.wheel(0, -400)
    player.wait_for_function(
        "(least) => document.querySelector('.player').player.maps[0].scale > least", arg=before["scale"]
    )
    player.mouse.down()
    player.mouse.move(middle[0] + 60, middle[1], steps=3)
    player.mouse.up()
    after = player.evaluate(state)
    assert not after["following"]
    east = after["centre"][0] - player.evaluate("document.querySelector('.player').player.runs[0].columns.x.data[0][0]")
    assert east != pytest.approx(0.0, abs=1e-6)
    player.get_by_role("button", name="Follow the vehicle").click()
    assert player.evaluate(state)["following"]


def test_labels_do_not_cover_each_other_at_any_time(player: Page) -> None:
    player.keyboard.press("a")
    for t in (0.0, 4.0, 8.0, 12.0, 16.0):
        player.evaluate("(t) => document.querySelector('.player').player.show(t)", t)
        labels = player.evaluate("document.querySelector('.player').player.maps[0].labels")
        assert labels[0]["text"] == "ego"
        for one, other in combinations(labels, 2):
            a, b = one["place"], other["place"]
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


def test_the_picture_is_the_last_that_was_taken(player: Page) -> None:
    player.evaluate("document.querySelector('.player').player.show(5)")
    expect(player.locator(".view figcaption")).to_have_text("View ahead at 4.00 s: takeover request")


def test_two_runs_have_one_clock(browser: Browser, network: Network, tmp_path: Path) -> None:
    runs = made.run(network), made.run(network, pictures=False)
    found = compare(runs[0].recording, runs[1].recording, None, tolerance=None)
    path = tmp_path / "both.html"
    write_comparison(runs, ("one", "other"), found, ["They are alike."], [pictures_of(one) for one in runs], path)
    with opened_page(browser, f"{path.as_uri()}#t=6.4") as page:
        expect(page.locator(".pane h2")).to_have_text(["1: one", "2: other"])
        expect(page.locator(".values").nth(0)).to_contain_text("driver in control")
        expect(page.locator(".values").nth(1)).to_contain_text("driver in control")
        expect(page.locator(".view")).to_have_count(1)
        expect(page.locator(".u-legend").first).to_contain_text("left (2)")


def test_a_run_that_is_over_before_the_other_one_says_so(browser: Browser, network: Network, tmp_path: Path) -> None:
    runs = made.run(network), made.run(network, pictures=False)
    found = compare(runs[0].recording, runs[1].recording, None, tolerance=None)
    path = tmp_path / "both.html"
    write_comparison(runs, ("one", "other"), found, ["They are alike."], [[], []], path)
    with opened_page(browser, f"{path.as_uri()}#t=3") as page:
        values = page.locator(".values").first
        expect(values).to_contain_text("state")
        expect(values).not_to_contain_text("ended")
        page.evaluate("""() => {
          const { player } = document.querySelector(".player");
          player.runs[0].t = player.runs[0].t.filter((t) => t <= 2);
          player.show(3.1);
        }""")
        expect(values).to_contain_text("(the run ended at 2.00 s)")


def test_runs_of_different_steps_and_lengths_have_their_own_values_and_rows(
    browser: Browser, network: Network, tmp_path: Path
) -> None:
    other = made.run(network, pictures=False)
    coarse = {one.name: getattr(other.recording, one.name)[: round(6 / STEP) + 1 : 3] for one in COLUMNS}
    recording = replace(other.recording, **coarse)
    short = Run(other.plan, other.network, recording, judge(other.plan, recording))
    found = compare(short.recording, other.recording, None, tolerance=None)
    path = tmp_path / "both.html"
    write_comparison((short, other), ("short", "other"), found, ["They differ."], [[], []], path)
    legend = "document.querySelectorAll('.u-legend')[1].querySelectorAll('.u-value')"
    both = "13.90 m/s|13.90 m/s"
    speeds = f"[...{legend}].slice(1).map((one) => one.innerText)"
    with opened_page(browser, f"{path.as_uri()}#t={3 + STEP}", bypass_csp=True) as page:  # between two coarse rows
        page.locator(".player.ready").wait_for()
        page.wait_for_function(f"document.querySelector('.player').player.t > 3 && {speeds}.join('|') === '{both}'")
        page.evaluate("document.querySelector('.player').player.seek(6)")
        for key, t in (("ArrowRight", 6 + STEP), ("ArrowRight", 6 + 2 * STEP), ("ArrowLeft", 6 + STEP)):
            page.keyboard.press(key)
            assert time_of(page) == pytest.approx(t)
        assert page.evaluate(speeds) == ["–", "13.90 m/s"]
        page.keyboard.press("ArrowLeft")
        page.keyboard.press("ArrowLeft")
        assert time_of(page) == pytest.approx(6 - 3 * STEP)


def test_the_whole_of_a_run_with_very_many_rows_is_shown(player: Page) -> None:
    fitted = """() => {
      const [map] = document.querySelector(".player").player.maps;
      map.fit();
      const before = map.scale;
      map.run.columns.x.data[0] = Array.from({ length: 400000 }, (_, k) => map.run.columns.x.data[0][k] ?? NaN);
      map.run.columns.x.data[0] = map.run.columns.x.data[0].map((x) => (Number.isFinite(x) ? x : 0));
      map.fit();
      return [before, map.scale];
    }"""
    before, after = player.evaluate(fitted)
    assert 0 < after <= before


@pytest.mark.parametrize("width", [pytest.param(1400, marks=pytest.mark.slow), 390])
def test_nothing_reaches_beyond_the_window(browser: Browser, report: str, width: int) -> None:
    with opened_page(browser, report, width) as page:
        page.locator(".player.ready").wait_for()
        assert page.evaluate("document.documentElement.scrollWidth") <= width
