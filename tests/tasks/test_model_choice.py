"""choose_model against A1 itself: right, cheap, and true to its own checks."""

import numpy as np
import pytest

from squealpipe.parameters import Parameters
from squealpipe.schema.comparison import QUESTIONS, Level
from squealpipe.tasks.answers import answer_of, dominant_frequency, sample_times
from squealpipe.tasks.ensemble import run_ensemble
from squealpipe.tasks.model_choice import (
    choose_model,
    choose_models,
    contact_motion,
    decided_by_bounds,
    geometry_shift,
)

CELLS, HORIZON, TOLERANCE = 500, 200.0, 0.05


def random_cells(seed: int, count: int = CELLS) -> tuple[np.ndarray, np.ndarray]:
    alpha1, alpha2 = np.random.default_rng(seed).uniform(0.0, np.pi, (2, count))
    return alpha1, alpha2


def judged(params: Parameters, question: str, seed: int) -> tuple[np.ndarray, float]:
    """(whether each cell is within tolerance of A1, time integrated over that of always A1)."""
    cells = random_cells(seed)
    times = sample_times(params, HORIZON)
    always = run_ensemble(
        params, *cells, t_end=HORIZON, times=times if question == "frequency" else None,
        stop_at_first_separation=question == "contact_lost",
    )  # fmt: skip
    truth = answer_of(always, question, times)
    chosen = choose_models(params, *cells, question, TOLERANCE, t_end=HORIZON)
    right = (
        chosen.value == truth
        if question == "contact_lost"
        else np.abs(chosen.value / truth - 1.0) <= TOLERANCE
    )
    return right, float(chosen.integrated.sum() / always.time.sum())


@pytest.mark.parametrize("seed", [2021, 6])
def test_contact_is_decided_at_a_fifth_of_the_cost(seed: int) -> None:
    right, cost = judged(Parameters(), "contact_lost", seed)
    assert right.mean() >= 0.99
    assert cost <= 0.20


@pytest.mark.parametrize("question", QUESTIONS[1:])
@pytest.mark.parametrize("length", [5.0, 300.0])
def test_every_question_is_answered_within_the_tolerance(question: str, length: float) -> None:
    """What a mass does after losing contact takes all of A1, so no such saving is claimed."""
    right, cost = judged(Parameters(length1=length, length2=length), question, 3)
    assert right.mean() >= 0.99
    assert cost < 0.95


@pytest.mark.parametrize("changes", [{}, {"k2": 1.7, "mu": 0.5}])
def test_peak_force_on_long_springs_mostly_follows_from_the_first_integral(changes) -> None:
    right, cost = judged(
        Parameters(length1=300.0, length2=300.0, **changes), "peak_contact_force", 12
    )
    assert right.mean() >= 0.99
    assert cost <= 0.35


def test_first_integral_is_named_where_it_answers() -> None:
    long = Parameters(length1=300.0, length2=300.0)
    found = choose_model(long, 0.2 * np.pi, 0.6 * np.pi, "peak_contact_force", TOLERANCE)
    assert found.model == "closed_form"
    assert found.value == 1.0
    assert "first integral" in found.reason


def test_bounds_decide_no_cell_wrongly() -> None:
    """A regression test of GEOMETRY_FACTOR, on cells other than those it was set by."""
    params, cells = Parameters(), random_cells(99, 5000)
    truth = run_ensemble(params, *cells, t_end=HORIZON, stop_at_first_separation=True)
    motion = contact_motion(params, *cells)
    keeps, loses = decided_by_bounds(motion, geometry_shift(motion, params), params)
    assert keeps.sum() > 500
    assert loses.sum() > 1000
    assert not (truth.separations[keeps] > 0).any()
    assert (truth.separations[loses] > 0).all()


def test_a_level_is_never_taken_when_its_assumption_is_broken() -> None:
    """A slow belt breaks ẋ < V: only A1 may answer."""
    slow = Parameters(belt_speed=0.05)
    found = choose_models(slow, *random_cells(4, 200), "contact_lost", TOLERANCE, t_end=50.0)
    outrun = found.motion.fastest() >= slow.belt_speed
    assert outrun.any()
    assert not (found.level[outrun] < Level.a1_short).any()


def test_long_springs_need_no_run_where_contact_is_kept() -> None:
    params = Parameters(length1=1e4, length2=1e4)
    found = choose_model(params, 0.5 * np.pi, np.pi, "peak_contact_force", 0.01)
    # K = diag(k, k): y = κ/(1+κ)(1 − cos √(1+κ) t) ≥ 0, so the largest force is the first one
    assert found.model == "a3_in_contact"
    assert found.value == pytest.approx(1.0, rel=1e-4)
    assert found.cost == 0.0
    assert all(check.passed for check in found.checks)


def test_reason_and_checks_tell_why_a_run_was_needed() -> None:
    found = choose_model(Parameters(), 0.2 * np.pi, 0.8 * np.pi, "max_displacement", 0.05)
    assert found.model == "a1"
    assert found.cost == pytest.approx(1.0, rel=0.05)
    assert not all(check.passed for check in found.checks)
    assert "assumptions" in found.reason


@pytest.mark.parametrize(
    ("question", "tol", "text"), [("colour", 0.1, "question = 'colour'"), (QUESTIONS[0], 0, "tol")]
)
def test_bad_arguments_are_named(question: str, tol: float, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        choose_model(Parameters(), 1.0, 1.0, question, tol)


def test_dominant_frequency_of_two_tones() -> None:
    times = np.linspace(0.0, 200.0, 1001)
    samples = np.cos(1.2345 * times) + 0.4 * np.cos(0.7 * times)
    assert dominant_frequency(samples, times) == pytest.approx(1.2345, abs=1e-3)
