"""Motion of a system along legs of one regime each, with the derivatives that cycles need.

Idea: a leg is a piece of a motion in one regime. Newton's method for a cycle needs the end of each
leg, the switch there, and derivatives of both. :class:`Flow` says what a system has to answer;
:class:`TracedFlow` answers from symbols, whose derivatives are symbols, and
:mod:`squealpipe.systems.linear.flow` from matrices. Legs are run by the integrator's Taylor series,
to round-off. Invariant: where a leg takes too many steps all ends are NaN, so that Newton's method
gives up. Cost: functions are made of symbols once for each system and each choice of followed
parameters.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from squealpipe.systems.cycles.affine import Affine, is_affine
from squealpipe.systems.cycles.crossing import Crossing
from squealpipe.systems.cycles.legs import LegEnd, Path, Vector
from squealpipe.systems.integrate import compiled, symbolic
from squealpipe.systems.scales import Scales
from squealpipe.systems.taylor.lanes import (
    INVERSES,
    Workspace,
    aligned,
    drive,
    taylor_terms,
)
from squealpipe.systems.taylor.legs import (
    FIRST_PARAMETER,
    LEG_ARRAYS,
    LEG_SIZES,
    LEG_TABLE,
    run_legs,
)
from squealpipe.systems.taylor.scalar import python_function
from squealpipe.systems.taylor.simd import FEW, LANES
from squealpipe.systems.taylor.symbols import derivative, parameter, symbol
from squealpipe.systems.trace import TIME, TIME_UNIT, Names

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


_compiled_functions: WeakKeyDictionary[Any, dict[tuple[str, ...], dict[Any, Any]]] = (
    WeakKeyDictionary()
)
"""Functions of flows by the system whose symbols they are made of, and followed parameters."""


class Flow(ABC):
    """A system's legs and switches as functions of states and parameters.

    Attributes:
        system, followed: the system, and the parameters by which derivatives are taken.
        scales: scales, if the system states them, by which states, times and parameters are divided
            here; None where all are in the system's own units.
        size: number of states.
        columns: number of states, of followed parameters and, if time is explicit, of one more.
        timed: whether the system's functions depend on time explicitly.
    """

    def __init__(
        self, system: System, followed: Sequence[str] = (), scales: Scales | None = None
    ) -> None:
        self.system, self.followed, self.scales = system, tuple(followed), scales
        t = system.traced
        self.size, self.timed = t.size, len(t.variables) > t.size
        self.columns = self.size + len(self.followed) + self.timed
        # a leg of more steps has no end, so that Newton's method gives up; a stiff motion may
        # need more: the run that its cycle is guessed from says how many
        self.most_steps = 3000
        self._sizes: tuple[Any, Vector] | None = None

    def sizes(self, values: Mapping[str, float]) -> Vector:
        """Return the typical sizes of the states, (size,)."""
        key = tuple(values[name] for name in self.system.parameters)
        if self._sizes is None or self._sizes[0] != key:
            self._sizes = key, self.system.sizes_in(values)
        return self._sizes[1]

    @staticmethod
    def of(
        system: System, values: Mapping[str, Any], followed: Sequence[str] = ()
    ) -> tuple[Flow, dict[str, Any]]:
        """Return a flow in the scales that a system states, and the parameters divided by them."""
        flow = system.flow(followed, system.scales_in(values))
        if flow.scales is None:
            return flow, dict(values)
        return flow, flow.scales.into(system.units_of_values, values)

    def following(self, *followed: str) -> Flow:
        """Return the flow of the same system with other followed parameters."""
        flow: Flow = self.system.flow(followed, self.scales)
        return flow

    def scale_of(self, *names: str) -> Vector:
        """Return the scales of states, parameters, outputs or ``time``, in their own units."""
        if self.scales is None:
            return np.ones(len(names))
        units = {
            **self.system.units_of_values,
            **{name: unit for name, (unit, _) in self.system.outputs.items()},
            TIME: "s",
        }
        return np.array([float(self.scales.of(units[name])) for name in names])

    def unit(self, values: Mapping[str, float]) -> float:
        """Return the system's typical time, which is 1 in the Taylor series, s."""
        scale = self.system.time_scale
        return float(scale(Names("the system", values)) if callable(scale) else scale)

    @property
    @abstractmethod
    def is_affine(self) -> bool:
        """Tell whether all rates are affine in the states."""

    @abstractmethod
    def forcing(self, values: Mapping[str, float]) -> tuple[float, Vector]:
        """Return the forcing's period, s, and its derivatives by the followed parameters."""

    @abstractmethod
    def field(
        self, values: Mapping[str, float], regime: int, state: Vector, time: float
    ) -> Vector:
        """Return the rates of the states, (size,)."""

    @abstractmethod
    def jacobian(
        self, values: Mapping[str, float], regime: int, state: Vector
    ) -> Vector:
        """Return ∂f/∂(states, followed parameters, time), (size, columns)."""

    @abstractmethod
    def affine_at(self, values: Mapping[str, float], regime: int) -> Affine:
        """Return the rates as a matrix and a constant, where they are affine in the states."""

    @abstractmethod
    def slopes_along(
        self, values: Mapping[str, float], regimes: NDArray[np.int64], states: Vector
    ) -> Vector:
        """Return :meth:`jacobian` at many states, (size, columns, nodes, many).

        Args:
            regimes: (many,).
            states: (states, and time if it is explicit; nodes; many).
        """

    @abstractmethod
    def crossing(
        self,
        values: Mapping[str, float],
        switch: int,
        surface: int,
        regimes: tuple[int, int],
        state: Vector,
        time: float,
    ) -> Crossing:
        """Return a switch at a state: its surface, its reset, and their derivatives.

        Args:
            switch: its number; −1 for a surface that is crossed without a switch.
            surface: number of that surface; −1 for an end of a leg that is on no surface.
            regimes: before and after it.
        """

    @abstractmethod
    def quantity(
        self,
        values: Mapping[str, float],
        event: LegEnd,
        condition: int | None,
        state: Vector,
        time: float,
    ) -> Vector:
        """Return a number that decides on an event, followed by its derivatives.

        They are by the states, the time if it is explicit, and the followed parameters.

        Args:
            condition: number of the condition of the event's switch that is asked for; None asks
                for the rate of its surface just before the event.
        """

    @abstractmethod
    def run(
        self,
        values: Mapping[str, float],
        states: Vector,
        regimes: Sequence[int],
        starts: Vector,
        durations: Vector,
    ) -> Path:
        """Run legs side by side, each in its regime, and return their series and ends.

        Args:
            states: (legs, size), at the beginning of each.
            starts, durations: (legs,), in the flow's unit of time.
        """


class TracedFlow(Flow):
    """Legs and switches of a system whose functions are symbols."""

    def __init__(
        self, system: System, followed: Sequence[str] = (), scales: Scales | None = None
    ) -> None:
        super().__init__(system, followed, scales)
        t = system.traced
        self.by = [parameter(name) for name in followed]
        self.time = t.variables[-1] if self.timed else None
        fixed = [parameter(name) for name in (*t.parameters, *t.constants)]
        self.arguments = [*t.variables, *fixed]
        # what is made of the symbols is the same for all flows of systems that share them
        shared = _compiled_functions.setdefault(system.form, {})
        self._functions: dict[Any, Any] = shared.setdefault(self.followed, {})
        # steps of a leg that are kept at first; one that has more is run again with room for all
        self._room, self._legs = 48, 0
        self._directions = [
            *t.variables[: t.size],
            *self.by,
            *([self.time] * self.timed),
        ]
        self._known: tuple[Any, Vector] | None = None
        self._numbers: tuple[Any, list[Any]] | None = None

    def _made(self, what: str, make: Callable[[], Any]) -> Any:
        """Return what is made of the symbols at the first call, for all flows of the system."""
        if what not in self._functions:
            self._functions[what] = make()
        return self._functions[what]

    @cached_property
    def is_affine(self) -> bool:
        """True if each rate is a constant plus a linear function of the states, without time."""
        rates = self.system.traced.rates[: self.size]
        return bool(not self.timed and self._made("affine", lambda: is_affine(rates)))

    @cached_property
    def rates(self) -> Any:
        """The function that gives the rates of the states."""
        rates = self.system.traced.rates[: self.size]
        return self._made("rates", lambda: python_function(rates, self.arguments, np))

    @cached_property
    def _derived(self) -> Any:
        """The function that gives the parameters that are computed from others."""
        names = [parameter(name) for name in (*self.system.parameters, TIME_UNIT)]
        roots = self.system.integrated.derived
        return self._made("derived", lambda: python_function(roots, names, np))

    @cached_property
    def entries(self) -> list[tuple[int, int, Any]]:
        """Nonzero ∂f/∂(states, followed parameters, time), each as (row, column, symbol)."""

        def entries() -> list[tuple[int, int, Any]]:
            every = [
                (i, j, symbol(derivative(rate, by)))
                for i, rate in enumerate(self.system.traced.rates[: self.size])
                for j, by in enumerate(self._directions)
            ]
            return [
                e
                for e in every
                if not (e[2].kind == "number" and not e[2].arguments[0])
            ]

        pieces: list[tuple[int, int, Any]] = self._made("entries", entries)
        return pieces

    @cached_property
    def slopes(self) -> Any:
        """The function that gives :attr:`entries`."""
        roots = [e[2] for e in self.entries]
        return self._made("slopes", lambda: python_function(roots, self.arguments, np))

    @cached_property
    def rates_by(self) -> Any:
        """The function that gives ∂f/∂(followed parameters), state by state."""
        rates = self.system.traced.rates[: self.size]

        def function() -> Any:
            roots = [symbol(derivative(rate, by)) for rate in rates for by in self.by]
            return python_function(roots, self.arguments, np)

        return self._made("rates by", function)

    @cached_property
    def period(self) -> Any:
        """The forcing's period and its derivatives by the followed parameters, as a function."""
        names = {name: parameter(name) for name in self.system.parameters}
        given: Any = self.system.period
        root = symbol(given(Names("the system", names)))
        roots = [root, *(symbol(derivative(root, by)) for by in self.by)]
        return python_function(roots, self.arguments, np)

    def numbers(self, values: Mapping[str, float], regime: int) -> list[Any]:
        """Return the functions' arguments: parameters, 1 as unit of time, a regime's constants."""
        key = regime, *(values[name] for name in self.system.parameters)
        if self._numbers is None or self._numbers[0] != key:
            given = [*map(np.float64, key[1:]), np.float64(1.0)]
            self._numbers = key, [*given, *self.system.joint.constants(regime)]
        return self._numbers[1]

    def forcing(self, values: Mapping[str, float]) -> tuple[float, Vector]:
        """Return the forcing's period, s, and its derivatives by the followed parameters."""
        blank = [np.float64(0.0)] * len(self.system.traced.variables)
        period = self.period(*blank, *self.numbers(values, 0))
        return float(period[0]), np.array(period[1:], float)

    def field(
        self, values: Mapping[str, float], regime: int, state: Vector, time: float
    ) -> Vector:
        """Return the rates of the states, (size,)."""
        return self._at(self.rates, values, regime, state, time)

    def _at(
        self,
        function: Any,
        values: Mapping[str, float],
        regime: int,
        state: Vector,
        time: float,
    ) -> Vector:
        """Evaluate a function of :attr:`arguments` at a state."""
        at = [*state, *([np.float64(time)] * self.timed)]
        return np.array(function(*at, *self.numbers(values, regime)), float)

    def jacobian(
        self, values: Mapping[str, float], regime: int, state: Vector
    ) -> Vector:
        """Return ∂f/∂(states, followed parameters, time), (size, columns)."""
        matrix = np.zeros((self.size, self.columns))
        # asked only of motions that nothing forces, whose field reads no time
        entries = self._at(self.slopes, values, regime, state, 0.0)
        for (i, j, _), value in zip(self.entries, entries, strict=True):
            matrix[i, j] = value
        return matrix

    def affine_at(self, values: Mapping[str, float], regime: int) -> Affine:
        """Return the rates as a matrix and a constant, where they are affine in the states."""
        n, p = self.size, len(self.by)
        numbers, sizes = self.numbers(values, regime), self.sizes(values)
        # at the origin and at one unit of each state: what is affine is known by these
        places = np.column_stack([np.zeros(n), np.diag(sizes)])

        def parts(function: Any) -> tuple[Vector, Vector]:
            rows = function(*places, *numbers)
            coefficients = np.array([np.broadcast_to(row, n + 1) for row in rows])
            coefficients = coefficients.reshape(-1, n + 1)
            return (coefficients[:, 1:] - coefficients[:, :1]) / sizes, coefficients[
                :, 0
            ]

        matrix, constant = parts(self.rates)
        by_matrix, by_constant = parts(self.rates_by)
        return Affine(
            matrix,
            constant,
            by_matrix.reshape(n, p, n).transpose(1, 0, 2),
            by_constant.reshape(n, p).T,
        )

    def slopes_along(
        self, values: Mapping[str, float], regimes: NDArray[np.int64], states: Vector
    ) -> Vector:
        """Return derivatives of the rates at many states; see :meth:`Flow.slopes_along`."""
        joint, given = self.system.joint, len(self.system.traced.parameters)
        kinds, kind = np.unique(regimes, return_inverse=True)
        of_kinds = np.array([joint.constants(regime) for regime in kinds.tolist()])
        constants = of_kinds.T[:, kind]
        numbers = self.numbers(values, 0)[:given]
        slopes = np.zeros((self.size, self.columns, *states.shape[1:]))
        entries = self.slopes(*states, *numbers, *constants)
        for (i, j, _), value in zip(self.entries, entries, strict=True):
            slopes[i, j] = value
        return slopes

    def crossing(
        self,
        values: Mapping[str, float],
        switch: int,
        surface: int,
        regimes: tuple[int, int],
        state: Vector,
        time: float,
    ) -> Crossing:
        """A switch at a state; see :meth:`Flow.crossing`."""
        t = self.system.traced
        each = t.switches[switch] if switch >= 0 else None
        entered = -1
        if each and not each.has_one_reset:
            entered = self.system.joint.entered_by(regimes[1], switch)
        key = (switch, surface, "into", entered)
        if key not in self._functions:
            states = t.variables[: t.size]
            jumps = next(iter(each.resets.values())) if each else {}
            jumps = each.resets[entered] if each and entered >= 0 else jumps
            alone = t.surfaces[surface] if surface >= 0 else symbol(0.0)
            roots = [each.surface if each else alone]
            roots += [jumps.get(i, z) for i, z in enumerate(states)]
            targets = [c for _, c, _ in each.targets if c is not None] if each else []
            by = [*states, *[self.time] * self.timed, *self.by]
            sloped = [
                [root, *(symbol(derivative(root, b)) for b in by)] for root in roots
            ]
            every = [*chain(*sloped), *t.rates[: t.size], *targets]
            self._functions[key] = python_function(every, self.arguments, np)
        flat = self._at(self._functions[key], values, regimes[0], state, time)
        n, width = self.size, 1 + self.size + self.timed + len(self.by)
        # values, and slopes by states, the time and parameters: of the surface and what comes after
        rows = flat[: (n + 1) * width].reshape(n + 1, width)
        rest = flat[(n + 1) * width :]
        after, last = rows[1:, 0], n + 1 + self.timed
        return Crossing(
            height=float(rows[0, 0]),
            height_by_state=rows[0, 1 : n + 1],
            height_by_time=float(rows[0, n + 1]) if self.timed else 0.0,
            height_by=rows[0, last:],
            after=after,
            after_by_state=rows[1:, 1 : n + 1],
            after_by_time=rows[1:, n + 1] if self.timed else np.zeros(n),
            after_by=rows[1:, last:],
            rate=rest[:n],
            rate_after=self.field(values, regimes[1], after, time),
            conditions=rest[n:],
        )

    def quantity(
        self,
        values: Mapping[str, float],
        event: LegEnd,
        condition: int | None,
        state: Vector,
        time: float,
    ) -> Vector:
        """Return the rate of a surface or a condition; see :meth:`Flow.quantity`."""
        key = event.switch, event.surface, condition
        if key not in self._functions:
            t = self.system.traced
            states, by = t.variables[: t.size], [self.time] * self.timed
            switch = t.switches[event.switch] if event.switch >= 0 else None
            if switch and condition is not None:
                root = [c for _, c, _ in switch.targets if c is not None][condition]
            else:
                surface = switch.surface if switch else t.surfaces[event.surface]
                along = zip(
                    [*states, *by],
                    [*t.rates[: t.size], *[1.0] * self.timed],
                    strict=True,
                )
                root = sum(
                    (symbol(derivative(surface, z)) * rate for z, rate in along),
                    symbol(0.0),
                )
            roots = [
                root,
                *(symbol(derivative(root, each)) for each in (*states, *by, *self.by)),
            ]
            self._functions[key] = python_function(roots, self.arguments, np)
        return self._at(self._functions[key], values, event.before, state, time)

    def _prepare(self, legs: int) -> None:
        t, code = self.system.integrated, compiled(self.system, tangent=False, few=True)
        # Taylor steps to round-off: Newton's method converges to the last digit
        terms, constants = taylor_terms(1e-16), len(t.all_constants)
        kept = len(t.variables) + len(t.surfaces) + len(t.outputs)
        self._legs = legs
        sizes = {
            "n_terms": terms,
            "n_legs": legs,
            "n_states": t.size,
            "n_variables": len(t.variables),
            "n_kept": kept,
            "n_parameters": len(t.parameters),
            "n_constants": constants,
            "n_series": code.n_series,
            "n_steps": self._room,
            "take_step": code.address("series"),
            "shorten": code.address("shorten"),
        }
        arrays = {
            "rows": aligned(FIRST_PARAMETER + len(t.parameters) + constants, LANES),
            "series": aligned(code.n_series, terms, LANES),
            "inverses": INVERSES,
            "units": aligned(t.size, LANES),
            "bent": np.append(symbolic(self.system).bent, 0),
            "constants": np.zeros((legs, max(1, constants))),
            "initial": np.zeros((legs, t.size)),
            "starts": np.zeros(legs),
            "durations": np.zeros(legs),
            "kept": np.zeros((legs, self._room, kept, terms)),
            "steps": np.zeros((legs, self._room)),
            "counts": np.zeros(legs, np.int64),
            "lanes": np.zeros(2 * FEW, np.int64),
        }
        self._work = Workspace(
            LEG_TABLE,
            {k: arrays[k] for k in LEG_ARRAYS},
            {name: sizes[name] for name in LEG_SIZES},
        )

    def run(
        self,
        values: Mapping[str, float],
        states: Vector,
        regimes: Sequence[int],
        starts: Vector,
        durations: Vector,
    ) -> Path:
        """Run legs side by side, each in its regime; see :meth:`Flow.run`."""
        if self._legs != len(states):
            self._prepare(len(states))
        key = tuple(values[name] for name in self.system.parameters)
        if self._known is None or self._known[0] != key:
            unit = self.unit(values)
            derived = self._derived(*map(np.float64, (*key, unit)))
            self._known = key, np.array([*key, *derived, unit], float)
        column = self._known[1]
        unit = float(column[-1])
        arrays = self._work.arrays
        last = FIRST_PARAMETER + len(column)
        arrays["rows"][FIRST_PARAMETER:last] = column[:, None]
        sizes = np.minimum(
            self.sizes(values), np.maximum(np.abs(states).max(axis=0), 1e-200)
        )
        arrays["units"][:] = 1.0 / sizes[:, None]
        arrays["initial"][:] = states
        for row, regime in zip(arrays["constants"], regimes, strict=True):
            constants = self._constants_of(regime, column)
            row[: len(constants)] = constants
        arrays["starts"][:], arrays["durations"][:] = starts / unit, durations / unit
        drive(run_legs(), self._work)
        counts = arrays["counts"]
        more = counts.max() > self._room
        endless = more and self._room >= self.most_steps
        if endless:
            counts = np.ones_like(counts)
        elif more:
            self._room *= 4
            self._legs = 0
            return self.run(values, states, regimes, starts, durations)
        used = np.arange(self._room) < counts[:, None]
        path = Path.of(
            arrays["kept"][used],
            arrays["steps"][used],
            counts,
            self.size,
            regimes=regimes,
            starts=starts,
            durations=durations,
            unit=unit,
        )
        if endless:
            path.ends[:] = np.nan
        return path

    def _constants_of(self, regime: int, parameters: Vector) -> Vector:
        """Return a regime's constants and what is computed from them, as the series take them."""
        t, constants = self.system.integrated, self.system.joint.constants(regime)
        known = dict(zip(t.parameters, parameters, strict=True))
        known |= dict(zip(t.constants, constants, strict=True))
        function, names = self.system.at_switches
        return np.array([*constants, *function(*(known[name] for name in names))])
