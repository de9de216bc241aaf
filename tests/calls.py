"""Public functions that return a dataset, each called once; horizons in units of the parameters."""

from collections.abc import Callable
from functools import cache

import numpy as np
import xarray as xr

import squealpipe as sp

A, B = 5 * np.pi / 6, 0.8 * np.pi
AXIS = np.linspace(0.1, 3.0, 7)
WINDOW = [0.8, 0.9, 1.0], [2.7, 2.8, 2.9]


@cache
def _boundary(p: sp.Parameters) -> xr.Dataset:
    return sp.contact_boundary(p, *WINDOW, t_end=5 * p.time_unit, tol=1e-9)


CALLS: dict[str, Callable[[sp.Parameters], xr.Dataset]] = {
    "simulate": lambda p: sp.simulate(p, A, B, t_end=30 * p.time_unit),
    "summarize": lambda p: sp.summarize(sp.simulate(p, A, B, t_end=30 * p.time_unit)),
    "spectrum": lambda p: sp.spectrum(sp.simulate(p, A, B, t_end=30 * p.time_unit)),
    "validity_map": lambda p: sp.validity_map(p, AXIS, AXIS),
    "refine_validity_map": lambda p: sp.refine_validity_map(p, resolution=9, coarse=5),
    "hammering_map": lambda p: sp.hammering_map(p, AXIS, AXIS, t_end=30 * p.time_unit),
    "basin_map": lambda p: sp.basin_map(
        p, A, B, x=[0.0, 0.3 * p.preload], t_end=30 * p.time_unit
    ),
    "smallest_disturbance": lambda p: sp.smallest_disturbance(
        p, 0.4, 1.0, directions=8
    ),
    "assess": lambda p: sp.assess(p, 0.4, 1.0, tol=1e-9),
    "quasi_static_map": lambda p: sp.quasi_static_map(p, AXIS, AXIS),
    "stability_map": lambda p: sp.stability_map(p, AXIS, AXIS),
    "critical_friction_map": lambda p: sp.critical_friction_map(p, AXIS, AXIS),
    "natural_frequencies": lambda p: sp.natural_frequencies(p, AXIS, AXIS),
    "periodic_orbit": lambda p: sp.periodic_orbit(
        p, 0.3 * np.pi, 0.9 * np.pi, mode=1, y_peak=2 * p.preload
    ),
    "backbone": lambda p: sp.backbone(p, A, A, mode=1),
    "backbone by harmonics": lambda p: sp.backbone(
        p, 0.3 * np.pi, 0.9 * np.pi, mode=2, y_peak_max=1.5 * p.preload, method="hbm"
    ),
    "limit_cycle": lambda p: sp.limit_cycle(
        p, 0.07 * np.pi, 0.305 * np.pi, t_settle=20 * p.time_unit
    ),
    "propensity": lambda p: sp.propensity(
        p,
        0.3,
        1.0,
        samples=64,
        t_end=20 * p.time_unit,
        distributions={"mu": {"distribution": "uniform", "low": 0.1, "high": 0.9}},
    ),
    "cycle_branch": lambda p: sp.cycle_branch(
        p, 0.22, 0.96, parameter="mu", to=0.9, start="onset", n_points=2
    ),
    "infer_parameters": lambda p: sp.infer_parameters(p, samples=2, workers=1),
    "contact_boundary": lambda p: _boundary(p).copy(deep=True),
    "boundary_distance": lambda p: sp.boundary_distance(
        _boundary(p), {"alpha1": 0.9, "alpha2": 2.8}
    ),
    "regime_chart": lambda p: sp.regime_chart(
        p, *WINDOW, t_end=5 * p.time_unit, tol=1e-9
    ),
}
