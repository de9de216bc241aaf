"""Exact boundary curves of the linear maps, and the areas that they enclose."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.models import a2, a3
from squealpipe.models.a4 import spectrum
from squealpipe.models.contact_system import contact_system
from squealpipe.models.refusals import WHY_CIRCLES, refuse_extensions
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.linear import LINEAR_SHARES, STABILITY_BOUNDARIES, Boundary


def stability_boundaries(params: Parameters, *, points: int = 400) -> xr.Dataset:
    """Curves over the angle map where a linear regime or the sign of A2's reaction changes.

    All of them are circles or lines in the plane of Z (see :mod:`squealpipe.models.a3`), from
    where the angles follow in closed form, so each point is exact to round-off.

    Args:
        params: physical parameters.
        points: points of each arc; every arc gives two segments.

    Returns:
        Dataset over point: alpha1, alpha2 (rad, continuous along a segment, hence not confined
        to 0 … π; the map has period π in either angle), z_real, z_imag (N/m), boundary, segment.
    """
    refuse_extensions(params, "stability_boundaries", WHY_CIRCLES)
    total = params.k1 + params.k2
    arcs = {
        Boundary.flutter: a3.circle_arcs(params, *a3.flutter_circle(params, params.k3), points),
        Boundary.divergence: a3.circle_arcs(
            params, *a3.divergence_circle(params, params.k3), points
        ),
        Boundary.reaction_changes_sign: a3.line_parts(params, 1 - 1j * params.drag, -total, points),
        Boundary.no_coupling: a3.line_parts(params, 1j, 0.0, points),
    }
    segments = [
        (boundary, *np.unwrap(branch, period=np.pi))
        for boundary, parts in arcs.items()
        for z in parts
        for branch in np.stack(a3.angles_from_plane(z, params), axis=1)
    ]
    if params.k1 == params.k2:
        # Z = 0 all along α1 + α2 = π/2 and 3π/2, where angles_from_plane has no answer.
        along = np.linspace(0.0, np.pi, points)
        segments += [
            (Boundary.no_coupling, along, turn - along) for turn in (np.pi / 2, 1.5 * np.pi)
        ]
    count = points * len(segments)
    alpha1, alpha2 = (np.concatenate([segment[i] for segment in segments]) for i in (1, 2))
    z = a3.plane(params, alpha1, alpha2)
    return build(
        STABILITY_BOUNDARIES,
        {
            "alpha1": alpha1,
            "alpha2": alpha2,
            "z_real": z.real,
            "z_imag": z.imag,
            "boundary": np.repeat([segment[0] for segment in segments], points),
            "segment": np.repeat(np.arange(len(segments)), points),
        },
        {"point": np.arange(count)},
    )


def linear_shares(
    params: Parameters,
    mu: np.ndarray,
    kappa: np.ndarray,
    sharpness: np.ndarray,
    *,
    points: int = 180,
) -> xr.Dataset:
    """Areas of the angle map against friction, contact stiffness and regularization.

    Args:
        params: physical parameters; mu and k3 are replaced by the grids.
        mu, kappa: friction coefficients and ratios k3/k1.
        sharpness: values of σ l_pre, for the baseline's mu and k3.
        points: angles per period and axis; the midpoint rule over one period of the map.

    Returns:
        Dataset of shares between 0 and 1; see the schema ``linear_shares``.
    """
    refuse_extensions(params, "linear_shares", WHY_CIRCLES)
    angles = (np.arange(points) + 0.5) * (np.pi / points)
    system = contact_system(params, angles[:, None], angles[None, :])
    stiffness, determinant = system.stiffness, system.spring_determinant

    def regime(k3: float, friction: float) -> np.ndarray:
        invariants = spectrum(stiffness, determinant, k3=k3, mu=friction, mass=params.mass)
        return np.asarray(a3.regime(invariants))

    shape = (len(mu), len(kappa))
    names = ("flutter", "divergence", "pulled", "impossible_but_pressed", "unstable_where_possible")
    shares = {name: np.zeros(shape) for name in names}
    impossible, as_printed = np.zeros(len(mu)), np.zeros(len(mu))
    for row, friction in enumerate(mu):
        possible = a2.reaction_force(stiffness, friction, 1.0) > 0
        impossible[row] = 1.0 - possible.mean()
        as_printed[row] = 1.0 - a2.possible_as_printed(stiffness, friction).mean()
        for column, ratio in enumerate(kappa):
            k3 = ratio * params.k1
            regimes = regime(k3, friction)
            force = a3.static_state(stiffness, determinant, k3=k3, mu=friction, actuation=1.0)[2]
            cell = row, column
            shares["flutter"][cell] = np.mean(regimes == a3.LinearRegime.flutter)
            shares["divergence"][cell] = np.mean(regimes == a3.LinearRegime.divergence)
            shares["pulled"][cell] = np.mean(force < 0)
            shares["impossible_but_pressed"][cell] = np.mean(~possible & (force > 0))
            shares["unstable_where_possible"][cell] = np.mean(possible & (regimes > 0))
    stiffnesses = [
        a2.contact_stiffness(params, value / params.preload) for value in np.asarray(sharpness)
    ]
    regularized = [regime(k3, params.drag) for k3 in stiffnesses]
    return build(
        LINEAR_SHARES,
        {
            "impossible_as_printed": as_printed,
            "impossible": impossible,
            **shares,
            "stiffness_ratio": np.array(stiffnesses) / params.k3,
            "flutter_regularized": [np.mean(r == a3.LinearRegime.flutter) for r in regularized],
            "divergence_regularized": [
                np.mean(r == a3.LinearRegime.divergence) for r in regularized
            ],
        },
        {"mu": mu, "kappa": kappa, "sharpness": sharpness},
    )
