"""Our own engine: the problem's texts become a ``System``, run with its predictability horizon."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from squealpipe import functions
from squealpipe.benchmark.problem import FUNCTIONS, Problem
from squealpipe.schema import Outcome
from squealpipe.systems.runs import integrate
from squealpipe.systems.system import Switch, System

_KNOWN: dict[str, System] = {}
MOST_EVENTS = 1000


def system_of(problem: Problem) -> System:
    """A system with the equations of a problem."""
    data = problem.data

    def made(text: Any) -> Any:
        if isinstance(text, dict):
            parts = {name: made(each) for name, each in text.items()}
            return lambda *args: {name: part(*args) for name, part in parts.items()}
        code = compile(text, problem.name, "eval")
        known = {name: getattr(functions, name) for name in FUNCTIONS}
        return partial(_value, code, known)

    return System(
        problem.name,
        states=dict.fromkeys(problem.states, "1"),
        parameters=problem.parameters,
        regimes=problem.regimes,
        field=made(data["field"]),
        switches=[
            Switch(
                s["name"], s["leaves"], made(s["when"]),
                [(regime, made(c) if c else None, kind) for regime, c, kind in s["to"]],
                made(s["reset"]),
            )
            for s in data["switches"]
        ],
        start={**data["start"], "regime": problem.regime},
    )  # fmt: skip


def _value(code: Any, known: Any, t: Any, s: Any, p: Any, r: Any) -> Any:
    return eval(code, {**known, "time": t, **vars(s), **vars(p), **vars(r)})  # noqa: S307


def solve(problem: Problem, tol: float) -> Any:
    """Times, kinds, state, evaluations, flag; a Taylor step of order p counts p + 1."""
    system = _KNOWN.setdefault(problem.name, system_of(problem))
    values = {
        name: np.array([value])
        for name, value in {**system.parameters, **problem.data["start"]}.items()
    }
    raw = integrate(
        system, values, np.array([problem.t_end]), times=np.array(problem.times), tol=tol,
        tangent=True, log_events=MOST_EVENTS, workers=1,
    )  # fmt: skip
    outcome, _, steps, count = raw["ends"][0]
    flag = "" if outcome == Outcome.converged else Outcome(outcome).name
    if np.isfinite(raw["summary"][0, 1]):
        flag = "beyond the horizon of predictability"
    kinds = [system.traced.kinds[kind] for kind in raw["event_kinds"][0, :count]]
    evaluations = int(steps) * (math.ceil(1.0 - 0.5 * math.log(tol)) + 1)
    return (
        raw["event_times"][0, :count].tolist(),
        kinds,
        raw["final"][0].tolist(),
        evaluations,
        flag,
    )
