"""Moreau–Jean time stepping with a fixed step, the fourth root of the tolerance.

Acary and Brogliato (2008), section 10.1: forces at the midpoint, friction as an impulse within its
bound, found from the velocity at the end, impacts by Newton's law where the midpoint has no gap.
"""

import math
from typing import Any

from squealpipe.benchmark.problems import Problem


def solve(problem: Problem, tol: float) -> Any:
    """No events, no kinds, state, evaluations.

    Raises:
        NotImplementedError: the problem is none of friction or impact in these terms.
    """
    if "stepping" not in problem.data:
        raise NotImplementedError("no friction or impact")
    data = problem.data["stepping"]
    moves = [problem.states.index(name) for name in data["velocities"]]
    rests = [i for i in range(len(problem.states)) if i not in moves]
    drift, kick = (
        problem.function([problem.rates[i] for i in places], data["constants"])
        for places in (rests, moves)
    )
    velocity, *law = data.get("friction") or data["impact"]
    place, values = problem.states.index(velocity), problem.function(law, {})
    n_steps = math.ceil(problem.t_end / tol**0.25)
    h, y = problem.t_end / n_steps, list(problem.start)

    def half(t: float) -> None:
        for i, rate in zip(rests, drift(t, y), strict=True):
            y[i] += 0.5 * h * rate

    for step in range(n_steps):
        t = step * h
        gap = values(t, y)[0] if "impact" in data else 0.0
        half(t)
        t += 0.5 * h
        now, (a, b), before = kick(t, y), values(t, y), y[place]
        for i, rate in zip(moves, now, strict=True):
            y[i] += h * rate
        if "friction" in data:
            y[place] += min(max(a - y[place], -b * h), b * h)
        elif a <= min(0.0, gap):
            y[place] = -b * before
        half(t)
    return None, None, y, n_steps
