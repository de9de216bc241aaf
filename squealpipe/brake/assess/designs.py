"""Changes of a pad's design, each with the range over which it is searched."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from squealpipe.brake.assess.sliding import Design
from squealpipe.laws.friction_laws import COULOMB, LAWS
from squealpipe.laws.tables import is_table, scaled
from squealpipe.parameters import Parameters
from squealpipe.substitutes import critical_damping
from squealpipe.vibration.boundaries import Cure


@dataclass(frozen=True)
class CureRanges:
    """Ranges in which parameters are changed to find where the verdict does."""

    factor: float = 10.0
    """Stiffnesses and the like go from the value divided by this to its product with it."""
    farthest_angle: float = math.radians(60.0)
    """Largest change of an angle, rad."""
    angle_step: float = math.radians(2.0)
    """Step of the search along an angle, rad; a range of another verdict that is narrower may be
    missed."""


def cures_of(design: Design) -> dict[str, Cure]:
    """All cures of a design by name."""
    params = design.params
    cures = {
        "mu": _friction(design),
        "k3": _scaled(
            params.k3,
            lambda value: design._replace(params=_with_contact(params, value)),
        ),
    }
    for name in ("k1", "k2", "preload", "belt_speed"):
        cures[name] = _scaled(getattr(params, name), partial(design.at, name))
    for name in ("alpha1", "alpha2"):
        now = getattr(design, name)
        steps = CureRanges.angle_step * np.arange(
            1, 1 + round(CureRanges.farthest_angle / CureRanges.angle_step)
        )
        cures[name] = Cure(
            now, partial(design.at, name), now - steps, now + steps, is_angle=True
        )
    cures["damping"] = _damping(design)
    return cures


def with_friction(params: Parameters, factor: float) -> Parameters:
    """The whole friction law times a factor."""
    static = None if params.mu_static is None else params.mu_static * factor
    law = params.friction_law
    if law in LAWS:
        return params.with_(mu=params.mu * factor, mu_static=static)
    if is_table(law):
        return params.with_(friction_law=scaled(law, 1.0, 1.0 / factor))
    # the factor ``mu`` stands outside the law, which is then compiled once for all factors
    plain = (
        "_plain_coefficient = coefficient\n"
        "class _AsGiven:\n"
        "    mu = {mu!r}\n"
        "def coefficient(speed, p):\n"
        "    return p.mu * _plain_coefficient(speed, _AsGiven)\n"
    )
    source = f"{law}\n{plain.format(mu=params.mu)}"
    return params.with_(friction_law=source, mu=factor, mu_static=static)


def damping_ratio(params: Parameters) -> float:
    """Mean of both dashpots over 2 √(k m) of their springs."""
    ratios = (
        params.damping1 / critical_damping(params.k1, params.mass),
        params.damping2 / critical_damping(params.k2, params.mass),
    )
    return 0.5 * sum(ratios)


def _friction(design: Design) -> Cure:
    params = design.params
    # of whatever law, the coefficient at which the mass slides steadily
    mu = abs(params.drag)
    if mu == 0.0:
        above = np.linspace(0.0, 1.0, 51)[1:]
        level = params.with_(friction_law=COULOMB, mu_static=None, friction_speed=1.0)
        return Cure(
            0.0,
            lambda value: design._replace(params=level.with_(mu=value)),
            np.zeros(0),
            above,
        )
    # three times the friction, or coefficient 1 where that is more
    factors = _factors(max(3.0, 1.0 / mu))
    # a table of zeros could not be scaled back, so 0 itself is left out
    below = np.append(mu / _factors(CureRanges.factor), 1e-9 * mu)
    return Cure(
        mu,
        lambda value: design._replace(params=with_friction(params, value / mu)),
        below,
        mu * factors,
    )


def _with_contact(params: Parameters, stiffness: float) -> Parameters:
    """The contact with another stiffness: a table's forces are scaled."""
    if is_table(params.contact_law):
        factor = stiffness / params.k3
        return params.with_(contact_law=scaled(params.contact_law, 1.0, 1.0 / factor))
    return params.with_(k3=stiffness)


def _damping(design: Design) -> Cure:
    params, ratio = design.params, damping_ratio(design.params)

    def apply(value: float) -> Design:
        if ratio > 0.0:
            factor = value / ratio
            changed = {
                "damping1": params.damping1 * factor,
                "damping2": params.damping2 * factor,
            }
        else:
            changed = {
                f"damping{i}": value * critical_damping(stiffness, params.mass)
                for i, stiffness in ((1, params.k1), (2, params.k2))
            }
        return design._replace(params=params.with_(**changed))

    below = (
        np.append(ratio / _factors(CureRanges.factor), 0.0)
        if ratio > 0.0
        else np.zeros(0)
    )
    least = max(ratio, 1e-4)
    above = np.geomspace(least, max(0.5, 2.0 * least), 60)
    return Cure(ratio, apply, below, above[above > ratio])


def _scaled(value: float, apply: Callable[[float], Design]) -> Cure:
    """A number whose sign stays."""
    factors = _factors(CureRanges.factor) if value else np.zeros(0)
    return Cure(value, apply, value / factors, value * factors)


def _factors(most: float) -> np.ndarray:
    # values that are looked at first differ by 8 %
    return np.geomspace(1.0, most, 1 + math.ceil(math.log(most) / math.log(1.08)))[1:]
