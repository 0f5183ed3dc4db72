"""Contrast, names and structure of the pages, checked by axe-core."""

from __future__ import annotations

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page

from scenario_compiler.recording.comparison import compare
from scenario_compiler.report.compare_page import write_comparison
from scenario_compiler.report.gallery import Card, Moment, write_gallery
from scenario_compiler.report.html import write_report
from scenario_compiler.report.run import Run
from tests.browser import opened_page
from tests.live.serving import served
from tests.report import made

OPTIONS = {"resultTypes": ["violations"], "runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]}


def faults(page: Page) -> list[str]:
    """Return each rule that is broken, with the elements that break it."""
    found = Axe().run(page, options=OPTIONS).response["violations"]
    return [f"{one['id']}: {', '.join(str(node['target']) for node in one['nodes'][:3])}" for one in found]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_report_is_accessible(finished: Run, tmp_path: Path, browser: Browser, scheme: str) -> None:
    path = write_report([finished], tmp_path)
    with opened_page(browser, path.as_uri()) as page:
        page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
        page.locator(".player.ready").wait_for()
        assert faults(page) == []


def test_a_comparison_is_accessible(finished: Run, tmp_path: Path, browser: Browser) -> None:
    found = compare(finished.recording, finished.recording, None, tolerance=None)
    path = tmp_path / "both.html"
    write_comparison((finished, finished), ("one", "other"), found, ["Alike."], [(), ()], path)
    with opened_page(browser, path.as_uri()) as page:
        page.locator(".player.ready").wait_for()
        assert faults(page) == []


def test_a_gallery_is_accessible(tmp_path: Path, browser: Browser) -> None:
    moment = Moment("takeover request after 3 s", "path blocked", made.picture("it"))
    path = tmp_path / "gallery.html"
    write_gallery([Card("Group", "name", "It crosses", "A source", "scenario-compiler run it", "town", moment)], path)
    with opened_page(browser, path.as_uri()) as page:
        assert faults(page) == []


def test_the_page_of_a_run_under_way_is_accessible(browser: Browser) -> None:
    with (
        served("drive", "obstacle_ahead", "--perception", "ideal") as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        page.wait_for_function("globalThis.page?.role === 'driver'")
        assert faults(page) == []
        page.get_by_role("button", name="Start").click()
        page.wait_for_function("page.latest !== undefined", timeout=120_000)
        assert faults(page) == []
