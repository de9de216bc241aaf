"""A1 as a hybrid automaton: fields, guards and switching rules in plain floats.

Written from the definition of A1 (see :mod:`squealpipe.brake.models.a1`) and nothing else, so that
public integrators can run it and our own engine has an independent counterpart.
"""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from squealpipe.brake.models.a1 import State, Suspension, acceleration, suspension_force
from squealpipe.codes import Regime
from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.springs import Geometry, geometry

EventKind = IntEnum("EventKind", "separation contact belt_speed release", start=0)
DIRECTION = {Regime.slip_slower: 1.0, Regime.slip_faster: -1.0, Regime.stick: 0.0}


@dataclass
class HybridRun:
    """State at the end, and events in order; ``regimes`` begins with the one at the start.

    ``time`` is less than asked, and ``message`` not empty, where the integration failed.
    """

    state: np.ndarray
    time: float = 0.0
    event_times: list[float] = field(default_factory=list)
    event_kinds: list[int] = field(default_factory=list)
    event_states: list[np.ndarray] = field(default_factory=list)
    regimes: list[int] = field(default_factory=list)
    message: str = ""

    def add(self, kind, regime):
        """An event at the present time, and the regime behind it."""
        self.event_times.append(self.time)
        self.event_kinds.append(kind)
        self.event_states.append(self.state)
        self.regimes.append(regime)


class A1Automaton:
    """A1 at given parameters and angles; states are (x, y, ẋ, ẏ).

    ``as_printed``: friction has the sign of Eq. (4), which repels from belt speed, so that nothing
    sticks.
    """

    def __init__(
        self, params, alpha1, alpha2, *, linear_springs=False, as_printed=False
    ):
        self.params, self.as_printed = params, as_printed
        self.geometry = Geometry(*map(float, geometry(alpha1, alpha2)))
        dashpots = params.damping1 + params.damping2 > 0.0
        self.form = Suspension(linear_springs, dashpots=dashpots)

    def field(self, regime):
        """The field f(t, z) of a regime."""
        regime = Regime(regime)
        part = {
            "contact": float(regime != Regime.separated),
            "stick": float(regime == Regime.stick),
        }
        sign = -1.0 if self.as_printed else 1.0
        part |= {"direction": sign * DIRECTION.get(regime, 0.0), "form": self.form}

        def f(_, z):
            return *z[2:].tolist(), *acceleration(
                State(*z.tolist()), self.params, self.geometry, **part
            )

        return f

    def guards(self, regime):
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
        return [leave, (EventKind.belt_speed, self.lag, -DIRECTION[regime])]

    def gap(self, z):
        """l_pre − y, m: positive in contact."""
        return float(self.params.preload - z[1])

    def lag(self, z):
        """V − ẋ, m/s."""
        return float(self.params.belt_speed - z[2])

    def grip(self, z):
        """μs N, N: what friction can hold."""
        return float(stick_limit(contact_force(float(z[1]), self.params), self.params))

    def pull(self, z, axis=0):
        """x-force of springs and dashpots, N."""
        state = State(*z.tolist())
        return float(
            suspension_force(state, self.params, self.geometry, self.form)[axis]
        )

    def start(self, z):
        """The regime of a state; on the threshold the velocity decides, then the force."""
        gap = self.gap(z)
        apart = gap < 0.0 if gap else z[3] > 0.0 if z[3] else self.pull(z, 1) > 0.0
        return Regime.separated if apart else self._sliding(z)

    def switch(self, kind, z):
        """The next regime, and the state put exactly onto the guard that it met."""
        z = z.copy()
        if kind in {EventKind.separation, EventKind.contact}:
            z[1] = self.params.preload
            return (
                Regime.separated if kind == EventKind.separation else self._sliding(z)
            ), z
        z[2] = self.params.belt_speed
        return self._sliding(z, held=kind != EventKind.release), z

    def leave(self, regime, z, round_off):
        """A state that lies on a surface, moved off it into its regime by a unit of round-off.

        A guard that starts at exactly zero is found again at once, or hides the next crossing.
        """
        z = z.copy()
        if self.gap(z) == 0.0:
            shift = round_off * max(1.0, self.params.preload)
            z[1] += shift if regime == Regime.separated else -shift
        if self.lag(z) == 0.0 and regime in {Regime.slip_slower, Regime.slip_faster}:
            z[2] -= (
                DIRECTION[regime] * round_off * max(1.0, abs(self.params.belt_speed))
            )
        return z

    def _sliding(self, z, *, held=True):
        """Slip or stick in contact; at belt speed the force decides."""
        lag, pull = self.lag(z), self.pull(z)
        held = held and not self.as_printed
        if lag == 0.0 and held and abs(pull) <= self.grip(z):
            return Regime.stick
        return Regime.slip_faster if (lag or -pull) < 0.0 else Regime.slip_slower
