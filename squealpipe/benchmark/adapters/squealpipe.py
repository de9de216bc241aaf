"""Our own engine: the problem's texts become a ``System``, run with its predictability horizon."""

import math
from typing import Any

import numpy as np

from squealpipe.benchmark.as_system import system_of
from squealpipe.benchmark.problems import Problem
from squealpipe.schema import Outcome
from squealpipe.systems.integrate import RunOptions, integrate

_known: dict[str, Any] = {}


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations, flag, derivative; a Taylor step of order p counts p + 1."""
    if problem.name not in _known:
        _known[problem.name] = system_of(problem)
    system = _known[problem.name]
    given = {**system.parameters, **problem.data["start"]}
    # room for the events of a run; more than any problem of the benchmark has
    max_events = 1000
    raw = integrate(
        system,
        {name: np.array([value]) for name, value in given.items()},
        np.array([problem.t_end]),
        RunOptions(times=np.array(problem.times), tangent=True, log_events=max_events),
        tol=tol,
        workers=1,
    )
    outcome, steps, count = (
        int(raw[name][0]) for name in ("outcome", "steps", "n_events")
    )
    flag = "" if outcome == Outcome.converged else Outcome(outcome).name
    if np.isfinite(raw["horizon"][0]):
        flag = "beyond the horizon of predictability"
    slope = None
    if problem.derivative:
        event, name = problem.derivative
        run = system.simulate(problem.t_end, tol=tol, sensitivity=(name,))
        slope = float(run[f"event_time_by_{name}"][event])
    times = raw["event_times"][0, :count].tolist()
    kinds = [system.traced.kinds[kind] for kind in raw["event_kinds"][0, :count]]
    evaluations = steps * (math.ceil(1.0 - 0.5 * math.log(tol)) + 1)
    return times, kinds, raw["final"][0].tolist(), evaluations, flag, slope
