"""One run's datasets at the shipped baseline, on a coarse grid."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from squealpipe.parameters import SCENES, Parameters
from squealpipe.tasks.backbones.backbone import backbone
from squealpipe.tasks.backbones.harmonic_sweeps import compare_harmonic_forms
from squealpipe.tasks.dynamics.assumptions import check_assumptions, linear_pull_map
from squealpipe.tasks.dynamics.hammering import hammering_map
from squealpipe.tasks.dynamics.runs import simulate, validity_map
from squealpipe.tasks.dynamics.whirl import transient_lifetimes, whirl_sizes
from squealpipe.tasks.inference.inference import infer_parameters
from squealpipe.tasks.linear.maps import natural_frequencies, quasi_static_map, stability_map

POINTS = 41
"""Multiples of π/40: holds 0.4π, 0.5π and π."""


@pytest.fixture(scope="session")
def baseline() -> Parameters:
    return Parameters()


def compute_evidence(params: Parameters) -> dict[str, xr.Dataset]:
    """All datasets that the checks read, at any parameters; times and speeds scale with them."""
    unit = params.time_unit
    speed = params.preload / unit
    angles = np.linspace(0.0, np.pi, POINTS)
    found = {
        "quasi_static_map": quasi_static_map(params, angles, angles),
        "stability_map": stability_map(params, angles, angles),
        "natural_frequencies": natural_frequencies(params, angles, angles),
        "assumptions": check_assumptions(params),
        "linear_pull": linear_pull_map(params, angles, angles, t_end=50.0 * unit),
        "validity_map": validity_map(params, angles, angles, t_end=200.0 * unit, workers=1),
        "parameter_inference": infer_parameters(
            params,
            samples=24,
            kappa=(0.6, 0.8),
            mu=(0.2, 0.3),
            length_ratio=(4.5, 6.0),
            speed_ratio=(90.0, 110.0),
            workers=1,
        ),
        "whirl": whirl_sizes(params, [50.0 * speed, 100.0 * speed], t_end=2000.0 * unit, workers=1),
        "transient": transient_lifetimes(
            params, [10.0 * speed], samples=2, shown_samples=8, t_end=4000.0 * unit, workers=1
        ),
        "harmonic_forms": compare_harmonic_forms(
            params,
            {
                "F10": (0.5 * np.pi, np.pi, 2),
                "coupled": (0.3 * np.pi, 0.9 * np.pi, 2),
            },
        ),
        "hammering_map": hammering_map(
            params, angles[::4], angles[::4], t_end=50.0 * unit, workers=1
        ),
    }
    for name, scene in SCENES.items():
        if scene.figure <= 5:
            found[f"simulate/{name}"] = simulate(
                params, scene.alpha1, scene.alpha2, t_end=scene.t_end * unit
            )
        else:
            for mode in (1, 2):
                found[f"backbone/{name}_mode{mode}"] = backbone(
                    params, scene.alpha1, scene.alpha2, mode=mode
                )
    first = SCENES["F2a"]
    printed = params.with_(belt_speed=-params.belt_speed)
    found["simulate/F2a_reversed"] = simulate(
        printed, first.alpha1, first.alpha2, t_end=first.t_end * unit
    )
    return found


@pytest.fixture(scope="session")
def evidence(baseline: Parameters) -> dict[str, xr.Dataset]:
    return compute_evidence(baseline)
