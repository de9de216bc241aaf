"""A problem's texts as a ``System``."""

from typing import Any

from squealpipe.benchmark.problems import FORMULA_FUNCTIONS, Problem
from squealpipe.systems import functions
from squealpipe.systems.components import Switch
from squealpipe.systems.system import System


def system_of(problem: Problem) -> System:
    """A system with the equations of a problem."""
    data = problem.data

    def made(text: Any) -> Any:
        if isinstance(text, dict):
            parts = {name: made(each) for name, each in text.items()}
            return lambda *args: {name: part(*args) for name, part in parts.items()}
        code = compile(text, problem.name, "eval")
        known = {name: getattr(functions, name) for name in FORMULA_FUNCTIONS}
        return lambda t, s, p, r: eval(  # noqa: S307 (equations of this package)
            code, {**known, "time": t, **vars(s), **vars(p), **vars(r)}
        )

    return System(
        problem.name,
        states=dict.fromkeys(problem.states, "1"),
        parameters=problem.parameters,
        regimes=problem.regimes,
        field=made(data["field"]),
        switches=[
            Switch(
                s["name"],
                s["leaves"],
                made(s["when"]),
                [(regime, made(c) if c else None, kind) for regime, c, kind in s["to"]],
                made(s["reset"]),
            )
            for s in data["switches"]
        ],
        start={**data["start"], "regime": problem.regime},
    )
