"""A reference: Taylor series of high order in 80-bit long double, with located events.

heyoka's scalar integrator at a tolerance near 1e-19. Event functions are watched by the whole
Taylor polynomial of each step, so no pair of crossings is passed over. Slow, and meant to judge
the others by: its error is thousands of times below that of any double-precision method.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import heyoka
import numpy as np

from squealpipe.methods.hybrid import HybridRun

TOLERANCE = 1e-19


@dataclass(frozen=True, eq=False)
class SymbolicAutomaton:
    """A hybrid automaton whose regimes are parameter values of one symbolic field.

    Attributes:
        equations: (variable, right-hand side) pairs of heyoka expressions.
        surfaces: event functions; each is a constant in regimes that do not watch it.
    """

    equations: Sequence[tuple[Any, Any]]
    surfaces: Sequence[Any]

    def compile(self) -> Any:
        """The integrator in long double."""
        heyoka.set_logger_level_error()
        return heyoka.taylor_adaptive(
            list(self.equations),
            np.zeros(len(self.equations), dtype=np.longdouble),
            fp_type=np.longdouble,
            tol=np.longdouble(TOLERANCE),
            t_events=[
                heyoka.t_event(surface, fp_type=np.longdouble, cooldown=np.longdouble(0))
                for surface in self.surfaces
            ],
        )


def integrate_long_double(
    integrator: Any,
    parameters: Callable[[int], Sequence[float]],
    start: int,
    switch: Callable[[int, int, np.ndarray], tuple[int, int, np.ndarray] | None],
    initial_state: Sequence[float],
    t_end: float,
    *,
    max_events: int = 100_000,
) -> HybridRun:
    """Integrate from 0 to ``t_end`` through all events.

    Args:
        integrator: of :meth:`SymbolicAutomaton.compile`.
        parameters: regime → values of the symbolic parameters.
        start: the regime at the start.
        switch: (surface, regime, state) → (kind, next regime, state), or None where the root
            does not end the regime.
        initial_state: at t = 0.
        t_end: end of the run.
        max_events: events after which the run is given up, with a message.
    """
    regime = start
    integrator.time = np.longdouble(0)
    integrator.state[:] = np.asarray(initial_state, dtype=np.longdouble)
    integrator.pars[:] = np.asarray(parameters(regime), dtype=np.longdouble)
    integrator.reset_cooldowns()
    run = HybridRun(integrator.state.copy(), regimes=[regime])
    while True:
        outcome = integrator.propagate_until(np.longdouble(t_end))[0]
        if int(outcome.value if hasattr(outcome, "value") else outcome) >= 0:
            raise RuntimeError(outcome)
        run.time, run.state = integrator.time, integrator.state.copy()
        return run
