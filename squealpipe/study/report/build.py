"""A Typst source gives two files: a self-contained page (HTML with MathML) and a PDF."""

import json
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

import typst
from jinja2 import Environment, StrictUndefined

from squealpipe.store.whole_files import not_written, whole_file

TEMPLATES = Path(str(files("squealpipe.study.report"))) / "templates"


def _typeset(source: Path, target: Literal["html", "pdf"]) -> bytes:
    """The document in one format; the PDF with the fonts that come with Typst."""
    return typst.compile(
        source,
        format=target,
        sys_inputs={"target": target},
        ignore_system_fonts=target == "pdf",
    )


def write_document(
    template: str,
    content: Mapping[str, Any],
    pictures: Mapping[str, Path],
    *,
    page: Path,
    pdf: Path,
    media: Mapping[str, str] | None = None,
) -> None:
    """Typeset one document and write both files, each whole or not at all.

    Args:
        pictures: path inside the source (``content["figures"][name]["path"]``) → PNG file.
        media: name of a place for films and sounds in the template → elements of the page there.
    """
    with _source(template, content, pictures) as main, ThreadPoolExecutor(2) as pool:
        made = pool.submit(_typeset, main, "html")
        document = pool.submit(_typeset, main, "pdf")
    with whole_file(page) as temporary:
        temporary.write_bytes(
            _page(content, made.result().decode(), media or {}).encode()
        )
    with whole_file(pdf) as temporary:
        temporary.write_bytes(document.result())


@contextmanager
def _source(
    template: str, content: Mapping[str, Any], pictures: Mapping[str, Path]
) -> Iterator[Path]:
    """The Typst source with data and pictures beside it, in a folder of its own."""
    with tempfile.TemporaryDirectory(prefix="squealpipe-report-") as folder:
        root = Path(folder)
        try:
            (root / "data.json").write_text(
                json.dumps(content, allow_nan=False), encoding="utf-8"
            )
            templates = {path.name: path for path in TEMPLATES.iterdir()}
            for path, source in {**templates, **pictures}.items():
                target = root / path
                target.parent.mkdir(exist_ok=True)
                shutil.copyfile(source, target)
        except OSError as error:  # the disk of temporary files may be another one
            raise not_written(root, error) from error
        yield root / f"{template}.typ"


def _page(content: Mapping[str, Any], made: str, media: Mapping[str, str]) -> str:
    """Our own shell around the body and the mathematics style of Typst's page."""
    environment = Environment(undefined=StrictUndefined, autoescape=True)
    shell = environment.from_string(
        (TEMPLATES / "page.html.j2").read_text(encoding="utf-8")
    )
    # dots over a symbol: as combining characters they land beside it where no mathematics font is
    body = _between(made, "<body>", "</body>")
    for combining, beside in (("\u0307", "\u02d9"), ("\u0308", "\u00a8")):
        body = body.replace(combining, beside)
    for name, elements in media.items():
        place = re.search(rf'<div[^>]*id="media-{re.escape(name)}"[^>]*></div>', body)
        if place is not None:
            body = body.replace(place[0], elements)
    return shell.render(
        title=content["title"],
        # a page without a formula has none
        mathematics_style=_between(made, "<style>", "</style>")
        if "<style>" in made
        else "",
        style=(TEMPLATES / "style.css").read_text(encoding="utf-8"),
        sections=re.findall(r'<h2 id="([^"]+)">(.*?)</h2>', body),
        body=body,
    )


def _between(text: str, start: str, end: str) -> str:
    return text[text.index(start) + len(start) : text.rindex(end)]
