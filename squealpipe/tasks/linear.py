"""Linear maps over both spring angles."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.models import a3
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.linear import STABILITY_MAP


def stability_map(params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray) -> xr.Dataset:
    """Growth rate and frequencies of model A3, from closed forms.

    Args:
        params: physical parameters; the sharp contact stiffness k3 is used.
        alpha1, alpha2: 1-D arrays of angles, rad.

    Returns:
        Dataset over (alpha1, alpha2, mode): growth_rate (1/s), frequency (rad/s),
        regime_linear, outcome.
    """
    alpha1, alpha2 = np.asarray(alpha1, float), np.asarray(alpha2, float)
    stiffness = linear_stiffness(params, geometry(alpha1[:, None], alpha2[None, :]))
    spectrum = a3.spectrum(stiffness, params.k3, params.mu, params.mass)
    root = np.sqrt(spectrum.discriminant.astype(complex))
    squared = np.stack([spectrum.half_trace - root, spectrum.half_trace + root], axis=-1)
    s = np.sqrt(-squared)
    flutter = spectrum.discriminant < 0
    divergent = ~flutter & (spectrum.determinant < 0)
    return build(
        STABILITY_MAP,
        {
            "growth_rate": np.abs(s.real).max(axis=-1),
            "frequency": np.abs(s.imag),
            "regime_linear": np.where(flutter, 1, np.where(divergent, 2, 0)),
            "outcome": np.where(
                flutter, Outcome.complex_pair, np.where(divergent, Outcome.divergence, 0)
            ),
        },
        {"alpha1": alpha1, "alpha2": alpha2, "mode": [1, 2]},
    )
