"""One run's datasets at the shipped baseline, on a coarse grid."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from squealpipe.parameters import SCENES, Parameters
from squealpipe.tasks.assumptions import check_assumptions, linear_pull_map
from squealpipe.tasks.backbones import backbone
from squealpipe.tasks.dynamics import simulate, validity_map
from squealpipe.tasks.hammering import hammering_map
from squealpipe.tasks.harmonic_sweeps import compare_harmonic_forms
from squealpipe.tasks.inference import infer_parameters
from squealpipe.tasks.linear import natural_frequencies, quasi_static_map, stability_map
from squealpipe.tasks.whirl import transient_lifetimes, whirl_sizes

POINTS = 41
"""Multiples of π/40: holds 0.4π, 0.5π and π."""


@pytest.fixture(scope="session")
def baseline() -> Parameters:
    return Parameters()


@pytest.fixture(scope="session")
def evidence(baseline: Parameters) -> dict[str, xr.Dataset]:
    angles = np.linspace(0.0, np.pi, POINTS)
    found = {
        "quasi_static_map": quasi_static_map(baseline, angles, angles),
        "stability_map": stability_map(baseline, angles, angles),
        "natural_frequencies": natural_frequencies(baseline, angles, angles),
        "assumptions": check_assumptions(baseline),
        "linear_pull": linear_pull_map(baseline, angles, angles),
        "validity_map": validity_map(baseline, angles, angles, workers=1),
        "parameter_inference": infer_parameters(
            baseline,
            samples=24,
            kappa=(0.6, 0.8),
            mu=(0.2, 0.3),
            length_ratio=(4.5, 6.0),
            speed_ratio=(90.0, 110.0),
            workers=1,
        ),
        "whirl": whirl_sizes(baseline, [50.0, 100.0], t_end=2000.0, workers=1),
        "transient": transient_lifetimes(
            baseline, [10.0], samples=2, shown_samples=8, t_end=4000.0, workers=1
        ),
        "harmonic_forms": compare_harmonic_forms(
            baseline,
            {
                "F10": (0.5 * np.pi, np.pi, 2),
                "coupled": (0.3 * np.pi, 0.9 * np.pi, 2),
            },
        ),
        "hammering_map": hammering_map(baseline, angles[::4], angles[::4], t_end=50.0, workers=1),
    }
    for name, scene in SCENES.items():
        if scene.figure <= 5:
            found[f"simulate/{name}"] = simulate(
                baseline, scene.alpha1, scene.alpha2, t_end=scene.t_end
            )
        else:
            for mode in (1, 2):
                found[f"backbone/{name}_mode{mode}"] = backbone(
                    baseline, scene.alpha1, scene.alpha2, mode=mode
                )
    first = SCENES["F2a"]
    printed = baseline.with_(belt_speed=-baseline.belt_speed)
    found["simulate/F2a_reversed"] = simulate(
        printed, first.alpha1, first.alpha2, t_end=first.t_end
    )
    return found
