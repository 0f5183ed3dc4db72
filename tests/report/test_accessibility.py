"""Contrast, names and structure of the pages, checked by axe-core."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page

from scenario_compiler.recording.comparison import compare
from scenario_compiler.report.compare_page import write_comparison, write_tables
from scenario_compiler.report.gallery import Card, Moment, write_gallery
from scenario_compiler.report.html import write_report
from scenario_compiler.report.run import Run
from tests.browser import opened_page
from tests.live.serving import COARSELY, served
from tests.report import made

WIDTHS = pytest.mark.parametrize("width", [pytest.param(1400, marks=pytest.mark.slow), 390])
"""Widths of the window, pixels: a desktop and a phone, where tables scroll sideways and faults are likelier."""


def faults(page: Page) -> list[str]:
    """Return each rule that is broken, with the elements that break it."""
    found = Axe().run(page).response["violations"]
    return [f"{one['id']}: {', '.join(str(node['target']) for node in one['nodes'][:3])}" for one in found]


@pytest.mark.parametrize(
    "looks",
    [
        {1400: "light", 390: "dark"},
        pytest.param({1400: "dark", 390: "light"}, marks=pytest.mark.slow),
    ],
)
def test_a_report_is_accessible(
    finished: Run, tmp_path: Path, browser: Browser, looks: dict[int, Literal["light", "dark"]]
) -> None:
    path = write_report([finished], tmp_path)
    with opened_page(browser, path.as_uri()) as page:
        page.locator(".player.ready").wait_for()
        for width, scheme in looks.items():
            page.set_viewport_size({"width": width, "height": 900})
            page.emulate_media(color_scheme=scheme)
            assert faults(page) == []


@WIDTHS
def test_a_comparison_is_accessible(finished: Run, tmp_path: Path, browser: Browser, width: int) -> None:
    found = compare(finished.recording, finished.recording, None, tolerance=None)
    path = tmp_path / "both.html"
    write_comparison((finished, finished), ("one", "other"), found, ["Alike."], [(), ()], path)
    with opened_page(browser, path.as_uri(), width) as page:
        page.locator(".player.ready").wait_for()
        assert faults(page) == []


@WIDTHS
def test_a_comparison_of_sweeps_is_accessible(tmp_path: Path, browser: Browser, width: int) -> None:
    facts = ("How the sweeps were made", ("", "first", "second"), [("plan digest", "0123456789abcdef" * 4, "=")], 0)
    measures = [(f"minimum_{k}", "m/s2", "1", "0", "0", "0.0131", "0.4474", "5") for k in range(30)]
    headings = ("measure", "unit", "differ", "first only", "second only", "median", "largest", "variant")
    path = tmp_path / "both.html"
    write_tables(("one", "other"), ["The sweeps differ."], [facts, ("Measures", headings, measures, 3)], path)
    with opened_page(browser, path.as_uri(), width) as page:
        assert faults(page) == []


@WIDTHS
def test_a_gallery_is_accessible(tmp_path: Path, browser: Browser, width: int) -> None:
    moment = Moment("takeover request after 3 s", "path blocked", made.picture("it"))
    path = tmp_path / "gallery.html"
    write_gallery([Card("Group", "name", "It crosses", "A source", "scenario-compiler run it", "town", moment)], path)
    with opened_page(browser, path.as_uri(), width) as page:
        assert faults(page) == []


@pytest.mark.slow
def test_the_page_of_a_run_under_way_is_accessible(browser: Browser) -> None:
    with (
        served("drive", "obstacle_ahead", *COARSELY) as server,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        page.wait_for_function("globalThis.page?.role === 'driver'")
        assert faults(page) == []
        page.get_by_role("button", name="Start").click()
        page.wait_for_function("page.latest !== undefined")
        assert faults(page) == []
