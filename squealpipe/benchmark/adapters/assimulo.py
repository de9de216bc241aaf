"""Assimulo's CVode with state events, stopped and restarted at each.

The solver of its tutorial "Discontinuous Problems"; Adams' method, as for SUNDIALS.
"""

from typing import Any

import numpy as np
from assimulo.exception import TerminateSimulation
from assimulo.problem import Explicit_Problem
from assimulo.solvers import CVode

from squealpipe.benchmark.problems import Problem, run


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations."""

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        fired: list[int] = []

        def stop(solver: Any, info: Any) -> None:
            fired.extend(i for i, way in enumerate(info[0]) if way == -1)
            if fired:
                raise TerminateSimulation

        def rates(t: float, y: Any, _: Any) -> Any:
            return np.array(problem.field(t, y.tolist(), regime), float)

        def surfaces(t: float, y: Any, _: Any) -> Any:
            return np.array([switch.when(t, y.tolist(), regime) for switch in watched])

        asked = Explicit_Problem(rates, np.array(y, float), t, sw0=[True])
        if watched:
            asked.state_events, asked.handle_event = surfaces, stop
        solver = CVode(asked)
        # 50: no messages of the solver
        solver.discr, solver.verbosity = "Adams", 50
        solver.rtol, solver.atol = tol, tol
        if t < problem.t_end:
            solver.simulate(problem.t_end, 0, problem.times_after(t))
        return solver.t, solver.y.copy(), next(iter(fired), None)

    return run(problem, advance)
