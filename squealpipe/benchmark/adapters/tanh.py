"""Regularization: a regime's constants become tanh of width 1/σ, and LSODA sees no events."""

from typing import Any

from scipy.integrate import solve_ivp

from squealpipe.benchmark.problems import Problem


def solve(problem: Problem, tol: float, sigma: float = 1e3) -> Any:
    """No events, no kinds, state, evaluations.

    Raises:
        NotImplementedError: the problem has no smooth form.
        RuntimeError: LSODA gave up.
    """
    if "smoothed" not in problem.data:
        raise NotImplementedError("no smooth form")
    constants = {"sigma": sigma, **problem.data["smoothed"]}
    problem.fields[problem.regime] = problem.function(problem.rates, constants)
    span = 0.0, problem.t_end
    solution = solve_ivp(
        # Python's numbers are several times faster
        lambda t, y: problem.field(t, y.tolist()),
        span,
        problem.start,
        method="LSODA",
        rtol=tol,
        atol=tol,
    )
    if not solution.success:
        raise RuntimeError(solution.message)
    return None, None, solution.y[:, -1], problem.calls
