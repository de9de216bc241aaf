"""Hard scenes of A1 in time, each asked of our engine and of public integrators."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from squealpipe.methods.hybrid import HybridRun
from squealpipe.models.a1_automaton import EventKind
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.comparison import Role
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.solvers.a1.peers import simulate_moreau_jean, simulate_regularized, simulate_scipy
from squealpipe.solvers.a1.reference import simulate_reference
from squealpipe.tasks.comparison.failures.verdicts import BASE, Answer, HardScene, Method
from squealpipe.tasks.comparison.work_precision.integration import contact_changes

OURS = "Taylor + events"
TOLERANCE = 1e-3
"""Largest error of the final state that counts as right, in l_pre and l_pre √(k1/m)."""
TOLERANCES = (1e-8, 1e-10, 1e-12)
"""Given to every method alike; the last is that of our maps."""
STEP, SIGMA = 1e-3, 1e3
TANH, STEPPING = "LSODA, tanh", f"Moreau–Jean, h = {STEP:g}"
PATIENCE = 30.0
"""Longest run that Radau is asked for, √(m/k1): longer ones take it minutes."""
_GRAZING_DEPTH = 1e-8
"""Share by which k3 exceeds the value at which the mass just takes off."""


@dataclass(frozen=True)
class Case:
    """Arguments of one run; lengths in l_pre, times in √(m/k1)."""

    name: str
    params: Parameters
    alpha1_over_pi: float
    alpha2_over_pi: float
    t_end: float
    initial_state: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @property
    def arguments(self) -> dict[str, Any]:
        """As all integrators take them."""
        return {
            "params": self.params,
            "alpha1": self.alpha1_over_pi * math.pi,
            "alpha2": self.alpha2_over_pi * math.pi,
            "t_end": self.t_end,
            "initial_state": self.initial_state,
        }


def setting(method: str, tolerance: float) -> str:
    """Name of a method at a tolerance, for instance ``DOP853 + events, 1e-8``."""
    return f"{method}, {np.format_float_scientific(tolerance, trim='-', exp_digits=1)}"


def time_methods(solvers: Sequence[str], tolerances: Sequence[float]) -> list[Method]:
    """Rows of the atlas in time: ours, ``solve_ivp`` with events, and two without."""
    public = [*(f"{solver} + events" for solver in solvers), TANH]
    return [
        *(Method(setting(OURS, tol), Role.ours, tol) for tol in tolerances),
        *(Method(setting(name, tol), requested=tol) for name in public for tol in tolerances),
        Method(STEPPING),
    ]


def cases(chaotic_horizon: float, beyond_horizon: float) -> list[Case]:
    """The hard scenes, in units of m = k1 = l_pre = 1."""
    base = BASE
    pivot = (base.length1 * math.cos(math.pi / 3), base.length1 * math.sin(math.pi / 3))
    return [
        Case("grazing contact", base.with_(k3=_grazing_k3(base)), 0.5, 1.0, 4.0),
        Case("separation in stick", base.with_(belt_speed=0.0), 1.0, 1.0, 20.0),
        Case("stick release", base.with_(belt_speed=0.05), 0.3, 0.9, 30.0),
        Case(
            "simultaneous events", base.with_(belt_speed=0.5), 0.3, 0.9, 20.0, (0.0, 1.0, 0.5, -0.5)
        ),
        Case(
            "near-pivot passage", base, 1 / 3, 0.9, 2.0,
            (pivot[0] - 4.0, pivot[1] + 1e-9, 8.0, 0.0),
        ),
        Case("very stiff contact", base.with_(k3=1e6), 0.5, 1.0, 20.0, (0.0, 1.1, 0.0, 0.0)),
        Case("chaotic hammering", base, 0.2, 0.8, chaotic_horizon),
        Case("T beyond the horizon", base, 0.2, 0.8, beyond_horizon),
    ]  # fmt: skip


def _grazing_k3(base: Parameters) -> float:
    """Contact stiffness at which the mass takes off by a hair at its first peak, by bisection."""
    keeps, loses = 0.5, 1.5
    while loses - keeps > 4e-16:
        middle = 0.5 * (keeps + loses)
        if middle in (keeps, loses):
            break
        run = simulate_reference(
            base.with_(k3=middle), 0.5 * math.pi, math.pi, t_end=4.0, stop_at=EventKind.separation
        )
        keeps, loses = (keeps, middle) if run.event_times else (middle, loses)
    return loses * (1.0 + _GRAZING_DEPTH)


def scenes(
    solvers: Sequence[str],
    tolerances: Sequence[float],
    chaotic_horizon: float,
    beyond_horizon: float,
) -> list[HardScene]:
    """All scenes with their truth in long double, and both smoothings of the tanh laws."""
    hard = [_scene(case, solvers, tolerances) for case in cases(chaotic_horizon, beyond_horizon)]
    return hard + _smoothing_scenes(tolerances)


def _scene(case: Case, solvers: Sequence[str], tolerances: Sequence[float]) -> HardScene:
    reference = simulate_reference(**case.arguments)

    def ours(tol: float) -> Answer:
        return _ours(case, tol, reference)

    def located(method: str, tol: float) -> Answer:
        return _answer(simulate_scipy(**case.arguments, method=method, tol=tol), reference)

    def smoothed(tol: float) -> Answer:
        run = simulate_regularized(**case.arguments, method="LSODA", tol=tol, sigma=SIGMA)
        return _answer(run, reference)

    def stepped() -> Answer:
        return _answer(simulate_moreau_jean(**case.arguments, step=STEP), reference)

    answers: dict[str, Callable[[], Answer]] = {STEPPING: stepped}
    for tol in tolerances:
        answers[setting(OURS, tol)] = partial(ours, tol)
        answers[setting(TANH, tol)] = partial(smoothed, tol)
        for method in solvers:
            if method != "Radau" or case.t_end <= PATIENCE:
                answers[setting(f"{method} + events", tol)] = partial(located, method, tol)
    return HardScene(case.name, _state(reference), TOLERANCE, answers)


def _state(run: HybridRun) -> np.ndarray:
    return np.array([*map(float, run.state)])


def _answer(run: HybridRun, reference: HybridRun) -> Answer:
    """A method without events is not asked for them."""
    missed = abs(contact_changes(run) - contact_changes(reference)) if run.reports_events else None
    return Answer(_state(run), run.message, missed)


def _ours(case: Case, tol: float, reference: HybridRun) -> Answer:
    """Our engine with its predictability horizon, as ``hammering_map`` uses it."""
    arguments = case.arguments
    found = run_ensemble(
        arguments.pop("params"),
        arguments.pop("alpha1"),
        arguments.pop("alpha2"),
        **arguments,
        tol=tol,
        tangent=True,
        workers=1,
    )
    outcome = Outcome(int(found.outcome))
    flag = "" if outcome == Outcome.converged else outcome.name
    if np.isfinite(found.predictability_horizon):
        flag = Outcome.beyond_horizon.name
    missed = abs(int(found.separations + found.contacts) - contact_changes(reference))
    return Answer(np.array(found.final_state), flag, missed)


def _smoothing_scenes(tolerances: Sequence[float]) -> list[HardScene]:
    """Stick–slip with tanh laws that are too wide, and too steep for the tolerance."""
    case = Case("stick release", Parameters(belt_speed=0.05), 0.3, 0.9, 10.0)
    reference = simulate_reference(**case.arguments)

    def ours(tol: float) -> Answer:
        return _ours(case, tol, reference)

    def smoothed(sigma: float, tol: float) -> Answer:
        run = simulate_regularized(**case.arguments, method="LSODA", tol=tol, sigma=sigma)
        return _answer(run, reference)

    return [
        HardScene(
            name=name,
            truth=_state(reference),
            tolerance=TOLERANCE,
            answers={
                **{setting(OURS, tol): partial(ours, tol) for tol in tolerances},
                **{setting(TANH, tol): partial(smoothed, sigma, tol) for tol in tolerances},
            },
        )
        for name, sigma in (("σ = 10/m", 10.0), ("σ = 10⁷/m", 1e7))
    ]
