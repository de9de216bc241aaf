"""One Typst source, two outputs: a self-contained page (HTML with MathML) and a PDF."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any

import typst
from jinja2 import Environment, StrictUndefined

TEMPLATES = Path(str(files("squealpipe.report"))) / "templates"


def write_report(
    content: Mapping[str, Any], pictures: Mapping[str, Path], page: Path, pdf: Path
) -> None:
    """Typeset the report and write both files, each whole or not at all.

    Args:
        content: what :func:`squealpipe.report.content.gather` returns.
        pictures: path inside the source (``content["figures"][name]["path"]``) → PNG file.
        page: ``index.html``; needs no network and no other file.
        pdf: ``report.pdf``.
    """
    with _source(content, pictures) as main:
        body = _body(typst.compile(main, format="html", sys_inputs={"target": "html"}).decode())
        document = typst.compile(
            main, format="pdf", sys_inputs={"target": "pdf"}, ignore_system_fonts=True
        )
    _write(page, _page(content, body).encode())
    _write(pdf, document)


@contextmanager
def _source(content: Mapping[str, Any], pictures: Mapping[str, Path]) -> Iterator[Path]:
    """The Typst source with data and pictures beside it, in a folder of its own."""
    with tempfile.TemporaryDirectory(prefix="squealpipe-report-") as folder:
        root = Path(folder) / "report"
        shutil.copytree(TEMPLATES, root)
        (root / "data.json").write_text(json.dumps(content, allow_nan=False), encoding="utf-8")
        for path, source in pictures.items():
            target = root / path
            target.parent.mkdir(exist_ok=True)
            shutil.copyfile(source, target)
        yield root / "main.typ"


def _body(document: str) -> str:
    """What is between the body tags of Typst's page; our own shell replaces the rest."""
    return document[document.index("<body>") + len("<body>") : document.rindex("</body>")]


def _page(content: Mapping[str, Any], body: str) -> str:
    environment = Environment(undefined=StrictUndefined, autoescape=True)
    shell = environment.from_string((TEMPLATES / "page.html.j2").read_text(encoding="utf-8"))
    sections = re.findall(r'<h2 id="([^"]+)">(.*?)</h2>', body)
    return shell.render(
        title=content["title"],
        style=(TEMPLATES / "style.css").read_text(encoding="utf-8"),
        sections=sections,
        body=body,
    )


def _write(path: Path, text: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(text)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
