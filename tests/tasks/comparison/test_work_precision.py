"""Work–precision rows: what they measure, and that our setting is as good as it is said to be."""

import numpy as np
import pytest

from squealpipe.schema import Outcome
from squealpipe.schema.comparison import Role
from squealpipe.tasks.comparison.work_precision import harmonic as speed_accuracy_harmonic
from squealpipe.tasks.comparison.work_precision import integration as speed_accuracy_integration
from squealpipe.tasks.comparison.work_precision import stability as speed_accuracy_stability
from squealpipe.tasks.comparison.work_precision import validity as speed_accuracy_validity
from squealpipe.tasks.comparison.work_precision.solutions import timed, work_precision
from squealpipe.tasks.comparison.work_precision.validity import boundary_distance, on_grid
from tests.former import FORMER


@pytest.fixture(scope="module")
def integration():
    return work_precision(
        speed_accuracy_integration.solutions(
            FORMER, horizon=20.0, solvers=("DOP853",), tolerances=(1e-4, 1e-8),
            steps=(1e-2,), sigmas=(100.0,), repeats=1,
        )
    )  # fmt: skip


def test_our_setting_beats_what_the_public_methods_reach(integration) -> None:
    ours = integration.isel(run=integration.role.values == Role.our_setting)
    public = integration.isel(run=integration.role.values == Role.public)
    assert float(ours.error.max()) < 1e-10
    assert (ours.wrong_events == 0).all()
    assert float(public.error.min()) > float(ours.error.max())


def test_tighter_tolerances_cost_more_and_err_less(integration) -> None:
    dop = integration.isel(run=integration.method.values == "DOP853 + events")
    for scene in np.unique(dop.scene.values):
        loose, tight = (
            dop.isel(run=(dop.scene.values == scene) & (dop.setting.values == text))
            for text in ("tol 0.0001", "tol 1e-08")
        )
        assert float(tight.error.squeeze()) < 0.01 * float(loose.error.squeeze())
        assert float(tight.evaluations.squeeze()) > float(loose.evaluations.squeeze())


def test_references_are_a_thousand_times_better(integration) -> None:
    judged = integration.isel(run=integration.role.values == Role.public)
    assert (judged.error > 1e3 * judged.reference_error).all()


def test_wall_times_are_volatile(integration) -> None:
    assert integration.wall_time.attrs["volatile"] == "true"
    assert (integration.wall_time > 0).all()


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


def test_validity_map_needs_its_horizon_more_than_its_tolerance() -> None:
    found = work_precision(
        speed_accuracy_validity.solutions(
            FORMER, points=31, fine_points=61, tolerances=(1e-6,), horizons=(25.0, 400.0),
            steps=(0.1,),
        )
    )  # fmt: skip
    wrong = {
        text: int(count)
        for text, count in zip(found.setting.values, found.wrong_events.values, strict=True)
    }
    assert wrong["tol 1e-06"] == 0
    assert wrong["T 25"] > 0


def test_boundary_distance_of_a_shifted_half_plane() -> None:
    column = np.arange(40)
    maps = [np.tile(column < edge, (40, 1)) for edge in (20, 23)]
    assert boundary_distance(*maps) == pytest.approx(3.0)
    assert boundary_distance(maps[0], maps[0]) == 0.0


def test_a_coarse_map_stands_for_its_neighbourhood() -> None:
    fine = on_grid(np.array([[0, 1], [2, 3]]), 4)
    assert fine.tolist() == [[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]


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
