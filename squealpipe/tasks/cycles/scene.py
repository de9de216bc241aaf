"""A1 as a system of cycles: its parameters in units of m = k1 = l_pre = 1."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from squealpipe.codes import Event, Regime
from squealpipe.laws import contact_laws
from squealpipe.laws.springs import fixed_ends, geometry
from squealpipe.models.damped import is_undamped
from squealpipe.parameters import TABLE, Parameters
from squealpipe.solvers.a1.ensemble import NEAR_PIVOT
from squealpipe.solvers.a1.scaling import PHYSICAL, plain, unit_value
from squealpipe.systems.brake import brake, parameters_of_run, regimes_of
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.system import System

DASHPOTS = ("damping1", "damping2")
FAMILY = 1e-6
"""A second multiplier this close to 1 belongs to a family of cycles."""


@dataclass(frozen=True)
class Scene:
    """Parameters and angles, and the units of what a cycle of them is made of.

    Attributes:
        alpha1, alpha2: angles, rad.
        follow: the parameter or angle that changes, if any.
        model: "A1" or one of its variants.
    """

    params: Parameters
    alpha1: float
    alpha2: float
    follow: str | None = None
    model: str = "A1"

    @cached_property
    def units(self) -> dict[str, float]:
        """Of each parameter and of what a cycle has."""
        p = self.params
        bases = (np.asarray(p.mass), np.asarray(p.k1), np.asarray(p.preload))
        found = {
            name: float(unit_value(TABLE[name].units, *bases))
            for name in PHYSICAL
            if TABLE[name].allowed != "law"
        }
        return {**found, "alpha1": 1.0, "alpha2": 1.0}

    @cached_property
    def state_units(self) -> np.ndarray:
        """Of x, y, ẋ and ẏ."""
        length, speed = self.params.preload, self.params.preload / self.params.time_unit
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
        """The brake with these laws."""
        return brake(
            self.params.friction_law,
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

    @cached_property
    def tied(self) -> dict[str, str]:
        """A static coefficient that is none of its own changes with the sliding one."""
        return {"static_mu": "mu"} if self.params.mu_static is None else {}

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

    def is_family_member(self, cycle: Cycle) -> bool:
        """Whether a second multiplier is 1 in a system whose cycles come in families."""
        near = np.abs(cycle.nontrivial - 1.0).min() < FAMILY
        return bool(near and is_undamped(self.params) and self.follow not in DASHPOTS)

    def is_singular(self, places: np.ndarray) -> bool:
        """Whether one of some places, (…, 2), is next to a pivot, where d = 0."""
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
            "stable": int(cycle.is_stable and not self.is_family_member(cycle)),
            "multiplier_real": cycle.multipliers.real,
            "multiplier_imag": cycle.multipliers.imag,
        }
