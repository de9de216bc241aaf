"""Captions of the published study name only marks that are drawn, and so do its keys."""

from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import squealpipe
from squealpipe.paper.report.sections import PAPER_FIGURES
from squealpipe.plotting import style
from squealpipe.store import load
from squealpipe.study.figures import declared
from tests.paper.figures.marks import undrawn_entries, undrawn_marks

PUBLISHED = Path(squealpipe.__file__).parents[1] / "results/archive/reference/data"


@pytest.fixture
def example():
    """Orange circles, a dotted grey line and a hatched cell on black, with their key."""
    figure, axes = style.new_figure()
    panel = axes[0, 0]
    panel.imshow(
        [[0, 1]], **style.category_colours([style.Colour.black, style.Colour.white])
    )
    panel.plot([0, 1], [0, 1], "o", mfc="none", color=style.Colour.orange, label="runs")
    panel.axhline(0.5, ls=":", color=style.Colour.grey, label="line")
    panel.contourf([[0, 1], [1, 0]], levels=[0.5, 1], colors="none", hatches=["//"])
    panel.legend()
    yield figure
    plt.close("all")


def test_marks_that_are_drawn_may_be_named(example):
    assert undrawn_marks(example, "Orange circles; dotted grey: a line; hatched.") == []
    assert undrawn_entries(example) == []


@pytest.mark.parametrize(
    ("caption", "words"),
    [
        ("Blue dots.", ["blue"]),
        ("Red crosses", ["red", "cross(es)?"]),
        ("dashed", ["dashed"]),
        ("Lines; dashed red: unstable, if there are any.", []),
        ("purple triangles", ["purple", "triangles?"]),
    ],
)
def test_marks_that_are_not_drawn_are_told(example, caption, words):
    assert undrawn_marks(example, caption) == words


def test_entries_of_a_key_that_stand_for_nothing_are_told(example):
    panel = example.axes[0]
    panel.plot([], [], "--", color=style.Colour.green, label="nothing")
    panel.legend(
        handles=[*panel.lines, *style.patches([(style.Colour.red, "no cell")])]
    )
    assert undrawn_entries(example) == ["nothing", "no cell"]


@pytest.mark.release
@pytest.mark.parametrize("name", PAPER_FIGURES)
def test_captions_and_keys_of_the_published_study(name):
    known = [
        str(path.relative_to(PUBLISHED).with_suffix(""))
        for path in PUBLISHED.rglob("*.nc")
    ]
    wanted = declared.datasets_of(name, known)
    if wanted is None:
        pytest.skip("the published study has no such dataset")
    datasets = {each: load(PUBLISHED / f"{each}.nc") for each in wanted}
    figure = declared.draw(name, datasets)
    caption, _ = declared.texts(name, datasets)
    assert undrawn_marks(figure, caption) == []
    assert undrawn_entries(figure) == []
