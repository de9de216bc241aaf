"""The report: self-contained, complete, with links that lead somewhere and texts for pictures."""

import hashlib
import re
from collections import Counter
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from squealpipe.paper.claims.statements import STATEMENTS
from squealpipe.paper.report import content as contents
from squealpipe.paper.report import edited
from squealpipe.paper.report.content import CITED_PAPER
from squealpipe.paper.report.sections import (
    BEYOND_THE_PAPER,
    COMPARED,
    METHOD_SECTIONS,
    PAPER_FIGURES,
)
from squealpipe.parameters import Parameters
from squealpipe.study.configuration.settings import parse_study
from squealpipe.study.report.build import TEMPLATES, write_document
from squealpipe.study.report.lineage import lineage
from squealpipe.study.report.parts import picture_files, provenance
from tests.browser import chromium_path, open_page
from tests.conftest import ROOT

VOID = {"meta", "img", "br", "link", "hr", "input"}
FETCHING = {"src", "srcset", "poster", "data", "action"}
"""Attributes from which a browser fetches on its own."""


class Page(HTMLParser):
    """What the tests ask of a page."""

    def __init__(self, text):
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


def prose(text):
    """The words of a page."""
    return " ".join(
        re.sub(r"<style>.*?</style>|<[^>]+>", " ", text, flags=re.DOTALL).split()
    )


@pytest.fixture(scope="module")
def text(small_report):
    return small_report.page.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def test_every_tag_is_closed_ids_are_unique_and_no_level_of_heading_is_skipped(page):
    assert page.open == []
    assert [name for name, times in page.ids.items() if times > 1] == []
    assert page.headings[0] == 1
    assert max(np.diff(page.headings)) <= 1


def test_links_lead_to_places_in_the_pages_and_to_files_beside_them(page, small_report):
    behind = Page(small_report.supplement.read_text(encoding="utf-8"))
    for one in (page, behind):
        inside = [link[1:] for link in one.links if link.startswith("#")]
        beside = [link.partition("#") for link in one.links if not link.startswith("#")]
        assert [link for link in inside if link not in one.ids] == []
        for file, _, place in beside:
            assert (small_report.page.parent / file).is_file()
            assert not place or place in behind.ids
    assert "../data/stability_map.nc" in behind.links


def test_nothing_is_fetched_from_elsewhere(page, text):
    assert all(source.startswith("data:image/png;base64,") for source in page.fetched)
    assert "@import" not in text
    assert not re.search(r"url\((?!data:)", text)
    assert page.tags["script"] == page.tags["iframe"] == page.tags["link"] == 0


def test_every_picture_has_an_alt_text_and_stands_once(page, small_report):
    expected = [item["alt"] for item in small_report.content["figures"].values()]
    assert sorted(image["alt"] for image in page.images) == sorted(expected)
    assert all(len(alt) > 20 for alt in expected)


def test_every_statement_has_its_place(page, small_report):
    behind = Page(small_report.supplement.read_text(encoding="utf-8"))
    assert {f"claim-{statement.id}" for statement in STATEMENTS} <= set(
        page.ids | behind.ids
    )


def test_after_an_edit_the_page_shows_changes_and_no_narrative(text, small_report):
    words = prose(text)
    assert "linear.points 181 21" in words
    assert "as printed nothing ends this" not in words
    assert "None" not in words
    assert not re.search(r"\bnan\b", words)


def test_narrative_has_words_for_every_part():
    words = (TEMPLATES / "narrative.typ").read_text(encoding="utf-8")
    written = set(re.findall(r"^  (\w+): \(\) => \[", words, flags=re.MULTILINE))
    assert written == {*COMPARED, *BEYOND_THE_PAPER, *METHOD_SECTIONS} - {"model"}


def test_the_front_has_at_most_400_words():
    words = (TEMPLATES / "narrative.typ").read_text(encoding="utf-8")
    front = words[words.index("#let asked") : words.index("#let compared")]
    assert len(front.split()) <= 400
    assert not re.search(
        r"\b[A-Z]\d+[a-z]?\b", re.sub(r"\bA[1-4]\b|n\(.*?\)", "", front)
    )


def test_formulas_are_mathml(page, text):
    assert page.tags["math"] > 10
    assert "$" not in re.sub(
        r"<style>.*?</style>|data:image[^\"]*", "", text, flags=re.DOTALL
    )


def test_equal_content_gives_equal_files(small_report, tmp_path):
    page, pdf = tmp_path / "index.html", tmp_path / "report.pdf"
    pictures = picture_files(small_report.content, small_report.figures)
    write_document("paper", small_report.content, pictures, page=page, pdf=pdf)
    assert page.read_bytes() == small_report.page.read_bytes()
    assert pdf.read_bytes() == small_report.pdf.read_bytes()
    assert pdf.read_bytes().startswith(b"%PDF-")


def test_provenance_names_rule_id_and_checksum_of_every_dataset(small_report):
    made = {
        name: contents.Made(
            path=small_report.page.parents[1] / f"data/{name}.nc", rule=f"make_{name}"
        )
        for name in small_report.datasets
    }
    found = provenance(made, small_report.figures)
    for name, one in made.items():
        row = found["datasets"][name]
        assert row["rule"] == f"make_{name}"
        assert row["sha256"] == hashlib.sha256(one.path.read_bytes()).hexdigest()
        assert row["dataset_id"]
    assert found["figures"]["fig06"]["rule"] == "draw_topic"


def test_lineage_follows_files_from_rule_to_rule():
    rules = [
        SimpleNamespace(
            name="make", input=["code.py", "r/data/a/b.nc"], output=["r/data/c.nc"]
        ),
        SimpleNamespace(
            name="draw", input=["r/data/c.nc", "code.py"], output=["r/figures/f.png"]
        ),
    ]
    expected = {"path": "r/data/c.nc", "rule": "make", "datasets": ["a/b"]}
    assert lineage(rules, "r/data/") == {"c": expected}


def test_no_measured_number_is_typed_into_the_narrative():
    """Decimals belong to datasets; the angles of scenes may stand."""
    words = (TEMPLATES / "narrative.typ").read_text(encoding="utf-8")
    prose = re.sub(r"\$[^$]*\$", "", words)
    decimals = re.findall(r"(?<![\w.-])\d+\.\d+(?!\w|\.\d)", prose)
    assert decimals == ["0.084"]  # no dataset's: held by tests/paper/inference


@pytest.mark.parametrize("width", [1100, 390])
@pytest.mark.release
@pytest.mark.skipif(chromium_path() is None, reason="no chromium on this machine")
def test_page_in_a_browser(small_report, width):
    with open_page(small_report.page.as_uri(), width=width) as (page, faults):
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate(
            "[...document.querySelectorAll('math[display=block]')]"
            ".every(formula => formula.scrollWidth <= formula.clientWidth + 1)"
        )
        assert page.evaluate(
            "[...document.images].every(image => image.naturalWidth > 0)"
        )
        assert (
            page.evaluate(
                "document.querySelector('math').getBoundingClientRect().width"
            )
            > 5
        )
        assert faults == []


def test_statements_point_to_figures_that_are_drawn():
    assert {statement.figure for statement in STATEMENTS} - {""} <= set(PAPER_FIGURES)


def test_paper_is_cited_as_in_the_citation_file():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))["references"][0]
    assert cited["title"] == CITED_PAPER["title"]
    assert (cited["journal"], cited["year"]) == (
        CITED_PAPER["journal"],
        CITED_PAPER["year"],
    )
    for author in cited["authors"]:
        assert f"{author['given-names']} {author['family-names']}" in str(
            CITED_PAPER["authors"]
        )


@pytest.mark.parametrize("template", sorted(TEMPLATES.glob("*.typ")))
def test_no_semicolon_is_lost_behind_an_expression(template):
    """Typst takes a semicolon behind an expression for its end; as text it needs a backslash."""
    text = template.read_text(encoding="utf-8")
    assert "];" not in text
    assert not re.search(r"#[\w.]+\([^()]*\);", text)


def test_changed_keys_are_those_that_differ():
    shipped = parse_study({})
    edited = parse_study({"parameters": {"mu": 0.4}, "results": "results/mine"})
    assert edited.changes_of(shipped) == [("parameters.mu", shipped.parameters.mu, 0.4)]
    assert shipped.changes_of(shipped) == []


@pytest.mark.parametrize(
    ("parameters", "reading", "words"),
    [
        (
            Parameters(),
            "as_printed",
            "along −x; the linear models are dragged along +x",
        ),
        (Parameters(), "along_minus_x", "Friction drags along −x in A1"),
        (Parameters(belt_speed=-1.0), "along_plus_x", "Friction drags along −x in A1"),
        (
            Parameters(friction_law="exponential", mu_static=0.5, friction_speed=2.0),
            "along_plus_x",
            "exponential (mu = 0.3, mu_static = 0.5, friction_speed = 2)",
        ),
    ],
)
def test_a_page_says_which_friction_its_models_have(parameters, reading, words):
    assert words in edited.friction_in_words(parameters, reading)


def test_what_was_edited_is_told_physics_first():
    changed = [
        ("linear.points", 181, 31),
        ("parameters.friction_law", None, "hyperbolic"),
    ]
    said = edited.what_changed([*changed, ("reading", "as_printed", "along_plus_x")])
    assert "friction_law (friction law): hyperbolic (shipped: coulomb)" in said
    assert "(shipped: A1 by Eq. (4) as printed" in said
    assert "linear.points" not in said
    assert "other keys" in edited.what_changed(changed[:1])


def test_the_edited_page_counts_tests_and_fitted_apart_and_groups_what_is_undecided(
    small_report,
):
    content = small_report.content
    rows = content["statements"]
    for part in content["tally"]:
        assert part["number"] == sum(part["counts"])
    assert sum(part["number"] for part in content["tally"]) == len(rows)
    undecided = {
        name for part in content["undecided"] for name in part["ids"].split(", ")
    }
    claims = small_report.datasets["claims"]
    assert undecided == set(claims.claim.values[(claims.verdict == 4).values])
    text = small_report.page.read_text(encoding="utf-8")
    assert "Friction drags along" in text or "A1 has Eq. (4)" in text
    assert text.index("Parameters and reading are those") < text.index("linear.points")
