"""choose_model against A1 itself: right, cheap, and true to its own checks."""

import numpy as np
import pytest

from squealpipe.parameters import Parameters
from squealpipe.schema.ladder import QUESTIONS, Level
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.ladder.choice import choose_model, choose_models
from squealpipe.tasks.ladder.questions import answer_of, dominant_frequency
from squealpipe.tasks.sampling import sample_times

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
def test_contact_is_always_decided_rightly_at_less_than_half_of_the_cost(seed: int) -> None:
    right, cost = judged(Parameters(), "contact_lost", seed)
    assert right.all()
    assert cost <= 0.45


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


@pytest.mark.parametrize(
    ("k2", "k3", "mu", "lengths", "angles"),
    [
        (1.63, 0.8, 0.62, (55.0, 26.0), (1.39, 0.34)),
        (1.83, 0.89, 0.36, (23.0, 48.0), (0.82, 0.55)),
        (1.82, 0.82, 0.27, (26.0, 28.0), (1.2, 0.33)),
    ],
)
def test_first_integral_does_not_answer_where_geometry_makes_sliding_unstable(
    k2, k3, mu, lengths, angles
) -> None:
    """A4 keeps N ≤ k3 l_pre there, but A1 reaches 1.4 to 3.3 times that by growing."""
    params = Parameters(k2=k2, k3=k3, mu=mu, length1=lengths[0], length2=lengths[1], belt_speed=1e3)
    found = choose_model(params, *angles, "peak_contact_force", 0.1, t_end=HORIZON)
    assert found.model == "a1"
    assert found.value > 1.3


@pytest.mark.parametrize("speed", [0.05, -0.05])
def test_a_level_is_never_taken_when_its_assumption_is_broken(speed: float) -> None:
    """A slow belt is reached by the mass: only A1 may answer."""
    slow = Parameters(belt_speed=speed)
    found = choose_models(slow, *random_cells(4, 200), "contact_lost", TOLERANCE, t_end=50.0)
    outrun = found.certificate.second.motion.fastest() >= abs(speed)
    assert outrun.any()
    assert not (found.level[outrun] < Level.a1_short).any()


def test_long_springs_need_no_run_where_contact_is_kept() -> None:
    params = Parameters(length1=1e4, length2=1e4)
    found = choose_model(params, 0.5 * np.pi, np.pi, "peak_contact_force", 0.01)
    # K = diag(k, k): y = κ/(1+κ)(1 − cos √(1+κ) t) ≥ 0, so the largest force is the first one
    assert found.model == "closed_form"
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


@pytest.mark.parametrize(
    "change",
    [
        {"damping1": 0.05, "damping2": 0.05},
        {"friction_law": "exponential", "mu_static": 0.5},
        {"mu_static": 0.5},
    ],
    ids=str,
)
@pytest.mark.parametrize("question", QUESTIONS)
def test_no_cheaper_level_answers_for_other_friction(change, question):
    """Where a closed form answers for the paper's friction, A1 answers for any other."""
    cell = np.array([0.5 * np.pi]), np.array([1.0 * np.pi])
    plain, other = (
        choose_models(params, *cell, question, 0.2, t_end=200.0, workers=1)
        for params in (Parameters(), Parameters(**change))
    )
    assert plain.level[0] != Level.a1
    assert other.level[0] == Level.a1
    assert other.integrated[0] == 200.0
    first = choose_model(Parameters(**change), 0.5 * np.pi, np.pi, question, 0.2, t_end=4.0)
    assert not first.checks[0].passed


def random_parameters(generator: np.random.Generator) -> tuple[Parameters, float]:
    """Unequal springs, both belt directions, slow and fast belts, other units; and a horizon."""

    def between(low: float, high: float) -> float:
        return float(np.exp(generator.uniform(np.log(low), np.log(high))))

    mass, stiffness, length = between(1e-2, 1e2), between(1e-3, 1e6), between(1e-4, 10.0)
    unit = np.sqrt(mass / stiffness)
    k2, free = between(0.2, 5.0), between(2.5, 1000.0)
    params = Parameters(
        mass=mass, k1=stiffness, k2=k2 * stiffness, preload=length,
        k3=between(0.05, 5.0) * 0.5 * (1.0 + k2) * stiffness, mu=generator.uniform(0.0, 0.8),
        belt_speed=generator.choice([-1, 1]) * between(0.1, 300.0) * length / unit,
        length1=free * length, length2=free * between(0.4, 2.5) * length,
    )  # fmt: skip
    return params, between(30.0, 400.0) * unit


def test_no_cheap_answer_is_wrong_at_random_parameters() -> None:
    """Against A1 over the whole horizon, at the tolerance that was asked for."""
    generator = np.random.default_rng(20)
    answered = dict.fromkeys(QUESTIONS[1:], 0)
    for _ in range(60):
        params, horizon = random_parameters(generator)
        tol = float(generator.choice([0.01, 0.02, 0.05, 0.1, 0.2]))
        cells = generator.uniform(0.0, np.pi, (2, 40))
        times = sample_times(params, horizon)
        run = run_ensemble(params, *cells, t_end=horizon, times=times, workers=1)
        for question in answered:
            found = choose_models(params, *cells, question, tol, t_end=horizon, workers=1)
            below = found.level != Level.a1
            error = np.abs(found.value / answer_of(run, question, times) - 1.0)
            assert not (error > tol)[below].any(), (params, question, tol)
            assert (found.integrated[below] <= 0.5 * horizon).all()
            answered[question] += below.sum()
    assert min(answered.values()) > 0.12 * 60 * 40, answered


@pytest.mark.parametrize("question", ["peak_contact_force", "max_displacement"])
def test_answer_lies_between_what_a_short_run_reaches_and_the_bound(question: str) -> None:
    params = Parameters(k2=1.4, length1=40.0, length2=60.0, belt_speed=-20.0)
    cells = random_cells(8, 200)
    found = choose_models(params, *cells, question, 0.005, t_end=HORIZON)
    truth = answer_of(run_ensemble(params, *cells, t_end=HORIZON), question, np.zeros(0))
    asked = np.isfinite(found.upper)
    assert (found.level == Level.a1_short).sum() > 5
    assert (found.lower[asked] <= truth[asked] * (1.0 + 1e-9)).all()
    assert (truth[asked] <= found.upper[asked]).all()


@pytest.mark.parametrize("question", QUESTIONS)
def test_reason_of_what_is_not_proved_names_its_sample(question: str) -> None:
    params = Parameters(length1=100.0, length2=100.0)
    found = choose_model(params, 0.5 * np.pi, 0.9 * np.pi, question, TOLERANCE)
    assert found.model in {"closed_form", "a1_short"}
    assert "measured, not proved" in found.reason
