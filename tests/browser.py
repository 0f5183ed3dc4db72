"""The machine's own Chromium, driven by Playwright, for tests of pages."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

SLOW = 120_000
"""Time after which a state that must come is no longer waited for, ms: the machine may be slow and busy."""

expect.set_options(timeout=SLOW)

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")


@contextmanager
def opened_browser() -> Iterator[Browser]:
    """Yield Chromium without a window; the test is skipped if the machine has none."""
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@cache
def context_of(browser: Browser, *, bypass_csp: bool) -> BrowserContext:
    """Return what a browser's pages share: a page with a context of its own takes twice the time to open."""
    return browser.new_context(bypass_csp=bypass_csp)


@contextmanager
def killable_page(browser: Browser, address: str, folder: Path) -> Iterator[tuple[Page, Callable[[], None]]]:
    """Yield a page in a Chromium of its own, with its profile in a folder, and what kills all processes of that one."""
    assert CHROMIUM is not None
    command = [CHROMIUM, "--headless=new", "--no-sandbox", "--remote-debugging-port=0", f"--user-data-dir={folder}"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    try:
        assert process.stderr is not None
        told = (line.partition("DevTools listening on ")[2].strip() for line in process.stderr)
        own = browser.browser_type.connect_over_cdp(next(one for one in told if one))
        page = own.new_context(bypass_csp=True).new_page()
        page.set_default_timeout(SLOW)
        page.goto(address)
        yield page, lambda: os.killpg(process.pid, signal.SIGKILL)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def free_page(browser: Browser) -> Page:
    """Return a page that may complain, as one does whose server is gone; the test closes it."""
    page = context_of(browser, bypass_csp=True).new_page()
    page.set_default_timeout(SLOW)
    return page


@contextmanager
def opened_page(
    browser: Browser, address: str, width: int = 1200, height: int = 900, *, bypass_csp: bool = False
) -> Iterator[Page]:
    """Yield an open page; afterwards it must have logged no errors and sent no request to another machine.

    With `bypass_csp`, the page's content security policy does not block scripts of the test.
    """
    context = context_of(browser, bypass_csp=bypass_csp)
    page = context.new_page()
    page.set_viewport_size({"width": width, "height": height})
    page.set_default_timeout(SLOW)
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    try:
        page.goto(address)
        yield page
    finally:  # a page that a failed test leaves open would keep the driver's place at a shared server
        kept = {"origin": "/".join(address.split("/")[:3]), "storageTypes": "all"}
        context.new_cdp_session(page).send("Storage.clearDataForOrigin", kept)
        page.close()
    assert complaints == []
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:", "http://127.0.0.1"))] == []
