"""Charts of methods and models: what is drawn is what the datasets say."""

import numpy as np
import pytest

from squealpipe.benchmark.schema import (
    Reliability,
    Role,
    benchmark_schema,
    failure_atlas_schema,
)
from squealpipe.brake.schema.ladder import QUESTIONS, Level, model_ladder_schema
from squealpipe.paper.figures.comparison import (
    failure_atlas,
    model_needed,
    speed_and_accuracy,
    where_methods_fail,
    work_precision_benchmark,
)
from squealpipe.plotting import work_precision
from squealpipe.schema import build


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
        "group": ["order", "chaos"],
        "role": [Role.ours, Role.public],
        "verdict": verdict,
        "missed": np.where(verdict == 3, 2, 0),
        "spurious": np.where(verdict == 2, 1, 0),
        "out_of_order": 0 * ones,
        "time_error": 0 * ones,
        "evaluations": 1000 * ones,
        "error": np.where(verdict > 0, 1e-9 * verdict, np.nan),
        "cpu_time": ones,
        "cpu_ratio": ones,
        "message": np.full(ones.shape, ""),
    }
    attributes = {"platform": "a machine", "libraries": '{"scipy": "1.0"}'}
    return build(
        benchmark_schema, data, {**axes, "solver": ["squealpipe", "theirs"]}, attributes
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
        "verdict": verdict,
        "error": np.where(np.array(verdict) > 0, 1e-5, np.nan),
        "message": [[""] * 3, ["careful", "careful", ""], [""] * 3],
        "tolerance": [1e-3] * 3,
        "role": [Role.ours, Role.public, Role.ours],
    }
    axes = {
        "scene": ["grazing", "chaos", "onset"],
        "solver": ["ours", "theirs", "closed form"],
    }
    atlas = build(failure_atlas_schema, data, axes)
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


def test_failures_are_counted_by_class_and_nobody_is_blamed_for_what_was_not_asked(
    benchmark,
):
    table = where_methods_fail.answers(benchmark)
    theirs = table.sel(solver="theirs")
    assert theirs.silent.to_series().to_dict() == {"order": 2, "chaos": 0}
    assert theirs.asked.to_series().to_dict() == {"order": 2, "chaos": 1}
    text = written(where_methods_fail.draw(benchmark))
    assert "2/2" in text
    assert "0/" not in text


def test_speed_is_compared_on_scenes_of_the_model_alone(benchmark):
    own = benchmark.assign_coords(problem=["A1: hammering", "long run"])
    assert speed_and_accuracy.scenes_of_a1(own).problem.values == ["A1: hammering"]
    axes = speed_and_accuracy.draw(own).axes
    crosses = [
        line
        for panel in axes
        for line in panel.get_lines()
        if line.get_label() == "silently wrong"
    ]
    assert [len(line.get_xdata()) for line in crosses] == [2, 2]


def test_bars_tell_hindsight_from_what_is_known_beforehand():
    cheapest = np.full((4, 2, 2), Level.a1)
    cheapest[0] = [[Level.a3, Level.a3], [Level.a3, Level.a1]]
    axes = {
        "alpha1": [0.5, 1.0],
        "alpha2": [0.5, 1.0],
        "question": list(QUESTIONS),
        "level": [level.name for level in Level],
    }
    data = {
        "error": np.zeros((4, len(Level), 2, 2)),
        "cheapest": cheapest,
        "chosen": [[Level.a3, Level.a1], [Level.a1, Level.a1]],
        "tolerance": 0.05,
        "chosen_wrong": np.zeros((2, 2), bool),
        "always_cpu_time": 2.0,
        "chosen_cpu_time": 1.0,
        "belt_reached": np.zeros((2, 2), bool),
        "outcome": np.zeros((2, 2)),
    }
    ladder = build(model_ladder_schema, data, axes)
    assert model_needed.shares_of_a3(ladder) == (75.0, 25.0)
    text = written(model_needed.draw(ladder))
    assert "beforehand" in text
    caption = model_needed.caption(ladder)
    assert "75 % of the angles" in caption
    assert "50 % of the CPU time" in caption
