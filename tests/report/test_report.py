"""The report: self-contained, complete, with links that lead somewhere and texts for pictures."""

from __future__ import annotations

import hashlib
import math
import re
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path

import pytest
import yaml

from squealpipe.study.claims.statements import PAPER as STATED
from squealpipe.study.claims.statements import STATEMENTS
from squealpipe.study.report.build import TEMPLATES, write_report
from squealpipe.study.report.content import picture_files, title
from squealpipe.study.report.lineage import lineage
from squealpipe.study.report.places import FIGURES, PLACES
from squealpipe.study.report.summary import PAPER
from tests.browser import chromium_path, open_page
from tests.conftest import ROOT

VOID = {"meta", "img", "br", "link", "hr", "input"}
FETCHING = {
    "src",
    "srcset",
    "poster",
    "data",
    "action",
}
"""Attributes from which a browser fetches on its own."""


class Page(HTMLParser):
    """What the tests ask of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: Counter[str] = Counter()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.images: list[dict[str, str]] = []
        self.tags: Counter[str] = Counter()
        self.open: list[str] = []
        self.headings: list[int] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = {key: value or "" for key, value in attrs}
        self.tags[tag] += 1
        if "id" in values:
            self.ids[values["id"]] += 1
        if tag == "a":
            self.links.append(values["href"])
        self.fetched += [value for key, value in values.items() if key in FETCHING]
        if tag == "link":
            self.fetched.append(values.get("href", ""))
        if tag == "img":
            self.images.append(values)
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        assert self.open, tag
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def text(small_report) -> str:
    return small_report.page.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(text: str) -> Page:
    return Page(text)


def test_every_tag_is_closed(page: Page) -> None:
    assert page.open == []


def test_links_lead_to_places_in_the_page_and_to_files_beside_it(page: Page, small_report) -> None:
    inside = [link[1:] for link in page.links if link.startswith("#")]
    beside = [link for link in page.links if not link.startswith("#")]
    assert [link for link in inside if link not in page.ids] == []
    assert [link for link in beside if not (small_report.page.parent / link).is_file()] == []
    assert "report.pdf" in beside
    assert "../data/stability_map.nc" in beside


def test_ids_are_unique(page: Page) -> None:
    assert [name for name, times in page.ids.items() if times > 1] == []


def test_nothing_is_fetched_from_elsewhere(page: Page, text: str) -> None:
    assert all(source.startswith("data:image/png;base64,") for source in page.fetched)
    assert "@import" not in text
    assert not re.search(r"url\((?!data:)", text)
    assert page.tags["script"] == page.tags["iframe"] == page.tags["link"] == 0


def test_every_picture_has_an_alt_text_and_stands_once(page: Page, small_report) -> None:
    expected = [item["alt"] for item in small_report.content["figures"].values()]
    assert sorted(image["alt"] for image in page.images) == sorted(expected)
    assert all(len(alt) > 20 for alt in expected)


def test_every_statement_has_its_place(page: Page) -> None:
    assert {f"claim-{statement.id}" for statement in STATEMENTS} <= set(page.ids)


def test_heading_levels_are_never_skipped(page: Page) -> None:
    assert page.headings[0] == 1
    steps = [
        later - earlier for earlier, later in zip(page.headings, page.headings[1:], strict=False)
    ]
    assert max(steps) <= 1


def test_formulas_are_mathml(page: Page, text: str) -> None:
    assert page.tags["math"] > 20
    assert "$" not in re.sub(r"<style>.*?</style>|data:image[^\"]*", "", text, flags=re.DOTALL)


def test_both_colour_schemes_print_and_narrow_screens_are_provided_for(text: str) -> None:
    for query in ("prefers-color-scheme: dark", "@media print", "max-width: 40rem"):
        assert query in text


def test_prose_takes_its_numbers_from_the_datasets(small_report) -> None:
    facts = small_report.content["facts"]["linear"]
    regime = small_report.datasets["stability_map"].regime_linear
    assert facts["flutter"] == int((regime == 1).sum())
    assert facts["divergence"] == int((regime == 2).sum())
    prose = re.sub(r"<[^>]+>", "", small_report.page.read_text(encoding="utf-8"))
    assert f"there are {facts['flutter']} cells with flutter" in " ".join(prose.split())


def test_equal_content_gives_equal_files(small_report, tmp_path: Path) -> None:
    page, pdf = tmp_path / "index.html", tmp_path / "report.pdf"
    pictures = picture_files(small_report.content, small_report.figures)
    write_report(small_report.content, pictures, page, pdf)
    assert page.read_bytes() == small_report.page.read_bytes()
    assert pdf.read_bytes() == small_report.pdf.read_bytes()
    assert pdf.read_bytes().startswith(b"%PDF-")


def test_provenance_names_rule_id_and_checksum_of_every_dataset(small_report) -> None:
    for name in small_report.datasets:
        row = small_report.content["datasets"][name]
        path = small_report.page.parents[1] / f"data/{name}.nc"
        assert row["rule"] == f"make_{name}"
        assert row["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
        assert re.fullmatch("[0-9a-f]{16}", row["dataset_id"])


def test_headings_of_pictures() -> None:
    assert title("fig01") == "Fig. 1."
    assert title("orbit_atlas") == "Orbit atlas."
    assert title("a1_beside_a4") == "A1 beside A4."


def test_lineage_follows_files_from_rule_to_rule() -> None:
    class Rule:
        def __init__(self, name, inputs, outputs):
            self.name, self.input, self.output = name, inputs, outputs

    found = lineage(
        [
            Rule("make", ["code.py", "r/data/a/b.nc"], ["r/data/c.nc"]),
            Rule("draw", ["r/data/c.nc", "code.py"], ["r/figures/f.png"]),
        ],
        "r/data/",
    )
    assert found == {"c": {"path": "r/data/c.nc", "rule": "make", "datasets": ["a/b"]}}


@pytest.mark.parametrize("template", sorted((TEMPLATES / "sections").iterdir()))
def test_no_measured_number_is_typed_into_a_template(template: Path) -> None:
    """Decimals belong to datasets; the angles of scenes and two published constants may stand."""
    prose = re.sub(r"\$[^$]*\$", "", template.read_text(encoding="utf-8"))
    numbers = [float(number) for number in re.findall(r"(?<![\w.-])\d+\.\d+(?![\w.]|fr|em)", prose)]
    assert [number for number in numbers if not math.isclose(number, round(number, 1))] == []


@pytest.mark.parametrize("width", [1100, 390])
@pytest.mark.release
@pytest.mark.skipif(chromium_path() is None, reason="no chromium on this machine")
def test_page_in_a_browser(small_report, width: int) -> None:
    with open_page(small_report.page.as_uri(), width=width) as (page, faults):
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate(
            "[...document.querySelectorAll('math[display=block]')]"
            ".every(formula => formula.scrollWidth <= formula.clientWidth + 1)"
        )
        assert page.evaluate("[...document.images].every(image => image.naturalWidth > 0)")
        assert page.evaluate("document.querySelector('math').getBoundingClientRect().width") > 5
        assert faults == []


def test_every_part_with_figures_shows_them_once() -> None:
    sections = "".join(path.read_text("utf-8") for path in (TEMPLATES / "sections").iterdir())
    placed = re.findall(r'#pictures\("([\w-]+)"\)', sections)
    assert sorted(placed) == sorted(PLACES)
    assert len(set(FIGURES)) == len(FIGURES)


def test_statements_point_to_figures_that_are_drawn() -> None:
    assert {statement.figure for statement in STATEMENTS} - {""} <= set(FIGURES)


def test_each_statement_is_judged_once_and_told_once(text: str, small_report) -> None:
    for row in small_report.content["claims"]:
        assert text.count(f'id="claim-{row["id"]}"') == 1
    rows = [row for row in small_report.content["claims"] if row["value"] is not None]
    assert rows
    prose = " ".join(re.sub(r"<[^>]+>", "", text).split())
    for row in rows:
        start = re.split(r"[Kkα\u03c9l]", row["evidence"])[0][:40]
        assert prose.count(start) <= 1 or len(start) < 20, row["id"]


def test_totals_of_statements_and_misprints_are_apart(small_report) -> None:
    content = small_report.content
    for part, begins in (("statements", "TSFC"), ("misprints", "E")):
        assert {row["id"][0] for row in content[part]["rows"]} <= set(begins)
        listed = sum(len(row["ids"]) for row in content[part]["tally"])
        assert listed == len(content[part]["rows"])
    assert len(content["misprints"]["rows"]) == 12


def test_every_statement_has_its_evidence_in_one_part() -> None:
    sections = "".join(path.read_text("utf-8") for path in (TEMPLATES / "sections").iterdir())
    shown = [
        name
        for line in re.findall(r"#shown\((.*?)\)", sections)
        for name in re.findall(r"\w+", line)
    ]
    wanted = [row.id for row in STATED]
    assert sorted(shown) == sorted(wanted)


def test_paper_is_cited_as_in_the_citation_file() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))["references"][0]
    assert cited["title"] == PAPER["title"]
    assert (cited["journal"], cited["year"]) == (PAPER["journal"], PAPER["year"])
    for author in cited["authors"]:
        assert f"{author['given-names']} {author['family-names']}" in str(PAPER["authors"])


@pytest.mark.parametrize("template", sorted((TEMPLATES / "sections").iterdir()))
def test_no_semicolon_is_lost_behind_a_condition(template: Path) -> None:
    """Typst takes a semicolon behind an expression for its end; as text it needs a backslash."""
    prose = template.read_text(encoding="utf-8")
    assert "];" not in prose
