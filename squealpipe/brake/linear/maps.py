"""Linear maps over both spring angles: quasi-static sliding, stability, natural frequencies."""

from __future__ import annotations  # help shows Angle, not its checks

from types import SimpleNamespace

import numpy as np
import xarray as xr

from squealpipe.brake.models import a2, a3
from squealpipe.brake.models.a4 import (
    StiffnessSpectrum,
    natural_frequencies_squared,
    spectrum,
)
from squealpipe.brake.models.contact_system import contact_system
from squealpipe.brake.models.damped import damped_system, is_undamped, stability
from squealpipe.brake.models.refusals import WHY_A4, refuse_extensions, refuse_scales
from squealpipe.brake.schema.linear import (
    natural_frequencies_schema,
    quasi_static_map_schema,
    stability_map_schema,
)
from squealpipe.laws.springs import Geometry, linear_stiffness, pair_determinant
from squealpipe.parameters import NUMBERS_OF_A1, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.validation import Angles, Positive


@recorded(model="A2", method="closed form")
def quasi_static_map(
    params: Parameters, alpha1: Angles, alpha2: Angles, *, sigma: Positive | None = None
) -> xr.Dataset:
    """Map where quasi-static sliding exists (A2), in both readings, and the state of Eq. (15).

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad.
        sigma: regularizing factor of the contact law, 1/m; None means the sharp law.

    Returns:
        Dataset over (alpha1, alpha2): Eq. (11) as printed, the reaction force of A2 (y = 0), and
        the equilibrium of Eq. (15), which has y ≠ 0 (E11). NaN with outcome singular_static_state
        where there is no such state.
    """
    refuse_scales(params)
    k3, load = a2.contact_stiffness(params, sigma), a2.actuation(params, sigma)
    system = contact_system(params, alpha1[:, None], alpha2[None, :], k3=k3)
    stiffness = system.stiffness
    reaction = a2.reaction_force(stiffness, params.drag, load)
    state = a3.static_state(
        stiffness, system.spring_determinant, k3=k3, mu=params.drag, actuation=load
    )
    # Farther out than this, the state is the quotient of two round-off errors.
    farthest = load / (a2.FEW_ULPS * (params.k1 + params.k2))
    singular = ~(np.hypot(state[0], state[1]) < farthest)
    x, y, force = (np.where(singular, np.nan, value) for value in state)
    return build(
        quasi_static_map_schema,
        {
            "possible_as_printed": a2.possible_as_printed(stiffness, params.drag),
            "possible": reaction > 0,
            "reaction_force": reaction,
            "x_static": x,
            "y_static": y,
            "contact_force_static": force,
            "stiffness_x": stiffness.k11,
            "stiffness_xy": stiffness.k12,
            "stiffness_y": stiffness.k22,
            "outcome": np.where(
                singular | np.isnan(reaction),
                Outcome.singular_static_state,
                Outcome.converged,
            ),
        },
        {"alpha1": alpha1, "alpha2": alpha2},
    )


@recorded(model="A3", method="closed form")
def stability_map(
    params: Parameters, alpha1: Angles, alpha2: Angles, *, sigma: Positive | None = None
) -> xr.Dataset:
    """Growth rate and frequencies of model A3, from closed forms; damped, from the quartic.

    Damped here means with dashpots or with friction whose slope at belt speed is not 0
    (:mod:`squealpipe.brake.models.damped`).

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad.
        sigma: regularizing factor in K3 of Eq. (8d), 1/m; None means the sharp law, K3 = k3.

    Returns:
        Dataset over (alpha1, alpha2, mode); a frequency is common to both modes in flutter, 0 for a
        divergent mode. Relative error below 1e-13, also next to the boundaries, where the
        eigenvalues of the rounded matrix are good to half of the digits only; damped, below 1e-12
        but where eigenvalues coalesce, for they are polished in long double, and NaN with outcome
        singular_static_state where friction depends on speed and no static contact force exists.
    """
    refuse_scales(params)
    if is_undamped(params):
        invariants = _spectrum(
            params, alpha1, alpha2, a2.contact_stiffness(params, sigma)
        )
        s = np.stack(a3.eigenvalues(invariants), axis=-1)
        growth, frequency, regime = s.real.max(axis=-1), s.imag, a3.regime(invariants)
        similarity = a3.shape_similarity(
            invariants, params.drag, a2.contact_stiffness(params, sigma), params.mass
        )
    else:
        pair = (
            alpha1.astype(np.longdouble)[:, None],
            alpha2.astype(np.longdouble)[None, :],
        )
        growth, frequency, regime, similarity = stability(
            damped_system(params, *pair, sigma=sigma)
        )
    outcomes = np.array([Outcome.converged, Outcome.complex_pair, Outcome.divergence])
    return build(
        stability_map_schema,
        {
            "growth_rate": growth,
            "frequency": frequency,
            "regime_linear": regime,
            "shape_similarity": similarity,
            "outcome": np.where(
                np.isnan(growth), Outcome.singular_static_state, outcomes[regime]
            ),
        },
        {"alpha1": alpha1, "alpha2": alpha2, "mode": [1, 2]},
    )


@recorded(model="A4", method="closed form")
def natural_frequencies(
    params: Parameters, alpha1: Angles, alpha2: Angles
) -> xr.Dataset:
    """Natural frequencies of model A4 in both of its states, Eqs. (22) and (25).

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad.

    Returns:
        Dataset over (alpha1, alpha2, mode, contact_state): omega (rad/s) and outcome.
        Where a pair is complex (flutter), omega holds the common |Im s|; where ω² < 0
        (divergence) and where the springs leave a direction free it is 0; the outcome says so.

    Raises:
        ValueError: damping or friction that A4 cannot carry.
    """
    refuse_extensions(params, "model A4", WHY_A4)
    refuse_scales(params)
    shape = (alpha1.size, alpha2.size, 2, 2)
    omega, outcomes = np.empty(shape), np.empty(shape, np.int8)
    for state, k3 in enumerate((params.k3, 0.0)):
        squares = natural_frequencies_squared(_spectrum(params, alpha1, alpha2, k3))
        # Below this ω1 is the round-off of a free direction, as at α1 = α2 = π/2 in contact.
        smallest = a2.FEW_ULPS**2 * np.abs(squares[1])
        for mode, square in enumerate(squares):
            rigid = np.abs(square) <= smallest
            omega[..., mode, state] = np.where(
                rigid, 0.0, np.abs(np.sqrt(-square).imag)
            )
            outcomes[..., mode, state] = np.select(
                [rigid, square.imag != 0, square.real < 0],
                [Outcome.rigid_mode, Outcome.complex_pair, Outcome.divergence],
                Outcome.converged,
            )
    return build(
        natural_frequencies_schema,
        {"omega": omega, "outcome": outcomes},
        {
            "alpha1": alpha1,
            "alpha2": alpha2,
            "mode": [1, 2],
            "contact_state": ["contact", "separated"],
        },
    )


def _spectrum(
    params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray, k3: float
) -> StiffnessSpectrum:
    """Invariants over the map, each to full relative precision for the angles as given.

    Next to a boundary the discriminant or the determinant is a small difference of rounded
    numbers. The few cells concerned go through the same formulas in more digits. Separated,
    both are sums of squares and nothing is lost.
    """
    system = contact_system(params, alpha1[:, None], alpha2[None, :], k3=k3)
    invariants = system.invariants
    # below this share of (trace/2)² a discriminant or determinant has lost digits, and is formed
    # in more
    small = 3e-4 * invariants.half_trace**2
    close = (np.abs(invariants.discriminant) < small) | (
        np.abs(invariants.determinant) < small
    )
    if k3 == 0 or not close.any():
        return invariants
    import mpmath  # a quarter of a second, which most jobs and commands can save

    rows, columns = np.nonzero(close)
    with mpmath.workdps(40):
        p = SimpleNamespace(
            **{name: _precise(getattr(params, name)) for name in NUMBERS_OF_A1}
        )
        g = Geometry(
            *_precise_geometry(alpha1, rows), *_precise_geometry(alpha2, columns)
        )
        sine = np.where(
            system.spring_determinant[close] == 0,
            mpmath.mpf(0),
            g.s1 * g.c2 + g.c1 * g.s2,
        )
        precise = spectrum(
            linear_stiffness(p, g),
            pair_determinant(p.k1, p.k2, sine),
            k3=_precise(k3),
            mu=_precise(params.drag),
            mass=p.mass,
        )
    for values, exact in zip(invariants, precise, strict=True):
        values[close] = exact.astype(float)
    return invariants


def _precise(value: float) -> np.ndarray:
    """One high-precision number that multiplies arrays of them."""
    import mpmath

    return np.array([mpmath.mpf(value)], dtype=object)


def _precise_geometry(
    angles: np.ndarray, index: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Cosines and sines of some of the angles as arrays of high-precision numbers."""
    import mpmath

    needed, inverse = np.unique(index, return_inverse=True)
    pairs = [mpmath.cos_sin(mpmath.mpf(value)) for value in angles[needed].tolist()]
    table = np.array(pairs, dtype=object).reshape(-1, 2)
    return table[inverse, 0], table[inverse, 1]
