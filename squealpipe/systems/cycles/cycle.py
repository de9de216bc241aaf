"""One periodic motion of a system: the verb ``limit_cycle``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.systems.cycles.described import dataset
from squealpipe.systems.cycles.find import find_cycle
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.grid import call_values, scalar
from squealpipe.systems.inputs.gate import Natural, Positive, Values, checked
from squealpipe.systems.integrate import MOST_STEPS

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


@checked
def limit_cycle(
    system: Any,
    *,
    start: Values | None = None,
    guess: Values | None = None,
    periods: Natural = 1,
    t_settle: Positive | None = None,
    max_steps: Natural = MOST_STEPS,
    **parameters: Any,
) -> xr.Dataset:
    """A periodic motion with every event located, its stability included.

    Newton's method on the legs between the events; derivatives are exact, through resets and with
    the forcing's phase.

    Args:
        start: from where to settle, states that differ from the system's start.
        guess: a state near the cycle, which may be unstable; at t = 0 of the forcing.
        periods: of the forcing; without it, returns to the section, which is the event that is
            met least often.
        t_settle: s; 200 forcing periods or time scales by default.
        max_steps: steps of the integrator in a run, after which the outcome is ``step_limit``.
        parameters: those that differ from the system's.

    Returns:
        Dataset: ``period``, ``<state>_min``, ``<state>_max`` (of outputs too), ``multiplier_real``
        and ``multiplier_imag`` (the trivial one first without forcing), ``stable``, ``residual``,
        ``outcome``, events with states and regimes entered, and ``periods``. Times count from t = 0
        of the forcing, or from a state far from events. NaN with the reason in ``outcome`` where
        no cycle is found; ``settled_on_k_periods`` where the settled motion has more than asked.

    Raises:
        ValueError: an unknown state or parameter, a value that is not a finite number, or explicit
            time without a period.
    """
    values, state = given(system, guess if guess is not None else start, parameters)
    if start is not None and guess is not None:
        raise ValueError("start, guess: give one of them")
    cycle, outcome = find_cycle(
        system,
        values,
        state,
        guess=guess is not None,
        periods=periods,
        t_settle=t_settle,
        most_steps=max_steps,
    )
    return dataset(system, cycle, outcome, values, periods)


def given(
    system: System, start: Mapping[str, Any] | None, parameters: Mapping[str, Any]
) -> tuple[dict[str, float], Vector]:
    """Parameters and the start of a call, checked."""
    numbers = {
        n: scalar(n, v) for n, v in call_values(system, start, parameters).items()
    }
    if len(system.traced.variables) > system.traced.size and system.period is None:
        raise ValueError(
            f"{system.name} depends on the time but has no period; give `period`"
        )
    return {n: numbers[n] for n in system.parameters}, np.array(
        [numbers[n] for n in system.states]
    )
