"""Exact orbits of A4 from cold: the linear mode, the start of its branch, the way to a peak."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.a4.system import ScaledSystem
from squealpipe.brake.orbits.orbits import (
    Orbit,
    decoupled_half_period,
    shape,
    solve_orbit,
)
from squealpipe.brake.orbits.shorter_orbits import is_primitive
from squealpipe.brake.orbits.tracing import TraceEnd, TraceSettings, orbit_on_branch
from squealpipe.brake.schema.backbones import Assumption
from squealpipe.laws.friction import slides
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome


def find_orbit(
    scene: ScaledSystem, mode: int, y_peak: float, *, across: bool = False
) -> tuple[Orbit | None, Outcome]:
    """The orbit of a mode at a scaled peak, and its outcome.

    Where the branch ends before the peak and ``across`` is given, :func:`orbit_across` looks for
    an orbit of another branch.
    """
    if scene.obstacle != Outcome.converged:
        return None, scene.obstacle
    if scene.isolated_mode == mode:
        return None, Outcome.isolated_mode
    check_peak(scene, "y_peak", y_peak)
    if not math.isfinite(scene.slope(mode)):
        return None, Outcome.pole
    if y_peak <= 1.0:
        return linear_orbit(scene, mode, y_peak), Outcome.linear_mode
    if scene.system.decoupled:
        guess = np.array(
            [scene.rest[0], y_peak, decoupled_half_period(scene.system, y_peak)]
        )
        orbit = solve_orbit(scene.system, guess)
        return orbit, Outcome.converged if orbit else Outcome.pole
    seed = grazing_start(scene, mode)
    orbit, end = orbit_on_branch(
        scene.system, seed.point, seed.direction, y_peak, seed.settings()
    )
    # these ends leave no doubt that the branch does not reach the peak
    if across and end in (TraceEnd.retraced, TraceEnd.tongue_end, TraceEnd.pole):
        other = orbit_across(scene, mode, y_peak)
        if other is not None:
            return other, Outcome.other_branch
    reached = end is TraceEnd.amplitude_reached
    return orbit, Outcome.converged if reached else Outcome[end.name]


def orbit_across(scene: ScaledSystem, mode: int, y_peak: float) -> Orbit | None:
    """An orbit at a scaled peak by a trace that crosses the narrow resonances on its way."""
    seed = grazing_start(scene, mode)
    lenient = replace(seed.settings(), strict=False, max_points=80)
    orbit, _ = orbit_on_branch(
        scene.system, seed.point, seed.direction, y_peak, lenient
    )
    return orbit if orbit is not None and is_primitive(scene.system, orbit) else None


def check_peak(scene: ScaledSystem, name: str, y_peak: float) -> None:
    """Raise ``ValueError`` if a scaled peak is not above the equilibrium."""
    if y_peak <= (rest := float(scene.rest[1])):
        peak, lowest = y_peak * scene.length, rest * scene.length
        raise ValueError(
            f"{name} = {peak!r}: a motion peaks above its equilibrium, y = {lowest!r}"
        )


def linear_orbit(scene: ScaledSystem, mode: int, y_peak: float) -> Orbit:
    """The linear mode with a scaled peak of at most 1, in closed form.

    Its monodromy has the trace 2 + 2 cos(2π ω_other/ω).
    """
    half_period = math.pi / scene.omega(mode)
    x0 = scene.rest[0] + scene.slope(mode) * (y_peak - scene.rest[1])
    index = 2.0 * math.cos(2.0 * half_period * scene.omega(3 - mode))
    point = np.array([x0, y_peak, half_period])
    return Orbit(point, 2.0 * scene.rest - point[:2], np.empty(0), index, 0.0)


@dataclass(frozen=True)
class GrazingStart:
    """Start of a branch: the linear mode that touches the end of contact, and the direction from
    there.
    """

    point: NDArray[np.float64]
    direction: NDArray[np.float64]
    room: float

    def settings(self) -> TraceSettings:
        """Step control whose first step is small against the linear mode itself."""
        reach = 1.0 + float(np.linalg.norm(self.point))
        control = TraceSettings()
        return replace(
            control,
            first_step=min(0.1 * control.longest_step, 0.1 * self.room / reach),
            linear_x=float(abs(self.point[0])),
            linear_slope=float(abs(self.direction[0])),
        )


def grazing_start(scene: ScaledSystem, mode: int) -> GrazingStart:
    """Start of the branch; the branch is smooth there, as the flight takes off at rest."""
    direction = np.array([scene.slope(mode), 1.0, 0.0])
    room = float(np.linalg.norm(direction)) * (1.0 - scene.rest[1])
    return GrazingStart(linear_orbit(scene, mode, 1.0).point, direction, room)


SHAPE = (
    "omega",
    "x_at_peak",
    "x_amplitude",
    "y_amplitude",
    "largest_speed",
    "sliding_assumption",
)
"""Names of the numbers that :func:`orbit_values` gives."""


def orbit_values(
    scene: ScaledSystem, params: Parameters, point: NDArray[np.float64]
) -> dict[str, Any]:
    """Return the stored description of an orbit's shape, in the user's units."""
    x_amplitude, y_amplitude, speed = shape(scene.system, point)
    largest_speed = speed * scene.length * scene.frequency
    return {
        "omega": math.pi / point[2] * scene.frequency,
        "x_at_peak": point[0] * scene.length,
        "x_amplitude": x_amplitude * scene.length,
        "y_amplitude": y_amplitude * scene.length,
        "largest_speed": largest_speed,
        "sliding_assumption": Assumption(int(slides(largest_speed, params))),
    }
