"""A1 as a hybrid automaton: fields, guards and switching rules in plain floats.

Written from the definition of A1 (see :mod:`squealpipe.models.a1`) and nothing else, so that
public integrators can run it and our own engine has an independent counterpart.

Regimes are those of :class:`squealpipe.codes.Regime`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np

from squealpipe.codes import Regime
from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.springs import Geometry, geometry
from squealpipe.models.a1 import acceleration, suspension_force
from squealpipe.parameters import Parameters


class EventKind(IntEnum):
    """What ends a regime."""

    separation = 0
    contact = 1
    belt_speed = 2
    release = 3


@dataclass
class HybridRun:
    """What an integration from event to event gave.

    Attributes:
        state: at the end.
        time: reached; less than asked where it failed.
        event_times, event_kinds: in order.
        regimes: the regime at the start and after each event.
        message: empty where it ran to the end.
    """

    state: np.ndarray
    time: float = 0.0
    event_times: list[float] = field(default_factory=list)
    event_kinds: list[int] = field(default_factory=list)
    regimes: list[int] = field(default_factory=list)
    message: str = ""


_DIRECTION = {Regime.slip_slower: 1.0, Regime.slip_faster: -1.0, Regime.stick: 0.0}


class A1Automaton:
    """A1 at given parameters and angles; states are (x, y, ẋ, ẏ)."""

    def __init__(
        self,
        params: Parameters,
        alpha1: float,
        alpha2: float,
        *,
        linear_springs: bool = False,
    ) -> None:
        self.params = params
        self.geometry = Geometry(*map(float, geometry(alpha1, alpha2)))
        self.linear_springs = linear_springs
        self.dashpots = params.damping1 + params.damping2 > 0.0

    def field(self, regime: int) -> Any:
        """The field f(t, z) of a regime."""
        p, g = self.params, self.geometry
        contact = 0.0 if regime == Regime.separated else 1.0
        stick = 1.0 if regime == Regime.stick else 0.0
        direction = _DIRECTION.get(Regime(regime), 0.0)

        def f(_: float, z: np.ndarray) -> tuple[float, float, float, float]:
            x, y, vx, vy = z.tolist()
            ax, ay = acceleration(
                x, y, vx, vy, p, g, contact=contact, direction=direction, stick=stick,
                linear_springs=self.linear_springs, dashpots=self.dashpots,
            )  # fmt: skip
            return vx, vy, ax, ay

        return f

    def guards(self, regime: int) -> list[tuple[EventKind, Any, int]]:
        """(kind, function of the state, direction of the crossing) of a regime's guards."""
        if regime == Regime.separated:
            return [(EventKind.contact, self.gap, 1)]
        leave = (EventKind.separation, self.gap, -1)
        if regime == Regime.stick:
            return [
                leave,
                (EventKind.release, lambda z: self.grip(z) - self.pull(z), -1),
                (EventKind.release, lambda z: self.grip(z) + self.pull(z), -1),
            ]
        direction = -1 if regime == Regime.slip_slower else 1
        return [leave, (EventKind.belt_speed, self.lag, direction)]

    def gap(self, z: np.ndarray) -> float:
        """l_pre − y, m: positive in contact."""
        return float(self.params.preload - z[1])

    def lag(self, z: np.ndarray) -> float:
        """V − ẋ, m/s."""
        return float(self.params.belt_speed - z[2])

    def grip(self, z: np.ndarray) -> float:
        """μs N, N: what friction can hold."""
        return float(stick_limit(contact_force(float(z[1]), self.params), self.params))

    def pull(self, z: np.ndarray) -> float:
        """x-force of springs and dashpots, N."""
        return float(self._suspension(z)[0])

    def start(self, z: np.ndarray) -> int:
        """The regime of a state, also of one that lies on guards."""
        if self._in_contact(z):
            return self._sliding(z)
        return Regime.separated

    def switch(self, kind: int, z: np.ndarray) -> tuple[int, np.ndarray]:
        """The next regime, and the state put exactly onto the guard that it met."""
        z = z.copy()
        if kind in (EventKind.separation, EventKind.contact):
            z[1] = self.params.preload
            if kind == EventKind.separation:
                return Regime.separated, z
            return self._sliding(z), z
        z[2] = self.params.belt_speed
        if kind == EventKind.release:
            return (Regime.slip_faster if self.pull(z) > 0 else Regime.slip_slower), z
        return self._sliding(z), z

    def leave(self, regime: int, z: np.ndarray, round_off: float) -> np.ndarray:
        """A state that lies on a surface, moved off it into its regime by a unit of round-off.

        A guard that starts at exactly zero is found again at once, or hides the next crossing.
        """
        z = z.copy()
        if self.gap(z) == 0.0:
            shift = round_off * max(1.0, self.params.preload)
            z[1] += shift if regime == Regime.separated else -shift
        if self.lag(z) == 0.0 and regime in {Regime.slip_slower, Regime.slip_faster}:
            shift = round_off * max(1.0, abs(self.params.belt_speed))
            z[2] += shift if regime == Regime.slip_faster else -shift
        return z

    def _in_contact(self, z: np.ndarray) -> bool:
        """On the threshold the velocity decides, then the force."""
        if self.gap(z) != 0.0:
            return self.gap(z) > 0.0
        if z[3] != 0.0:
            return bool(z[3] < 0.0)
        return bool(self._suspension(z)[1] <= 0.0)

    def _sliding(self, z: np.ndarray) -> int:
        """Slip or stick in contact; at belt speed the force decides."""
        lag = self.lag(z)
        if lag != 0.0:
            return Regime.slip_slower if lag > 0.0 else Regime.slip_faster
        if abs(self.pull(z)) <= self.grip(z):
            return Regime.stick
        return Regime.slip_faster if self.pull(z) > 0.0 else Regime.slip_slower

    def _suspension(self, z: np.ndarray) -> tuple[float, float]:
        x, y, vx, vy = z.tolist()
        p, g = self.params, self.geometry
        return suspension_force(
            x, y, vx, vy, p, g, linear_springs=self.linear_springs, dashpots=self.dashpots
        )
