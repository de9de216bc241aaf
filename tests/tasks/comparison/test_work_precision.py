"""Work–precision rows: what they measure, and that our setting is as good as it is said to be."""

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.tasks.comparison.work_precision import harmonic as speed_accuracy_harmonic
from squealpipe.tasks.comparison.work_precision import stability as speed_accuracy_stability
from squealpipe.tasks.comparison.work_precision.solutions import timed, work_precision
from tests.former import FORMER


def test_harmonic_balance_converges_as_published() -> None:
    """ω falls about like N_h^-4 with closed-form integrals; the printed Eq. (34) is just wrong."""
    found = work_precision(
        speed_accuracy_harmonic.solutions(
            FORMER, harmonics=(8, 32), oversampling=(1,), sigmas=(10.0,), repeats=1
        )
    )
    closed = found.isel(run=found.method.values == "cosines, closed-form contact")
    errors = {
        text: float(error)
        for text, error in zip(closed.setting.values, closed.error.values, strict=True)
    }
    rate = np.log(errors["N_h 8"] / errors["N_h 32"]) / np.log(4.0)
    assert 3.3 < rate < 4.7
    assert errors["N_h 32"] < 1e-7
    printed = found.isel(run=found.method.values == "paper, Eq. (34) as printed")
    assert float(printed.error.min()) > 0.1
    assert (printed.outcome == Outcome.converged).all()


def test_first_order_eigenvalues_lose_half_their_digits_and_the_closed_form_none() -> None:
    found = work_precision(speed_accuracy_stability.solutions(halvings=(50,), repeats=1))
    error = found.error.groupby("method").max() if "method" in found.coords else found.error
    ours = error.values[found.method.values == "closed form"]
    numeric = error.values[found.method.values == "eigenvalues, 4 × 4 (numpy)"]
    assert ours.max() < 1e-15
    assert numeric.max() > 1e-10


def test_time_of_a_known_wait() -> None:
    import time

    _, seconds = timed(lambda: time.sleep(0.01), repeats=3)
    assert 0.01 <= seconds < 0.2


def test_a_long_run_is_called_twice() -> None:
    import time

    calls: list[None] = []
    timed(lambda: calls.append(time.sleep(0.11)), repeats=5)
    assert len(calls) == 2


def test_evaluations_do_not_depend_on_the_number_of_repeats() -> None:
    counts = [
        [
            solution.evaluations
            for solution in speed_accuracy_harmonic.solutions(
                FORMER, harmonics=[4], sigmas=[], oversampling=[], repeats=repeats
            )
        ]
        for repeats in (1, 3)
    ]
    assert counts[0] == counts[1]
