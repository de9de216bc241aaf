"""Charts of methods and models: what is drawn is what the datasets say."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from squealpipe.schema import Outcome, build
from squealpipe.schema.comparison import (
    FAILURE_ATLAS,
    WORK_PRECISION,
    Reliability,
    Role,
)
from squealpipe.schema.ladder import MODEL_LADDER, QUESTIONS, Level
from squealpipe.study.figures.comparison import (
    failure_atlas,
    model_ladder,
    work_precision_evaluations,
    work_precision_frequencies,
    work_precision_time,
    work_precision_validity,
)
from squealpipe.study.figures.parts import work_precision


def rows(entries):
    """Dataset ``work_precision`` from (task, scene, method, setting, role, error, seconds)."""
    names = ("task", "scene", "method", "setting", "role", "error", "wall_time")
    columns = dict(zip(names, map(list, zip(*entries, strict=True)), strict=True))
    count = len(entries)
    return build(
        WORK_PRECISION,
        {
            **columns,
            "reference_error": np.full(count, 1e-17),
            "wrong_events": np.zeros(count),
            "boundary_distance": np.abs(columns["error"]),
            "evaluations": np.array(columns["wall_time"]) * 1e6,
            "outcome": np.full(count, Outcome.converged),
        },
        {"run": np.arange(count)},
        {"platform": "a machine", "libraries": '{"scipy": "1.0"}'},
    )


@pytest.fixture
def integration():
    entries = [
        ("integration", scene, method, f"tol {tol:g}", role, tol * factor, seconds / tol**0.1)
        for scene in ("smooth", "hammering", "stick-slip", "whirl")
        for method, role, factor, seconds in (
            ("Taylor + events, one run", Role.our_setting, 1e-2, 1e-4),
            ("DOP853 + events", Role.public, 1.0, 1e-2),
        )
        for tol in (1e-4, 1e-8)
    ]
    entries += [
        ("validity", "horizon", "Taylor + events, ensemble", "T 50", Role.ours, 0.01, 0.1),
        ("validity", "tolerance", "Taylor + events, ensemble", "tol 1", Role.our_setting, 0.0, 1),
        ("validity", "tolerance", "Moreau–Jean", "h 0.1", Role.public, 1e-3, 1.0),
    ]
    return rows(entries)


def written(figure: Figure) -> str:
    figure.draw_without_rendering()
    return "\n".join(
        text.get_text() for text in figure.findobj(lambda item: hasattr(item, "get_text"))
    )


@pytest.mark.parametrize("module", [work_precision_time, work_precision_evaluations])
def test_integration_charts_name_methods_scenes_and_machine(integration, module) -> None:
    text = written(module.draw(integration))
    for expected in ("smooth", "whirl", "DOP853 + events", "our setting", "a machine", "scipy 1.0"):
        assert expected in text


def test_validity_chart_labels_only_maps_with_wrong_cells(integration) -> None:
    text = written(work_precision_validity.draw(integration))
    assert "T = 50" in text
    assert "tol 1" not in text
    assert "no wrong cell" in text


def test_frequency_chart_names_the_forms() -> None:
    dataset = rows(
        [
            ("harmonic balance", "coupled", "cosines", "N_h 8", Role.ours, 1e-6, 1e-3),
        ]
    )
    assert "cosines" in written(work_precision_frequencies.draw(dataset))


def test_pareto_front_keeps_exactly_the_unbeaten() -> None:
    error = np.array([1e-2, 1e-4, 1e-6, 1e-5, 1e-4])
    cost = np.array([1.0, 2.0, 9.0, 10.0, 3.0])
    assert set(work_precision._pareto(error, cost)) == {0, 1, 2}


def test_marks_can_be_told_apart() -> None:
    for marks in (list(work_precision.MARKS.values()), work_precision.FALLBACK):
        assert len(set(marks)) == len(marks)


def test_atlas_prints_verdicts_and_counts() -> None:
    verdict = [[1, 3, 0], [2, 1, 0], [0, 0, 1]]
    atlas = build(
        FAILURE_ATLAS,
        {
            "verdict": verdict,
            "error": np.where(np.array(verdict) > 0, 1e-5, np.nan),
            "flagged": [[0, 0, 0], [1, 1, 0], [0, 0, 0]],
            "message": [["", "", ""], ["careful", "careful", ""], ["", "", ""]],
            "missed_events": [[0, 2, np.nan], [np.nan, 0, np.nan], [np.nan] * 3],
            "tolerance": [1e-3] * 3,
            "role": [Role.ours, Role.public, Role.ours],
            "requested": [1e-12, 1e-12, np.nan],
        },
        {"scene": ["grazing", "chaos", "onset"], "solver": ["ours", "theirs", "closed form"]},
    )
    figure = failure_atlas.draw(atlas)
    text = written(figure)
    for sign, verdict in (("✗", Reliability.silently_wrong), ("✓", Reliability.right)):
        assert text.count(f"{sign}\N{THIN SPACE}10⁻⁵") == int((atlas.verdict == verdict).sum())
    assert text.count("✗\N{THIN SPACE}10⁻⁵\N{THIN SPACE}(2)") == 1
    assert "✗ silently wrong" in text
    bold = [
        label.get_text()
        for axes in figure.axes
        for label in axes.get_yticklabels()
        if label.get_fontweight() == "bold"
    ]
    assert bold == ["ours", "closed form"]


@pytest.fixture
def ladder():
    angles = np.linspace(0.1, 3.0, 5)
    cells = (len(QUESTIONS), 5, 5)
    return build(
        MODEL_LADDER,
        {
            "error": np.zeros((len(QUESTIONS), len(Level), 5, 5)),
            "cheapest": np.full(cells, Level.a4_exact),
            "chosen": np.full(cells, Level.a1_short),
            "chosen_error": np.zeros(cells),
            "level_cpu_time": np.full(len(Level), 1e-3),
            "always_cpu_time": np.full(4, 100.0),
            "chosen_cpu_time": [10.0, 50.0, 50.0, 80.0],
            "tolerance": 0.05,
            "outcome": np.zeros((5, 5)),
        },
        {
            "alpha1": angles,
            "alpha2": angles,
            "question": list(QUESTIONS),
            "level": [level.name for level in Level],
        },
    )


def test_ladder_maps_name_only_the_levels_that_occur(ladder) -> None:
    text = written(model_ladder.draw(ladder))
    assert "A4, closed-form flow" in text
    assert "A3 in contact" not in text


def test_ladder_cost_is_the_share_of_time(ladder) -> None:
    text = written(model_ladder.draw(ladder))
    assert "contact lost?: 10 %" in text
    assert "100.0 % right, 0 % below A1" in text
