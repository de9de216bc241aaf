"""Branches of exact periodic motions of model A4, in scaled units."""

import math
from functools import partial
from typing import Any

import numpy as np

from squealpipe.brake.a4.orbits import check_peak, grazing_start, linear_orbit
from squealpipe.brake.a4.system import ScaledSystem
from squealpipe.brake.orbits.orbits import Orbit, decoupled_half_period, solve_orbit
from squealpipe.brake.orbits.tracing import Place, places_on_branch, trace_branch
from squealpipe.schema import Outcome

POINT_SPACING = 0.02
"""Distance of the recorded points of a branch, over 1 + |z|."""


def exact_branch(
    scene: ScaledSystem,
    mode: int,
    y_max: float,
    x_max: float,
    *,
    cross_poles: bool = False,
) -> tuple[list[Orbit], list[Outcome], Outcome]:
    """Orbits of a branch in scaled units, their outcomes, and why it ends."""
    orbits, outcomes, end = linear_part(scene, mode, y_max, x_max)
    if end is not None:
        return orbits, outcomes, end
    if scene.system.decoupled:
        steps, end = decoupled_steps(scene, y_max, cross_poles=cross_poles)
        guesses = [
            np.array([scene.rest[0], peak, half_period]) for peak, half_period in steps
        ]
        found = [solve_orbit(scene.system, guess) for guess in guesses]
        beyond = [orbit for orbit in found if orbit is not None]
    else:
        beyond, why = trace_branch(*_trace_of(scene, mode, y_max))
        end = Outcome[why.name]
    return orbits + beyond, outcomes + [Outcome.converged] * len(beyond), end


def places_on_exact_branch(
    scene: ScaledSystem, mode: int, y_max: float, x_max: float
) -> tuple[list[Place], Outcome]:
    """Return the branch of :func:`exact_branch` with orbits as functions, computed when wanted."""
    orbits, _, end = linear_part(scene, mode, y_max, x_max)
    beyond = list[Place]()
    if end is None and scene.system.decoupled:
        orbits, _, end = exact_branch(scene, mode, y_max, x_max)
    elif end is None:
        beyond, why = places_on_branch(*_trace_of(scene, mode, y_max))
        end = Outcome[why.name]
    return [*(partial(_known, orbit) for orbit in orbits), *beyond], end


def _known(orbit: Orbit) -> Orbit:
    return orbit


def _trace_of(scene: ScaledSystem, mode: int, y_max: float) -> tuple[Any, ...]:
    """The arguments with which a branch is traced from grazing on."""
    seed = grazing_start(scene, mode)
    way = seed.point, seed.direction, y_max, seed.settings()
    return scene.system, *way, POINT_SPACING


def linear_part(
    scene: ScaledSystem, mode: int, y_max: float, x_max: float
) -> tuple[list[Orbit], list[Outcome], Outcome | None]:
    """Orbits in closed form with which a branch begins, their outcomes, and why it ends there.

    None where it goes on beyond grazing.
    """
    if scene.obstacle != Outcome.converged:
        return [], [], scene.obstacle
    if scene.isolated_mode == mode:
        orbits = isolated_orbits(scene, mode, x_max)
        return orbits, [Outcome.isolated_mode] * len(orbits), Outcome.amplitude_reached
    if not math.isfinite(scene.slope(mode)):
        return [], [], Outcome.pole
    check_peak(scene, "y_peak_max", y_max)
    # a backbone begins with six points on the linear mode, from rest to grazing
    peaks = np.linspace(scene.rest[1], min(1.0, y_max), 6 + 1)[1:].tolist()
    outcomes = [
        Outcome.grazing if peak == 1.0 else Outcome.linear_mode for peak in peaks
    ]
    end = Outcome.amplitude_reached if y_max <= 1.0 else None
    return [linear_orbit(scene, mode, peak) for peak in peaks], outcomes, end


def isolated_orbits(scene: ScaledSystem, mode: int, x_max: float) -> list[Orbit]:
    """The vertical branch of a decoupled x mode: y rests, x swings at its own frequency."""
    half_period = math.pi / scene.omega(mode)
    index = 2.0 * math.cos(2.0 * half_period * scene.omega(3 - mode))
    x_rest, y_rest = scene.rest
    return [
        Orbit(
            np.array([x_rest + a, y_rest, half_period]),
            np.array([x_rest - a, y_rest]),
            np.empty(0),
            index,
            0.0,
        )
        for a in np.linspace(0.0, x_max, 24 + 1)[1:].tolist()
    ]


def pole_number(scene: ScaledSystem, half_period: float) -> int:
    """Count the internal resonances ω = ω_x/n above this motion's ω, where K12 = 0."""
    return int(half_period * math.sqrt(scene.system.below.matrix[0][0]) / math.pi)


def decoupled_steps(
    scene: ScaledSystem, y_max: float, *, cross_poles: bool
) -> tuple[list[tuple[float, float]], Outcome]:
    """Peaks and half periods of the y mode where K12 = 0, from just above grazing, and its end.

    y is known in closed form and drives x, up to a pole.
    """
    count = max(8, math.ceil((y_max - 1.0) / 0.04))
    peaks = 1.0 + (y_max - 1.0) * np.linspace(0.0, 1.0, count + 1)[1:] ** 1.5
    first = pole_number(scene, math.pi / math.sqrt(scene.system.below.matrix[1][1]))
    steps: list[tuple[float, float]] = []
    for peak in peaks.tolist():
        half_period = decoupled_half_period(scene.system, peak)
        if pole_number(scene, half_period) != first and not cross_poles:
            return steps, Outcome.pole
        steps.append((peak, half_period))
    return steps, Outcome.amplitude_reached
