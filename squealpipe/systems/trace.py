"""A system's functions as symbols: traced once, checked before anything is compiled."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import Any, Self

import numpy as np

from squealpipe.systems import functions  # noqa: F401 (laws call exp on symbols)
from squealpipe.systems.components import Composition
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.taylor.scalar import REGIME, SwitchSymbols
from squealpipe.systems.taylor.symbols import (
    Symbol,
    constant_parts,
    in_order,
    parameter,
    substituted,
    symbol,
    variables,
)

TIME, TIME_UNIT = "time", "time unit"
"""Names that no state or parameter can have: of the time, and of the unit that it is run in."""
SWITCHED = f"{REGIME}switched "
"""Begin the names of what holds parameters alone, and parameters and regimes' constants alone."""


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
        constants: names of the regimes' constants, component after component.
        regimes: (regime, constant) their values; 0 for those of other components.
        component_of: (regime,) the component of each.
        first_constant: (component + 1,) where the constants of each begin.
        surfaces: functions whose roots switch or stop, no two the same but for sign.
        falls, rises: (regime, surface) the switch that fires there, or −1; stops follow switches.
        owner: (surface,) the component whose regime says whether it is watched.
        marks: (regime, surface) 1 where the only switch there changes nothing.
        clocks: (surface,) 1 of those of the time alone with a switch: nothing is beyond them.
        outputs: tracked quantities beside the states.
        starts: (regime, condition or None, equality or None) of each component.
        derived: what holds parameters alone, computed once a run: parameters after the given ones.
        switched: what holds parameters and the regimes' constants alone, computed when a regime
            is entered: after those constants.
    """

    variables: tuple[Symbol, ...]
    size: int
    rates: tuple[Symbol, ...]
    parameters: tuple[str, ...]
    constants: tuple[str, ...]
    regimes: np.ndarray
    component_of: np.ndarray
    first_constant: np.ndarray
    surfaces: tuple[Symbol, ...]
    falls: np.ndarray
    rises: np.ndarray
    owner: np.ndarray
    marks: np.ndarray
    clocks: np.ndarray
    switches: tuple[SwitchSymbols, ...]
    kinds: tuple[str, ...]
    outputs: tuple[Symbol, ...]
    starts: tuple[tuple[tuple[int, Symbol | None, Symbol | None], ...], ...]
    derived: tuple[Symbol, ...] = ()
    switched: tuple[Symbol, ...] = ()

    @property
    def n_components(self) -> int:
        """Number of components."""
        return len(self.first_constant) - 1

    def columns(self, component: int) -> slice:
        """The constants of a component."""
        return slice(*self.first_constant[component : component + 2])

    def constants_in(self, regimes: Sequence[int]) -> np.ndarray:
        """All constants where each component is in one of these regimes."""
        return np.concatenate(
            [self.regimes[r, self.columns(k)] for k, r in enumerate(regimes)]
        )

    def with_derived(self) -> Self:
        """Return the system as the integrator takes it: what is constant for long stands apart."""
        derived_from_parameters = "derived "
        once, derived = self.set_apart(REGIME, derived_from_parameters)
        made, switched = once.set_apart(None, SWITCHED)
        names = [f"{derived_from_parameters}{i}" for i in range(len(derived))]
        return replace(
            made,
            parameters=(*self.parameters[:-1], *names, TIME_UNIT),
            derived=derived,
            switched=switched,
        )

    def set_apart(
        self, skipped: str | None, prefix: str
    ) -> tuple[Self, tuple[Symbol, ...]]:
        """Return the system with its constant parts as parameters of their own, and those parts.

        Args:
            skipped: beginning of the names of parameters that do not count. Without it only
                what steps read is looked through: a condition of a switch is computed at that
                switch, not at all of them.
        """
        steps = [*self.rates, *self.surfaces, *self.outputs]
        at_switches = [
            each
            for switch in self.switches
            for each in (
                switch.surface,
                *switch.after,
                *(c for _, c, _ in switch.targets if c is not None),
            )
        ]
        parts = constant_parts(steps + at_switches if skipped else steps, skipped)
        placeholders = {id(n): parameter(f"{prefix}{i}") for i, n in enumerate(parts)}
        made = substituted(steps + at_switches, placeholders)

        def of(root: Any) -> Any:
            return None if root is None else made[id(root)]

        switches = tuple(
            SwitchSymbols(
                of(switch.surface),
                tuple((regime, of(c), kind) for regime, c, kind in switch.targets),
                {
                    regime: {place: of(value) for place, value in reset.items()}
                    for regime, reset in switch.resets.items()
                },
            )
            for switch in self.switches
        )
        replaced = replace(
            self,
            rates=tuple(map(of, self.rates)),
            surfaces=tuple(map(of, self.surfaces)),
            outputs=tuple(map(of, self.outputs)),
            switches=switches,
        )
        return replaced, tuple(parts)

    @property
    def all_constants(self) -> tuple[str, ...]:
        """Names of the regimes' constants and of what is computed from them at switches."""
        computed = (f"{SWITCHED}{i}" for i in range(len(self.switched)))
        return (*self.constants, *computed)


def long_name(component: str, name: str) -> str:
    """The name of a regime's constant among those of all components."""
    return f"{component}.{name}" if component else name


class Tracer:
    """Calls the functions of one system on symbols."""

    def __init__(
        self,
        states: Sequence[str],
        parameters: Iterable[str],
        composition: Composition,
        known: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        """Parameters whose values are ``known`` are numbers."""
        self.states = tuple(states)
        self.composition = composition
        self.regimes = list(composition.regimes)
        self.time, *state = variables(TIME, *self.states)
        self.variables = tuple(state)
        self.s = Names("the state", dict(zip(self.states, state, strict=True)))
        symbols = {name: parameter(name) for name in parameters}
        symbols |= {name: symbol(value) for name, value in known.items()}
        self.p = Names("the system", symbols)
        self._names = [self._constants_of(k) for k in range(len(composition.names))]
        self.first_constant = np.cumsum([0, *map(len, self._names)])
        self.constants = tuple(
            long_name(component, name)
            for component, names in zip(composition.names, self._names, strict=True)
            for name in names
        )
        self._symbols = [
            {name: parameter(REGIME + long_name(component, name)) for name in names}
            for component, names in zip(composition.names, self._names, strict=True)
        ]
        self.r = self._constants(self._symbols)
        # functions that keep what they found at these objects find it again
        self.numbers = cache(self._numbers)

    def _constants_of(self, component: int) -> list[str]:
        """Names of a component's constants; each of its regimes has all."""
        regimes = {
            self.regimes[i]: self.composition.regimes[self.regimes[i]]
            for i in self.composition.regimes_of(component)
        }
        names = {name for regime in regimes.values() for name in regime}
        for regime, each in regimes.items():
            if missing := names - set(each):
                raise ValueError(
                    f"regime {regime!r} lacks the constant {min(missing)!r}, which others have"
                )
        return sorted(names)

    def _constants(self, values: Sequence[Mapping[str, Any]]) -> Names:
        """``r``, from the constants of each component."""
        names = self.composition.names
        if names == ("",):
            return Names("a regime", values[0])
        return Names(
            "the system",
            {
                name: Names(f"component {name!r}", constants)
                for name, constants in zip(names, values, strict=True)
            },
        )

    def one(self, what: str, function: Callable[..., Any], r: Any = None) -> Symbol:
        """A scalar function of (t, s, p, r)."""
        return self._symbol(what, self._call(what, function, r))

    def several(
        self, what: str, function: Callable[..., Any], r: Any = None
    ) -> dict[str, Symbol]:
        """A function that gives a mapping of states."""
        values = self._call(what, function, r)
        if not isinstance(values, Mapping):
            raise TypeError(
                f"{what} gives {type(values).__name__}; a dict of states is needed"
            )
        for name in values:
            if name not in self.states:
                raise ValueError(
                    f"{what} gives {name!r}; {suggestion(name, self.states)}"
                )
        return {
            name: self._symbol(f"{what}[{name!r}]", value)
            for name, value in values.items()
        }

    def _numbers(self, regime: str) -> Names:
        """``r`` with the constants of one regime as numbers."""
        place = self.composition.component_of[self.regimes.index(regime)]
        values: list[Any] = list(self._symbols)
        constants = self.composition.regimes[regime]
        values[place] = {key: float(value) for key, value in constants.items()}
        return self._constants(values)

    def table(self) -> np.ndarray:
        """(regime, constant) their values."""
        filled = np.zeros((len(self.regimes), len(self.constants)))
        for row, place, regime in zip(
            filled, self.composition.component_of, self.regimes, strict=True
        ):
            constants = self.composition.regimes[regime]
            first = self.first_constant[place]
            for column, name in enumerate(self._names[place]):
                row[first + column] = float(constants[name])
        return filled

    def _call(self, what: str, function: Callable[..., Any], r: Any) -> Any:
        try:
            return function(self.time, self.s, self.p, self.r if r is None else r)
        except (TypeError, AttributeError) as error:
            remedy = "; for cos, exp and the like take squealpipe.functions"
            wants = remedy if isinstance(error, TypeError) else ""
            raise type(error)(f"{what}: {error}{wants}") from error
        except ArithmeticError as error:
            raise ValueError(
                f"{what}: {error}; it must be finite in each regime"
            ) from error

    def _symbol(self, what: str, value: Any) -> Symbol:
        try:
            traced = symbol(value)
        except (TypeError, ValueError):
            raise TypeError(
                f"{what} gives {value!r}; a number or an expression is needed"
            ) from None
        for node in in_order([traced]):
            if node.kind == "number" and not np.isfinite(node.arguments[0]):
                raise ValueError(
                    f"{what} holds {node.arguments[0]}; finite numbers are needed"
                )
        return traced

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
