"""The friction at which steady sliding turns unstable, over the angles and over both dashpots."""

from __future__ import annotations  # help shows Angle, not its checks

from types import SimpleNamespace

import xarray as xr

from squealpipe.brake.models.damped import critical_friction, dashpots_lower
from squealpipe.brake.schema.linear import (
    critical_damping_map_schema,
    critical_friction_map_schema,
)
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import slope
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.systems.inputs.values import brief
from squealpipe.validation import Angle, Angles, NotNegativeVector


@recorded(model="A3", method="closed form")
def critical_friction_map(
    params: Parameters, alpha1: Angles, alpha2: Angles
) -> xr.Dataset:
    """The friction at which steady sliding turns unstable: A3 and Coulomb, by Routh–Hurwitz.

    Args:
        params: physical parameters; the sign of the belt's speed counts, ``mu`` does not.
        alpha1, alpha2: 1-D arrays of angles, rad.

    Returns:
        Dataset over (alpha1, alpha2): the critical friction with dashpots, without them, and in the
        limit of both going to 0 at their ratio (without them where there are none), each ∞ where no
        friction destabilizes.

    Raises:
        ValueError: the friction law depends on speed, so that its slope counts beside μ.
    """
    _refuse_slope(params)
    pair = alpha1[:, None], alpha2[None, :]
    critical, undamped = critical_friction(params, *pair)
    vanishing, _ = critical_friction(params, *pair, vanishing=True)
    return build(
        critical_friction_map_schema,
        {
            "critical_mu": critical,
            "critical_mu_undamped": undamped,
            "critical_mu_vanishing": vanishing,
            "destabilized": dashpots_lower(critical, undamped),
        },
        {"alpha1": alpha1, "alpha2": alpha2},
    )


@recorded(model="A3", method="closed form")
def critical_damping_map(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    damping1: NotNegativeVector,
    damping2: NotNegativeVector,
) -> xr.Dataset:
    """The critical friction of :func:`critical_friction_map` at one pair of angles, over dashpots.

    Args:
        alpha1, alpha2: angles, rad.
        damping1, damping2: 1-D arrays of dashpots along springs 1 and 2, N·s/m, 0 or greater.

    Returns:
        Dataset over (damping1, damping2), ∞ where no friction destabilizes.
    """
    _refuse_slope(params)
    numbers = {
        name: getattr(params, name) for name in ("mass", "k1", "k2", "k3", "drag")
    }
    system = SimpleNamespace(
        **numbers,
        belt_direction=params.belt_direction,
        damping1=damping1[:, None],
        damping2=damping2[None, :],
    )
    critical, undamped = critical_friction(system, alpha1, alpha2)
    return build(
        critical_damping_map_schema,
        {
            "critical_mu": critical,
            "critical_mu_undamped": undamped,
            "destabilized": dashpots_lower(critical, undamped),
            "alpha1": alpha1,
            "alpha2": alpha2,
        },
        {"damping1": damping1, "damping2": damping2},
    )


def _refuse_slope(params: Parameters) -> None:
    """Stop a friction law whose slope counts beside μ, and a contact that is not linear."""
    if params.contact_law != LINEAR:
        raise ValueError(
            f"contact_law = {brief(params.contact_law)}: critical friction is that of the linear "
            "contact; use stability_map, or contact_law = 'linear'"
        )
    if slope(abs(params.belt_speed), params) != 0:
        raise ValueError(
            f"friction_law = {brief(params.friction_law)}: critical friction is that of Coulomb's "
            "law, for the slope of another counts beside μ; use stability_map in a sweep over mu, "
            "or friction_law = 'coulomb'"
        )
