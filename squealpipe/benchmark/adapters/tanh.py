"""Regularization: a regime's constants become tanh of width 1/σ, and LSODA sees no events."""

from __future__ import annotations

from typing import Any

from scipy.integrate import solve_ivp

from squealpipe.benchmark.adapters.scipy import SMALLEST
from squealpipe.benchmark.problems import Problem


def solve(problem: Problem, tol: float, sigma: float = 1e3) -> Any:
    """No events, no kinds, state, evaluations, flag.

    Raises:
        NotImplementedError: the problem has no smooth form.
    """
    if problem.smoothed is None:
        raise NotImplementedError("no smooth form")
    names = [*problem.smoothed]
    widths = problem.function([*problem.smoothed.values()], {"sigma": sigma})
    constants: dict[str, float] = {}
    fields = problem.data["field"].values()
    rates = problem.function([f"({text})" for text in fields], constants)
    rates_of = rates.__globals__

    def field(t: float, y: Any) -> Any:
        problem.field(t, y)  # counts
        rates_of.update(zip(names, widths(t, y), strict=True))
        return rates(t, y)

    found = solve_ivp(
        field,
        (0.0, problem.t_end),
        problem.start,
        method="LSODA",
        rtol=max(tol, SMALLEST),
        atol=tol,
    )
    flag = "" if found.success else found.message
    return None, None, found.y[:, -1].tolist(), problem.calls, flag
