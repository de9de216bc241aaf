"""``scipy.integrate.solve_ivp`` with terminal events, restarted after each.

Settings of its page (``scipy.integrate.solve_ivp``): rtol and atol, ``terminal`` and ``direction``
of each event; ``max_step`` is left at infinity, its default.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from squealpipe.benchmark.problems import Problem, run

SMALLEST = 100 * np.finfo(float).eps
"""solve_ivp refuses a smaller rtol."""


def solve(problem: Problem, tol: float, method: str = "DOP853") -> Any:
    """Times, kinds, state, evaluations, flag."""
    failed: list[str] = []

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        events = []
        for switch in watched:

            def event(t: float, y: Any, switch: Any = switch) -> float:
                return float(switch.when(t, y.tolist(), regime))

            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
            events.append(event)
        found = solve_ivp(
            lambda t, y: problem.field(t, y.tolist(), regime),
            (t, problem.t_end),
            np.array(y, float),  # scipy hands it to the events as it is
            method=method,
            t_eval=[*(each for each in problem.times if each > t), problem.t_end],
            rtol=max(tol, SMALLEST),
            atol=tol,
            events=events,
        )
        if found.status == 1:
            hit = next(i for i, times in enumerate(found.t_events) if len(times))
            return found.t_events[hit][-1], found.y_events[hit][-1], hit
        failed.extend([found.message] * (found.status < 0))
        return problem.t_end, found.y[:, -1] if found.y.size else y, None

    times, kinds, state, evaluations, flag = run(problem, advance)
    return times, kinds, state, evaluations, flag or "".join(failed)
