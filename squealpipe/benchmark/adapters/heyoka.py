"""heyoka's adaptive Taylor integrator with terminal events.

As its notebook "Event detection" has it: one integrator, a direction for each event, the cooldown
that it chooses itself; what changes with the regime are its runtime parameters.
"""

from typing import Any

import heyoka as hy

from squealpipe.benchmark.problems import Problem, run


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations; a Taylor step of order p counts p + 1."""
    symbols = Problem(problem.data, hy, hy.expression)
    names = sorted(problem.regimes[problem.regime])
    constants = {name: hy.par[i] for i, name in enumerate(names)}
    y = [hy.expression(name) for name in problem.states]
    rates = symbols.function(problem.rates, constants)(hy.time, y)
    events = []
    for i, switch in enumerate(problem.data["switches"]):
        watched = hy.par[
            len(names) + i
        ]  # 1 where it can fire, else the surface is the constant 1
        surface = (
            watched * symbols.function(switch["when"], constants)(hy.time, y)
            + 1.0
            - watched
        )
        events.append(hy.t_event(surface, direction=hy.event_direction.negative))
    equations = [(a, hy.expression(b)) for a, b in zip(y, rates, strict=True)]
    integrator = hy.taylor_adaptive(equations, problem.start, tol=tol, t_events=events)

    def advance(problem: Problem, regime: str, watched: Any, t: float, y: Any) -> Any:
        can_fire = [float(switch in watched) for switch in problem.switches]
        integrator.pars[:] = [
            problem.regimes[regime][name] for name in names
        ] + can_fire
        integrator.state[:] = y
        outcome, *_, steps = integrator.propagate_until(problem.t_end)[:4]
        problem.calls += steps * (integrator.order + 1)
        if outcome == hy.taylor_outcome.time_limit:
            return problem.t_end, integrator.state, None
        if not 0 < -outcome.value <= len(events):
            raise RuntimeError(outcome)
        hit = watched.index(problem.switches[-outcome.value - 1])
        return integrator.time, integrator.state.copy(), hit

    return run(problem, advance)
