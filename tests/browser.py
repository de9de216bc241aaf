"""Headless Chromium for tests of pages, without access to a network."""

import shutil
from contextlib import contextmanager

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def chromium_path():
    """Chromium on this machine, if there is one."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


@contextmanager
def open_page(address, *, width=1280, height=900, scheme="light", site="data:"):
    """A page in a new browser, and the list of what went wrong on it: errors, other addresses.

    Addresses that begin with ``site`` belong to it.
    """
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium_path(), args=FLAGS
        )
        page = browser.new_page(
            viewport={"width": width, "height": height},
            reduced_motion="reduce",
            color_scheme=scheme,
        )
        faults: list[str] = []
        page.on("pageerror", lambda error: faults.append(f"error: {error}"))
        page.on(
            "console",
            lambda message: message.type == "error" and faults.append(message.text),
        )
        page.on(
            "request",
            lambda request: (
                request.url.split("#")[0] != address.split("#", maxsplit=1)[0]
                and not request.url.startswith(("data:", "blob:", site))
                and faults.append(f"asks for {request.url}")
            ),
        )
        page.goto(address)
        try:
            yield page, faults
        finally:
            browser.close()
