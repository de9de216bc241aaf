"""Work–precision of the validity map: which tolerance, horizon and grid decide a cell rightly."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.comparison import Role
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.solvers.a1.peers import simulate_moreau_jean
from squealpipe.tasks.comparison.work_precision.integration import (
    DEFAULT_TOLERANCE,
    taylor_evaluations,
)
from squealpipe.tasks.comparison.work_precision.solutions import Solution

TASK = "validity"
HORIZON = 200.0
"""Our default horizon of the map, √(m/k1)."""
REFERENCE_TOLERANCE = 1e-15


def solutions(
    params: Parameters,
    *,
    points: int,
    fine_points: int,
    tolerances: Sequence[float],
    horizons: Sequence[float],
    steps: Sequence[float],
) -> Iterator[Solution]:
    """Maps of lost contact at all settings, each judged by a finer one.

    Args:
        params: physical parameters.
        points: grid of the maps over tolerance, horizon and step.
        fine_points: grid of the reference for coarser grids; one more than a multiple of
            ``points`` − 1 keeps the coarse cells on it.
        tolerances: of the Taylor integrator.
        horizons: in units of √(m/k1); the last is the reference's.
        steps: of Moreau–Jean stepping, in units of √(m/k1).
    """
    longest = max(*horizons, HORIZON)
    reference, _ = _separates(params, points, longest, REFERENCE_TOLERANCE)
    at_horizon, _ = _separates(params, points, HORIZON, REFERENCE_TOLERANCE)
    for tol in tolerances:
        yield _judged(params, points, HORIZON, tol, at_horizon, "tolerance", f"tol {tol:g}")
    for horizon in horizons:
        yield _judged(
            params, points, horizon, DEFAULT_TOLERANCE, reference, "horizon", f"T {horizon:g}"
        )
    fine, _ = _separates(params, fine_points, HORIZON, DEFAULT_TOLERANCE)
    for count in sorted({(points - 1) // 4 + 1, (points - 1) // 2 + 1, points}):
        yield _judged(params, count, HORIZON, DEFAULT_TOLERANCE, fine, "grid", f"{count} × {count}")
    for step in steps:
        yield _moreau_jean(params, points, step, at_horizon)


def _separates(
    params: Parameters, points: int, horizon: float, tol: float
) -> tuple[np.ndarray, float]:
    """Map of lost contact, and the integration steps that it took."""
    angles = np.linspace(0.0, np.pi, points)
    found = run_ensemble(
        params,
        angles[:, None],
        angles[None, :],
        t_end=horizon * params.time_unit,
        tol=tol,
        stop_at_first_separation=True,
    )
    return found.outcome == Outcome.separated, float(found.steps.sum())


def _judged(
    params: Parameters,
    points: int,
    horizon: float,
    tol: float,
    reference: np.ndarray,
    scene: str,
    setting: str,
) -> Solution:
    _separates(params, 3, 1.0, tol)  # compile outside the clock
    started = time.perf_counter()
    found, steps = _separates(params, points, horizon, tol)
    seconds = time.perf_counter() - started
    default = tol == DEFAULT_TOLERANCE and horizon == HORIZON and scene != "grid"
    return _solution(
        found, reference, scene, "Taylor + events, ensemble", setting,
        Role.our_setting if default else Role.ours, seconds, taylor_evaluations(steps, tol),
    )  # fmt: skip


def _moreau_jean(params: Parameters, points: int, step: float, reference: np.ndarray) -> Solution:
    angles = np.linspace(0.0, np.pi, points)
    arguments: dict[str, Any] = {
        "t_end": HORIZON * params.time_unit,
        "step": step * params.time_unit,
        "stop_at_switch": True,
    }
    started = time.perf_counter()
    runs = [
        simulate_moreau_jean(params, alpha1, alpha2, **arguments)
        for alpha1 in angles
        for alpha2 in angles
    ]
    seconds = time.perf_counter() - started
    found = np.array([bool(run.event_kinds) for run in runs]).reshape(points, points)
    return _solution(
        found, reference, "tolerance", "Moreau–Jean", f"h {step:g}", Role.public, seconds,
        float(sum(run.evaluations for run in runs)),
    )  # fmt: skip


def _solution(
    found: np.ndarray,
    reference: np.ndarray,
    scene: str,
    method: str,
    setting: str,
    role: Role,
    seconds: float,
    evaluations: float,
) -> Solution:
    shown = on_grid(found, len(reference))
    wrong = shown != reference
    return Solution(
        task=TASK,
        scene=scene,
        method=method,
        setting=setting,
        role=role,
        error=float(wrong.mean()),
        wall_time=seconds,
        evaluations=evaluations,
        reference_error=0.5 / reference.size,
        wrong_events=int(wrong.sum()),
        boundary_distance=boundary_distance(shown, reference) * np.pi / (len(reference) - 1),
    )


def on_grid(coarse: np.ndarray, points: int) -> np.ndarray:
    """A square map shown on a finer grid by its nearest cell."""
    nearest = np.rint(np.linspace(0, len(coarse) - 1, points)).astype(int)
    return np.asarray(coarse[np.ix_(nearest, nearest)])


def boundary_distance(found: np.ndarray, reference: np.ndarray) -> float:
    """Mean distance of the boundary cells of two maps, both ways, in cells."""
    edges = [_boundary(image) for image in (found, reference)]
    if not all(edge.any() for edge in edges):
        return 0.0 if edges[0].any() == edges[1].any() else float(len(reference))
    ways = [
        ndimage.distance_transform_edt(~there)[here].mean() for here, there in (edges, edges[::-1])
    ]
    return float(0.5 * sum(ways))


def _boundary(image: np.ndarray) -> np.ndarray:
    """Cells of the region that touch its outside."""
    return np.asarray(image & ~ndimage.binary_erosion(image, border_value=1))
