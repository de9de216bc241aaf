"""diffrax with its ``Event`` and a root finder, restarted after each event.

Dopri8, which "How to choose a solver" suggests at tight tolerances, a PID controller with its
defaults, and optimistix' Newton, the choice that the page of ``diffrax.Event`` calls typical.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import optimistix

from squealpipe.benchmark.problems import Problem, all_data, run

jax.config.update("jax_enable_x64", val=True)
STAGES, MOST_STEPS = 13, 2**14


@cache
def compiled(name: str, regime: str, tol: float) -> Any:
    """(t, y) → time and state at the stop, steps, and which event fired."""
    traced = Problem(next(data for data in all_data() if data["name"] == name), jnp)
    conditions = [
        lambda t, y, args, switch=switch, **kwargs: switch.when(t, y, regime)
        for switch in traced.watched(regime)
    ]
    event = diffrax.Event(conditions, optimistix.Newton(tol, tol), direction=False)

    @jax.jit
    def made(t: Any, y: Any) -> Any:
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(lambda t, y, _: jnp.array(traced.field(t, y, regime), float)),
            diffrax.Dopri8(), t, traced.t_end, None, y, max_steps=MOST_STEPS, throw=False,
            stepsize_controller=diffrax.PIDController(rtol=tol, atol=tol),
            event=event if conditions else None,
        )  # fmt: skip
        fine = diffrax.is_okay(found.result)
        return found.ts[-1], found.ys[-1], found.stats["num_steps"], found.event_mask, fine

    return made


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations, flag."""
    steps, failed = 0, ""

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        nonlocal steps, failed
        step = compiled(problem.name, regime, tol)
        t, y, made, mask, fine = step(float(t), jnp.array(y, float))
        steps += int(made)
        fired = [i for i, hit in enumerate(mask or ()) if hit]
        if not fine:
            failed, fired = "the solve did not succeed", []
        return float(t), y.tolist(), fired[0] if fired else None

    times, kinds, state, _, flag = run(problem, advance)
    return times, kinds, state, steps * STAGES, flag or failed
