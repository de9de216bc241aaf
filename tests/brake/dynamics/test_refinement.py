"""The refined map at many parameters: what is inherited is right, or measured to be wrong."""

import numpy as np
import pytest

from squealpipe.brake.dynamics import refinement
from squealpipe.brake.dynamics.refinement import refine_validity_map
from squealpipe.brake.dynamics.runs import validity_map
from squealpipe.schema import Outcome
from tests.former import FORMER

OTHERS = {
    "baseline": FORMER,
    "unequal springs": FORMER.with_(k2=1.8, length2=12.0, mu=0.45, k3=0.5),
    "reversed slow belt": FORMER.with_(
        k2=0.6, length1=8.0, belt_speed=-0.6, mu=0.2, k3=1.1
    ),
    "short springs": FORMER.with_(
        length1=2.6, length2=2.6, mu=0.35, k3=0.4, belt_speed=2.0
    ),
}


@pytest.mark.parametrize(
    ("points", "coarse", "t_end", "most"),
    [
        (121, 16, 100.0, 0.35),
        pytest.param(241, 31, 200.0, 0.2, marks=pytest.mark.release),
    ],
)
@pytest.mark.parametrize(
    "params",
    [
        pytest.param(params, marks=[pytest.mark.release] * ("belt" not in name))
        for name, params in OTHERS.items()
    ],
    ids=OTHERS,
)
def test_inherited_cells_are_as_wrong_as_measured(params, points, coarse, t_end, most):
    angles = np.linspace(0.0, np.pi, points)
    refined = refine_validity_map(params, resolution=points, coarse=coarse, t_end=t_end)
    uniform = validity_map(params, angles, angles, t_end=t_end)
    wrong = refined.separates.values != uniform.separates.values
    ran = refined.computed.values
    first = (each.first_separation_time.values[ran] for each in (refined, uniform))
    np.testing.assert_allclose(*first, rtol=1e-9)
    np.testing.assert_array_equal(refined.outcome.values != Outcome.inherited, ran)
    low, high = refined.inherited_error_interval.values
    assert low <= wrong[~ran].mean() <= high
    assert wrong.sum() <= 2
    assert ran.mean() < most
    assert not wrong[ran].any()


def test_an_island_that_the_sample_finds_is_followed(monkeypatch):
    """Neither reserve nor late separation is told: some islands are missed by the grid alone."""
    refine, samples = refinement.refine_grid, []

    def blind(evaluate, resolution, coarse):
        def without(rows, columns):
            lost, late, reserve = evaluate(rows, columns)
            return lost, np.zeros_like(late), np.full(reserve.shape, np.nan)

        return refine(without, resolution, coarse)

    def counting(*arguments):
        samples.append(refinement_check(*arguments))
        return samples[-1]

    refinement_check = refinement._check_inherited
    monkeypatch.setattr(refinement, "refine_grid", blind)
    monkeypatch.setattr(refinement, "_check_inherited", counting)
    monkeypatch.setattr(refinement, "CHECKED_CELLS", 2000)
    params = FORMER.with_(
        k3=0.48023366024799824,
        mu=0.1390424912331886,
        belt_speed=-2.0,
        length1=22.18325523692714,
        length2=22.18325523692714,
    )
    angles = np.linspace(0.0, np.pi, 81)
    refined = refine_validity_map(params, resolution=81, coarse=6, t_end=200.0)
    uniform = validity_map(params, angles, angles, t_end=200.0)
    assert len(samples) == 2
    missed = samples[0][1]
    assert missed >= 2
    left = np.count_nonzero(refined.separates.values != uniform.separates.values)
    assert left < missed
    assert samples[1] == (int(refined.inherited_checked), int(refined.inherited_wrong))
