"""What the paper's form of harmonic balance finds, and A1 beside A4."""

import math

import numpy as np
import pytest

from squealpipe.brake.backbones.a1_beside_a4 import a1_beside_a4
from squealpipe.brake.backbones.harmonic_forms import compare_harmonic_forms
from squealpipe.brake.schema.backbones import Form
from squealpipe.schema import Outcome
from tests.former import FORMER

PI = math.pi
BRANCHES = {"F10 mode 2": (0.5 * PI, PI, 2), "coupled mode 1": (0.3 * PI, 0.9 * PI, 1)}


def test_the_papers_form_mended_and_as_printed():
    forms = compare_harmonic_forms(FORMER, BRANCHES)
    assert (forms.outcome == Outcome.converged).all()
    mended, printed = (
        forms.omega.sel(form=int(form)) for form in (Form.mended, Form.as_printed)
    )
    np.testing.assert_allclose(mended, forms.omega_exact, rtol=5e-3)
    assert float(printed.sel(scene="F10 mode 2")) == pytest.approx(1.0, abs=1e-6)
    assert float(forms.omega_exact.sel(scene="F10 mode 2")) == pytest.approx(
        1.2341, abs=5e-5
    )
    rank = forms.fourier_rank.values
    assert rank[0] == int(forms.fourier_columns) - 1
    assert (rank[1:] == int(forms.fourier_columns)).all()


def test_a1_stays_beside_a4_the_longer_the_springs():
    """The geometry's part of the frequency shift falls like the inverse of the length."""
    beside = a1_beside_a4(
        FORMER,
        {"F10 mode 2": BRANCHES["F10 mode 2"]},
        peak=2.0,
        length_ratios=(50, 500),
    )
    shifts = np.abs(beside.omega_a1 / beside.omega - 1.0).values[0]
    assert shifts[1] < 0.2 * shifts[0] < 2e-3
    apart = np.abs(beside.y_a1 - beside.y_a4).max("period").values[0]
    assert apart[1] < 0.2 * apart[0]


def test_a_scene_without_orbits_is_refused_with_its_reason():
    with pytest.raises(ValueError, match="singular_static_state"):
        compare_harmonic_forms(FORMER, {"whirl": (0.4 * PI, 0.6 * PI, 1)})
