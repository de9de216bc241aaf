"""The regimes of all components at once, numbered as motions meet them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from squealpipe.systems.taylor.scalar import evaluate
from squealpipe.systems.taylor.symbols import derivative, symbol
from squealpipe.systems.trace import TIME, Traced


class Joint:
    """Equations of a system while each of its components is in one regime.

    Numbers stand for one regime of each component; with one component they are those of its
    regimes. Only what motions meet is numbered: there may be 4¹⁶.
    """

    def __init__(self, traced: Traced, units: Sequence[str]) -> None:
        self.traced, self._states = traced, tuple(units)
        self._rows: list[tuple[int, ...]] = []
        self._numbers: dict[tuple[int, ...], int] = {}
        self._holds: dict[int, np.ndarray] = {}
        firsts = [
            np.flatnonzero(traced.component_of == k) for k in range(traced.n_components)
        ]
        if len(firsts) == 1:
            for regime in firsts[0].tolist():
                self.number([regime])
        else:
            self.number([int(regimes[0]) for regimes in firsts])

    def number(self, regimes: Sequence[int]) -> int:
        """Return the number of a combination of the components' regimes."""
        key = tuple(int(regime) for regime in regimes)
        if key not in self._numbers:
            self._numbers[key] = len(self._rows)
            self._rows.append(key)
        return self._numbers[key]

    def regimes(self, number: int) -> tuple[int, ...]:
        """The regime of each component."""
        return self._rows[number]

    def entered(self, number: int, regime: int) -> int:
        """The number after one component has entered a regime."""
        row = list(self._rows[number])
        row[self.traced.component_of[regime]] = regime
        return self.number(row)

    def entered_by(self, number: int, switch: int) -> int:
        """The regime of the component that has this switch."""
        regime, _, _ = self.traced.switches[switch].targets[0]
        return self._rows[number][int(self.traced.component_of[regime])]

    def along(self, first: Sequence[int], entered: Sequence[int]) -> np.ndarray:
        """Numbers from a start on, after each of the regimes that are entered."""
        numbers = [self.number(first)]
        for regime in entered:
            numbers.append(self.entered(numbers[-1], int(regime)))
        return np.array(numbers, np.int64)

    def constants(self, number: int) -> np.ndarray:
        """All constants."""
        return self.traced.constants_in(self._rows[number])

    def falls(self, number: int) -> np.ndarray:
        """(surface,) the switch that fires where it falls through zero, or −1."""
        return self._watched(self.traced.falls, number)

    def rises(self, number: int) -> np.ndarray:
        """(surface,) the switch that fires where it rises through zero, or −1."""
        return self._watched(self.traced.rises, number)

    def _watched(self, table: np.ndarray, number: int) -> np.ndarray:
        t = self.traced
        row = np.array(self._rows[number], np.int64)
        return np.asarray(table[row[t.owner], np.arange(len(t.surfaces))])

    def seen(self, number: int, surface: int) -> int:
        """The number in which a surface is as those see it that watch it."""
        watched = (self.traced.falls[:, surface] >= 0) | (
            self.traced.rises[:, surface] >= 0
        )
        return self.entered(number, int(np.argmax(watched)))

    def holds(self, number: int) -> np.ndarray:
        """(surface,) whether it is constant along the motion, as in stick."""
        if number not in self._holds:
            self._holds[number] = self._held(number)
        return self._holds[number]

    def sticks(self, number: int) -> np.ndarray:
        """(surface,) whether what it watches is held, by itself or behind a spring."""
        return self.holds(number)

    def begins_at_zero(self, before: int, after: int) -> np.ndarray:  # noqa: ARG002
        """(surface,) whether it is zero at every change between these regimes."""
        return np.zeros(len(self.traced.surfaces), bool)

    def _held(self, number: int) -> np.ndarray:
        t, rng = self.traced, np.random.default_rng(2)
        names = [TIME, *self._states, *t.parameters, *t.constants]
        values: dict[str, Any] = {name: rng.uniform(0.3, 1.7, 16) for name in names}
        held = np.zeros(len(t.surfaces), bool)
        here = dict(zip(t.constants, self.constants(number), strict=True))

        def at(roots: Any, constants: dict[str, Any]) -> np.ndarray:
            with np.errstate(all="ignore"):
                numbers = evaluate([symbol(root) for root in roots], values | constants)
            return np.array([np.broadcast_to(number, 16) for number in numbers])

        rates = at(t.rates, here)
        for index, surface in enumerate(t.surfaces):
            seen = self.constants(self.seen(number, index))
            slopes = at(
                [derivative(surface, z) for z in t.variables],
                dict(zip(t.constants, seen, strict=True)),
            )
            # relative to its terms: in SI their round-off alone may be far above any fixed number
            terms = slopes * rates
            held[index] = (
                np.abs(terms.sum(axis=0)) <= 1e-13 * np.abs(terms).sum(axis=0) + 1e-14
            ).all()
        return held
