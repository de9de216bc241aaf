"""A system's functions as symbols: traced once, checked before anything is compiled."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from squealpipe.methods.taylor.scalar import REGIME, SwitchSymbols, evaluate
from squealpipe.methods.taylor.symbols import (
    Symbol,
    constant_parts,
    derivative,
    in_order,
    parameter,
    substituted,
    symbol,
    variables,
)
from squealpipe.text import suggestion

TIME, TIME_UNIT = "time", "time unit"
"""Names that no state or parameter can have: of the time, and of the unit that it is run in."""


class Names:
    """Attributes by name; an unknown one is refused with the nearest."""

    def __init__(self, what: str, values: Mapping[str, Any]) -> None:
        self.__dict__.update(values)
        self._what = what

    def __getattr__(self, name: str) -> Any:
        known = [each for each in self.__dict__ if each != "_what"]
        raise AttributeError(f"{self._what} has no {name!r}; {suggestion(name, known)}")


@dataclass(frozen=True, eq=False)
class Traced:
    """A system as symbols.

    Attributes:
        variables: states, then the time if anything depends on it.
        rates: their derivatives by time in units of the system's time scale.
        parameters: names, the time unit last.
        constants: names of a regime's constants.
        regimes: (regime, constant) their values.
        surfaces: functions whose roots switch or stop, no two the same but for sign.
        falls, rises: (regime, surface) the switch that fires there, or −1; stops follow switches.
        outputs: tracked quantities beside the states.
        starts: (regime, condition or None, equality or None).
        derived: what holds parameters alone, computed once a run: parameters after the given ones.
    """

    variables: tuple[Symbol, ...]
    size: int
    rates: tuple[Symbol, ...]
    parameters: tuple[str, ...]
    constants: tuple[str, ...]
    regimes: np.ndarray
    surfaces: tuple[Symbol, ...]
    falls: np.ndarray
    rises: np.ndarray
    switches: tuple[SwitchSymbols, ...]
    kinds: tuple[str, ...]
    outputs: tuple[Symbol, ...]
    starts: tuple[tuple[int, Symbol | None, Symbol | None], ...]
    derived: tuple[Symbol, ...] = ()

    @property
    def marks(self) -> np.ndarray:
        """(regime, switch) 2 where it changes nothing, 1 where it may do so, else 0."""
        found = np.zeros((len(self.regimes), len(self.switches)), np.int64)
        for number, switch in enumerate(self.switches):
            leads = [regime for regime, _, _ in switch.targets] * (not switch.reset)
            for regime in set(leads):
                found[regime, number] = 1 + (leads.count(regime) == len(leads))
        return found

    def with_derived(self) -> Self:
        """The same with its constant parts as parameters, for the integrator."""
        roots = [*self.rates, *self.surfaces, *self.outputs]
        for switch in self.switches:
            roots += [switch.surface, *switch.reset.values()]
            roots += [c for _, c, _ in switch.targets if c is not None]
        derived = constant_parts(roots, REGIME)
        names = [f"derived {i}" for i in range(len(derived))]
        given = {id(n): parameter(name) for n, name in zip(derived, names, strict=True)}

        def of(root: Any) -> Any:
            return None if root is None else substituted(root, given)

        switches = tuple(
            SwitchSymbols(
                of(each.surface),
                tuple((regime, of(c), kind) for regime, c, kind in each.targets),
                {place: of(value) for place, value in each.reset.items()},
            )
            for each in self.switches
        )
        return replace(
            self,
            rates=tuple(map(of, self.rates)),
            surfaces=tuple(map(of, self.surfaces)),
            outputs=tuple(map(of, self.outputs)),
            switches=switches,
            parameters=(*self.parameters[:-1], *names, TIME_UNIT),
            derived=tuple(derived),
        )


class Tracer:
    """Calls the functions of one system on symbols."""

    def __init__(
        self,
        states: Sequence[str],
        parameters: Iterable[str],
        regimes: Mapping[str, Mapping],
    ) -> None:
        self.states = tuple(states)
        self.regimes = list(regimes)
        constants = {name for each in regimes.values() for name in each}
        for name, each in regimes.items():
            if missing := constants - set(each):
                raise ValueError(
                    f"regime {name!r} lacks the constant {min(missing)!r}, which others have"
                )
        self.values = regimes
        self.time, *state = variables(TIME, *self.states)
        self.variables = tuple(state)
        self.s = Names("the state", dict(zip(self.states, state, strict=True)))
        self.p = Names("the system", {name: parameter(name) for name in parameters})
        self.constants = tuple(sorted(constants))
        self.r = Names(
            "a regime", {name: parameter(REGIME + name) for name in self.constants}
        )

    def one(self, what: str, function: Callable[..., Any], r: Any = None) -> Symbol:
        """A scalar function of (t, s, p, r)."""
        return self._symbol(what, self._call(what, function, r))

    def several(
        self, what: str, function: Callable[..., Any], r: Any = None
    ) -> dict[str, Symbol]:
        """A function that gives a mapping of states."""
        found = self._call(what, function, r)
        if not isinstance(found, Mapping):
            raise TypeError(
                f"{what} gives {type(found).__name__}; a dict of states is needed"
            )
        for name in found:
            if name not in self.states:
                raise ValueError(
                    f"{what} gives {name!r}; {suggestion(name, self.states)}"
                )
        return {
            name: self._symbol(f"{what}[{name!r}]", value)
            for name, value in found.items()
        }

    def numbers(self, regime: str) -> Names:
        """The constants of one regime as numbers."""
        return Names(
            "a regime",
            {key: float(value) for key, value in self.values[regime].items()},
        )

    def _call(self, what: str, function: Callable[..., Any], r: Any) -> Any:
        try:
            return function(self.time, self.s, self.p, self.r if r is None else r)
        except (TypeError, AttributeError) as error:
            remedy = "; for cos, exp and the like take squealpipe.functions"
            wants = remedy if isinstance(error, TypeError) else ""
            raise type(error)(f"{what}: {error}{wants}") from error

    def _symbol(self, what: str, value: Any) -> Symbol:
        try:
            found = symbol(value)
        except (TypeError, ValueError):
            raise TypeError(
                f"{what} gives {value!r}; a number or an expression is needed"
            ) from None
        for node in in_order([found]):
            if node.kind == "number" and not np.isfinite(node.arguments[0]):
                raise ValueError(
                    f"{what} holds {node.arguments[0]}; finite numbers are needed"
                )
        return found

    def regime(self, what: str, name: Any) -> int:
        """The number of a regime."""
        if name not in self.regimes:
            raise ValueError(
                f"{what}: regime {name!r} is unknown; {suggestion(name, self.regimes)}"
            )
        return self.regimes.index(name)

    def samples(self, rng: np.random.Generator, size: int = 32) -> dict[str, Any]:
        """Random values of everything that an expression may hold."""
        constants = [REGIME + c for c in self.constants]
        names = [TIME, TIME_UNIT, *self.states, *vars(self.p), *constants]
        return {name: rng.uniform(0.3, 1.7, size) for name in names}


def check_progress(
    tracer: Tracer,
    traced: Traced,
    names: Sequence[str],
    leaves: Sequence[Sequence[int]],
) -> None:
    """Refuse a switch that would fire again at once, whatever the state.

    At every one of many random states in which its surface falls it leads to a regime that it
    leaves, and there the surface is on the same height or lower, and goes on falling.
    """
    rng = np.random.default_rng(0)
    for name, switch, left in zip(names, traced.switches, leaves, strict=True):
        if not {regime for regime, _, _ in switch.targets} & set(left):
            continue
        if not switch.reset:  # a mark
            continue
        slope: Any = symbol(0.0)
        for variable, rate in zip(traced.variables, traced.rates, strict=True):
            slope = slope + derivative(switch.surface, variable) * rate
        values = tracer.samples(rng, 400)
        values |= {state: rng.uniform(-2.0, 2.0, 400) for state in tracer.states}

        def held(regimes: np.ndarray) -> dict[str, np.ndarray]:
            return dict(zip(traced.constants, traced.regimes[regimes].T, strict=True))

        values |= held(rng.choice(left, 400))
        with np.errstate(all="ignore"):
            height, rate = evaluate([switch.surface, symbol(slope)], values)
            *ways, (last, _, _) = switch.targets
            found = evaluate([symbol(condition) for _, condition, _ in ways], values)
            regimes = np.full(400, last)
            for value, (regime, _, _) in zip(found[::-1], ways[::-1], strict=True):
                regimes = np.where(value >= 0.0, regime, regimes)
            resets = evaluate(list(switch.reset.values()), values)
            after = {
                tracer.states[p]: v for p, v in zip(switch.reset, resets, strict=True)
            }
            after = values | after | held(regimes)
            later, new_rate = evaluate([switch.surface, symbol(slope)], after)
        rise = later - height
        falling = np.asarray(rate < 0) & np.isfinite(
            np.asarray(rate) + np.asarray(new_rate)
        )
        again = (rise < -1e-9) | ((np.abs(rise) <= 1e-9) & np.asarray(new_rate < 0))
        if falling.any() and (again & np.isin(regimes, left))[falling].all():
            raise ValueError(
                f"switch {name!r} leads back into a regime that it leaves, and its reset leaves "
                "the state where the surface goes on falling: it would fire again at once, without "
                "end; reset a state that turns it, or lead to another regime"
            )
