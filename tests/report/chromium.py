"""The Chromium of this machine, headless, driven by Playwright."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

PROGRAMS = (
    "chromium", "chromium-browser", "google-chrome", "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
)  # fmt: skip
FLAGS = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
)  # fmt: skip
"""For a browser of root in a container without a network."""


def executable() -> str | None:
    """The browser of this machine, if it has one."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


@contextmanager
def started() -> Iterator[Browser]:
    """Start the browser, and end it."""
    with sync_playwright() as playwright, playwright.chromium.launch(executable_path=executable(), args=FLAGS) as it:
        yield it


@contextmanager
def opened(browser: Browser, path: Path, *, width: int, dark: bool = False) -> Iterator[tuple[Page, list[str]]]:
    """Load a file in a window of this width. The list receives console warnings, errors and failed requests."""
    complaints: list[str] = []
    context = browser.new_context(
        viewport={"width": width, "height": 900}, is_mobile=width < 500, color_scheme="dark" if dark else "light"
    )
    with context, context.new_page() as page:
        page.on("console", lambda m: complaints.append(m.text) if m.type in ("error", "warning", "assert") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("requestfailed", lambda request: complaints.append(f"{request.url}: {request.failure}"))
        page.goto(path.resolve().as_uri())
        yield page, complaints
