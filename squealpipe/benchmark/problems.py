"""A benchmark problem as plain data, and the Python functions generated from its equations."""

import json
import math
from collections.abc import Callable, Mapping
from copy import deepcopy
from functools import cache
from importlib.resources import files
from types import CodeType
from typing import Any, NamedTuple

import yaml

INPUT_FILES = ("problems.yaml", "references.json")
"""Read below: every result that uses this module depends on them."""
FORMULA_FUNCTIONS = ("cos", "sin", "exp", "log", "tanh")


class OutOfPatienceError(RuntimeError):
    """A solver has called the field more often than a problem allows."""


class Transition(NamedTuple):
    """End of a regime: a surface, and the reset where it falls through zero.

    Attributes:
        when: (t, y, regime) → the surface's value.
        fire: (t, y, regime) → kind of the event, next regime, state after it.
    """

    name: str
    leaves: tuple[str, ...]
    when: Callable[[Any, Any, str], Any]
    fire: Callable[[Any, Any, str], tuple[str, str, list[Any]]]

    def event(self, regime: str) -> Callable[[float, Any], float]:
        """The surface in a regime as scipy takes it: it stops the run where it falls."""

        def watched(t: float, y: Any) -> float:
            return float(self.when(t, y.tolist(), regime))

        watched.terminal, watched.direction = True, -1  # type: ignore[attr-defined]
        return watched


class Problem:
    """A problem that a solver is asked: where does this motion lead, and by which events?

    Args:
        data: one entry of ``problems.yaml``.
        functions: module or object with cos, sin, exp, log and tanh: math, mpmath.mp, jax.numpy, …
        number: what parameters become: float, mpmath.mpf, …

    Attributes:
        start: values of the states at t = 0; ``regime``: the regime there.
        t_end: end of the run; ``times``: instants at which output is asked on the way.
        derivative: None, or the event's number (from 0) and the parameter by which the derivative
            of its time is asked.
        rates: texts of the field; ``fields``: what they became, by the regime.
        calls: how often the field was called.
    """

    def __init__(
        self,
        data: Mapping[str, Any],
        functions: Any = math,
        number: Callable[[Any], Any] = float,
    ) -> None:
        self.data = data
        self.name, self.group = data["name"], data["class"]
        self.purpose = data["purpose"]
        self.states, self.regime = list(data["start"]), data["regime"]
        self.start = [number(value) for value in data["start"].values()]
        self.t_end = number(data["t_end"])
        self.times = [number(t) for t in data["times"]]
        self.parameters = {
            name: number(value) for name, value in data["parameters"].items()
        }
        self.regimes: dict[str, dict[str, float]] = data["regimes"]
        self.derivative = data.get("derivative")
        # after so many calls of the field a solver is stopped; its answer then counts as flagged
        self.calls, self.patience = 0, 200_000
        self._names = {
            name: getattr(functions, name) for name in FORMULA_FUNCTIONS
        } | self.parameters
        self.rates = list(data["field"].values())
        self.fields = self.per_regime(self.rates)
        self.switches = [self._transition(switch) for switch in data["switches"]]

    def field(self, t: Any, y: Any, regime: str = "") -> Any:
        """Rates of all states in a regime, by default that of the start.

        Raises:
            OutOfPatienceError: the calls are used up.
        """
        self.calls += 1
        if self.calls > self.patience:
            raise OutOfPatienceError(f"gave up after {self.patience} evaluations")
        return self.fields[regime or self.regime](t, y)

    def function(self, texts: Any, constants: Mapping[str, Any]) -> Any:
        """A Python function (t, y) of one text, or of a list; constants may be texts, too."""
        body = texts if isinstance(texts, str) else f"[{', '.join(texts)}]"
        lines = [f"{', '.join(self.states)}, = y"]
        lines += [
            f"{name} = {text}"
            for name, text in constants.items()
            if isinstance(text, str)
        ]
        source = "\n ".join(["def made(time, y):", *lines, f"return {body}"])
        scope = {**self._names, **constants}
        exec(_code(source), scope)  # noqa: S102 (equations of this package)
        return scope["made"]

    def per_regime(self, texts: Any) -> dict[str, Callable[[Any, Any], Any]]:
        """Return the texts with the constants of each regime inserted."""
        return {
            name: self.function(texts, constants)
            for name, constants in self.regimes.items()
        }

    def _transition(self, data: Mapping[str, Any]) -> Transition:
        leaves = tuple(data["leaves"])
        when = self.per_regime(data["when"])
        resets = self.per_regime(list(data["reset"].values()))
        places = [self.states.index(name) for name in data["reset"]]
        targets = [
            (regime, None if text is None else self.per_regime(text), kind)
            for regime, text, kind in data["to"]
        ]

        def fire(t: Any, y: Any, regime: str) -> tuple[str, str, list[Any]]:
            after = [*y]
            for place, value in zip(places, resets[regime](t, y), strict=True):
                after[place] = value
            for target, condition, kind in targets:
                if condition is None or condition[regime](t, y) >= 0:
                    return kind, target, after
            raise AssertionError(data["name"])

        return Transition(
            data["name"], leaves, lambda t, y, regime: when[regime](t, y), fire
        )

    def times_after(self, t: Any) -> list[Any]:
        """Times still to be reached: those at which the state is asked, and the end."""
        return [*(time for time in self.times if time > t), self.t_end]

    def watched(self, regime: str) -> list[Transition]:
        """The switches that can fire in a regime."""
        return [switch for switch in self.switches if regime in switch.leaves]


@cache
def _code(source: str) -> CodeType:
    return compile(source, "<equations>", "exec")


@cache
def _entries() -> Any:
    text = (files("squealpipe.benchmark") / "problems.yaml").read_text("utf-8")
    return yaml.safe_load(text)


def all_data() -> list[dict[str, Any]]:
    """The entries of ``problems.yaml``, each with the equations of its system."""
    entries = deepcopy(_entries())
    named = {entry["name"]: entry for entry in entries}
    # what makes a system; a problem may take them from an earlier one, its ``system``
    shared = {
        name: {
            key: e[key]
            for key in ("regimes", "field", "switches", "smoothed", "stepping")
            if key in e
        }
        for name, e in named.items()
    }
    return [shared.get(entry.get("system"), {}) | entry for entry in entries]


def references() -> dict[str, dict[str, Any]]:
    """Final state, events, growth and margin by the problem's name, from ``references.json``.

    A copy, so that nothing that is done to it changes what answers are held against.
    """
    by_problem: dict[str, dict[str, Any]] = json.loads(_references())
    return by_problem


@cache
def _references() -> str:
    return (files("squealpipe.benchmark") / "references.json").read_text("utf-8")


def run(problem: Problem, advance: Callable[..., Any], most_events: int = 2000) -> Any:
    """Drive a solver that stops at events: restart it after each, in the regime that follows.

    Args:
        advance: (problem, regime, surfaces, t, y) → the time and state at which it stopped, and
            the number of the surface that fired, None at ``t_end``.

    Returns:
        Times, kinds, final state, evaluations.

    Raises:
        OutOfPatienceError: there are more events.
    """
    t, y, regime = 0.0, problem.start, problem.regime
    times: list[float] = []
    kinds: list[str] = []
    while len(times) < most_events:
        watched = problem.watched(regime)
        t, y, fired = advance(problem, regime, watched, t, y)
        if fired is None:
            return times, kinds, list(y), problem.calls
        kind, regime, y = watched[fired].fire(t, [*map(float, y)], regime)
        times.append(float(t))
        kinds.append(kind)
    raise OutOfPatienceError(f"gave up after {most_events} events")
