"""diffrax with its ``Event`` and a root finder, restarted after each event.

Dopri8, which "How to choose a solver" suggests at tight tolerances, a PID controller with its
defaults, and optimistix' Newton, the choice that the page of ``diffrax.Event`` calls typical.
"""

from functools import cache
from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import optimistix

from squealpipe.benchmark.problems import Problem, all_data, run

jax.config.update("jax_enable_x64", val=True)


@cache
def compiled(name: str, regime: str, tol: float) -> Any:
    """(t, y) → time and state at the stop, steps, and which event fired."""
    traced = Problem(next(data for data in all_data() if data["name"] == name), jnp)
    surfaces = [switch.when for switch in traced.watched(regime)]
    conditions = [
        lambda t, y, *_, when=when, **__: when(t, y, regime) for when in surfaces
    ]
    event = diffrax.Event(conditions, optimistix.Newton(tol, tol), direction=False)
    rates = diffrax.ODETerm(
        lambda t, y, _: jnp.array(traced.fields[regime](t, y), float)
    )
    settings: dict[str, Any] = {
        "stepsize_controller": diffrax.PIDController(rtol=tol, atol=tol),
        "max_steps": 2**14,
        "event": event if conditions else None,
    }
    end, method = traced.t_end, diffrax.Dopri8()
    return jax.jit(
        lambda t, y: diffrax.diffeqsolve(rates, method, t, end, None, y, **settings)
    )


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations."""
    # Dormand and Prince's method of order 8 evaluates the right-hand side this often in a step
    stages_per_step = 13

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        solution = compiled(problem.name, regime, tol)(float(t), jnp.array(y, float))
        problem.calls += stages_per_step * int(solution.stats["num_steps"])
        fired = next(
            (i for i, hit in enumerate(solution.event_mask or ()) if hit), None
        )
        return float(solution.ts[-1]), solution.ys[-1].tolist(), fired

    return run(problem, advance)
