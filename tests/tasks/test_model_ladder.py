"""The ladder's levels against one another, and what choosing saves."""

import numpy as np
import pytest

from squealpipe.parameters import Parameters
from squealpipe.schema.comparison import QUESTIONS, Level
from squealpipe.tasks.model_ladder import model_ladder


@pytest.fixture(scope="module")
def ladder():
    return model_ladder(Parameters(), 14, 0.05, t_end=100.0)


def test_a1_is_adequate_everywhere_and_errs_nowhere(ladder) -> None:
    assert not ladder.error.sel(level="a1").any()
    assert (ladder.cheapest <= Level.a1).all()


def test_both_ways_to_solve_a4_agree(ladder) -> None:
    """Closed-form flow and Taylor integration of the same model; frequency by sampling alike."""
    for question in ("contact_lost", "frequency"):
        first, second = (
            ladder.error.sel(question=question, level=level).values
            for level in ("a4_exact", "a4_in_time")
        )
        assert np.isclose(first, second, rtol=1e-3, atol=1e-6).mean() > 0.97


def test_without_stick_a1_is_the_same_when_the_belt_is_never_reached(ladder) -> None:
    assert float(ladder.error.sel(level="a1_no_stick").max()) < 1e-6


@pytest.mark.parametrize("question", QUESTIONS)
def test_chosen_answers_are_within_the_tolerance(ladder, question: str) -> None:
    error = ladder.chosen_error.sel(question=question)
    assert float((error <= ladder.tolerance).mean()) >= 0.97


def test_choosing_saves_most_where_contact_is_asked(ladder) -> None:
    share = (ladder.chosen_time / ladder.always_time).sel(question="contact_lost")
    assert float(share) < 0.25


def test_knowing_the_cheapest_level_in_advance_costs_least(ladder) -> None:
    assert (ladder.hindsight_time <= 1.01 * ladder.chosen_time).all()
    runs = ladder.cheapest.sel(question="frequency") >= Level.a4_in_time
    least = ladder.hindsight_time / ladder.always_time
    assert float(least.sel(question="frequency")) == pytest.approx(float(runs.mean()), rel=1e-2)
