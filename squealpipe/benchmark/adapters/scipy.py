"""``scipy.integrate.solve_ivp`` with terminal events, restarted after each.

Settings of its page (``scipy.integrate.solve_ivp``): rtol and atol, ``terminal`` and ``direction``
of each event; ``max_step`` is left at infinity, its default, unless a share of the run bounds it.
"""

import math
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from squealpipe.benchmark.problems import Problem, all_data, run


def solve(
    problem: Problem,
    tol: float,
    method: str = "DOP853",
    *,
    longest: float = math.inf,
    compiled: bool = False,
) -> Any:
    """Return times, kinds, state, evaluations.

    Args:
        longest: longest step, as a share of the run; two crossings within one step go unseen.
        compiled: compile the field to machine code; the solver around it stays Python.
    """

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        if compiled:
            field = _machine_code(problem.name, regime)
        else:
            field = lambda t, y: problem.field(t, y.tolist(), regime)  # noqa: E731
        solution = solve_ivp(
            field,
            (t, problem.t_end),
            np.array(y, float),  # scipy hands it to the events as it is
            method=method,
            t_eval=problem.times_after(t),
            rtol=tol,
            atol=tol,
            max_step=longest * problem.t_end,
            events=[switch.event(regime) for switch in watched],
        )
        if compiled:
            problem.calls += solution.nfev  # the harness cannot count inside
        if solution.status < 0:
            raise RuntimeError(solution.message)
        if solution.status == 1:
            hit = next(i for i, times in enumerate(solution.t_events) if len(times))
            return solution.t_events[hit][-1], solution.y_events[hit][-1], hit
        return problem.t_end, solution.y[:, -1] if solution.y.size else y, None

    return run(problem, advance)


@cache
def _machine_code(name: str, regime: str) -> Any:
    """Return (t, y) → rates of a problem in a regime, compiled by numba at the first call."""
    from numba import njit  # the other methods need none

    data = next(each for each in all_data() if each["name"] == name)
    rates = njit(Problem(data).fields[regime])
    states = ", ".join(f"y[{i}]" for i in range(len(data["start"])))
    scope = {"rates": rates, "array": np.array}
    source = f"def field(time, y):\n return array(rates(time, ({states},)))"
    exec(source, scope)  # noqa: S102 (equations of this package)
    return njit(scope["field"])
