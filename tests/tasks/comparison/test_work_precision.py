"""Work–precision rows: what they measure, and that our setting is as good as it is said to be."""

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.tasks.comparison.work_precision import work_precision
from tests.former import FORMER


def test_harmonic_balance_converges_as_published():
    """ω falls about like N_h^-4 with closed-form integrals; the printed Eq. (34) is just wrong."""
    found = work_precision(FORMER, harmonics=(8, 32), oversampling=(1,), sigmas=(10.0,), repeats=1)
    names = zip(found.method.values, found.setting.values, strict=True)
    errors = dict(zip(names, found.error.values, strict=True))
    coarse, fine = (errors["cosines, closed-form contact", f"N_h {count}"] for count in (8, 32))
    assert 3.3 < np.log(coarse / fine) / np.log(4.0) < 4.7
    assert fine < 1e-7
    assert errors["exact orbit (shooting)", "with monodromy"] < 1e-12
    printed = found.isel(run=found.method.values == "paper, Eq. (34) as printed")
    assert float(printed.error.min()) > 0.1
    assert (printed.outcome == Outcome.converged).all()
