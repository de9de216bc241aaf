"""Hard scenes of A1 in time, each asked of our engine and of public integrators."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.methods.hybrid import HybridRun
from squealpipe.models.a1_automaton import EventKind
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.comparison import Role
from squealpipe.tasks.ensemble import run_ensemble
from squealpipe.tasks.failure_verdicts import Answer, HardScene, Method
from squealpipe.tasks.peers import simulate_moreau_jean, simulate_regularized, simulate_scipy
from squealpipe.tasks.reference import simulate_reference
from squealpipe.tasks.speed_accuracy_integration import DEFAULT_TOLERANCE

OURS = "Taylor + events"
TOLERANCE = 1e-3
"""Largest error of the final state that counts as right, in l_pre and l_pre √(k1/m)."""
PUBLIC_TOLERANCE, IMPLICIT_TOLERANCE = 1e-8, 1e-6
STEP, SIGMA = 1e-3, 1e3
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


def time_methods(solvers: Sequence[str]) -> list[Method]:
    """Rows of the atlas in time: ours, ``solve_ivp`` with events, and two without."""
    public = [*(f"{solver} + events" for solver in solvers), "LSODA, tanh", "Moreau–Jean"]
    return [Method(OURS, Role.ours), *map(Method, public)]


def cases(chaotic_horizon: float, beyond_horizon: float) -> list[Case]:
    """The hard scenes at the baseline, in units of m = k1 = l_pre = 1."""
    base = Parameters()
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
    solvers: Sequence[str], chaotic_horizon: float, beyond_horizon: float
) -> list[HardScene]:
    """All scenes with their truth in long double, and both smoothings of the tanh laws."""
    hard = [_scene(case, solvers) for case in cases(chaotic_horizon, beyond_horizon)]
    return hard + _smoothing_scenes()


def _scene(case: Case, solvers: Sequence[str]) -> HardScene:
    reference = simulate_reference(**case.arguments)
    public: dict[str, Callable[[], HybridRun]] = {
        f"{method} + events": lambda method=method: simulate_scipy(  # type: ignore[misc]
            **case.arguments,
            method=method,
            tol=IMPLICIT_TOLERANCE if method == "Radau" else PUBLIC_TOLERANCE,
        )
        for method in solvers
    }
    public["LSODA, tanh"] = lambda: simulate_regularized(
        **case.arguments, method="LSODA", tol=PUBLIC_TOLERANCE, sigma=SIGMA
    )
    public["Moreau–Jean"] = lambda: simulate_moreau_jean(**case.arguments, step=STEP)
    return HardScene(
        name=case.name,
        truth=_observed(reference),
        tolerance=TOLERANCE,
        answers={
            OURS: lambda: _ours(case),
            **{
                name: (lambda run=run: _answer(run(), reference))  # type: ignore[misc]
                for name, run in public.items()
            },
        },
    )


def _observed(run: HybridRun) -> np.ndarray:
    """Final state and number of contact changes."""
    changes = sum(kind in (EventKind.separation, EventKind.contact) for kind in run.event_kinds)
    return np.array([*map(float, run.state), changes])


def _answer(run: HybridRun, reference: HybridRun) -> Answer:
    """A method without events is not asked for them."""
    value = _observed(run)
    if not run.reports_events:
        value[-1] = _observed(reference)[-1]
    return Answer(value, run.message)


def _ours(case: Case) -> Answer:
    """Our engine with its predictability horizon, as ``hammering_map`` uses it."""
    arguments = case.arguments
    found = run_ensemble(
        arguments.pop("params"),
        arguments.pop("alpha1"),
        arguments.pop("alpha2"),
        **arguments,
        tol=DEFAULT_TOLERANCE,
        tangent=True,
        workers=1,
    )
    outcome = Outcome(int(found.outcome))
    flag = "" if outcome == Outcome.converged else outcome.name
    if np.isfinite(found.predictability_horizon):
        flag = Outcome.beyond_horizon.name
    changes = int(found.separations + found.contacts)
    return Answer(np.array([*found.final_state, changes]), flag)


def _smoothing_scenes() -> list[HardScene]:
    """Stick–slip with tanh laws that are too wide, and too steep for the tolerance."""
    case = Case("stick release", Parameters(belt_speed=0.05), 0.3, 0.9, 10.0)
    reference = simulate_reference(**case.arguments)

    def smoothed(method: str, sigma: float, tol: float) -> Callable[[], Answer]:
        return lambda: _answer(
            simulate_regularized(**case.arguments, method=method, tol=tol, sigma=sigma), reference
        )

    return [
        HardScene(
            name=name,
            truth=_observed(reference),
            tolerance=TOLERANCE,
            answers={OURS: lambda: _ours(case), "LSODA, tanh": smoothed("LSODA", sigma, tol)},
        )
        for name, sigma, tol in (("σ too small", 10.0, 1e-8), ("σ too large", 1e7, 1e-4))
    ]
