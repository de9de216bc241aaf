"""``scipy.integrate.solve_ivp`` with terminal events, restarted after each.

Settings of its page (``scipy.integrate.solve_ivp``): rtol and atol, ``terminal`` and ``direction``
of each event; ``max_step`` is left at infinity, its default.
"""

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from squealpipe.benchmark.problems import Problem, run


def solve(problem: Problem, tol: float, method: str = "DOP853") -> Any:
    """Times, kinds, state, evaluations."""

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        solution = solve_ivp(
            lambda t, y: problem.field(t, y.tolist(), regime),
            (t, problem.t_end),
            np.array(y, float),  # scipy hands it to the events as it is
            method=method,
            t_eval=problem.times_after(t),
            rtol=tol,
            atol=tol,
            events=[switch.event(regime) for switch in watched],
        )
        if solution.status < 0:
            raise RuntimeError(solution.message)
        if solution.status == 1:
            hit = next(i for i, times in enumerate(solution.t_events) if len(times))
            return solution.t_events[hit][-1], solution.y_events[hit][-1], hit
        return problem.t_end, solution.y[:, -1] if solution.y.size else y, None

    return run(problem, advance)
