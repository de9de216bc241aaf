"""Work–precision rows: what they measure, and that our setting is as good as it is said to be."""

import time

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.tasks.comparison.work_precision import timed, work_precision
from tests.former import FORMER


def test_harmonic_balance_converges_as_published():
    """ω falls about like N_h^-4 with closed-form integrals; the printed Eq. (34) is just wrong."""
    found = work_precision(FORMER, harmonics=(8, 32), oversampling=(1,), sigmas=(10.0,), repeats=1)
    errors = dict(
        zip(
            zip(found.method.values, found.setting.values, strict=True),
            found.error.values,
            strict=True,
        )
    )
    coarse, fine = (errors["cosines, closed-form contact", f"N_h {count}"] for count in (8, 32))
    assert 3.3 < np.log(coarse / fine) / np.log(4.0) < 4.7
    assert fine < 1e-7
    assert errors["exact orbit (shooting)", "with monodromy"] < 1e-12
    printed = found.isel(run=found.method.values == "paper, Eq. (34) as printed")
    assert float(printed.error.min()) > 0.1
    assert (printed.outcome == Outcome.converged).all()


def test_time_of_a_known_wait():
    _, seconds = timed(lambda: time.sleep(0.01), repeats=3)
    assert 0.01 <= seconds < 0.2


def test_a_long_run_is_called_twice():
    calls: list[None] = []
    timed(lambda: calls.append(time.sleep(0.11)), repeats=5)
    assert len(calls) == 2
