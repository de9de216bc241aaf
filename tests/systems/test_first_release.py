"""Systems without components have the numbers of 1.0.0, which knew no components."""

import numpy as np
import pytest

from squealpipe.systems.shipped.belt_friction import (
    exponential_oscillator,
    leine_oscillator,
)
from squealpipe.systems.shipped.dry_friction import dry_friction_oscillator
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from squealpipe.systems.shipped.mode_coupling import mode_coupling
from squealpipe.systems.shipped.relief_valve import relief_valve

# events, time of the last, and the state at t = 20, printed by 1.0.0
RECORDED = [
    (impact_oscillator, 0, None, [-0.1532828335371175, 0.06539484811337415]),
    (leine_oscillator, 4, 16.29703082031074, [0.19958748206776636, 0.2]),
    (
        exponential_oscillator,
        4,
        17.52519004344089,
        [1.3566584445450083, -1.4137577782786097],
    ),
    (
        dry_friction_oscillator,
        10,
        17.2559005642945,
        [1.3098013353335802, 0.8530888514954645],
    ),
    (
        relief_valve,
        0,
        None,
        [1.4033158428016084, -3.3000987641292965, 16.433149680385867],
    ),
    (
        mode_coupling,
        0,
        None,
        [
            -0.011411463866822088,
            -0.004731733979755583,
            0.0012356607505561387,
            -0.036919680023730334,
        ],
    ),
]


@pytest.mark.parametrize(("system", "events", "last", "state"), RECORDED)
def test_a_system_without_components_moves_as_in_the_first_release(
    system, events, last, state
):
    """To round-off: on the processor on which they were recorded all bits are the same."""
    run = system.simulate(20.0)
    assert run.sizes["event"] == events
    if events:
        assert float(run.event_time[-1]) == pytest.approx(last, rel=1e-13)
    found = np.array([run[name].values[-1] for name in system.states])
    np.testing.assert_allclose(found, state, rtol=0, atol=1e-13 * np.abs(state).max())
