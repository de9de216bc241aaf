"""heyoka's adaptive Taylor integrator with terminal events.

As its notebook "Event detection" has it: one integrator, a direction for each event, the cooldown
that it chooses itself; what changes with the regime are its runtime parameters.
"""

from __future__ import annotations

from typing import Any

import heyoka as hy

from squealpipe.benchmark.problems import Problem, run


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations, flag; a Taylor step of order p counts p + 1."""
    symbols = Problem(problem.data, hy, hy.expression)
    names = sorted(problem.regimes[problem.regime])
    constants = {name: hy.par[i] for i, name in enumerate(names)}
    y = [hy.expression(name) for name in problem.states]
    rates = symbols.function(list(problem.data["field"].values()), constants)(hy.time, y)
    events = []
    for i, switch in enumerate(problem.data["switches"]):
        watched = hy.par[len(names) + i]  # 1 where it can fire, else the surface is the constant 1
        surface = symbols.function(switch["when"], constants)(hy.time, y)
        events.append(
            hy.t_event(watched * surface + 1.0 - watched, direction=hy.event_direction.negative)
        )
    integrator = hy.taylor_adaptive(
        [(a, hy.expression(b)) for a, b in zip(y, rates, strict=True)],
        problem.start, tol=tol, t_events=events,
    )  # fmt: skip
    steps, failed = 0, ""

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        nonlocal steps, failed
        integrator.pars[:] = [problem.regimes[regime][name] for name in names] + [
            float(switch in watched) for switch in problem.switches
        ]
        integrator.state[:] = y
        found = integrator.propagate_until(problem.t_end)
        steps += found[3]
        if found[0].value >= 0 or -found[0].value > len(events):
            failed = "" if found[0] == hy.taylor_outcome.time_limit else str(found[0])
            return problem.t_end, integrator.state, None
        hit = watched.index(problem.switches[-found[0].value - 1])
        return integrator.time, integrator.state.copy(), hit

    times, kinds, state, _, flag = run(problem, advance)
    return times, kinds, state, steps * (integrator.order + 1), flag or failed
