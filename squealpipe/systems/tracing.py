"""A system traced: its functions as symbols, ready to be compiled; it knows no verbs."""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Self

import numpy as np

from squealpipe.systems.components import Switch
from squealpipe.systems.definition import Definition, SizeLimits
from squealpipe.systems.entries import Entries, constants_of
from squealpipe.systems.joint import Joint
from squealpipe.systems.starts import Starts
from squealpipe.systems.surfaces import simplest
from squealpipe.systems.taylor.scalar import (
    REGIME,
    SwitchSymbols,
    evaluate,
    numpy_function,
)
from squealpipe.systems.taylor.symbols import Symbol, in_order, only, parameter, symbol
from squealpipe.systems.text import describe
from squealpipe.systems.trace import TIME, TIME_UNIT, Names, Traced, Tracer, long_name


class TracedSystem(Definition):
    """A definition with what its functions became.

    Attributes:
        known: parameters that functions see as numbers.
    """

    known: Mapping[str, float] = MappingProxyType({})

    @cached_property
    def units_of_values(self) -> dict[str, str]:
        """Return the unit of each state and parameter."""
        return {**self.units, **self.parameter_units}

    def check_scales(self) -> None:
        """Raise if the functions do not agree with the units that the scales are of.

        Tried on random numbers: in the scales' units rates and outputs have the values that their
        units say, and surfaces have theirs over one common factor.
        """
        rng, t = np.random.default_rng(0), self.traced
        parameters = {
            name: (default or 1.0) * rng.uniform(0.5, 1.5)
            for name, default in self.parameters.items()
        }
        scales = self.scales_in(parameters)
        if scales is None:
            return
        sizes = self.sizes_in(parameters)
        # states and regimes in which units are tried
        tried = 16
        drawn = sizes[:, None] * rng.uniform(-1.0, 1.0, (t.size, tried))
        values = {**parameters, **dict(zip(self.states, drawn, strict=True))}
        values[TIME] = scales.of("s") * rng.uniform(0.0, 1.0)
        inside = scales.into({**self.units_of_values, TIME: "s"}, values)
        for each in (values, inside):
            scale = self.time_scale
            known = Names("the system", {name: each[name] for name in self.parameters})
            each[TIME_UNIT] = scale(known) if callable(scale) else scale
        units = [*self.units.values(), *(unit for unit, _ in self.outputs.values())]
        names = [*self.units, *self.outputs]
        # relative difference of values in two units that is round-off
        agrees = 1e-6
        for regime in range(min(len(self.regimes), tried)):
            held = constants_of(t, regime)
            with np.errstate(all="ignore"):
                rows, others = (
                    np.array(
                        [
                            np.broadcast_to(value, tried)
                            for value in evaluate(
                                [*t.rates[: t.size], *t.outputs, *t.surfaces],
                                each | held,
                            )
                        ]
                    )
                    for each in (values, inside)
                )
                whole = len(units)
                factors = [*(scales.of(unit) for unit in units)]
                factors += [
                    _factor(*pair)
                    for pair in zip(rows[whole:], others[whole:], strict=True)
                ]
                off = np.abs(rows - others * np.array(factors)[:, None])
                wrong = (off > agrees * np.abs(rows).max(axis=1)[:, None]).any(axis=1)
            if wrong.any():
                place = int(np.argmax(wrong))
                what = repr(names[place]) if place < whole else "a surface"
                raise ValueError(
                    f"scales: the function of {what} does not have the unit that the units of "
                    "states and parameters give it; state each parameter's unit, as "
                    "(1.0, 'kg'), and make numbers with a unit parameters"
                )

    def _rates(self, tracer: Tracer) -> list[Symbol]:
        if not isinstance(self.field, Mapping):
            return self._complete("the field", tracer.several("the field", self.field))
        if self.composition.names != ("",):
            raise ValueError(
                "a field for each regime is for a system without components; give one function, "
                "which reads the constants of all components"
            )
        total = [symbol(0.0)] * len(self.units)
        for regime in self.regimes:
            if regime not in self.field:
                raise ValueError(f"the field has no function for regime {regime!r}")
            what = f"the field of {regime!r}"
            changes = tracer.several(what, self.field[regime], tracer.numbers(regime))
            in_regime = parameter(REGIME + _indicator(regime))
            rates = self._complete(what, changes)
            total = [a + only(in_regime, b) for a, b in zip(total, rates, strict=True)]
        return total

    def _complete(self, what: str, found: Mapping[str, Symbol]) -> list[Symbol]:
        for name in self.units:
            if name not in found:
                raise ValueError(
                    f"{what} lacks the rate of the state {name!r}; what an algebraic equation "
                    "gives is no state: solve the equation for it, or differentiate it"
                )
        return [found[name] for name in self.units]

    def _trace(self) -> Traced:
        tracer = Tracer(self.states, self.parameters, self.composition, self.known)
        rates = self._rates(tracer)
        kinds: list[str] = []
        leaves = [self._leaves(tracer, switch) for switch in self.switches]
        switches = [
            self._trace_switch(tracer, switch, left, kinds)
            for switch, left in zip(self.switches, leaves, strict=True)
        ]
        stops = [
            simplest(tracer.one(f"stop {name!r}", f)) for name, f in self.stops.items()
        ]
        outputs = [
            tracer.one(f"output {name!r}", f) for name, (_, f) in self.outputs.items()
        ]
        starts = [
            tuple(self._trace_start(tracer, entry) for entry in entries)
            for entries in self.composition.starts
        ]
        for entries in starts:
            if entries and entries[-1][1] is not None:
                raise ValueError(
                    "starts_in has no last resort: end it with a regime alone"
                )
        every = [*rates, *stops, *outputs, *(switch.surface for switch in switches)]
        every += [value for switch in switches for value in switch.after]
        every += [
            c for switch in switches for _, c, _ in switch.targets if c is not None
        ]
        timed = any(node is tracer.time for node in in_order(every))
        unit = parameter(TIME_UNIT)
        if callable(self.time_scale) or self.time_scale != 1.0:
            rates = [rate * unit for rate in rates]
        surfaces, falls, rises, owner = self._watch(tracer, switches, leaves, stops)
        indicators = [_indicator(name) for name in self.regimes] * isinstance(
            self.field, Mapping
        )
        masks = np.eye(len(self.regimes))[:, : len(indicators)]
        ends = tracer.first_constant + len(indicators) * np.arange(
            len(tracer.first_constant)
        )
        traced = Traced(
            variables=(*tracer.variables, *([tracer.time] * timed)),
            size=len(self.units),
            rates=(*rates, *([unit] * timed)),
            parameters=(*self.parameters, TIME_UNIT),
            constants=tuple(REGIME + c for c in (*tracer.constants, *indicators)),
            regimes=np.hstack([tracer.table(), masks]),
            component_of=self.composition.component_of,
            first_constant=ends,
            surfaces=tuple(surfaces),
            falls=falls,
            rises=rises,
            owner=owner,
            marks=_marks(falls, rises, switches),
            clocks=_clocks(surfaces, falls, rises, len(switches)),
            switches=tuple(switches),
            kinds=tuple(kinds),
            outputs=tuple(outputs),
            starts=tuple(starts),
        )
        checks = Entries(tracer, traced)
        for each, switch, left in zip(self.switches, switches, leaves, strict=True):
            checks.check_progress(each.name, switch, left)
            checks.check_series(each.name, switch, left)
        return traced

    def _trace_switch(
        self, tracer: Tracer, switch: Switch, leaves: Sequence[int], kinds: list[str]
    ) -> SwitchSymbols:
        what = f"switch {switch.name!r}"
        surface = simplest(tracer.one(f"{what}: when", switch.when))
        for regime in leaves:
            inside = tracer.one(
                f"{what}: when", switch.when, tracer.numbers(self.name_of(regime))
            )
            (height,) = evaluate([inside], tracer.samples(np.random.default_rng(0)))
            if not inside.varies or not np.any(height):
                raise ValueError(
                    f"{what}: its surface is constant in regime {self.name_of(regime)!r}; leave "
                    "that regime out of `leaves`"
                )
        entered = [switch.to] if isinstance(switch.to, str) else list(switch.to)
        if not entered or not (isinstance(entered[-1], str) or entered[-1][1] is None):
            raise ValueError(
                f"{what}: `to` has no last resort; end it with a regime alone"
            )
        targets = []
        for entry in entered:
            regime, condition, kind = (
                (entry, None, switch.name)
                if isinstance(entry, str)
                else (*entry, switch.name)[:3]
            )
            if kind not in kinds:
                kinds.append(kind)
            symbols = (
                None
                if condition is None
                else tracer.one(f"{what}: to {regime!r}", condition)
            )
            targets.append((tracer.regime(what, regime), symbols, kinds.index(kind)))
        resets = self._trace_resets(
            tracer, switch, [regime for regime, _, _ in targets]
        )
        return SwitchSymbols(surface, tuple(targets), resets)

    def _trace_resets(
        self, tracer: Tracer, switch: Switch, entered: Sequence[int]
    ) -> dict[int, dict[int, Symbol]]:
        """The states that jump on the way into each regime."""
        what = f"switch {switch.name!r}: reset"

        def traced(function: Any) -> dict[int, Symbol]:
            values = tracer.several(what, function) if function else {}
            return {self.states.index(name): value for name, value in values.items()}

        if not isinstance(switch.reset, Mapping):
            alike = traced(switch.reset)
            return dict.fromkeys(entered, alike)
        for name in switch.reset:
            if tracer.regime(what, name) not in entered:
                raise ValueError(f"{what}: the switch does not lead to regime {name!r}")
        return {k: traced(switch.reset.get(self.name_of(k))) for k in entered}

    def _leaves(self, tracer: Tracer, switch: Switch) -> list[int]:
        names = [switch.leaves] if isinstance(switch.leaves, str) else switch.leaves
        return [tracer.regime(f"switch {switch.name!r}", name) for name in names]

    def _trace_start(
        self, tracer: Tracer, entry: Any
    ) -> tuple[int, Symbol | None, Symbol | None]:
        if isinstance(entry, str):
            return tracer.regime("starts_in", entry), None, None
        regime, condition, equality = (*entry, None)[:3]
        equal = (
            None if equality is None else tracer.one(f"starts_in {regime!r}", equality)
        )
        if condition is not None:
            condition = tracer.one(f"starts_in {regime!r}", condition)
        return tracer.regime("starts_in", regime), condition, equal

    def _watch(
        self,
        tracer: Tracer,
        switches: Sequence[SwitchSymbols],
        leaves: Sequence[Sequence[int]],
        stops: Sequence[Symbol],
    ) -> tuple[list[Symbol], np.ndarray, np.ndarray, np.ndarray]:
        """Surfaces without those that another one is, but for its sign, and who watches them.

        Each has one component as its owner; the first one watches the stops.
        """
        probe = tracer.samples(np.random.default_rng(1))
        surfaces: list[Symbol] = []
        prints: list[np.ndarray] = []
        watched: list[tuple[int, int, int, int]] = []  # regime, surface, rises, switch
        first = self.composition.regimes_of(0).tolist()
        places = [*leaves, *[first] * len(stops)]
        owner: list[int] = []
        every = [*(switch.surface for switch in switches), *stops]
        for number, (surface, regimes) in enumerate(zip(every, places, strict=True)):
            with np.errstate(all="ignore"):
                (value,) = evaluate([surface], probe)
            mine = np.broadcast_to(value, 32)
            component = int(self.composition.component_of[regimes[0]]) if regimes else 0
            others = [i for i, each in enumerate(owner) if each == component]
            same = [i for i in others if np.allclose(mine, prints[i], 1e-12, 0)]
            opposite = [i for i in others if np.allclose(-mine, prints[i], 1e-12, 0)]
            if not same + opposite:
                same = [len(surfaces)]
                surfaces.append(surface)
                prints.append(mine)
                owner.append(component)
            rises = int(not same)
            watched += [
                (regime, (same + opposite)[0], rises, number) for regime in regimes
            ]
        if len(surfaces) > SizeLimits.surfaces:
            raise ValueError(
                f"{len(surfaces)} surfaces; at most {SizeLimits.surfaces} can be watched"
            )
        table = np.full((2, len(self.regimes), len(surfaces)), -1, np.int64)
        for regime, index, rises, number in watched:
            if table[rises, regime, index] >= 0:
                names = [switch.name for switch in self.switches] + list(self.stops)
                earlier = names[table[rises, regime, index]]
                raise ValueError(
                    f"{earlier!r} and {names[number]!r} fire at the same surface in regime "
                    f"{self.name_of(regime)!r}; make them one switch whose `to` decides"
                )
            table[rises, regime, index] = number
        falls, rises_ = map(np.ascontiguousarray, table)
        return surfaces, falls, rises_, np.array(owner, np.int64)

    def with_numbers(
        self,
        regimes: Mapping[str, Mapping[str, float]],
        parameters: Mapping[str, float],
    ) -> Self:
        """Return the system with other constants and defaults, neither traced nor compiled again.

        Args:
            regimes: constants of all regimes, under the same names; functions must have read them
                from ``r`` alone.
            parameters: defaults of all parameters.
        """
        composition = replace(self.composition, regimes=dict(regimes))
        column = {name: at for at, name in enumerate(self.traced.constants)}
        table = self.traced.regimes.copy()
        owners = [composition.names[k] for k in composition.component_of]
        for row, owner, constants in zip(table, owners, regimes.values(), strict=True):
            for name, value in constants.items():
                row[column[REGIME + long_name(owner, name)]] = value
        other = copy(self)
        other.composition, other.regimes = composition, composition.regimes
        other.parameters = dict(parameters)
        other.traced = replace(self.traced, regimes=table)
        other.integrated = replace(self.integrated, regimes=table)
        other.derived, other.at_switches = self.derived, self.at_switches
        other.starts = self.starts.with_constants(other.traced, composition)
        for name in ("text", "joint"):
            other.__dict__.pop(name, None)
        return other

    @cached_property
    def exponents(self) -> tuple[str, ...]:
        """Parameters that something is raised to: x**a is exp(a log x), which has no value at 0."""
        t = self.traced
        powers = set()
        for node in in_order([*t.rates, *t.surfaces, *t.outputs]):
            if node.kind == "exp" and node.arguments[0].kind == "*":
                a, b = node.arguments[0].arguments
                if a.kind == "parameter" and b.kind == "log":
                    powers.add(a.arguments[0])
        return tuple(sorted(powers & set(self.parameters)))

    def retrace(self) -> None:
        """Trace the functions again, with the parameters that are known as numbers."""
        self.traced, self.form = self._trace(), self

    def for_exponents(self, values: Mapping[str, Any]) -> Self:
        """The system for these values: with whole exponents, which all runs share, as numbers."""
        if not self.exponents or self.form is not self:
            return self
        unique = ((name, np.unique(values[name])) for name in self.exponents)
        known = {
            name: float(each[0])
            for name, each in unique
            if each.size == 1 and each[0] >= 1.0 and each[0] % 1.0 == 0.0
        }
        if not known:
            return self
        made: dict[Any, Self] = self.__dict__.setdefault("_with_known", {})
        key = tuple(known.items())
        if key not in made:
            other = copy(self)
            for name in (
                "integrated",
                "derived",
                "at_switches",
                "text",
                "joint",
                "starts",
            ):
                other.__dict__.pop(name, None)
            other.known = known
            other.retrace()
            made[key] = other
        return made[key]

    @cached_property
    def integrated(self) -> Traced:
        """The system as the integrator takes it."""
        return self.traced.with_derived()

    @cached_property
    def derived(self) -> tuple[Any, list[str]]:
        """Return the function of the derived parameters of runs, and the names that it is given."""
        return numpy_function(self.integrated.derived)

    @cached_property
    def at_switches(self) -> tuple[Any, list[str]]:
        """Likewise what is computed from the regimes' constants."""
        return numpy_function(self.integrated.switched)

    @cached_property
    def text(self) -> dict[str, str]:
        """Return the system as text, for the attributes of its datasets."""
        return describe(self.traced, self.composition, self.states, tuple(self.outputs))

    def outputs_along(
        self,
        values: Mapping[str, float],
        times: np.ndarray,
        path: np.ndarray,
        regimes: np.ndarray,
    ) -> Sequence[Any]:
        """Return each output at the instants of a run.

        Args:
            path: states, (instants, states); NaN where the run did not come.
            regimes: of each component there, (instants, components).
        """
        traced = self.traced
        function, names = numpy_function(list(traced.outputs))
        known: dict[str, Any] = {**values, TIME: times}
        known |= dict(zip(self.states, path.T, strict=True))
        for component, numbers in enumerate(regimes.T):
            columns = traced.columns(component)
            held = traced.regimes[np.maximum(numbers, 0), columns].T
            known |= dict(zip(traced.constants[columns], held, strict=True))
        along: Sequence[Any] = function(*(known[name] for name in names))
        return along

    @cached_property
    def joint(self) -> Joint:
        """The regimes of all components at once."""
        return Joint(self.traced, self.states)

    def flow(self, followed: Sequence[str] = (), scales: Any = None) -> Any:
        """Return the motion along legs; see :meth:`squealpipe.System.flow`."""
        raise NotImplementedError

    @cached_property
    def starts(self) -> Starts:
        """Regimes in which runs start."""
        return Starts(self.traced, self.composition)

    def first_regimes(
        self,
        values: Mapping[str, Any],
        size: int,
        chosen: Any = None,
        *,
        in_scales: bool = False,
    ) -> np.ndarray:
        """The regime of each component in which each run starts, (size, components).

        Args:
            values: states, parameters and ``time`` as arrays of that size.
            chosen: what a start gives as ``regime``; by default that of the system's start. What
                neither gives is what fits.
            in_scales: the values are numbers in the system's scales already.
        """
        chosen = self.start.get("regime") if chosen is None else chosen
        scales = None if in_scales else self.scales_in(values)
        if scales is not None:
            values = scales.into({**self.units_of_values, TIME: "s"}, values)
        return self.starts.regimes(values, size, self.composition.numbers(chosen))


def _marks(
    falls: np.ndarray, rises: np.ndarray, switches: Sequence[SwitchSymbols]
) -> np.ndarray:
    """(regime, surface) 1 where the only switch keeps the regime and the state: a marker."""
    marks = np.zeros(falls.shape, np.int64)
    for regime, surface in np.argwhere((falls >= 0) != (rises >= 0)):
        number = max(falls[regime, surface], rises[regime, surface])
        if number < len(switches):
            marks[regime, surface] = switches[number].changes_nothing_in(regime)
    return np.ascontiguousarray(marks)


def _clocks(
    surfaces: Sequence[Symbol], falls: np.ndarray, rises: np.ndarray, n_switches: int
) -> np.ndarray:
    """(surface,) 1 of those that depend on the time alone; a stop that is passed is no clock."""
    stops = ((falls >= n_switches) | (rises >= n_switches)).any(axis=0)
    timed = [is_clock(surface) for surface in surfaces]
    return np.array(timed, np.int64) * ~stops


def is_clock(surface: Symbol) -> bool:
    """Return whether a surface depends on the time alone, parameters and
    regimes' constants aside.
    """
    moving = [
        node.arguments[0] for node in in_order([surface]) if node.kind == "variable"
    ]
    return set(moving) == {TIME}


def _factor(values: np.ndarray, others: np.ndarray) -> float:
    """Return the factor between two rows of values of one surface."""
    place = int(np.argmax(np.abs(others)))
    return float(values[place] / others[place])


def _indicator(regime: str) -> str:
    return f"is {regime}"
