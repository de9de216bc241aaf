"""Exact periodic motions of model A4: one orbit, found from cold."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.methods.orbits import (
    Orbit,
    TraceEnd,
    TraceSettings,
    decoupled_half_period,
    orbit_on_branch,
    shape,
    solve_orbit,
)
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.backbones import PERIODIC_ORBIT, Assumption
from squealpipe.tasks.a4_system import ScaledSystem, scaled_system

_LONGEST_STEP = 0.1
_UNBOUNDED = 20.0

TRACE_OUTCOMES = {
    TraceEnd.reached: Outcome.converged,
    TraceEnd.returned: Outcome.retraced,
    TraceEnd.tongue_end: Outcome.tongue_end,
    TraceEnd.lost: Outcome.branch_lost,
    TraceEnd.step_limit: Outcome.step_limit,
    TraceEnd.diverged: Outcome.pole,
}
"""Outcome of a trace that was to reach a given y_peak."""


def periodic_orbit(
    params: Parameters, alpha1: float, alpha2: float, *, mode: int, y_peak: float
) -> xr.Dataset:
    """The exact periodic motion of model A4 that belongs to a mode and a peak.

    Nothing needs to be known beforehand: the branch is followed from the linear mode at grazing
    contact to the peak, in steps that are checked not to leave it. Below l_pre the motion is the
    linear mode itself.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles, rad.
        mode: 1 or 2, by ascending ω of the contact state.
        y_peak: larger y of the two instants of rest, m. An isolated x mode (K12 = 0) has
            constant y and only the peak of its equilibrium; use ``backbone`` for it.

    Returns:
        Dataset with omega (rad/s), x_at_peak (m), switching_times (s, within the half period
        after the peak), stability_index, residual, outcome and the orbit's shape. NaN with the
        reason in ``outcome`` where there is no such motion.

    Raises:
        ValueError: mode is not 1 or 2, or y_peak is not a finite number above the equilibrium.
    """
    check_mode(mode)
    check_length("y_peak", y_peak)
    scene = scaled_system(params, alpha1, alpha2)
    found, outcome = find_orbit(scene, mode, y_peak / scene.length)
    values, switches = _empty_values(), np.empty(0)
    if found is not None:
        values = orbit_values(scene, params, found.point)
        values["stability_index"] = found.stability_index
        values["residual"] = found.residual
        switches = found.switches / scene.frequency
    return build(
        PERIODIC_ORBIT,
        {**values, "y_peak": y_peak, "mode": mode, "switching_times": switches, "outcome": outcome},
        {"switch": np.arange(1, len(switches) + 1)},
        {"alpha1": alpha1, "alpha2": alpha2},
    )


def check_mode(mode: int) -> None:
    """Raise a ValueError unless mode is 1 or 2."""
    if mode not in (1, 2):
        raise ValueError(f"mode = {mode!r}: 1 or 2 is needed, by ascending frequency in contact")


def check_length(name: str, value: float) -> None:
    """Raise a ValueError unless a length is finite and positive."""
    if not (isinstance(value, Real) and math.isfinite(value) and value > 0):
        raise ValueError(f"{name} = {value!r}: a finite length above 0 is needed, m")


def find_orbit(scene: ScaledSystem, mode: int, y_peak: float) -> tuple[Orbit | None, Outcome]:
    """The orbit of a mode at a scaled peak, and its outcome.

    Raises:
        ValueError: the peak is below the equilibrium.
    """
    if scene.obstacle != Outcome.converged:
        return None, scene.obstacle
    if scene.isolated_mode == mode:
        return None, Outcome.isolated_mode
    if y_peak <= scene.rest[1]:
        raise ValueError(
            f"y_peak = {y_peak * scene.length!r}: a motion peaks above its equilibrium, "
            f"y = {scene.rest[1] * scene.length!r}"
        )
    if not math.isfinite(scene.slope(mode)):
        return None, Outcome.pole
    if y_peak <= 1.0:
        return linear_orbit(scene, mode, y_peak), Outcome.linear_mode
    if scene.system.decoupled:
        guess = np.array([scene.rest[0], y_peak, decoupled_half_period(scene.system, y_peak)])
        found = solve_orbit(scene.system, guess)
        return found, Outcome.converged if found else Outcome.pole
    seed = grazing_start(scene, mode)
    found, end = orbit_on_branch(
        scene.system,
        seed.point,
        seed.direction,
        y_peak,
        seed.settings(_LONGEST_STEP, y_peak),
    )
    return found, TRACE_OUTCOMES[end]


def linear_orbit(scene: ScaledSystem, mode: int, y_peak: float) -> Orbit:
    """The linear mode with a scaled peak of at most 1, in closed form.

    Its monodromy has the trace 2 + 2 cos(2π ω_other/ω).
    """
    half_period = math.pi / scene.omega(mode)
    x0 = scene.rest[0] + scene.slope(mode) * (y_peak - scene.rest[1])
    index = 2.0 * math.cos(2.0 * half_period * scene.omega(3 - mode))
    return Orbit(np.array([x0, y_peak, half_period]), np.empty(0), index, 0.0)


@dataclass(frozen=True)
class GrazingStart:
    """Where the linear mode touches the end of contact, and the branch's direction there."""

    point: NDArray[np.float64]
    direction: NDArray[np.float64]
    room: float

    def settings(self, longest_step: float, y_stop: float) -> TraceSettings:
        """Step control whose first step is small against the linear mode itself.

        A branch whose x exceeds many times both y_stop and the linear mode's x at that peak
        follows an internal resonance.
        """
        reach = 1.0 + float(np.linalg.norm(self.point))
        first = min(0.1 * longest_step, 0.1 * self.room / reach)
        linear_x = abs(self.point[0]) + abs(self.direction[0]) * (y_stop - 1.0)
        return TraceSettings(
            first_step=first,
            longest_step=longest_step,
            largest_x=_UNBOUNDED * (y_stop + float(linear_x)),
        )


def grazing_start(scene: ScaledSystem, mode: int) -> GrazingStart:
    """Start of the branch; the branch is smooth there, as the flight takes off at rest."""
    direction = np.array([scene.slope(mode), 1.0, 0.0])
    room = float(np.linalg.norm(direction)) * (1.0 - scene.rest[1])
    return GrazingStart(linear_orbit(scene, mode, 1.0).point, direction, room)


def orbit_values(
    scene: ScaledSystem, params: Parameters, point: NDArray[np.float64]
) -> dict[str, Any]:
    """What a dataset says of an orbit's shape, in the user's units."""
    x_amplitude, y_amplitude, speed = shape(scene.system, point)
    largest_speed = speed * scene.length * scene.frequency
    return {
        "omega": math.pi / point[2] * scene.frequency,
        "x_at_peak": point[0] * scene.length,
        "x_amplitude": x_amplitude * scene.length,
        "y_amplitude": y_amplitude * scene.length,
        "largest_speed": largest_speed,
        "sliding_assumption": Assumption(int(largest_speed < abs(params.belt_speed))),
    }


def _empty_values() -> dict[str, Any]:
    names = ("omega", "x_at_peak", "x_amplitude", "y_amplitude", "largest_speed")
    blank: dict[str, Any] = dict.fromkeys((*names, "stability_index", "residual"), math.nan)
    return {**blank, "sliding_assumption": Assumption.holds}
