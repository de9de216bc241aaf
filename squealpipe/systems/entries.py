"""Check how regimes are entered: switches make progress, and fields have a Taylor series there.

Idea: a switch that leads to a regime which it leaves at once, or a power whose base is zero where
its regime begins, fails only in the middle of a run. Both are therefore tried beforehand, on random
states of each switch's surface: such a state lies on the line between two random ones of which the
surface has different signs. Invariant: a system is refused only for a state that was found, which
the message names; a random search proves nothing about others. Cost: some thousand evaluations of
the fields, without compilation.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from squealpipe.systems.taylor.scalar import (
    REGIME,
    SwitchSymbols,
    evaluate,
    numpy_function,
)
from squealpipe.systems.taylor.symbols import Symbol, derivative, symbol
from squealpipe.systems.text import expression
from squealpipe.systems.trace import Traced, Tracer


@dataclass(frozen=True)
class EntryChecks:
    """Effort and tolerances of the checks of how regimes are entered."""

    samples: int = 64
    """Random states that are tried on each surface; more find rarer faults."""
    halvings: int = 55
    """Halvings of the way between two states to the surface between them: to round-off."""
    reaches: tuple[float, ...] = (3.0, 60.0, 6e4)
    """Largest values of the random states between which a surface is searched, in turn."""
    enough: int = 16
    """States that all must fire again before a switch is refused: fewer may do so by chance."""
    most_regimes: int = 8
    """Regimes of a switch in which its progress is tried; a system of many components has
    thousands."""
    stays: float = 1e-9
    """A reset that leaves the surface this close, over its change in a unit of time, has left it
    where it was."""
    vanishes: float = 1e-14
    """A base smaller than this vanishes at an entry ..."""
    alike: float = 1e-6
    """... unless it has the same value within this share at every entry: then it is a small
    number."""


checks = EntryChecks()
Values = dict[str, Any]


class Entries:
    """Ways in which the regimes of a system are entered."""

    def __init__(self, tracer: Tracer, traced: Traced) -> None:
        self.tracer, self.traced = tracer, traced
        self.on_surface = cache(self._on_surface)
        self.bases = cache(self._bases)

    def check_progress(
        self, name: str, switch: SwitchSymbols, leaves: Sequence[int]
    ) -> None:
        """Refuse a switch that would fire again at once, wherever its surface is crossed.

        It then leads to a regime that it leaves, where the surface is beyond zero, or at zero and
        falling. One that changes nothing at all only marks an event.
        """
        entered = {regime for regime, _, _ in switch.targets}
        marks = len(leaves) == 1 and switch.changes_nothing_in(leaves[0])
        if marks or not entered & set(leaves):
            return
        tried = leaves[:: -(-len(leaves) // checks.most_regimes)]
        every = [self._fires_again(switch, regime, leaves) for regime in tried]
        again = np.concatenate(every)
        if again.size >= checks.enough and again.all():
            raise ValueError(
                f"switch {name!r} leads back into a regime that it leaves, and its reset leaves "
                "the state where the surface goes on falling: it would fire again at once, without "
                "end; reset a state that turns it, or lead to another regime"
            )

    def _fires_again(
        self, switch: SwitchSymbols, regime: int, leaves: Sequence[int]
    ) -> np.ndarray:
        """Return whether the switch fires again, for each state in which its surface falls through
        zero.
        """
        traced, surface = self.traced, switch.surface
        slope: Any = symbol(0.0)
        for variable, rate in zip(traced.variables, traced.rates, strict=True):
            slope = slope + derivative(surface, variable) * rate
        before = self.on_surface(surface, regime)
        conditions = [symbol(c) for _, c, _ in switch.targets if c is not None]
        with np.errstate(all="ignore"):
            (speed,) = evaluate([symbol(slope)], before)
            chosen = evaluate(conditions, before)
        speed = np.broadcast_to(speed, _count(before, self.tracer))
        waiting, again = speed < 0.0, np.zeros(speed.shape, bool)
        falls = waiting.copy()
        for (into, condition, _), value in zip(
            switch.targets, [*chosen, np.inf], strict=False
        ):
            here = waiting if condition is None else waiting & (value >= 0.0)
            waiting = waiting & ~here
            if into not in leaves:
                continue
            after = self._after(switch.resets[into], before)
            after |= constants_of(traced, into)
            with np.errstate(all="ignore"):
                height, rate = evaluate([surface, symbol(slope)], after)
                level = checks.stays * np.abs(speed)
                fires = (height < -level) | ((np.abs(height) <= level) & (rate < 0.0))
            falls &= ~here | np.isfinite(np.asarray(height) + np.asarray(rate))
            again |= here & fires
        return again[falls]

    def check_series(
        self, name: str, switch: SwitchSymbols, leaves: Sequence[int]
    ) -> None:
        """Refuse a power that is not whole and whose base vanishes where its regime is entered.

        So does the depth d of a Hertz contact d^1.5, whatever the state in which contact begins.
        """
        for regime in sorted({target for target, _, _ in switch.targets}):
            powers, function, arguments = self.bases(regime)
            if not powers:
                continue
            tried = (
                self.on_surface(switch.surface, left)
                for left in leaves[: checks.most_regimes]
            )
            states = next((each for each in tried if _count(each, self.tracer)), None)
            if states is None:  # no random line meets the surface
                continue
            values = self._after(switch.resets[regime], states)
            values |= constants_of(self.traced, regime)
            with np.errstate(all="ignore"):
                result = function(*(values[argument] for argument in arguments))
            for power, base in zip(powers, result, strict=True):
                if _vanishes(np.asarray(base)):
                    _refuse(name, self.tracer.regimes[regime], power)

    def _bases(self, regime: int) -> tuple[list[Symbol], Any, list[str]]:
        """Powers in the field of a regime, and a function that gives their bases."""
        powers = list(_powers(self.tracer, self.traced, regime))
        roots = [symbol(power.arguments[0]) for power in powers]
        return powers, *numpy_function(roots)

    def _on_surface(self, surface: Symbol, regime: int) -> Values:
        """States where lines between two random ones meet a surface of a regime; maybe none."""
        rng = np.random.default_rng(0)
        known = self.tracer.samples(rng, checks.samples) | constants_of(
            self.traced, regime
        )
        ends = rng.uniform(-1.0, 1.0, (2, len(self.tracer.states), checks.samples))
        for reach in checks.reaches:
            root = self._between(surface, known, reach * ends)
            if _count(root, self.tracer):
                break
        return root

    def _between(self, surface: Symbol, known: Values, ends: np.ndarray) -> Values:
        """States of a surface on the lines between two states each."""
        low, high = ends
        function, arguments = numpy_function([surface])

        def at(share: np.ndarray) -> Values:
            between = low + share * (high - low)
            return known | dict(zip(self.tracer.states, between, strict=True))

        def height(share: np.ndarray) -> Any:
            state = at(share)
            (found,) = function(*(state[name] for name in arguments))
            return np.broadcast_to(found, checks.samples)

        with np.errstate(all="ignore"):
            first, last = np.zeros(checks.samples), np.ones(checks.samples)
            start = np.sign(height(first))
            meets = start * np.sign(height(last)) < 0.0
            for _ in range(checks.halvings if meets.any() else 0):
                middle = 0.5 * (first + last)
                same = np.sign(height(middle)) == start
                first = np.where(same, middle, first)
                last = np.where(same, last, middle)
        return {
            name: np.broadcast_to(value, checks.samples)[meets]
            for name, value in at(first).items()
        }

    def _after(self, reset: Mapping[int, Symbol], before: Values) -> Values:
        """Values after some states have jumped."""
        with np.errstate(all="ignore"):
            jumped = evaluate(list(reset.values()), before)
        count = _count(before, self.tracer)
        places = (self.tracer.states[place] for place in reset)
        return before | {
            name: np.broadcast_to(value, count)
            for name, value in zip(places, jumped, strict=True)
        }


def _count(values: Values, tracer: Tracer) -> int:
    """Number of states."""
    return len(values[tracer.states[0]])


def constants_of(traced: Traced, regime: int) -> dict[str, float]:
    """The constants of a regime by name."""
    columns = traced.columns(int(traced.component_of[regime]))
    row = traced.regimes[regime, columns].tolist()
    return dict(zip(traced.constants[columns], row, strict=True))


def _vanishes(base: np.ndarray) -> bool:
    """Return whether a base is zero but for round-off at every entry, and not just small."""
    if not base.size or not (np.abs(base) < checks.vanishes).all():
        return False
    return bool(np.ptp(base) >= checks.alike * np.abs(base).max())


def _powers(tracer: Tracer, traced: Traced, regime: int) -> Iterator[Symbol]:
    """Powers in the field of a regime that have no series where their base is zero."""
    marks = {f"{REGIME}is {other}" for other in tracer.regimes}
    marks -= {f"{REGIME}is {tracer.regimes[regime]}"}
    seen: set[int] = set()
    waiting = list(traced.rates)
    while waiting:
        node = waiting.pop()
        elsewhere = node.kind == "only" and node.arguments[0].arguments[0] in marks
        if id(node) in seen or elsewhere:
            continue
        seen.add(id(node))
        waiting += [
            argument for argument in node.arguments if isinstance(argument, Symbol)
        ]
        if node.varies and (
            node.kind == "log" or (node.kind == "**" and node.arguments[1] % 1.0)
        ):
            yield node


def _refuse(switch: str, regime: str, power: Symbol) -> None:
    base = expression(power.arguments[0])
    what = "log" if power.kind == "log" else f"power {power.arguments[1]:g}"
    shifted = f"{base} * {base} + 1e-12"
    remedy = (
        f"0.5 * log({shifted})"
        if power.kind == "log"
        else f"({shifted}) ** {0.5 * power.arguments[1]:g}"
    )
    raise ValueError(
        f"switch {switch!r} enters regime {regime!r} where {base} is zero, and the field has its "
        f"{what}: there is no Taylor series there; write {remedy}, which is smooth, with a number "
        "that is small beside the square of what it usually is in place of 1e-12"
    )
