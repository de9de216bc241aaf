"""Charts of methods and models: what is drawn is what the datasets say."""

import numpy as np
import pytest

from squealpipe.schema import build
from squealpipe.schema.comparison import BENCHMARK, FAILURE_ATLAS, Reliability, Role
from squealpipe.study.figures.comparison import failure_atlas, work_precision_benchmark
from squealpipe.study.figures.panels import work_precision


def written(figure):
    figure.draw_without_rendering()
    return "\n".join(
        text.get_text()
        for text in figure.findobj(lambda item: hasattr(item, "get_text"))
    )


@pytest.fixture
def benchmark():
    verdict = np.array([[[1, 1], [3, 3]], [[1, 1], [0, 2]]])
    ones, axes = (
        np.ones((2, 2, 2)),
        {"problem": ["two gates", "long run"], "tol": [1e-6, 1e-12]},
    )
    data = {
        "group": ["order", "chaos"], "role": [Role.ours, Role.public], "verdict": verdict,
        "missed": np.where(verdict == 3, 2, 0), "spurious": np.where(verdict == 2, 1, 0),
        "out_of_order": 0 * ones, "time_error": 0 * ones, "evaluations": 1000 * ones,
        "error": np.where(verdict > 0, 1e-9 * verdict, np.nan), "cpu_time": ones,
        "cpu_ratio": ones, "message": np.full(ones.shape, ""),
    }  # fmt: skip
    attributes = {"platform": "a machine", "libraries": '{"scipy": "1.0"}'}
    return build(
        BENCHMARK, data, {**axes, "solver": ["squealpipe", "theirs"]}, attributes
    )


def test_benchmark_chart_names_solvers_classes_and_machine(benchmark):
    text = written(work_precision_benchmark.draw(benchmark))
    for expected in (
        "order",
        "chaos",
        "theirs",
        "our setting",
        "a machine",
        "scipy 1.0",
    ):
        assert expected in text


def test_pareto_front_keeps_exactly_the_unbeaten():
    error = np.array([1e-2, 1e-4, 1e-6, 1e-5, 1e-4])
    cost = np.array([1.0, 2.0, 9.0, 10.0, 3.0])
    assert set(work_precision._pareto(error, cost)) == {0, 1, 2}


def test_atlas_prints_verdicts_and_counts(benchmark):
    verdict = [[1, 3, 0], [2, 1, 0], [0, 0, 1]]
    data = {
        "verdict": verdict, "error": np.where(np.array(verdict) > 0, 1e-5, np.nan),
        "message": [[""] * 3, ["careful", "careful", ""], [""] * 3], "tolerance": [1e-3] * 3,
        "role": [Role.ours, Role.public, Role.ours],
    }  # fmt: skip
    axes = {
        "scene": ["grazing", "chaos", "onset"],
        "solver": ["ours", "theirs", "closed form"],
    }
    atlas = build(FAILURE_ATLAS, data, axes)
    figure = failure_atlas.draw(benchmark, atlas)
    text = written(figure)
    for sign, verdict in (("✗", Reliability.silently_wrong), ("✓", Reliability.right)):
        assert text.count(f"{sign}\N{THIN SPACE}10⁻⁵") == int(
            (atlas.verdict == verdict).sum()
        )
    assert "✗ silently wrong" in text
    assert "−2" in text
    assert "+1" in text
    labels = [label for axes in figure.axes for label in axes.get_yticklabels()]
    bold = [label.get_text() for label in labels if label.get_fontweight() == "bold"]
    assert bold == ["squealpipe", "ours", "closed form"]
