"""Takes the pictures of reports, comparisons and the gallery that docs/replay.md shows, at both widths.

    python -m tests.benchmarks.page_pictures docs/images

`obstacle_ahead` is run twice with ideal perception: as it is, and with a driver who responds late. The pictures show
both runs at the same moment.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Browser, Page

from scenario_compiler.cli import main as command
from tests.browser import opened_browser, opened_page

WIDTHS = {1400: 1180, 390: 1600}
"""Widths of the window and the heights of the pictures, pixels."""

MOMENT = 10.0
"""Time that is shown, s: the first driver has taken over, the second one has not."""

SHOWN = ("obstacle_ahead.xml", "narrowing_variants.xml", "ramp_variants.xml")
"""Files of the library that the gallery shows."""


def pages(folder: Path) -> dict[str, Path]:
    """Run the conflict twice and write the three pages to a folder; return them by the names of their pictures."""
    one, other = folder / "attentive", folder / "late"
    conflict = Path("library/conflicts/obstacle_ahead.xml")
    late = folder / "late.xml"
    text = conflict.read_text(encoding="utf-8")
    late.write_text(text.replace('preset="study_means"', 'takeover_time="5.5"'), encoding="utf-8")
    for file, out in ((conflict, one), (late, other)):
        _done("run", file, "--perception", "ideal", "-o", out)
    _done("report", one, "--camera")
    _done("compare", one, other, "--html", folder / "both.html", "--camera")
    _done("list", *(conflict.with_name(name) for name in SHOWN), "--html", folder / "gallery.html")
    return {"player": one / "report.html", "compare": folder / "both.html", "gallery": folder / "gallery.html"}


def _done(*arguments: str | Path) -> None:
    code = command([str(one) for one in arguments])
    if code != (1 if arguments[0] == "compare" else 0):  # runs that differ give 1
        raise RuntimeError(f"{arguments[0]} ended with {code}")


def take(page: Page, name: str, file: Path) -> None:
    """Take a picture of an open page: of its player, if it has one, at the moment that is shown."""
    if name != "gallery":
        page.locator(".player.ready").first.wait_for()
        page.evaluate("(t) => document.querySelector('.player').player.show(t)", MOMENT)
        page.evaluate("document.querySelector('.player').scrollIntoView({block: 'start', behavior: 'instant'})")
        page.wait_for_function("[...document.querySelectorAll('.player img')].every((one) => one.complete)")
    page.screenshot(path=str(file), type="jpeg", quality=80)


def main(images: Path, browser: Browser) -> None:
    """Take all pictures."""
    with tempfile.TemporaryDirectory() as folder:
        for name, path in pages(Path(folder)).items():
            for width, height in WIDTHS.items():
                with opened_page(browser, path.as_uri(), width, height) as page:
                    take(page, name, images / f"{name}_{width}.jpg")


if __name__ == "__main__":
    with opened_browser() as opened:
        main(Path(sys.argv[1]), opened)
