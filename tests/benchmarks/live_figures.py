"""Prints a table of pictures and delays for a person at the wheel: `python tests/benchmarks/live_figures.py`.

`drive` serves 1280 x 720 pictures to a page in headless Chromium on the same machine, which presses and releases a key
all the time. The page and the server measure themselves; both share the machine's cores. Nothing else should run.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser
from rich.console import Console
from rich.table import Table

from tests.browser import opened_browser, opened_page
from tests.live.serving import served

TARGETS = ("obstacle_ahead", "ramp_blocked", "markings_missing")
PRESSED, RELEASED = 400, 600
"""How long a key is pressed and how long it is not, ms."""


@dataclass(frozen=True)
class Driven:
    """What was measured of one drive.

    Attributes:
        target: The conflict.
        perception: What the automation saw by.
        seconds: How long the page was driven, s of the run.
        figures: What the server measured of the page; see `Session.figures`.
    """

    target: str
    perception: str
    seconds: float
    figures: dict[str, Any]

    def row(self) -> Sequence[str]:
        """Return the line of the table."""
        known = self.figures
        shown = known["pictures_shown"] - known["pictures_lost"]
        by_the_clock = self.seconds + 1e-3 * known["given_up_ms"]
        return (
            f"{self.target}, {self.perception}",
            f"{shown / by_the_clock:.1f}",
            f"{known['pictures_lost']} of {known['pictures_shown']}",
            f"{known['latency_median_ms']} / {known['latency_p95_ms']} ({known['latency_count']})",
            f"{known['late_median_ms']} / {known['late_most_ms']}",
            f"{known['given_up_ms']}",
        )


def driven(browser: Browser, target: str, perception: str, seconds: float, folder: Path) -> Driven:
    """Drive a conflict for some seconds of the run and return what was measured."""
    out = folder / f"{target}-{perception}"
    words = ("drive", target, "--perception", perception, "-o", out)
    with served(*words) as server, opened_page(browser, server.address, 1400, 900, bypass_csp=True) as page:
        page.set_default_timeout(600_000)
        page.get_by_role("button", name="Start").click()
        page.wait_for_function("globalThis.page?.latest !== undefined")
        while (at := float(page.evaluate("page.latest.t"))) < seconds:
            page.keyboard.down("ArrowUp")
            page.wait_for_timeout(PRESSED)
            page.keyboard.up("ArrowUp")
            page.wait_for_timeout(RELEASED)
        page.evaluate("page.say({kind: 'stop'})")
        page.wait_for_function("document.querySelector('#ended').textContent !== ''")
    return Driven(target, perception, at, json.loads((out / "drive-001" / "live.json").read_text(encoding="utf-8")))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Print what a person at the wheel gets.")
    parser.add_argument("--seconds", type=float, default=10.0, help="how long each drive takes, s")
    options = parser.parse_args()
    table = Table(title=f"{options.seconds:g} s each, 1280 x 720, wall clock")
    for heading in (
        "conflict",
        "pictures/s",
        "lost",
        "latency ms, median / 95 % (n)",
        "late ms, median / most",
        "given up",
    ):
        table.add_column(heading)
    with tempfile.TemporaryDirectory() as folder, opened_browser() as browser:
        for target in TARGETS:
            for perception in ("ideal", "camera"):
                table.add_row(*driven(browser, target, perception, options.seconds, Path(folder)).row())
    Console(width=140).print(table)


if __name__ == "__main__":
    main()
