"""A real Chromium for tests, driven by playwright's package; where there is none a test is skipped and says so."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

CHROMIUM = shutil.which("chromium")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync"]


@contextmanager
def page(width: int = 1280, height: int = 900) -> Iterator:
    """A page of a browser; `page.errors` collects what its console calls an error and what could not be loaded."""
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine; `make test-browser` installs it")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        one = browser.new_page(viewport={"width": width, "height": height})
        one.errors = []
        one.on("console", lambda message: one.errors.append(message.text) if message.type == "error" else None)
        one.on("pageerror", lambda error: one.errors.append(str(error)))
        one.on("requestfailed", lambda request: one.errors.append(f"not loaded: {request.url}"))
        try:
            yield one
        finally:
            browser.close()
