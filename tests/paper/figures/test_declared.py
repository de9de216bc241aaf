"""Figures declare what they read, and speak for themselves."""

import inspect

import pytest

from squealpipe.paper.figures.model import fig01
from squealpipe.paper.report.sections import PAPER_FIGURES
from squealpipe.study.figures import declared
from squealpipe.study.report.sections import OWN, STRUCTURE

NAMES = [f"simulate/F2{letter}" for letter in "abcd"]


@pytest.mark.parametrize("name", [*PAPER_FIGURES, *OWN, *STRUCTURE])
def test_every_figure_of_the_report_can_be_drawn_from_what_it_declares(name):
    figure = declared.registered(name)
    inspect.signature(figure.draw).bind(*declared.reads(name))
    assert declared.reads(name) == figure.reads
    for text in (figure.caption, figure.alt):
        if callable(text):
            inspect.signature(text).bind(*declared.reads(name))
        else:
            assert 40 < len(text) < 900


def test_no_module_is_left_without_a_place():
    declaring = {
        path.stem
        for path in declared.PACKAGE_FOLDER.glob("*/figures/*/*.py")
        if "\n@report_figure(" in path.read_text()
    }
    assert declaring == {*PAPER_FIGURES, *OWN, *STRUCTURE}


def test_a_wildcard_stands_for_all_that_match_and_plain_names_keep_their_order():
    known = ["backbone/F10_mode1", "backbone/F11_mode1", "backbone/coupled_mode1"]
    assert declared.datasets_of("fig10_to_12", known) == known[:2]
    datasets = {name: number for number, name in enumerate(known)}
    assert declared.arguments("fig10_to_12", datasets) == [{known[0]: 0, known[1]: 1}]
    assert declared.datasets_of("fig02", reversed(NAMES)) == NAMES
    assert declared.arguments("fig02", {name: name for name in NAMES}) == NAMES


def test_what_is_missing_is_said(monkeypatch):
    assert declared.datasets_of("fig02", NAMES[:3]) is None
    with pytest.raises(
        ValueError, match="the figure fig02 reads the dataset simulate/F2d"
    ):
        declared.arguments("fig02", dict.fromkeys(NAMES[:3]))
    with pytest.raises(ValueError, match="declares no figure; decorate"):
        declared.reads("backbone_panels")
    with pytest.raises(ValueError, match="registers no figure; decorate"):
        declared.texts("backbone_panels", {})
    without_caption = declared.ReportFigure((), " ", "Springs.", fig01.draw)
    monkeypatch.setitem(declared._registered, "fig01", without_caption)
    with pytest.raises(ValueError, match="the caption of the figure fig01 is empty"):
        declared.texts("fig01", {})
    with pytest.raises(ValueError, match="0 modules"):
        declared.topic("unknown")
