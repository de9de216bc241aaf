"""Moreau–Jean time stepping with a fixed step, the fourth root of the tolerance.

Acary and Brogliato (2008), section 10.1: forces at the midpoint, friction as an impulse within its
bound, found from the velocity at the end, impacts by Newton's law where the midpoint has no gap.
"""

from __future__ import annotations

import math
from typing import Any

from squealpipe.benchmark.problems import Problem


def solve(problem: Problem, tol: float) -> Any:
    """No events, no kinds, state, evaluations.

    Raises:
        NotImplementedError: the problem is none of friction or impact in these terms.
    """
    data = problem.stepping
    if data is None:
        raise NotImplementedError("no friction or impact")
    velocities = [problem.states.index(name) for name in data["velocities"]]
    others = [i for i in range(len(problem.states)) if i not in velocities]
    names = [*data["constants"]]
    constants = problem.function([*data["constants"].values()], {})
    rates = problem.function([*problem.data["field"].values()], {})
    law = [*data.get("friction", ()), *data.get("impact", ())]
    place = problem.states.index(law[0])
    values = problem.function(law[1:], {})
    n_steps = math.ceil(problem.t_end / tol**0.25)
    h = problem.t_end / n_steps
    y = list(problem.start)

    def half(t: float) -> None:
        now = rates(t, y)
        for i in others:
            y[i] += 0.5 * h * now[i]

    for step in range(n_steps):
        t = step * h
        gap = values(t, y)[0]
        rates.__globals__.update(zip(names, constants(t, y), strict=True))
        half(t)
        t += 0.5 * h
        rates.__globals__.update(zip(names, constants(t, y), strict=True))
        now = rates(t, y)
        a, b = values(t, y)
        before = y[place]
        for i in velocities:
            y[i] += h * now[i]
        if "friction" in data:
            y[place] += min(max(a - y[place], -b * h), b * h)
        elif a <= min(0.0, gap):
            y[place] = -b * before
        half(t)
    return None, None, y, n_steps, ""
