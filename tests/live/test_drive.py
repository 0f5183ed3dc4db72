"""`drive` in a real browser: a person takes over by keys or a gamepad, drives, hands back, leaves, drives again."""

from __future__ import annotations

import json
import math
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from scenario_compiler.recording.names import SOURCES
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.store import read_recording
from tests.browser import SLOW, opened_page
from tests.command import call
from tests.live.scenarios import SOON
from tests.live.serving import COARSELY, Served, served, waited_for

FLAGSHIPS = ("obstacle_ahead", "road_narrows", "markings_missing", "sensor_failure", "ramp_blocked")

GAMEPAD = """
globalThis.pad = {id: "test pad", connected: true, axes: [0, 0, 0, 0],
                  buttons: Array.from({length: 16}, () => ({value: 0, pressed: false}))};
navigator.getGamepads = () => [globalThis.pad];
"""

SEEN = "() => new Promise((seen) => requestAnimationFrame(() => requestAnimationFrame(seen)))"
"""Waits until the page, which looks at the devices in each frame, has seen their values."""

UNEVEN = """
() => {
  const decode = createImageBitmap;
  let count = 0;
  globalThis.createImageBitmap = async (file) => {
    const image = await decode(file);
    if (count++ % 3 === 0) await new Promise((resolve) => setTimeout(resolve, 150));
    return image;
  };
}
"""
"""Every third picture takes long to decode: one that overtook it would tell of a message twice."""


@pytest.fixture(scope="module")
def waiting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server whose pages are looked at, and which writes nothing."""
    file = tmp_path_factory.mktemp("waiting") / "soon.xml"
    file.write_text(SOON, encoding="utf-8")
    with served("drive", file, *COARSELY) as server:
        yield server


HIDDEN = """(hidden) => {
  Object.defineProperty(document, "hidden", { value: hidden, configurable: true });
  document.dispatchEvent(new Event("visibilitychange"));
}"""


@contextmanager
def page_with_gamepad(browser: Browser, server: Served) -> Iterator[Page]:
    """Open a page in a browser that has a gamepad."""
    with opened_page(browser, server.address, bypass_csp=True) as page:
        page.evaluate(GAMEPAD)
        yield page


def begun(page: Page) -> None:
    page.get_by_role("button", name="Start").click()
    page.wait_for_function("page.latest !== undefined")


def moved(page: Page, axis: int, *values: float) -> None:
    """Move an axis of the gamepad from value to value, each of which is seen by the page."""
    for value in values:
        page.evaluate("([axis, value]) => (pad.axes[axis] = value)", [axis, value])
        page.evaluate(SEEN)


def open_profile(page: Page) -> None:
    """Open the profile of the devices, once the page has connected: before, its button does nothing yet."""
    page.wait_for_function("globalThis.page?.role === 'driver'")
    page.get_by_role("button", name="Gamepad or wheel").click()


def places_found(page: Page, moves: tuple[tuple[int, int, int, tuple[int, ...]], ...]) -> list[str]:
    """Return where the profile has its first inputs after axes have been moved for them.

    A move has the input's row, the device and its axis in `pads`, and the values that the axis takes in turn.
    """
    open_profile(page)
    rows = page.locator("#profile tbody tr")
    for row, device, axis, values in moves:
        rows.nth(row).click()
        for value in values:
            page.evaluate("([device, axis, value]) => (pads[device].axes[axis] = value)", [device, axis, value])
            page.evaluate(SEEN)
    return [one.strip() for one in rows.locator("td:nth-child(2)").all_inner_texts()[: len(moves)]]


def driven(folder: Path, number: int = 1) -> Recording:
    return read_recording(folder / f"drive-{number:03d}" / "recording.parquet")


def ended(page: Page) -> None:
    page.evaluate("page.say({kind: 'stop'})")
    page.wait_for_function("document.querySelector('#ended').textContent !== ''")


def kinds(recording: Recording) -> list[str]:
    return [event.kind for event in recording.events]


def test_a_person_takes_over_by_keys_drives_and_is_repeated_bit_for_bit(
    soon: Path, tmp_path: Path, browser: Browser
) -> None:
    """The page stays within a window of any width, too."""
    out = tmp_path / "out"
    with (
        served("drive", soon, "--perception", "ideal", "-o", out) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        for width in (1400, 390):
            page.set_viewport_size({"width": width, "height": 900})
            expect(page.get_by_role("button", name="Start")).to_be_visible()
            assert page.evaluate("document.documentElement.scrollWidth") <= width
        begun(page)
        page.wait_for_function("page.latest.state === 'request'")
        expect(page.locator("#told")).to_contain_text("Take over now: the path ahead is blocked")
        expect(page.locator("#told svg")).to_be_visible()
        expect(page.locator("#left")).to_be_visible()
        page.keyboard.down("ArrowDown")
        page.wait_for_function("page.latest.byHand")
        expect(page.locator("#state")).to_have_text("you drive, the automation is not available")
        expect(page.locator("#told")).to_be_hidden()
        page.wait_for_function("page.latest.speed < 1")
        expect(page.locator("#measured")).to_contain_text("from input to picture")
        page.keyboard.up("ArrowDown")
        ended(page)
        expect(page.locator("#ended")).to_have_text("Driver took over, no collision")
        report = server.address + (page.locator("#report").get_attribute("href") or "").lstrip("/")
        with opened_page(browser, report) as shown:
            expect(shown.locator(".player.ready .clock")).to_have_text("0.00 s")
    recording = driven(out)
    assert kinds(recording).index("request") < kinds(recording).index("response")
    assert recording.header.step == 0.02
    assert recording.stop_reason == "user"
    by_hand = recording.control == next(code for code, name in SOURCES.items() if name == "person")
    assert recording.person_brake[by_hand].max() > 0.1  # from which on a pedal takes over
    inputs = [
        json.loads(line) for line in (out / "drive-001" / "inputs.jsonl").read_text(encoding="utf-8").splitlines()
    ]
    assert [one["brake"] for one in inputs] == recording.person_brake[1:].tolist()
    figures = json.loads((out / "drive-001" / "live.json").read_text(encoding="utf-8"))
    assert figures["latency_count"] > 0
    assert figures["latency_median_ms"] > 0
    if figures["latency_count"] > 1:  # on a slow machine only one input may be shown before the car stands
        assert figures["latency_median_ms"] <= figures["latency_p95_ms"]
    duration = f"{recording.t[-1]:.2f}"
    again = ("run", soon, "--perception", "ideal", "--dt", recording.header.step, "--duration", duration)
    assert call(*again, "--inputs", out / "drive-001", "-o", tmp_path / "again") == 0
    repeated = read_recording(tmp_path / "again" / "recording.parquet")
    rows = len(recording.t)
    assert recording.v.min() < 1
    for column in ("x", "y", "h", "v", "takeover_state", "control"):
        assert (getattr(repeated, column)[:rows] == getattr(recording, column)).all(), column


@pytest.mark.slow
def test_a_person_takes_over_by_gamepad_hands_back_and_takes_over_again(
    open_road: Path, tmp_path: Path, browser: Browser
) -> None:
    out = tmp_path / "out"
    with (
        served("drive", open_road, *COARSELY, "-o", out) as server,
        page_with_gamepad(browser, server) as page,
    ):
        begun(page)
        page.evaluate("pad.buttons[0].value = 1")
        page.wait_for_function("page.latest.byHand")
        expect(page.locator("#state")).to_have_text("you drive")
        page.evaluate("pad.buttons[0].value = 0")
        page.evaluate("pad.buttons[1].value = 1")
        page.wait_for_function("!page.latest.byHand")
        page.evaluate("pad.buttons[1].value = 0")
        page.evaluate("pad.axes[0] = -0.15")
        page.wait_for_function("page.latest.byHand")
        page.evaluate("pad.axes[0] = 0; pad.buttons[6].value = 0.7")
        page.wait_for_function("page.latest.speed < 1")
        ended(page)
    recording = driven(out)
    assert kinds(recording).count("override") + kinds(recording).count("response") == 2
    assert "hand_back" in kinds(recording)
    assert recording.person_steer.max() > 0.1
    assert recording.person_brake.max() == pytest.approx((0.7 - 0.04) / 0.96, abs=1e-4)


def test_a_vehicle_whose_person_leaves_stops_and_nothing_is_lost(
    open_road: Path, tmp_path: Path, browser: Browser
) -> None:
    """Until then pictures are shown in their order, however long each takes to decode."""
    out = tmp_path / "out"
    with served("drive", open_road, *COARSELY, "-o", out) as server:
        with opened_page(browser, server.address, bypass_csp=True) as page:
            page.evaluate(UNEVEN)
            begun(page)
            page.keyboard.press("Enter")
            page.wait_for_function("page.latest.byHand")
            page.wait_for_function("page.run.t.length > 8")
            times = page.evaluate("page.run.t")
        assert times == sorted(times)
        inputs = out / "drive-001" / "inputs.jsonl"
        waited_for(lambda: seconds_since_leaving(inputs) > 3.0)
    recording = driven(out)
    assert kinds(recording).index("override") < kinds(recording).index("person_left")
    assert kinds(recording).index("person_left") < kinds(recording).index("minimum_risk")
    assert recording.v[-1, 0] == pytest.approx(0.0, abs=0.1)


def seconds_since_leaving(inputs: Path) -> float:
    """Return the time of the run since its person left, s, as far as the file of the inputs goes; 0 before."""
    complete = inputs.read_text(encoding="utf-8").rpartition("\n")[0].splitlines()
    rows = [json.loads(line) for line in complete]
    left = [row["t"] for row in rows if row["wish"] == "leave"]
    return float(rows[-1]["t"] - left[0]) if left else 0.0


def test_a_message_and_the_start_are_in_the_window_at_any_size(waiting: Served, browser: Browser) -> None:
    within = """(name) => {
      const { left, top, right, bottom } = document.querySelector(name).getBoundingClientRect();
      return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight && bottom > top;
    }"""

    def outside(page: Page, name: str) -> list[tuple[int, int]]:
        found = []
        for width, height in ((1400, 900), (1366, 625), (1280, 590), (700, 450), (844, 390), (640, 320), (390, 844)):
            page.set_viewport_size({"width": width, "height": height})
            if not page.evaluate(within, name):
                found.append((width, height))
        return found

    with opened_page(browser, waiting.address, bypass_csp=True) as page:
        assert outside(page, "#go") == []
        begun(page)
        page.wait_for_function("page.latest?.state === 'request'")
        assert outside(page, "#told") == []
        ended(page)


@pytest.mark.slow
def test_a_run_that_cannot_be_written_has_no_report_and_says_why(
    open_road: Path, tmp_path: Path, browser: Browser
) -> None:
    with (
        served("drive", open_road, *COARSELY, "-o", tmp_path / "out", largest=30_000) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        begun(page)
        ended(page)
        expect(page.locator("#ended")).to_contain_text("The run broke off: [Errno 27]")
        expect(page.locator("#report")).to_be_hidden()
        (tmp_path / "out" / "drive-002").write_text("a file where the next folder should be")
        page.locator("#go").click()
        expect(page.locator("#ended")).to_contain_text("drive-002")
        page.wait_for_function("page.role === 'driver'")


@pytest.mark.slow
def test_messages_are_sounded_and_spoken_and_by_what_is_recorded(told: Path, tmp_path: Path, browser: Browser) -> None:
    out = tmp_path / "out"
    with (
        served("drive", told, *COARSELY, "-o", out) as server,
        page_with_gamepad(browser, server) as page,
    ):
        page.evaluate("pad.vibrationActuator = {playEffect: (...what) => (globalThis.shaken = what)}")
        page.get_by_role("button", name="Aloita").click()
        page.wait_for_function("page.latest?.state === 'request'")
        expect(page.locator("#state")).to_have_text("ohjauspyyntö")
        page.wait_for_function("page.told.some(([, text]) => text === 'Kädet rattiin!')")
        expect(page.locator("#told")).to_have_text("Kädet rattiin!")  # Chromium has no voice here
        assert page.evaluate("shaken[0]") == "dual-rumble"
        page.evaluate("page.say({kind: 'stop'})")
        expect(page.locator("#ended")).to_have_text("Pyyntö vielä avoinna, ei törmäystä")
    given = [(event.cause, event.message) for event in driven(out).events if event.kind == "message_given"]
    assert sorted(given) == [("speech", "file"), ("speech", "text"), ("tone", "file"), ("vibration", "gamepad")]


@pytest.mark.slow
def test_a_profile_of_a_wheel_is_found_by_moving_it(waiting: Served, browser: Browser) -> None:
    with page_with_gamepad(browser, waiting) as page:
        page.evaluate("pad.axes[2] = 1")
        open_profile(page)
        row = page.locator("#profile tbody tr", has_text="brake")
        row.click()
        expect(row).to_have_class("chosen")
        page.evaluate("pad.axes[2] = -1")
        expect(row.locator("td").nth(1)).to_have_text("axis 2")
        expect(row.locator("td").nth(4)).to_have_text("1.00")
        page.evaluate("pad.axes[2] = 1")
        expect(row.locator("td").nth(4)).to_have_text("0.00")


def test_a_pedal_that_the_browser_first_sees_when_it_moves_is_at_rest_where_it_is_let_go(
    waiting: Served, browser: Browser
) -> None:
    with page_with_gamepad(browser, waiting) as page:  # all axes are 0 at first, although this pedal is at 1
        open_profile(page)
        row = page.locator("#profile tbody tr", has_text="brake")
        row.click()
        moved(page, 2, 0, 0.98, 1, -1, 1)
        expect(row.locator("td").nth(2)).to_have_text("1.00")
        expect(row.locator("td").nth(3)).to_have_text("-1.00")
        expect(row.locator("td").nth(4)).to_have_text("0.00")
        steer = page.locator("#profile tbody tr").first
        steer.click()
        moved(page, 0, 0, -1, 1, 0)  # a stick is at rest in the middle
        expect(steer.locator("td").nth(2)).to_have_text("0.00")
        expect(steer.locator("td").nth(3)).to_have_text("-1.00")


@pytest.mark.slow
def test_a_wheel_and_separate_pedals_are_assigned_together(waiting: Served, browser: Browser) -> None:
    pedals = """() => {
      const none = { connected: true, buttons: [] };
      const wheel = { ...pad, id: "wheel", axes: [0], buttons: [{ value: 0 }] };
      globalThis.pads = [{ ...none, id: "pedals", axes: [1, 1] }, wheel];
      navigator.getGamepads = () => pads;
    }"""
    with page_with_gamepad(browser, waiting) as page:
        page.evaluate(pedals)
        moves = ((2, 0, 1, (1, -1, 1)), (0, 1, 0, (0, -1, 0)), (1, 0, 0, (1, -1, 1)))
        assert places_found(page, moves) == [
            "wheel: axis 0",
            "pedals: axis 0",
            "pedals: axis 1",
        ]
        page.evaluate("pads[0].axes = [1, -1]; pads[1].axes = [-0.5]")
        told = page.evaluate("page.wheel.read()")
        assert (told["throttle"], told["brake"]) == (0, 1)
        assert told["steer"] == pytest.approx(0.5, abs=0.01)
        page.evaluate("pads[1] = null; pads[0].axes = [1, 1]")  # the wheel is unplugged: its pedals do not steer
        told = page.evaluate("page.wheel.read()")
        assert (told["steer"], told["throttle"], told["brake"]) == (0, 0, 0)


def test_two_devices_of_one_model_are_assigned_apart(waiting: Served, browser: Browser) -> None:
    """Wheels and pedals of one's own making often have the name of the same circuit board."""
    boards = """() => {
      const board = { id: "board", connected: true, buttons: [] };
      globalThis.pads = [{ ...board, axes: [0] }, { ...board, axes: [1, 1] }];
      navigator.getGamepads = () => pads;
    }"""
    with page_with_gamepad(browser, waiting) as page:
        page.evaluate(boards)
        moves = ((0, 0, 0, (0, -1, 0)), (1, 1, 0, (1, -1, 1)), (2, 1, 1, (1, -1, 1)))
        assert places_found(page, moves) == [
            "board: axis 0",
            "board (2): axis 0",
            "board (2): axis 1",
        ]
        page.evaluate("pads[0].axes = [-0.5]; pads[1].axes = [0, 1]")
        told = page.evaluate("page.wheel.read()")
        assert told["steer"] == pytest.approx(0.5, abs=0.01)
        assert told["throttle"] == pytest.approx(0.5, abs=0.05)
        assert told["brake"] == 0
        page.evaluate("pads[0] = null; pads[1].axes = [1, 1]")  # the wheel is unplugged: its pedals do not steer
        told = page.evaluate("page.wheel.read()")
        assert (told["steer"], told["throttle"], told["brake"]) == (0, 0, 0)


def test_a_key_that_is_let_go_beside_a_modifier_or_in_another_window_is_not_held(
    waiting: Served, browser: Browser
) -> None:
    held = "[...page.wheel.held]"
    with opened_page(browser, waiting.address, bypass_csp=True) as page:
        page.wait_for_function("globalThis.page?.role === 'driver'")
        for modifier in ("Control", "Alt", "Meta"):
            page.keyboard.down("a")
            page.keyboard.down(modifier)
            assert page.evaluate(held) == ["left"]
            page.keyboard.up("a")
            page.keyboard.up(modifier)
            assert page.evaluate(held) == []
        page.keyboard.down("ArrowUp")
        page.evaluate("dispatchEvent(new Event('blur'))")
        assert page.evaluate(held) == []
        page.keyboard.up("ArrowUp")


@pytest.mark.slow
def test_pedals_of_a_page_that_is_hidden_are_released(open_road: Path, tmp_path: Path, browser: Browser) -> None:
    """Browsers give a hidden page the last values of a gamepad, and the release of a key to another page."""
    out = tmp_path / "out"
    with served("drive", open_road, *COARSELY, "-o", out) as server, page_with_gamepad(browser, server) as page:
        begun(page)
        page.evaluate("pad.buttons[6].value = 0.5")
        page.keyboard.down("ArrowDown")
        page.wait_for_function("page.latest.byHand && page.wheel.brake === 1")
        page.evaluate(HIDDEN, True)
        assert page.evaluate("page.wheel.read().brake") == 0
        page.keyboard.up("ArrowDown")
        page.evaluate(HIDDEN, False)
        assert page.evaluate("page.wheel.read().brake") == pytest.approx((0.5 - 0.04) / 0.96, abs=1e-4)
        ended(page)


def test_a_page_without_pictures_says_so(open_road: Path, browser: Browser) -> None:
    with (
        served("drive", open_road, *COARSELY) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        begun(page)
        server.process.send_signal(signal.SIGSTOP)
        expect(page.locator("#behind")).to_have_text("No picture for 2 s: the connection is interrupted.")
        server.process.send_signal(signal.SIGCONT)
        expect(page.locator("#behind")).to_be_hidden()
        ended(page)


def test_confidence_and_countdown_have_names(waiting: Served, browser: Browser) -> None:
    with opened_page(browser, waiting.address, bypass_csp=True) as page:
        begun(page)
        page.wait_for_function("page.latest?.state === 'request'")
        expect(page.locator("#left")).to_contain_text("until the car stops by itself")
        expect(page.get_by_text("Lane confidence")).to_be_visible()
        sides = page.get_by_role("group", name="Lane confidence").get_by_role("meter")
        assert [one.evaluate("one => one.labels[0].textContent.trim()") for one in sides.all()] == ["left", "right"]
        ended(page)


def test_a_page_that_watches_has_no_buttons_to_drive(waiting: Served, browser: Browser) -> None:
    with opened_page(browser, waiting.address, bypass_csp=True) as page:
        page.wait_for_function("globalThis.page?.role === 'driver'")
        phone = browser.new_context(has_touch=True, is_mobile=True, bypass_csp=True)
        other = phone.new_page()
        other.goto(waiting.address)
        other.wait_for_function("globalThis.page?.role === 'viewer'")
        expect(other.locator("#touch")).to_be_hidden()
        page.goto("about:blank")
        expect(other.get_by_role("button", name="Brake")).to_be_visible()
        phone.close()


def test_a_stick_steers_less_at_speed_and_a_wheel_takes_over_at_a_small_angle(
    waiting: Served, browser: Browser
) -> None:
    with page_with_gamepad(browser, waiting) as page:
        page.wait_for_function("globalThis.page?.role === 'driver'")
        steer = """([mapping, value, speed]) => {
          Object.assign(pad, { mapping, axes: [value, 0, 0, 0] });
          page.wheel.speed = speed;
          return page.wheel.read().steer;
        }"""
        slow, fast = (page.evaluate(steer, ["standard", -1, speed]) for speed in (2, 30))
        assert slow == 1
        assert 30**2 * math.tan(fast * math.radians(40)) / 2.6 < 4 * 8.3  # a few times what tyres hold, not a hundred
        assert page.evaluate(steer, ["standard", -0.03, 2]) == 0
        assert page.evaluate(steer, ["", -1, 30]) == 1
        assert page.evaluate(steer, ["", -0.01, 30]) > 2 / 600  # 2 degrees, of 15 times 40 to the full lock


@pytest.mark.slow
def test_a_run_that_nobody_drives_is_watched(tmp_path: Path, browser: Browser) -> None:
    out = tmp_path / "trajectory.csv"
    words = ("run", "obstacle_ahead", *COARSELY, "--duration", "0.5", "--watch", "--trajectory", out)
    with served(*words) as server:
        with opened_page(browser, server.address, bypass_csp=True) as page:
            page.wait_for_function("globalThis.page?.latest?.t > 0")
            page.wait_for_function("document.querySelector('#ahead').width === 1280")
            page.wait_for_function("document.querySelector('#ended').textContent !== ''")
        assert server.process.wait(timeout=SLOW / 1000) == 0
    assert out.read_text(encoding="utf-8").splitlines()[-1].startswith("0.5,")


@pytest.mark.slow
@pytest.mark.parametrize("by", ["keys", "gamepad"])
@pytest.mark.parametrize("name", FLAGSHIPS)
def test_each_flagship_conflict_is_driven_to_a_takeover(name: str, by: str, tmp_path: Path, browser: Browser) -> None:
    out = tmp_path / "out"
    with served("drive", name, "-o", out) as server, opened_page(browser, server.address, bypass_csp=True) as page:
        page.evaluate(GAMEPAD)
        begun(page)
        page.wait_for_function("['request', 'escalation', 'minimum_risk'].includes(page.latest.state)")
        if by == "keys":
            page.keyboard.down("s")
        else:
            page.evaluate("pad.buttons[6].value = 1")
        page.wait_for_function("page.latest.byHand")
        page.wait_for_function("page.latest.speed < 1")
        ended(page)
    found = kinds(driven(out))
    assert found.index("request") < found.index("response")
    assert "collision" not in found
