"""The site builds without warnings, holds what is public, and opens page by page."""

import os
import runpy
import subprocess
import sys
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from inspect import signature
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import squealpipe
from tests.browser import chromium_path, open_page

ROOT = Path(__file__).resolve().parents[1]


class Quiet(SimpleHTTPRequestHandler):
    """A server of files that prints nothing."""

    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "mkdocs",
        "build",
        "--strict",
        "-q",
        "-d",
        str(folder),
    ]
    # its pages run in test_a_page_of_the_gallery_runs: fourteen kernels take 40 s to start
    env = os.environ | {"EXECUTE_GALLERY": "false"}
    done = subprocess.run(
        command, cwd=ROOT, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


GALLERY = sorted((ROOT / "docs/gallery").glob("*.py"))


@pytest.mark.release
@pytest.mark.parametrize("page", GALLERY, ids=[page.stem for page in GALLERY])
def test_a_page_of_the_gallery_runs(page, monkeypatch):
    monkeypatch.chdir(ROOT)
    runpy.run_path(str(page))
    plt.close("all")


def test_signatures_are_shown_as_they_are_written():
    """What ``help`` and a notebook show: Angle, not the checks behind it."""
    called = {name: getattr(squealpipe, name) for name in squealpipe.__all__}
    shown = {
        name: str(signature(each)) for name, each in called.items() if callable(each)
    }
    assert [name for name, text in shown.items() if "Validator" in text] == []


@pytest.mark.release
def test_reference_holds_what_is_public(site):
    page = (site / "reference.html").read_text(encoding="utf-8")
    assert [
        name for name in squealpipe.__all__ if f'id="squealpipe.{name}"' not in page
    ] == []


@pytest.mark.release
@pytest.mark.skipif(chromium_path() is None, reason="no chromium on this machine")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_page_opens(site, scheme):
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    home = f"http://127.0.0.1:{server.server_port}/"
    pages = sorted(set(site.glob("*.html")) - {site / "404.html"})
    assert len(pages) > 15
    with open_page(f"{home}index.html", scheme=scheme, site=home) as (page, faults):
        for path in pages:
            page.goto(home + path.name)
            assert page.locator("h1").first.inner_text().strip(), path.name
            assert page.evaluate("document.body.scrollWidth <= innerWidth"), path.name
            empty = "[...document.images].filter(i => !i.naturalWidth).map(i => i.src)"
            assert page.evaluate(empty) == []
    server.shutdown()
    assert faults == []
