"""Backbones of model A4: exact, or by harmonic balance and judged by the exact orbits."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.methods.orbits import (
    Orbit,
    TraceEnd,
    decoupled_half_period,
    solve_orbit,
    trace_branch,
)
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.backbones import BACKBONE
from squealpipe.tasks.a4_system import ScaledSystem, scaled_system
from squealpipe.tasks.orbits import (
    check_length,
    check_mode,
    grazing_start,
    linear_orbit,
    orbit_values,
)

BRANCH_ENDS = {
    TraceEnd.reached: Outcome.amplitude_reached,
    TraceEnd.returned: Outcome.retraced,
    TraceEnd.tongue_end: Outcome.tongue_end,
    TraceEnd.lost: Outcome.branch_lost,
    TraceEnd.step_limit: Outcome.step_limit,
}
"""Outcome of a branch that was followed upwards."""

LINEAR_POINTS = 6
"""Points on the linear mode, from rest to grazing, with which a backbone begins."""
_LONGEST_STEP = 0.04


def backbone(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    *,
    mode: int,
    y_peak_max: float | None = None,
    x_amplitude_max: float | None = None,
    method: Literal["exact", "hbm"] = "exact",
    n_harmonics: int = 16,
    n_time: int | None = None,
    sigma: float | None = None,
    cross_poles: bool = False,
) -> xr.Dataset:
    """The family of periodic motions that grows out of a linear mode of model A4.

    Args:
        params: physical parameters; the belt moves along +x.
        alpha1, alpha2: angles, rad.
        mode: 1 or 2, by ascending ω of the contact state.
        y_peak_max: peak at which the branch ends, m; 3 l_pre by default.
        x_amplitude_max: amplitude at which the vertical branch of an isolated x mode
            (K12 = 0) ends, m; 3 l_pre by default.
        method: ``"exact"`` or ``"hbm"`` (symmetric cosine series).
        n_harmonics: harmonics of the series.
        n_time: samples a period of the contact force; None: contact integrals in closed form.
        sigma: regularizing factor of the contact law, 1/m; None: the sharp law.
        cross_poles: go on beyond internal resonances ω = ω_x/n where K12 = 0.

    Returns:
        Dataset over ``point``: omega (rad/s), x_amplitude, y_amplitude, y_peak, x_at_peak (m),
        stability_index, switches, residual, outcome; ``end`` says why the branch ends. For
        ``"hbm"`` also the cosine coefficients and each point's distance from the exact orbit
        of equal y_peak and from a time integration over one period.

    Raises:
        ValueError: an argument is out of its range; the message names it.
    """
    check_mode(mode)
    y_max = 3.0 * params.preload if y_peak_max is None else y_peak_max
    x_max = 3.0 * params.preload if x_amplitude_max is None else x_amplitude_max
    check_length("y_peak_max", y_max)
    check_length("x_amplitude_max", x_max)
    scene = scaled_system(params, alpha1, alpha2)
    attrs = {"alpha1": alpha1, "alpha2": alpha2, "mode": mode, "method": method}
    if method == "exact":
        orbits, outcomes, end = exact_branch(
            scene, mode, y_max / scene.length, x_max / scene.length, cross_poles=cross_poles
        )
        return _exact_dataset(scene, params, orbits, outcomes, end, attrs)
    raise ValueError(f"method = {method!r}: 'exact' or 'hbm' is needed")


def exact_branch(
    scene: ScaledSystem, mode: int, y_max: float, x_max: float, *, cross_poles: bool = False
) -> tuple[list[Orbit], list[Outcome], Outcome]:
    """Orbits of a branch in scaled units, their outcomes, and why it ends."""
    if scene.obstacle != Outcome.converged:
        return [], [], scene.obstacle
    if scene.isolated_mode == mode:
        orbits = isolated_orbits(scene, mode, x_max)
        return orbits, [Outcome.isolated_mode] * len(orbits), Outcome.amplitude_reached
    if not math.isfinite(scene.slope(mode)):
        return [], [], Outcome.pole
    peaks = np.linspace(scene.rest[1], min(1.0, y_max), LINEAR_POINTS + 1)[1:]
    orbits = [linear_orbit(scene, mode, float(peak)) for peak in peaks]
    outcomes = [Outcome.linear_mode] * len(orbits)
    if y_max <= 1.0:
        return orbits, outcomes, Outcome.amplitude_reached
    if scene.system.decoupled:
        beyond, end = _decoupled_branch(scene, y_max, cross_poles=cross_poles)
    else:
        seed = grazing_start(scene, mode)
        table, why = trace_branch(
            scene.system, seed.point, seed.direction, y_max, seed.settings(_LONGEST_STEP)
        )
        beyond = [Orbit(row[:3], np.empty(int(row[7])), row[5], row[6]) for row in table]
        end = BRANCH_ENDS[why]
    return orbits + beyond, outcomes + [Outcome.converged] * len(beyond), end


def isolated_orbits(scene: ScaledSystem, mode: int, x_max: float) -> list[Orbit]:
    """The vertical branch of a decoupled x mode: y rests, x swings at its own frequency."""
    half_period = math.pi / scene.omega(mode)
    index = 2.0 * math.cos(2.0 * half_period * scene.omega(3 - mode))
    x_rest, y_rest = scene.rest
    return [
        Orbit(np.array([x_rest + float(a), y_rest, half_period]), np.empty(0), index, 0.0)
        for a in np.linspace(0.0, x_max, 25)[1:]
    ]


def pole_number(scene: ScaledSystem, half_period: float) -> int:
    """How many internal resonances ω = ω_x/n lie above this motion's ω, where K12 = 0."""
    return int(half_period * math.sqrt(scene.system.below.matrix[0][0]) / math.pi)


def _decoupled_branch(
    scene: ScaledSystem, y_max: float, *, cross_poles: bool
) -> tuple[list[Orbit], Outcome]:
    """The y mode where K12 = 0: y is known in closed form and drives x, up to a pole."""
    count = max(8, math.ceil((y_max - 1.0) / _LONGEST_STEP))
    peaks = 1.0 + (y_max - 1.0) * np.linspace(0.0, 1.0, count + 1)[1:] ** 1.5
    orbits: list[Orbit] = []
    first = pole_number(scene, math.pi / math.sqrt(scene.system.below.matrix[1][1]))
    for peak in map(float, peaks):
        half_period = decoupled_half_period(scene.system, peak)
        if pole_number(scene, half_period) != first and not cross_poles:
            return orbits, Outcome.pole
        guess = np.array([scene.rest[0], peak, half_period])
        found = solve_orbit(scene.system, guess)
        if found is not None:
            orbits.append(found)
    return orbits, Outcome.amplitude_reached


def _exact_dataset(
    scene: ScaledSystem,
    params: Parameters,
    orbits: list[Orbit],
    outcomes: list[Outcome],
    end: Outcome,
    attrs: dict[str, Any],
) -> xr.Dataset:
    columns = columns_of([orbit_values(scene, params, orbit.point) for orbit in orbits])
    return build(
        BACKBONE,
        {
            **columns,
            "y_peak": np.array([orbit.point[1] for orbit in orbits]) * scene.length,
            "stability_index": np.array([orbit.stability_index for orbit in orbits]),
            "switches": [len(orbit.switches) for orbit in orbits],
            "residual": np.array([orbit.residual for orbit in orbits]),
            "outcome": outcomes,
            "end": end,
        },
        {"point": np.arange(len(orbits))},
        attrs,
    )


def columns_of(rows: list[dict[str, Any]]) -> dict[str, NDArray[Any]]:
    """One array a name from one mapping a point; empty arrays for an empty branch."""
    names = (
        "omega",
        "x_at_peak",
        "x_amplitude",
        "y_amplitude",
        "largest_speed",
        "sliding_assumption",
    )
    return {name: np.array([row[name] for row in rows]) for name in names}
