"""Exact periodic motions of model A4: one orbit, found from cold."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.brake.a4.orbits import find_orbit, orbit_values
from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.schema.backbones import Assumption, periodic_orbit_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import blank, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.inputs.values import brief
from squealpipe.validation import Angle, Mode, Positive


@recorded(model="A4", method="exact")
def periodic_orbit(
    params: Parameters, alpha1: Angle, alpha2: Angle, *, mode: Mode, y_peak: Positive
) -> xr.Dataset:
    """The exact periodic motion of model A4 that belongs to a mode and a peak.

    Nothing needs to be known beforehand: the branch is followed from the linear mode at grazing
    contact to the peak, in the steps of ``backbone``, which are checked not to leave it. Below
    l_pre the motion is the linear mode itself. Where the branch ends before the peak, an orbit of
    another branch may be found across the resonance that ends it; its outcome is then
    ``other_branch``.

    Args:
        alpha1, alpha2: angles, rad.
        mode: 1 or 2, by ascending ω of the contact state.
        y_peak: larger y of the two instants of rest, m. An isolated x mode (K12 = 0) has
            constant y and only the peak of its equilibrium; use ``backbone`` for it.

    Returns:
        Dataset ``periodic_orbit``; its path is that of the half period after the peak, along which
        the mass goes back in the other. NaN with the reason in ``outcome`` where there is no such
        motion.
    """
    check_length("y_peak", y_peak, params.preload)
    scene = scaled_system(params, alpha1, alpha2)
    orbit, outcome = find_orbit(scene, mode, y_peak / scene.length, across=True)
    values: dict[str, Any] = {
        **blank(periodic_orbit_schema),
        "sliding_assumption": Assumption.holds,
    }
    switches, path = np.empty(0), np.empty((0, 4))
    # phases at which the path of the orbit is kept
    path_phases = np.linspace(0.0, math.pi, 201)
    if orbit is not None:
        values |= orbit_values(scene, params, orbit.point)
        values["stability_index"] = orbit.stability_index
        values["residual"] = orbit.residual
        switches = orbit.switches / scene.frequency
        path = sample(scene.system.rows, orbit.point, path_phases) * scene.length
    return build(
        periodic_orbit_schema,
        {
            **values,
            "y_peak": y_peak,
            "mode": mode,
            "switching_times": switches,
            "time": path_phases[: len(path)] / values["omega"],
            "x_path": path[:, 0],
            "y_path": path[:, 1],
            "outcome": outcome,
        },
        {"switch": np.arange(1, len(switches) + 1)},
        {"alpha1": alpha1, "alpha2": alpha2},
    )


def check_length(name: str, value: float, preload: float) -> None:
    """Raise a ValueError unless a length is finite over l_pre too."""
    # squares of longer lengths overflow
    most_preloads = 1e100
    if not value <= most_preloads * preload:
        raise ValueError(
            f"{name} = {brief(value)}: more than {most_preloads:g} times preload = {preload!r}; "
            "give lengths in one system of units"
        )
