"""Find the regimes in which runs may start, from what each regime asks of the state.

Idea: a switch out of a regime on one sign of a surface says that the regime holds on the other
sign; a regime that a constraint holds, as stick, asks for a zero as well. The first regime whose
conditions all hold is that of the start.
"""

from collections.abc import Mapping
from copy import copy
from typing import Any, NamedTuple, Self

import numpy as np

from squealpipe.systems.components import Composition
from squealpipe.systems.taylor.scalar import numpy_function
from squealpipe.systems.trace import TIME_UNIT, Traced


class _Asked(NamedTuple):
    """Condition of a regime on the state: a function, its arguments, and the sign that it needs.

    The sign is 0 where it must vanish.
    """

    function: Any
    names: list[str]
    sign: float


class Starts:
    """The regimes that runs may start in, and what each asks of the state."""

    def __init__(self, traced: Traced, composition: Composition) -> None:
        self.traced, self.composition = traced, composition
        self.entries = [self._entries(k) for k in range(traced.n_components)]

    def with_constants(self, traced: Traced, composition: Composition) -> Self:
        """Return the conditions of a system that differs by its regimes' constants alone."""
        other = copy(self)
        other.traced, other.composition = traced, composition
        return other

    def _entries(self, component: int) -> list[tuple[int, list[_Asked]]]:
        """The regimes of a component in the order in which they are tried.

        What is below zero on a clock is chosen only if no other regime fits: nothing is beyond it.
        """
        entries = self._entries_with(component, 1)
        if self.traced.clocks.any() and not self.traced.starts[component]:
            entries += self._entries_with(component, 0)
        return entries

    def _entries_with(
        self, component: int, with_clocks: int
    ) -> list[tuple[int, list[_Asked]]]:
        """The regimes of a component, whose clocks count or do not."""
        traced, found = self.traced, []
        starts = traced.starts[component]
        n_switches = len(traced.switches)
        entries = starts or tuple(
            (int(i), None, None) for i in self.composition.regimes_of(component)
        )
        for position, (regime, condition, equality) in enumerate(entries):
            asked = [] if equality is None else [(equality, 0.0)]
            if condition is not None:
                asked.append((condition, 1.0))
            elif position != len(starts) - 1:
                for table, sign in (
                    (traced.falls[regime], 1.0),
                    (traced.rises[regime], -1.0),
                ):
                    watched = np.flatnonzero(
                        (table >= 0)
                        & (table < n_switches)
                        & (traced.marks[regime] == 0)  # beyond these nothing is
                        & (traced.clocks <= with_clocks)
                    )
                    asked += [(traced.surfaces[index], sign) for index in watched]
            checks = [_Asked(*numpy_function([root]), sign) for root, sign in asked]
            found.append((regime, checks))
        return found

    def regimes(
        self, values: Mapping[str, Any], size: int, chosen: np.ndarray
    ) -> np.ndarray:
        """The regime of each component in each run, (size, components).

        What a component's regimes ask of the state may depend on those of the others: they are
        gone through in order until none changes.

        Args:
            values: states, parameters and ``time`` as arrays of that size.
            chosen: (components,) regimes that are known; −1 of others.
        """
        open_ones = np.flatnonzero(chosen < 0).tolist()
        last = [entries[-1][0] for entries in self.entries]
        numbers = np.tile(np.where(chosen < 0, last, chosen), (size, 1)).astype(
            np.int64
        )
        known = {TIME_UNIT: np.ones(size), **values}
        fits = np.ones((size, self.traced.n_components), bool)
        # the others' regimes may change again: four rounds over all components for each of them
        for _ in range(4 * len(open_ones)):
            before = numbers.copy()
            for k in open_ones:
                first = self._first_that_fits(known, numbers, k)
                fits[:, k] = first >= 0
                numbers[:, k] = np.where(first >= 0, first, numbers[:, k])
            if self.traced.n_components == 1 or (before == numbers).all():
                break
        if not fits.all():
            unfit = self.composition.names[int(np.argmin(fits.all(axis=0)))]
            of = f" of component {unfit!r}" if unfit else ""
            raise ValueError(
                f"no regime{of} fits the start: in each, some surface is below zero; give "
                "start={'regime': …} or starts_in"
            )
        return numbers

    def _first_that_fits(
        self, known: Mapping[str, Any], now: np.ndarray, component: int
    ) -> np.ndarray:
        """The first regime of a component that fits each run; −1 where none does."""
        traced, size = self.traced, len(now)
        chosen = np.full(size, -1, np.int64)
        values = dict(known)
        for k in range(traced.n_components):
            columns = traced.columns(k)
            constants = traced.regimes[now[:, k], columns].T
            values |= dict(zip(traced.constants[columns], constants, strict=True))
        names = traced.constants[traced.columns(component)]
        for regime, checks in self.entries[component]:
            fits = chosen < 0
            if not fits.any():
                break
            row = traced.regimes[regime, traced.columns(component)].tolist()
            values |= dict(zip(names, row, strict=True))
            for function, arguments, sign in checks:
                terms = [np.asarray(values[name]) for name in arguments]
                (value,) = function(*terms)
                # an equality holds within round-off of what it is computed from
                fits &= (
                    sign * value >= 0.0
                    if sign
                    else abs(value) <= 1e-15 * sum(map(abs, terms))
                )
                if not fits.any():
                    break
            chosen = np.where(fits, regime, chosen)
        return chosen
