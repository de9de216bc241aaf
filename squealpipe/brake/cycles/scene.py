"""A1 as a system of cycles: its parameters in units of m = k1 = l_pre = 1."""

import math
import re
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from squealpipe.brake.a1.ensemble import NEAR_PIVOT
from squealpipe.brake.a1.motion_system import (
    brake,
    has_own_laws,
    parameters_of_run,
    regimes_of,
)
from squealpipe.brake.models.damped import is_undamped
from squealpipe.codes import Event, Regime
from squealpipe.laws import contact_laws
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, FALLING
from squealpipe.laws.springs import fixed_ends, geometry
from squealpipe.laws.tables import is_table
from squealpipe.parameters import NUMBERS_OF_A1, PHYSICAL, TABLE, Parameters
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.system import System

DASHPOTS = ("damping1", "damping2")
IN_SYSTEM = {of: name for name, of in NUMBERS_OF_A1.items()} | {
    angle: angle for angle in ("alpha1", "alpha2")
}
"""Parameter or angle → its name in the system."""


@dataclass(frozen=True)
class CycleScene:
    """Parameters and angles, and the units of what a cycle of them is made of.

    Attributes:
        alpha1, alpha2: angles, rad.
        follow: the parameter or angle that changes, if any.
        model: "A1" or one of its variants.
        reference: parameters whose m, k1 and l_pre are the units, if not ``params``.
    """

    params: Parameters
    alpha1: float
    alpha2: float
    follow: str | None = None
    model: str = "A1"
    reference: Parameters | None = None

    @cached_property
    def units(self) -> dict[str, float]:
        """Of each parameter and of what a cycle has."""
        p = self.reference or self.params
        bases = (np.asarray(p.mass), np.asarray(p.k1), np.asarray(p.preload))
        found = {
            name: float(unit_value(TABLE[name].units, *bases))
            for name in PHYSICAL
            if TABLE[name].allowed != "law"
        }
        return {**found, "alpha1": 1.0, "alpha2": 1.0}

    def at(self, value: float) -> Self:
        """The same at another value, in these units, of what is followed."""
        name = str(self.follow)
        if name == "alpha1":
            return replace(self, alpha1=value)
        if name == "alpha2":
            return replace(self, alpha2=value)
        moved = self.params.with_(**{name: value * self.units[name]})
        return replace(self, params=moved, reference=self.reference or self.params)

    @cached_property
    def state_units(self) -> np.ndarray:
        """Of x, y, ẋ and ẏ."""
        p = self.reference or self.params
        length, speed = p.preload, p.preload / p.time_unit
        return np.array([length, length, speed, speed])

    @cached_property
    def scaled(self) -> Parameters:
        """The parameters in these units; of laws of the user's own the numbers alone."""
        p = plain(self.params)
        values = {name: getattr(p, name) for name in self.units if name in TABLE}
        return p.with_(
            **{n: v if v is None else v / self.units[n] for n, v in values.items()}
        )

    @cached_property
    def system(self) -> System:
        """The brake with these laws.

        A static coefficient that is none of its own follows the law's numbers.
        """
        law = self.params.friction_law
        one_mu = self.params.mu_static is None and not is_table(law)
        return brake(
            COULOMB if one_mu and law in FALLING else law,
            one_mu=one_mu,
            damped=not is_undamped(self.params) or self.follow in DASHPOTS,
            contact_law=contact_laws.relative(
                self.params.contact_law, self.params.preload
            ),
            model=self.model,
        )

    @property
    def values(self) -> dict[str, float]:
        """What a run of the system is given."""
        damping3 = self.params.damping3 / self.units["damping3"]
        return parameters_of_run(self.scaled, self.alpha1, self.alpha2) | {
            "damping3": damping3
        }

    @property
    def slow_time(self) -> float:
        """√(m/min(k1, k2)): motions of the softer spring settle last, whichever it is."""
        return float((self.scaled.mass / min(self.scaled.k1, self.scaled.k2)) ** 0.5)

    @cached_property
    def regimes(self) -> list[Regime]:
        """A1's regime of each regime of the system, which may have several of a kind."""
        return regimes_of(self.system)

    @cached_property
    def kinds(self) -> list[Event | None]:
        """A1's kind of each event of the system; None of a law's knots."""
        return [Event.__members__.get(name) for name in self.system.traced.kinds]

    def count(self, cycle: Cycle) -> int:
        """A1's events of a cycle."""
        return sum(self.kinds[event.kind] is not None for event in cycle.events)

    def is_singular(self, places: np.ndarray) -> bool:
        """Return whether one of some places, (…, 2), is next to a pivot, where d = 0."""
        p = self.scaled
        x1, y1, x2, y2 = fixed_ends(p, geometry(self.alpha1, self.alpha2))
        return any(
            bool((np.hypot(*(places - [x, y]).T) < NEAR_PIVOT * length).any())
            for x, y, length in ((x1, y1, p.length1), (x2, y2, p.length2))
        )

    def numbers(self, cycle: Cycle) -> dict[str, Any]:
        """The scalars of a dataset, and the multipliers."""
        length, force = self.params.preload, self.params.k1 * self.params.preload
        regimes = [self.regimes[event.before] for event in cycle.map.events]
        share = {
            regime: float(cycle.parts.durations[[r == regime for r in regimes]].sum())
            / cycle.period
            for regime in (Regime.separated, Regime.stick)
        }
        low, high = cycle.extremes
        return {
            "period": cycle.period * self.params.time_unit,
            "x_min": low[0] * length,
            "x_max": high[0] * length,
            "y_min": low[1] * length,
            "y_max": high[1] * length,
            "contact_fraction": 1.0 - share[Regime.separated],
            "stick_fraction": share[Regime.stick],
            "least_contact_force": max(low[4], 0.0) * force,
            "residual": cycle.closing_error,
            "stable": int(cycle.is_stable),
            "multiplier_real": cycle.multipliers.real,
            "multiplier_imag": cycle.multipliers.imag,
        }


def plain(parameters: Parameters) -> Parameters:
    """The numbers that a law of the user's own stands for, under laws that have formulas."""
    if not has_own_laws(parameters):
        return parameters
    numbers = {
        name: getattr(parameters, name) for name in ("mu", "k3", "friction_speed")
    }
    return parameters.with_(
        **numbers,
        mu_static=parameters.static_mu,
        friction_law=FALLING[0],
        contact_law=LINEAR,
        damping3=0.0,
    )


def unit_value(unit: str, mass: np.ndarray, k1: np.ndarray, length: np.ndarray) -> Any:
    """A unit such as "N s m-1" in terms of m, k1 and l_pre; a newton is the unit k1 l_pre."""
    powers = {"kg": 0, "N": 0, "m": 0, "s": 0}
    for base, power in re.findall(r"([A-Za-z]+)(-?\d*)", unit):
        powers[base] += int(power or 1)
    powers["m"] += powers["N"]
    bases = {"kg": mass, "N": k1, "m": length, "s": np.sqrt(mass / k1)}
    above, below = (
        math.prod(
            bases[base] ** abs(power)
            for base, power in powers.items()
            if power * sign > 0
        )
        for sign in (1, -1)
    )
    return above / below
