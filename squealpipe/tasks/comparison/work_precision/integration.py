"""Work–precision of the time integration of A1: our engine beside public methods."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
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
from squealpipe.tasks.comparison.work_precision.solutions import Solution, timed

TASK = "integration"
REFERENCE_ERROR = 1e-16
"""Long double, tolerance 1e-19, outside chaos."""
DEFAULT_TOLERANCE = 1e-12
"""The tolerance that our tasks use unless given otherwise."""
ENSEMBLE = 64
"""Runs of the ensemble whose time per run is quoted."""
_STIFF_LIMIT = 1e-8
"""Implicit Runge–Kutta of order 5 below this tolerance takes seconds a run."""


@dataclass(frozen=True)
class IntegrationScene:
    """A scene with its angles over π and its belt speed over l_pre √(k1/m)."""

    name: str
    alpha1_over_pi: float
    alpha2_over_pi: float
    speed_ratio: float

    def arguments(self, params: Parameters) -> dict[str, Any]:
        """Arguments of the integrators."""
        speed = self.speed_ratio * params.preload / params.time_unit
        return {
            "params": params.with_(belt_speed=speed),
            "alpha1": self.alpha1_over_pi * math.pi,
            "alpha2": self.alpha2_over_pi * math.pi,
        }


SCENES = (
    IntegrationScene("smooth", 0.5, 1.0, 100.0),
    IntegrationScene("hammering", 1.0, 1.0, 100.0),
    IntegrationScene("stick-slip", 0.3, 0.9, 0.05),
    IntegrationScene("whirl", 0.4, 0.6, 100.0),
)


def solutions(
    params: Parameters,
    *,
    horizon: float,
    solvers: Sequence[str],
    tolerances: Sequence[float],
    steps: Sequence[float],
    sigmas: Sequence[float],
    repeats: int,
) -> Iterator[Solution]:
    """All methods at all settings on the four scenes.

    Args:
        params: physical parameters; each scene sets its own belt speed.
        horizon: end of the runs, in units of √(m/k1).
        solvers: methods of ``solve_ivp`` to compare with.
        tolerances: of the adaptive methods.
        steps: of Moreau–Jean stepping, in units of √(m/k1).
        sigmas: of the regularized laws, times l_pre.
        repeats: runs of which the median time is taken.
    """
    t_end = horizon * params.time_unit
    for scene in SCENES:
        arguments = scene.arguments(params)
        reference = simulate_reference(**arguments, t_end=t_end)
        runs = {
            **_ours(arguments, t_end, tolerances),
            **_public(arguments, t_end, params, solvers, tolerances, steps, sigmas),
        }
        for (method, setting, role), (run, divisor) in runs.items():
            found, seconds = timed(run, repeats)
            yield Solution(
                task=TASK,
                scene=scene.name,
                method=method,
                setting=setting,
                role=role,
                error=state_distance(found.state, reference.state, params),
                wall_time=seconds / divisor,
                evaluations=found.evaluations / divisor,
                reference_error=REFERENCE_ERROR,
                wrong_events=_wrong_contacts(found, reference),
                outcome=Outcome.no_convergence if found.message else Outcome.converged,
            )


def state_distance(state: Any, reference: Any, params: Parameters) -> float:
    """Largest difference of two states, in units of l_pre and l_pre √(k1/m)."""
    scale = params.preload * np.array([1.0, 1.0, *[1.0 / params.time_unit] * 2])
    return float(np.max(np.abs((np.asarray(state) - reference) / scale)))


def taylor_evaluations(steps: float, tol: float) -> float:
    """Taylor steps as evaluations of the field: p + 1 per step, order p = 1 − ½ ln tol."""
    return steps * (math.ceil(1.0 - 0.5 * math.log(tol)) + 1)


def engine_run(arguments: Mapping[str, Any], t_end: float, tol: float, size: int = 1) -> HybridRun:
    """``size`` equal runs of our engine; state and contact changes of the first."""
    found = run_ensemble(
        arguments["params"],
        np.full(size, arguments["alpha1"]),
        arguments["alpha2"],
        t_end=t_end,
        tol=tol,
        initial_state=arguments.get("initial_state", (0.0, 0.0, 0.0, 0.0)),
        workers=1,
    )
    outcome = Outcome(int(found.outcome[0]))
    return HybridRun(
        found.final_state[0],
        time=float(found.time[0]),
        event_kinds=[EventKind.separation] * int(found.separations[0] + found.contacts[0]),
        evaluations=int(taylor_evaluations(float(found.steps.sum()), tol)),
        message="" if outcome == Outcome.converged else outcome.name,
    )


_Runs = dict[tuple[str, str, Role], tuple[Callable[[], HybridRun], int]]


def _ours(arguments: Mapping[str, Any], t_end: float, tolerances: Sequence[float]) -> _Runs:
    runs: _Runs = {}
    for tol in sorted({*tolerances, DEFAULT_TOLERANCE}):
        role = Role.our_setting if tol == DEFAULT_TOLERANCE else Role.ours
        engine_run(arguments, 0.01 * t_end, tol)  # compiles or loads before any stopwatch runs
        for name, size in (
            ("Taylor + events, one run", 1),
            ("Taylor + events, ensemble", ENSEMBLE),
        ):
            runs[name, f"tol {tol:g}", role] = (
                lambda tol=tol, size=size: engine_run(arguments, t_end, tol, size),  # type: ignore[misc]
                size,
            )
    return runs


def _public(
    arguments: Mapping[str, Any],
    t_end: float,
    params: Parameters,
    solvers: Sequence[str],
    tolerances: Sequence[float],
    steps: Sequence[float],
    sigmas: Sequence[float],
) -> _Runs:
    runs: _Runs = {}
    public = Role.public
    for method in solvers:
        for tol in tolerances:
            if method == "Radau" and tol < _STIFF_LIMIT:
                continue
            runs[f"{method} + events", f"tol {tol:g}", public] = (
                lambda method=method, tol=tol: simulate_scipy(  # type: ignore[misc]
                    **arguments, t_end=t_end, method=method, tol=tol
                ),
                1,
            )
    for method in ("RK45", "LSODA"):
        for sigma in sigmas:
            runs[f"{method}, tanh", f"sigma {sigma:g}", public] = (
                lambda method=method, sigma=sigma: simulate_regularized(  # type: ignore[misc]
                    **arguments, t_end=t_end, method=method, tol=1e-7, sigma=sigma / params.preload
                ),
                1,
            )
    for step in steps:
        runs["Moreau–Jean", f"h {step:g}", public] = (
            lambda step=step: simulate_moreau_jean(  # type: ignore[misc]
                **arguments, t_end=t_end, step=step * params.time_unit
            ),
            1,
        )
    return runs


def _wrong_contacts(found: HybridRun, reference: HybridRun) -> int:
    """Contact changes too many or too few; −1 for methods that report none."""
    if not found.reports_events:
        return -1
    return abs(contact_changes(found) - contact_changes(reference))


def contact_changes(run: HybridRun) -> int:
    """Number of losses and returns of contact."""
    return sum(kind in (EventKind.separation, EventKind.contact) for kind in run.event_kinds)
