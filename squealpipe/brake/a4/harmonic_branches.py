"""Branches of model A4 by harmonic balance in cosines, each point judged by the exact orbit."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.a4.exact_branches import decoupled_steps, linear_part
from squealpipe.brake.a4.orbits import grazing_start
from squealpipe.brake.a4.system import ScaledSystem
from squealpipe.brake.balance.harmonic_balance import CosineBalance, contact_of
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.orbits.orbits import index_from_switches, solve_orbit
from squealpipe.schema import Outcome
from squealpipe.systems.continuation import (
    Continuation,
    ContinuationSettings,
    ContinuationState,
)
from squealpipe.systems.progress import report

Vector = NDArray[np.float64]

_PHASES = np.linspace(0.0, math.pi, 257)


@dataclass(frozen=True)
class HarmonicPoint:
    """A solution of the balance in scaled units, with what the exact orbits say of it.

    Attributes:
        switches: contact times over the unit of time, in the half period.
        stability_index: trace − 2 of the monodromy along the series' contact times.
        omega_exact: ω of the exact orbit of equal peak, NaN without one.
        waveform_error: largest distance of (x, y) from it at equal phase.
        integration_error: the same from A4 integrated over one period from the series' peak.
    """

    z: Vector
    residual: float
    outcome: Outcome
    switches: Vector
    stability_index: float
    omega_exact: float
    waveform_error: float
    integration_error: float


def harmonic_branch(
    scene: ScaledSystem,
    mode: int,
    y_max: float,
    x_max: float,
    *,
    n_harmonics: int,
    n_time: int | None,
    sigma: float | None,
    cross_poles: bool,
) -> tuple[CosineBalance, list[HarmonicPoint], Outcome]:
    """Points of a branch from the linear mode upwards, and why it ends; all scaled.

    Args:
        sigma: scaled regularizing factor, or None for the sharp law.
        cross_poles: go on beyond ω = ω_x/n where K12 = 0.
    """
    balance = CosineBalance(scene.system, contact_of(n_harmonics, n_time, sigma))
    orbits, outcomes, end = linear_part(scene, mode, y_max, x_max)
    series = [linear_series(scene, mode, n_harmonics, orbit.point) for orbit in orbits]
    points = [
        _judged(scene, balance, *each) for each in zip(series, outcomes, strict=True)
    ]
    if end is not None:
        return balance, points, end
    if scene.system.decoupled:
        beyond, end = _decoupled_branch(
            scene, balance, series[-1], y_max, cross_poles=cross_poles
        )
    else:
        beyond, end = _coupled_branch(scene, balance, mode, series[-1], y_max)
    return (
        balance,
        points + [_judged(scene, balance, z, Outcome.converged) for z in beyond],
        end,
    )


def linear_series(
    scene: ScaledSystem, mode: int, n_harmonics: int, point: Vector
) -> Vector:
    """Unknowns of the linear mode that starts at rest at (x0, y0) of a point."""
    z = np.zeros(2 * n_harmonics + 3)
    z[0], z[n_harmonics + 1] = scene.rest
    z[1], z[n_harmonics + 2] = point[:2] - scene.rest
    z[-1] = scene.omega(mode)
    return z


def _coupled_branch(
    scene: ScaledSystem, balance: CosineBalance, mode: int, start: Vector, y_max: float
) -> tuple[list[Vector], Outcome]:
    """Solutions beyond grazing, followed by pseudo-arclength, and why the branch ends."""
    seed, settings = grazing_start(scene, mode), ContinuationSettings()
    direction = np.zeros_like(start)
    direction[1], direction[balance.contact.n_harmonics + 2] = seed.direction[:2]
    first = min(
        settings.first_step, 0.1 * seed.room / (1.0 + float(np.linalg.norm(start)))
    )
    control = replace(settings, first_step=max(first, settings.shortest_step))
    ended = Outcome.converged

    def from_higher_end(state: ContinuationState) -> ContinuationState:
        signs = balance.shift_signs
        if _peak(balance, signs * state.point) <= _peak(balance, state.point):
            return state
        return replace(
            state,
            point=signs * state.point,
            tangent=signs * state.tangent,
            curvature=signs * state.curvature,
        )

    def stop(state: ContinuationState) -> bool:
        nonlocal ended
        report(lambda: _peak(balance, state.point) / y_max)
        odd = state.point * (balance.shift_signs < 0.0)
        reach = state.step * (1.0 + float(np.linalg.norm(state.point)))
        if _peak(balance, state.point) >= y_max:
            ended = Outcome.amplitude_reached
        elif float(np.linalg.norm(odd)) < reach:
            ended = Outcome.tongue_end
        elif _peak(balance, state.point) <= 1.0:
            ended = Outcome.retraced
        return ended != Outcome.converged

    branch = Continuation(balance, start, direction, control, from_higher_end)
    points = [state.point for state in branch.run(stop)]
    if ended == Outcome.converged:
        lost = len(points) < control.max_points
        return points, Outcome.branch_lost if lost else Outcome.step_limit
    if ended == Outcome.amplitude_reached:
        last = balance.solve(points[-1], balance.peak_row, y_max)
        points = points[:-1] + ([last[0]] if last else [])
    return points, ended


def _peak(balance: CosineBalance, z: Vector) -> float:
    return float(balance.peak_row @ z)


def _decoupled_branch(
    scene: ScaledSystem,
    balance: CosineBalance,
    start: Vector,
    y_max: float,
    *,
    cross_poles: bool,
) -> tuple[list[Vector], Outcome]:
    """The y mode where K12 = 0, at given peaks, up to a pole of x."""
    points: list[Vector] = []
    guess = start
    steps, end = decoupled_steps(scene, y_max, cross_poles=cross_poles)
    for peak, half_period in steps:
        guess = guess.copy()
        guess[-1] = math.pi / half_period
        solved = balance.solve(guess, balance.peak_row, peak)
        if solved is not None:
            guess = solved[0]
            points.append(guess)
    return points, end


def _judged(
    scene: ScaledSystem, balance: CosineBalance, z: Vector, outcome: Outcome
) -> HarmonicPoint:
    """A point with its index and its distances from exact orbit and exact flow."""
    x, y, omega = balance.split(z)
    half_period = math.pi / omega
    start = np.array([x.sum(), y.sum(), half_period])
    switches = balance.contact.angles(y) / omega
    values, _ = balance.evaluate(z)
    omega_exact, waveform_error = _distance(scene, balance, z, start, outcome)
    # beyond a distance of 0.05 l_pre a series does not stand for the exact orbit
    if outcome == Outcome.converged and not waveform_error <= 0.05:
        outcome = Outcome.unconfirmed
    return HarmonicPoint(
        z=z,
        residual=float(np.abs(values).max()),
        outcome=outcome,
        switches=switches,
        stability_index=index_from_switches(
            scene.system, switches, half_period, start[1]
        ),
        omega_exact=omega_exact,
        waveform_error=waveform_error,
        integration_error=_apart(
            scene, balance, z, start * [1.0, 1.0, 2.0], 2.0 * _PHASES
        ),
    )


def _distance(
    scene: ScaledSystem,
    balance: CosineBalance,
    z: Vector,
    start: Vector,
    outcome: Outcome,
) -> tuple[float, float]:
    """(ω, waveform distance) of the exact orbit of equal peak; NaN where none is near."""
    omega, point = balance.split(z)[2], start
    if outcome == Outcome.converged:
        exact = solve_orbit(scene.system, start)
        # an exact orbit whose ω differs by more is another motion
        if exact is None or abs(exact.omega - omega) > 0.05 * omega:
            return math.nan, math.nan
        point = exact.point
    return math.pi / float(point[2]), _apart(scene, balance, z, point, _PHASES)


def _apart(
    scene: ScaledSystem, balance: CosineBalance, z: Vector, point: Vector, theta: Vector
) -> float:
    """Largest distance of the series at θ from the exact motion that ``point`` starts."""
    x, y, _ = balance.split(z)
    table = np.cos(np.outer(theta, np.arange(len(x))))
    states = sample(scene.system.rows, point, _PHASES)
    return float(np.hypot(table @ x - states[:, 0], table @ y - states[:, 1]).max())
