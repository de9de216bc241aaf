"""A1 as a flow with derivative: its automaton under :mod:`tests.oracles.event_flow`."""

from functools import cache

import numpy as np

from squealpipe.codes import Event, Regime
from tests.oracles.a1_automaton import A1Automaton, EventKind
from tests.oracles.a1_long_double import (
    PARAMETERS,
    SURFACES,
    VARIED,
    regime_values,
    symbolic_automaton,
)
from tests.oracles.event_flow import Switched, compile_flow

ULP = 2.0**-52


@cache
def _compiled(law):
    return compile_flow(*symbolic_automaton(law), len(PARAMETERS), VARIED)


class A1Flow:
    """A1 at given parameters and angles, for :mod:`tests.oracles.event_flow`.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles, rad.
        follow: name of a parameter or angle that derivatives are taken by.
    """

    def __init__(self, params, alpha1, alpha2, *, follow=None):
        self.params = params
        self.a1 = A1Automaton(params, alpha1, alpha2)
        self.integrator, self._slopes, self._gradients = _compiled(params.friction_law)
        self._values = {regime: regime_values(self.a1, regime) for regime in Regime}
        behind = [*self._changes(follow), 0.0]
        self._behind = np.array([[*self._values[regime], *behind] for regime in Regime])

    def _changes(self, follow):
        """Change of :data:`PARAMETERS` with one parameter or angle."""
        g = self.a1.geometry
        changes: dict[str | None, dict[str, float]] = {
            None: {},
            "alpha1": {"c1": -g.s1, "s1": g.c1},
            "alpha2": {"c2": -g.s2, "s2": g.c2},
            "mu": {"mu": 1.0, "static_mu": float(self.params.mu_static is None)},
            "mu_static": {"static_mu": 1.0},
        }
        change = changes.get(follow, {str(follow): 1.0})
        return np.array([change.get(name, 0.0) for name in PARAMETERS[:VARIED]])

    def parameters(self, regime):
        """Values of the symbolic parameters in a regime."""
        return self._values[Regime(regime)]

    def start(self, state):
        """The regime of a state, and the state off any surface."""
        regime = self.a1.start(state)
        return regime, self.a1.leave(regime, state, ULP)

    def switch(self, surface, regime, state):
        """What follows when a surface is met."""
        kind = SURFACES[surface]
        if kind == EventKind.separation and regime == Regime.separated:
            kind = EventKind.contact
        after, on_surface = self.a1.switch(kind, state)
        gradient = None
        if kind in {EventKind.belt_speed, EventKind.release}:
            values = self._gradients(on_surface, pars=self._behind[regime])
            gradient = values.reshape(-1, len(state) + 1)[surface]
        return Switched(
            int(_event(kind, after)), after, self.a1.leave(after, on_surface, ULP), gradient
        )

    def velocity(self, regime, state):
        """The field of a regime."""
        return np.array(self.a1.field(regime)(0.0, state))

    def slopes(self, regimes, states):
        """Derivatives of ẍ and ÿ by state and parameter, (2, 5, n), at states (4, n)."""
        values = self._slopes(states, pars=np.ascontiguousarray(self._behind[regimes].T))
        return np.asarray(values).reshape(2, 5, -1)

    def jacobian(self, regime, state):
        """∂f/∂z of a regime, (4, 4)."""
        slopes = self.slopes(np.array([regime]), state[:, None])
        return np.vstack([np.eye(2, 4, 2), slopes[:, :4, 0]])


def _event(kind, after):
    if kind == EventKind.separation:
        return Event.separation
    if kind == EventKind.contact:
        return Event.contact
    if kind == EventKind.release:
        return Event.slip
    return Event.stick if after == Regime.stick else Event.reversal
