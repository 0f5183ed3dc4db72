"""A study in a real browser: two participants finish it, the server dies and goes on, the experimenter looks on."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Locator, Page, expect

from scenario_compiler.recording.store import read_recording
from scenario_compiler.study.journal import read_journal
from scenario_compiler.study.tables import read_table, tidy_rows
from tests.browser import free_page, opened_page
from tests.live.serving import COARSELY, Served, served, waited_for
from tests.study import made
from tests.study.test_server import ordered as sent

LONG = """\
<scenarios version="1">
  <scenario name="blocked" map="motorway" duration="600">
    <ego speed="4"><start><spawn_point name="right_lane"/></start></ego>
    <takeover escalate_after="600" minimum_risk_after="600"/>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""
"""A run that ends only when somebody ends it."""


@pytest.fixture
def short(tmp_path: Path) -> Path:
    study = made.study(tmp_path)
    conflicts = tmp_path / "conflicts.xml"
    conflicts.write_text(
        conflicts.read_text(encoding="utf-8").replace('duration="8"', 'duration="2"'), encoding="utf-8"
    )
    return study


def endless_in(folder: Path) -> Path:
    """Write a study of three participants that begins with a run, and whose runs last; return its file."""
    study = made.study(folder)
    (folder / "conflicts.xml").write_text(LONG, encoding="utf-8")
    head, _, rest = study.read_text(encoding="utf-8").partition("  <before>")
    rest = rest.partition("</before>\n")[2].replace('from="0.5" to="1.5"', 'from="900" to="900"')
    study.write_text(head.replace('participants="2"', 'participants="3"') + rest, encoding="utf-8")
    return study


@pytest.fixture
def endless(tmp_path: Path) -> Path:
    return endless_in(tmp_path)


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, Path]]:
    """A server of such a study, of which each test takes a participant of its own; and the study's file."""
    study = endless_in(tmp_path_factory.mktemp("standing"))
    with served(*serving(study)) as server:
        yield server, study


def serving(study: Path) -> tuple[object, ...]:
    return ("study", study, *COARSELY, "--size", "640x360", "-o", study.parent / "data")


def journal(study: Path, participant: int) -> list[dict[str, object]]:
    return read_journal(study.parent / "data" / "sourcedata" / f"sub-{participant:02d}" / "ses-01" / "journal.jsonl")


def rows_of(study: Path, participant: int) -> list[dict[str, str]]:
    """Return the runs of a participant as far as the tables go."""
    return [one for one in tidy_rows(study.parent / "data") if one["participant_id"] == f"sub-{participant:02d}"]


def started(server: Served, *participants: int) -> None:
    """Let participants begin; in the tests of the experimenter's page its button does so."""
    for one in participants:
        assert sent(server, participant=one, action="start") == 200


def row_of(desk: Page, participant: int) -> Locator:
    return desk.locator(f"#sub-{participant:02d}")


def ordered(desk: Page, participant: int, what: str) -> None:
    """Press a button of the experimenter, and confirm where the page asks."""
    desk.once("dialog", lambda asked: asked.accept())
    desk.get_by_role("button", name=f"{what}, participant {participant}").click()


def begun(page: Page) -> None:
    page.get_by_role("button", name="Start").click()


def consented(page: Page) -> None:
    page.get_by_role("button", name="I agree").click()
    expect(page.get_by_role("heading", name="Welcome")).to_be_visible()
    page.get_by_role("button", name="Continue").click()


def probed(page: Page) -> None:
    """Answer the probe, which comes in each run."""
    page.get_by_label("How fast were you, in km/h?").fill("36")
    assert page.evaluate(DRAWN) == 0
    page.get_by_label("the automation").check()
    page.locator("#held button").click()


DRAWN = """
() => {
  const canvas = document.querySelector("#ahead");
  return canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.reduce((a, b) => a + b, 0);
}
"""
"""What is left of the view ahead: the sum of its pixels."""


def driven(page: Page) -> None:
    begun(page)
    probed(page)
    left(page)


def left(page: Page) -> None:
    """Go on from a run that has ended."""
    expect(page.locator("#go")).to_have_text("Continue")
    page.locator("#go").click()


def answered(page: Page) -> None:
    page.get_by_role("group", name="Taking over was hard.").get_by_label("2").check()
    page.get_by_role("group", name="I stayed calm.").get_by_label("7").check()
    page.get_by_label("A sound").check()
    page.get_by_label("What else do you want to say?").fill("Nothing, thanks = fine\tor not")
    page.get_by_role("button", name="Continue").click()


@pytest.mark.slow
def test_two_participants_finish_a_study_whose_server_dies_in_the_middle(short: Path, browser: Browser) -> None:
    data = short.parent / "data"
    with served(*serving(short)) as server:
        started(server, 1)
        with opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page:
            consented(page)
            driven(page)
            answered(page)
            begun(page)
            expect(page.get_by_label("How fast were you, in km/h?")).to_be_visible()
            server.process.kill()
            server.process.wait()
            page.goto("about:blank")
    before = journal(short, 1)
    assert [one["kind"] for one in before][-1] == "begun"
    with served(*serving(short)) as server:
        assert journal(short, 1) == before
        started(server, 1, 2)
        with opened_page(browser, f"{server.address}?participant=1", bypass_csp=True) as page:
            for _ in range(3):
                driven(page)
                answered(page)
            expect(page.get_by_role("heading", name="The session is over")).to_be_visible()
        with opened_page(browser, server.address, bypass_csp=True) as page:
            page.get_by_label("Your participant number").fill("2")
            page.get_by_role("button", name="Continue").click()
            consented(page)
            for _ in range(4):
                driven(page)
                answered(page)
            expect(page.get_by_role("heading", name="The session is over")).to_be_visible()
    rows = tidy_rows(data)
    assert [(row["participant_id"], row["run"]) for row in rows] == [
        (person, run) for person in ("sub-01", "sub-02") for run in "1234"
    ]
    assert [row["attempt"] for row in rows] == ["1", "2", *["1"] * 6]
    assert {row["driven_by"] for row in rows} == {"person"}
    assert {row["probe_asked"] for row in rows} == {"2"}
    assert {row["probe_right"] for row in rows} == {"2"}
    assert {row["effort.effort"] for row in rows} == {"1.5"}
    assert {row["effort.more"] for row in rows} == {"Nothing, thanks = fine or not"}
    assert [row["condition"] for row in rows[:4]] == ["blocked-tone", "blocked-text", "blocked-text", "blocked-tone"]
    assert [row["sessions_done"] for row in read_table(data / "participants.tsv")] == ["1", "1"]
    for row in rows:
        assert (data / row["recording"] / "inputs.jsonl").is_file()
        assert read_recording(data / row["recording"] / "recording.parquet").t[-1] == pytest.approx(2.0)


def test_a_page_that_is_gone_in_a_takeover_stops_the_vehicle_and_marks_the_trial(
    standing: tuple[Served, Path], browser: Browser
) -> None:
    server, study = standing
    started(server, 2)
    with opened_page(browser, f"{server.address}participant/2", bypass_csp=True) as page:
        begun(page)
        page.wait_for_function("globalThis.page?.latest !== undefined")
        page.keyboard.press("Enter")
        page.wait_for_function("page.latest.byHand")
    with opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk:
        expect(row_of(desk, 2)).to_contain_text("standstill, page gone")
        ordered(desk, 2, "Abort")
        waited_for(lambda: journal(study, 2)[-1]["kind"] == "done")
        expect(row_of(desk, 2)).to_contain_text("ask")
    ended = next(one for one in journal(study, 2) if one["kind"] == "driven")
    assert ended["marks"] == ["aborted", "person_left"]
    folder = study.parent / "data" / "sub-02" / "ses-01" / "beh"
    waited_for(lambda: any(folder.glob("*_run-01_events.tsv")))  # the tables come after the journal
    (table,) = folder.glob("*_run-01_events.tsv")
    events = [one["trial_type"] for one in read_table(table)]
    assert events.index("override") < events.index("person_left") < events.index("minimum_risk")
    assert events.index("minimum_risk") < events.index("standstill")


def test_the_experimenter_pauses_requests_aborts_and_notes(standing: tuple[Served, Path], browser: Browser) -> None:
    server, study = standing
    with (
        opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page,
        opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk,
    ):
        expect(page.get_by_role("heading", name="Please wait for the experimenter.")).to_be_visible()
        ordered(desk, 1, "Start")
        begun(page)
        page.wait_for_function("globalThis.page?.latest !== undefined")
        ordered(desk, 1, "Pause")
        expect(page.get_by_role("heading", name="A short pause.")).to_be_visible()
        expect(row_of(desk, 1)).to_contain_text("paused")
        stood = page.evaluate("page.latest.t")
        ordered(desk, 1, "Start")
        page.wait_for_function(f"page.latest.t > {stood}")
        expect(page.locator("#held")).to_be_hidden()
        ordered(desk, 1, "Request")
        page.wait_for_function("page.latest.state === 'request'")
        expect(page.locator("#state")).to_have_text("automated")
        expect(page.locator("#left")).to_be_hidden()
        expect(page.locator("#told")).to_be_hidden()
        desk.get_by_label("Note on participant 1").fill("looked aside")
        desk.get_by_label("Note on participant 1").press("Enter")
        waited_for(lambda: any(one["kind"] == "note" for one in journal(study, 1)))
        circles = page.locator("#search circle")
        expect(circles).to_have_count(6)
        page.evaluate(PRESS_LARGEST)
        waited_for(lambda: any(one["kind"] == "search" for one in journal(study, 1)))
        ordered(desk, 1, "Abort")
        left(page)
        expect(page.get_by_role("heading", name="This trial")).to_be_visible()
    records = journal(study, 1)
    kinds = [one["kind"] for one in records]
    assert kinds[:3] == ["started", "begun", "paused"]
    assert next(one for one in records if one["kind"] == "note")["text"] == "looked aside"
    assert next(one for one in records if one["kind"] == "search")["right"] is True
    assert next(one for one in records if one["kind"] == "driven")["marks"] == ["aborted", "paused", "requested"]
    waited_for(lambda: rows_of(study, 1) != [])
    (row,) = rows_of(study, 1)
    assert (row["cause"], row["marks"], row["search_right"]) == ("scheduled", "aborted paused requested", "1")
    (table,) = (study.parent / "data" / "sub-01" / "ses-01" / "beh").glob("*_run-01_events.tsv")
    pauses = [float(one["onset"]) for one in read_table(table) if one["trial_type"] == "paused"]
    assert pauses == [pytest.approx(one["t"]) for one in records if one["kind"] == "paused"]


PRESS_LARGEST = """
() => {
  const circles = [...document.querySelectorAll("#search circle")];
  const size = (one) => Number(one.getAttribute("r"));
  const largest = circles.reduce((a, b) => (size(b) > size(a) ? b : a));
  largest.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, cancelable: true }));
}
"""


@pytest.mark.slow
def test_an_open_page_goes_on_by_itself_when_the_server_is_there_again(endless: Path, browser: Browser) -> None:
    page = free_page(browser)  # one that complains of the missing server
    with served(*serving(endless)) as server:
        started(server, 1)
        page.goto(f"{server.address}participant/1")
        begun(page)
        page.wait_for_function("page.latest !== undefined")
        server.process.kill()
        server.process.wait()
        expect(page.locator("#ended")).to_have_text("The server has gone.")
        expect(page.locator("#go")).to_be_disabled()
    with served(*serving(endless), port=int(server.host.rpartition(":")[2])) as again:
        expect(page.get_by_role("heading", name="Please wait")).to_be_visible()
        started(again, 1)
        begun(page)
        page.wait_for_function("page.latest !== undefined")
        page.close()


@pytest.mark.slow
def test_answers_given_before_a_pause_stand_in_the_form_again(tmp_path: Path, browser: Browser) -> None:
    study = made.study(tmp_path)
    study.write_text(
        study.read_text(encoding="utf-8").replace('<page file="welcome.md"/>', '<ask file="effort.xml"/>'),
        encoding="utf-8",
    )
    with (
        served(*serving(study)) as server,
        opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk,
        opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page,
    ):
        ordered(desk, 1, "Start")
        page.get_by_role("button", name="I agree").click()
        page.get_by_role("group", name="Taking over was hard.").get_by_label("2").check()
        page.get_by_label("A sound").check()
        page.get_by_label("What else do you want to say?").fill("Half a sen")
        page.get_by_label("A sound").focus()
        ordered(desk, 1, "Pause")
        expect(page.get_by_role("heading", name="Please wait")).to_be_visible()
        ordered(desk, 1, "Start")
        expect(page.get_by_label("What else do you want to say?")).to_have_value("Half a sen")
        expect(page.get_by_role("group", name="Taking over was hard.").get_by_label("2")).to_be_checked()
        expect(page.get_by_role("group", name="I stayed calm.").get_by_label("7")).not_to_be_checked()
        answered(page)
        expect(page.locator("#go")).to_be_visible()
        page.wait_for_function("sessionStorage.length === 0")
    given = journal(study, 1)[-1]["answers"]
    assert given == {"hard": 2, "calm": 7, "first": "sound", "more": "Nothing, thanks = fine\tor not"}


@pytest.mark.slow
def test_a_run_that_cannot_be_written_is_reported_to_the_experimenter_and_repeated(
    short: Path, browser: Browser
) -> None:
    short.write_text(short.read_text().replace('from="0.5" to="1.5"', 'from="0.5" to="1.5" share="0"'))
    with served(*serving(short), largest=120_000) as server:  # less than the map
        started(server, 1)
        with opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page:
            consented(page)
            begun(page)
            expect(page.locator("#ended")).to_have_text("The run broke off. Please wait for the experimenter.")
            expect(page.locator("#go")).to_have_text("Again")
            with opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk:
                expect(row_of(desk, 1).locator(".fault")).to_contain_text("File too large")
            page.locator("#go").click()
            page.wait_for_function("document.querySelector('#start').hidden")
    assert [one["kind"] for one in journal(short, 1)][-2:] == ["begun", "begun"]


@pytest.mark.slow
def test_a_second_page_of_a_participant_watches(standing: tuple[Served, Path], browser: Browser) -> None:
    server, _ = standing
    started(server, 3)
    address = f"{server.address}participant/3"
    with opened_page(browser, address, bypass_csp=True) as page:
        page.wait_for_function("globalThis.page?.role === 'driver'")
        with opened_page(browser, address, bypass_csp=True) as other:
            other.wait_for_function("globalThis.page?.role === 'viewer'")
            begun(page)
            other.wait_for_function("page.latest?.t > 1.5")  # pages that watch stay connected
            assert (page.evaluate("page.role"), other.evaluate("page.role")) == ("driver", "viewer")
            other.keyboard.press("Enter")
            page.keyboard.press("Enter")
            other.wait_for_function("page.latest.byHand")
            expect(page.locator("#search circle")).to_have_count(6)
            expect(other.locator("#search circle")).to_have_count(0)


@pytest.mark.slow
def test_a_second_page_of_a_participant_goes_on_with_the_first(endless: Path, browser: Browser) -> None:
    with served(*serving(endless)) as server:
        started(server, 1)
        address = f"{server.address}participant/1"
        with (
            opened_page(browser, address, bypass_csp=True) as page,
            opened_page(browser, address, bypass_csp=True) as other,
            opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk,
        ):
            for one in (page, other):
                one.wait_for_function("globalThis.page?.role !== undefined")
            begun(page)
            other.wait_for_function("page.latest !== undefined")
            ordered(desk, 1, "Abort")
            expect(other.locator("#ended")).to_contain_text("This drive is over")
            expect(other.locator("#go")).to_be_hidden()
            left(page)
            for one in (page, other):
                expect(one.get_by_role("heading", name="This trial")).to_be_visible()


def test_who_does_not_consent_takes_no_part(short: Path, browser: Browser) -> None:
    with served(*serving(short)) as server:
        started(server, 2)
        with opened_page(browser, f"{server.address}participant/2", bypass_csp=True) as page:
            page.get_by_role("button", name="I do not agree").click()
            expect(page.get_by_role("heading", name="You do not take part")).to_be_visible()
            page.reload()
            expect(page.get_by_role("heading", name="You do not take part")).to_be_visible()
    assert [one["kind"] for one in journal(short, 2)] == ["started", "declined"]


@pytest.mark.slow
def test_all_questions_of_a_probe_are_in_sight_in_a_narrow_window(short: Path, browser: Browser) -> None:
    query = '<query name="{}" about="{}" text="What do you remember of the moment at which the picture went blank?"/>'
    more = "".join(query.format(name, name) for name in ("blocked", "vehicles"))
    short.write_text(short.read_text().replace("</probe>", f"{more}</probe>"))
    with served(*serving(short)) as server:
        started(server, 1)
        with opened_page(browser, f"{server.address}participant/1", 390, 600, bypass_csp=True) as page:
            consented(page)
            begun(page)
            expect(page.get_by_label("How fast were you, in km/h?")).to_be_visible()
            assert page.evaluate("document.documentElement.scrollWidth") <= 390
            heights = page.evaluate("(({ scrollHeight, clientHeight }) => [scrollHeight, clientHeight])(held)")
            assert heights[0] == heights[1]  # the page scrolls, not a part of it that hides the rest


@pytest.mark.slow
def test_scales_stay_in_the_window_whatever_their_length(short: Path, browser: Browser) -> None:
    study, effort = short, short.parent / "effort.xml"
    study.write_text(study.read_text().replace('<consent file="consent.md"/>', '<ask file="effort.xml"/>'))
    long = '<scale name="whole" from="0" to="100"/><scale name="twenty" from="0" to="20"/>'
    items = '<item name="much" text="How much?" scale="whole"/><item name="demand" text="Demand" scale="twenty"/>'
    effort.write_text(effort.read_text().replace("  <item", f"{long}{items}\n  <item", 1))
    with served(*serving(study)) as server:
        started(server, 1)
        with opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page:
            expect(page.get_by_role("group", name="Demand").get_by_role("radio")).to_have_count(21)
            for width in (1400, 390):
                page.set_viewport_size({"width": width, "height": 900})
                assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.slow
@pytest.mark.parametrize("width", [1400, 390])
def test_pages_are_accessible_and_stay_in_the_window(short: Path, browser: Browser, width: int) -> None:
    def checked(page: Page) -> None:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        found = json.loads(json.dumps(Axe().run(page).response["violations"]))
        assert [(one["id"], one["nodes"][0]["html"]) for one in found] == []

    with (
        served(*serving(short)) as server,
        opened_page(browser, f"{server.address}experimenter", width, bypass_csp=True) as desk,
        opened_page(browser, server.address, width, bypass_csp=True) as page,
    ):
        expect(row_of(desk, 1)).to_be_visible()
        checked(desk)
        checked(page)
        page.goto(f"{server.address}participant/1")
        checked(page)
        ordered(desk, 1, "Start")
        expect(page.get_by_role("button", name="I agree")).to_be_visible()
        checked(page)
        consented(page)
        begun(page)
        expect(page.get_by_label("How fast were you, in km/h?")).to_be_visible()
        checked(page)
        probed(page)
        left(page)
        expect(page.get_by_role("heading", name="This trial")).to_be_visible()
        checked(page)
