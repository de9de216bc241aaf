"""The derivative of a motion against heyoka's variational equations of it."""

import math

import heyoka
import numpy as np
import pytest

from squealpipe.codes import Regime
from tests.former import FORMER
from tests.oracles.a1_flow import A1Flow
from tests.oracles.a1_long_double import PARAMETERS, symbolic_automaton
from tests.oracles.event_flow import flow

FOLLOWED = "k2"


def variational(system, law, regime, state, duration):
    """The state and its derivatives by the initial one and by ``FOLLOWED``, by Taylor's series."""
    parameter = heyoka.par[PARAMETERS.index(FOLLOWED)]
    equations, _ = symbolic_automaton(law)
    variables = [variable for variable, _ in equations]
    integrator = heyoka.taylor_adaptive(
        heyoka.var_ode_sys(equations, [*variables, parameter]), state, compact_mode=True
    )
    integrator.pars[:] = system.parameters(regime)[: len(integrator.pars)]
    integrator.propagate_until(duration)
    return integrator.state[:4], integrator.state[4:].reshape(4, 5)


@pytest.mark.parametrize("belt_speed", [-1.3, 40.0])
@pytest.mark.parametrize("law", ["coulomb", "exponential"])
def test_derivative_agrees_with_the_variational_equations(law, belt_speed):
    params = FORMER.with_(
        k2=1.4, length1=3.0, length2=7.0, belt_speed=belt_speed, mu=0.2, mu_static=0.6,
        friction_law=law, friction_speed=0.3, damping1=0.03, damping2=0.1,
    )  # fmt: skip
    system = A1Flow(params, 0.3 * math.pi, 0.55 * math.pi, follow=FOLLOWED)
    state, duration = np.array([0.3, 0.2, 0.1, -0.2]), 2.5
    passage = flow(system, state, duration)
    assert not passage.event_kinds
    assert passage.regime in {Regime.slip_slower, Regime.slip_faster}
    end, derivative = variational(system, law, passage.regime, state, duration)
    np.testing.assert_allclose(passage.state, end, rtol=1e-13)
    np.testing.assert_allclose(passage.derivative, derivative[:, :4], atol=1e-12)
    np.testing.assert_allclose(passage.slope, derivative[:, 4], atol=1e-12)
