"""CyRK's ``pysolve_ivp`` with terminal events, which follows scipy's interface (its README)."""

from typing import Any

import numpy as np
from CyRK import pysolve_ivp

from squealpipe.benchmark.problems import Problem, run


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations."""

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        solution = pysolve_ivp(
            lambda t, y: np.array(problem.field(t, y.tolist(), regime)),
            (t, problem.t_end),
            np.array(y, float),
            method="DOP853",
            rtol=tol,
            atol=tol,
            events=[switch.event(regime) for switch in watched],
            t_eval=np.array(problem.times_after(t)),
        )
        if solution.event_terminated:
            hit = solution.event_terminate_index
            return (
                solution.t_events[hit][-1],
                solution.y_events[hit].reshape(len(y), -1)[:, -1],
                hit,
            )
        if not solution.success:
            raise RuntimeError(solution.message)
        return problem.t_end, solution.y[:, -1], None

    return run(problem, advance)
