"""SUNDIALS' CVODE by scikit-sundae, with its rootfinding and a new start after each event.

Adams' method, which the page of ``sksundae.cvode.CVODE`` suggests for problems that are not stiff;
``max_num_steps`` above its default of 500, which a whole flight needs at tight tolerances.
"""

from typing import Any

import numpy as np
from sksundae.cvode import CVODE

from squealpipe.benchmark.problems import Problem, run


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations."""

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        def rates(t: float, y: Any, out: Any) -> None:
            out[:] = problem.field(t, y.tolist(), regime)

        def surfaces(t: float, y: Any, out: Any) -> None:
            out[:] = [switch.when(t, y.tolist(), regime) for switch in watched]

        surfaces.terminal = [True] * len(watched)  # type: ignore[attr-defined]
        surfaces.direction = [-1] * len(watched)  # type: ignore[attr-defined]
        events = {"eventsfn": surfaces, "num_events": len(watched)} if watched else {}
        solver = CVODE(
            rates, method="Adams", rtol=tol, atol=tol, max_num_steps=100_000, **events
        )
        times = np.array([t, *problem.times_after(t)])
        solution = solver.solve(times, np.array(y, float))
        if solution.status == 2:
            hit = int(np.flatnonzero(solution.i_events[-1])[0])
            return solution.t_events[-1], solution.y_events[-1], hit
        if not solution.success:
            raise RuntimeError(solution.message)
        return problem.t_end, solution.y[-1], None

    return run(problem, advance)
