"""Basins of published oscillators, and starts as a grid."""

import math

import numpy as np
import pytest

from squealpipe import basin_map, simulate
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.schema import Outcome
from tests.former import FORMER
from tests.oracles.friction_oscillators import ANGLES, BSTAB, oscillator

SHARES = {1.25: 0.08019692, 1.4: 0.21226526, 1.55: 0.35659639, 1.7: 0.49411159}
"""Exact share of starts that come to rest, by the area of the unstable cycle."""


@pytest.mark.parametrize(
    ("speed", "starts"),
    [
        (1.25, 1000),
        pytest.param(1.55, 1000, marks=pytest.mark.release),
        *(pytest.param(v, 5_000, marks=pytest.mark.release) for v in (1.4, 1.7)),
    ],
)
def test_basin_shares_of_a_published_oscillator(speed, starts):
    generator = np.random.default_rng(int(100 * speed))
    side = math.isqrt(starts)
    # one random start in each cell of a grid, so that the error is at most that of random starts
    x = -2.0 + 4.0 * (np.arange(side) + generator.uniform(size=side)) / side
    vx = 2.0 * (np.arange(side) + generator.uniform(size=side)) / side
    params = oscillator(1e4, speed, **BSTAB | {"damping1": 0.0})
    basin = basin_map(params, *ANGLES, x=x, vx=vx, y=0.25, t_end=500.0, t_late=400.0)
    assert basin.late_max_vx.dims == ("x0", "vx0")
    rest = basin.late_max_vx.values <= 0.2
    error = math.sqrt(SHARES[speed] * (1.0 - SHARES[speed]) / rest.size)
    assert abs(rest.mean() - SHARES[speed]) < 3.0 * error
    assert not basin.separates.any()
    moving = basin.motion.values[~rest]
    # next to the unstable cycle a motion grows so slowly that it has not stuck by t = 500
    growing = ~np.isin(moving, (MotionFlag.stick_slip, MotionFlag.unsettled))
    assert (moving[growing] == MotionFlag.contact_kept).all()
    assert growing.mean() < 2e-3


def test_rest_is_the_run_from_rest():
    params = FORMER.with_(k2=1.3, belt_speed=-2.0)
    basin = basin_map(params, 1.0, 2.2, t_end=15.0)
    run = simulate(params, 1.0, 2.2, t_end=15.0, times=np.linspace(12.0, 15.0, 20_001))
    assert basin.sizes == {}
    np.testing.assert_allclose(basin.late_max_x, np.abs(run.x).max(), rtol=1e-6)
    np.testing.assert_allclose(basin.late_max_vx, np.abs(run.vx).max(), rtol=1e-6)


def test_a_run_that_came_to_rest_has_settled():
    """Dashpots end the hammering of Fig. 2(d) early in the run, or just in its second half."""
    damped = FORMER.with_(damping1=0.1, damping2=0.1)
    angles = (5 * math.pi / 6, 5 * math.pi / 6)
    basin = basin_map(damped, *angles, vy=[0.0, 0.01], t_end=2000.0)
    assert (basin.outcome == Outcome.converged).all()
    assert basin.separates.all()
    assert (basin.motion == MotionFlag.at_rest).all()
    shorter = basin_map(damped, *angles, t_end=500.0)
    assert shorter.motion.item() == MotionFlag.hammered_then_contact
    ends = float(simulate(damped, *angles, t_end=400.0, times=[0.0]).event_time[-1])
    early = basin_map(damped, *angles, t_end=1.6 * ends)
    assert early.motion.item() == MotionFlag.unsettled


@pytest.mark.parametrize(
    ("change", "named"),
    [({"t_late": 60.0}, "t_late = 60.0"), ({"x": [[1.0]]}, r"x = .*: a 1-D array")],
)
def test_refuses_what_it_cannot_do(change, named):
    with pytest.raises(ValueError, match=named):
        basin_map(FORMER, 1.0, 2.0, **({"t_end": 50.0} | change))


def test_late_extremes_begin_at_t_late():
    """A decaying motion is largest there, inside of a step of the integrator."""
    params = FORMER.with_(damping1=0.3, damping2=0.2, k2=1.3)
    starts = np.linspace(-0.5, 0.5, 6)
    for late in (7.3, 21.1):
        found = basin_map(
            params, 1.1, 0.6, x=starts, t_end=50.0, t_late=late, workers=1
        )
        for start, largest in zip(starts, found.late_max_x.values, strict=True):
            run = simulate(
                params,
                1.1,
                0.6,
                t_end=50.0,
                initial_state=(start, 0, 0, 0),
                times=np.linspace(late, 50.0, 20_001),
            )
            assert largest == pytest.approx(np.abs(run.x).max().item(), rel=1e-4)
