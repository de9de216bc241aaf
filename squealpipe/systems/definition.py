"""Define a piecewise-smooth system, and check the definition.

:mod:`squealpipe.systems.tracing` turns its functions into symbols, and
:mod:`squealpipe.systems.system` binds runs and cycles to it as methods.
"""

from __future__ import annotations  # help shows Angle, not its checks

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from pydantic import WrapValidator

from squealpipe.systems.components import (
    Begins,
    Component,
    Composition,
    Function,
    Regimes,
    Switch,
)
from squealpipe.systems.datasets import Outcome
from squealpipe.systems.inputs.gate import (
    Identifier,
    Number,
    Positive,
    Word,
    checked,
    needed,
)
from squealpipe.systems.inputs.units import holds_units
from squealpipe.systems.inputs.values import is_finite_number, numbers_in_si
from squealpipe.systems.inputs.words import says_what_was_meant, suggestion
from squealpipe.systems.scales import Scales
from squealpipe.systems.schema import names_in_results
from squealpipe.systems.trace import Names, Traced

Size = Annotated[
    str | tuple[str, Positive | Function],
    needed("a unit, or (unit, typical size greater than 0, or a function), is"),
]
Output = Annotated[tuple[str, Function], needed("(unit, function) is")]
Default = Annotated[
    Number | tuple[Number, Word], needed("a finite number, or (number, unit), is")
]
StartValue = Annotated[
    Number | str | Mapping[str, str],
    needed("a finite number, or the name of a regime, is"),
    WrapValidator(lambda value, check: value if holds_units(value) else check(value)),
]
"""One with a unit is read where its state is known."""
Field = Annotated[
    Function | Mapping[str, Function], needed("a function, or one for each regime, is")
]


@dataclass(frozen=True)
class SizeLimits:
    """Largest sizes of a system that is compiled; code grows with their product."""

    states: int = 64
    surfaces: int = 64
    regimes: int = 256


@says_what_was_meant
class Definition:
    """A piecewise-smooth system: regimes, a field, and switches between them.

    Args:
        name: for titles and files.
        states: name → unit, or name → (unit, typical size). The size is a number or a function of
            the parameters, 1 if none is given; error control and round-off are relative to it.
        parameters: name → default, or (default, unit).
        regimes: name → {constant: value}: the constants ``r`` that field and surfaces read. All
            regimes have constants of the same names.
        components: name → :class:`squealpipe.Component`, for a system of several parts each of
            which has its own regimes; given in place of ``regimes``, ``switches`` and
            ``starts_in``.
        field: (t, s, p, r) → rates of all states, or one such function for each regime.
        start: state → value, and ``regime`` if it is to be given, with components as
            {component: regime}.
        starts_in: [(regime, condition) or (regime, condition, equality), …, regime]. A run begins
            in the first regime whose condition is ≥ 0 and whose equality is 0, else in the last
            one. Where a condition is None, all surfaces of that regime have to be ≥ 0; where
            ``starts_in`` is left out, those of each regime, in the order of ``regimes``.
        period: of the forcing, a function of the parameters; left out, the system is autonomous.
        outputs: name → (unit, function (t, s, p, r)): quantities that runs give beside the states,
            with their extremes.
        stops: outcome → function (t, s, p, r): ends a run where it falls through zero.
        time_scale: typical time, a number or a function of the parameters.
        scales: function of the parameters that gives {unit: typical size of a quantity of that
            unit}, for "s" and every other unit of which those of states, parameters and outputs are
            made. Runs are then made in numbers without units, so that they do not depend on the
            units of what they are given; typical sizes and time are these scales.

    Raises:
        ValueError: a name is unknown, missing or taken, a surface is constant in a regime, a ``to``
            has no last resort, a reset makes no progress, or ``scales`` are given and the functions
            do not agree with the units.
        TypeError: a function is not smooth (a comparison, a branch), or gives what is not a number.
    """

    batch: Any = None
    """Integrator of runs in place of series that are compiled for the system; None: these."""
    most_states, most_regimes = SizeLimits.states, SizeLimits.regimes
    scales: Any = None
    has_typical_sizes = True

    @checked
    def __init__(
        self,
        name: str,
        *,
        states: Mapping[Identifier, Size],
        parameters: Mapping[Identifier, Default],
        regimes: Regimes | None = None,
        components: Mapping[Identifier, Component] | None = None,
        field: Field,
        switches: Sequence[Switch] = (),
        start: Mapping[str, StartValue],
        starts_in: Begins = (),
        period: Function | None = None,
        outputs: Mapping[Identifier, Output] | None = None,
        stops: Mapping[Word, Function] | None = None,
        time_scale: Annotated[
            Positive | Function | None,
            needed("a number greater than 0, or a function, is"),
        ] = None,
        scales: Function | None = None,
    ) -> None:
        self.name = name
        self.units = {
            key: value if isinstance(value, str) else value[0]
            for key, value in states.items()
        }
        self.typical_sizes = {
            key: None if isinstance(value, str) else value[1]
            for key, value in states.items()
        }
        self.has_typical_sizes = any(self.typical_sizes.values())
        self.parameters = {
            key: value[0] if isinstance(value, tuple) else value
            for key, value in parameters.items()
        }
        self.parameter_units = {
            key: value[1] if isinstance(value, tuple) else "1"
            for key, value in parameters.items()
        }
        self.field = field
        self.start = {
            key: in_unit_of_state(self.units, key, value)
            for key, value in start.items()
        }
        self.composition = Composition.of(
            _components(regimes, switches, starts_in, components)
        )
        self.regimes = self.composition.regimes
        self.switches = self.composition.switches
        self.period, self.scales = period, scales
        if time_scale is None:
            time_scale = 1.0 if scales is None else lambda p: scales(p)["s"]
        self.time_scale = time_scale
        self.outputs, self.stops = dict(outputs or {}), dict(stops or {})
        self._check_names()
        for what, function in (("period", period), ("time_scale", time_scale)):
            if callable(function):
                value = function(Names("the system", self.parameters))
                if not is_finite_number(value):
                    raise ValueError(f"{what} gives {value!r}; a number is needed")
        for state, size in zip(self.units, self.sizes_in(self.parameters), strict=True):
            if not (is_finite_number(size) and size > 0.0):
                raise ValueError(
                    f"the typical size of state {state!r} is {size:g}; a number greater than 0 "
                    "is needed"
                )
        self.traced = self._trace()
        self.form = self
        self.check_scales()

    def _trace(self) -> Traced:
        """Call the functions with symbols, and return what they become; a subclass does this."""
        raise NotImplementedError

    def check_scales(self) -> None:
        """Raise if the functions do not agree with the scales' units; a subclass does this."""
        raise NotImplementedError

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(self.units)

    def scales_in(self, values: Mapping[str, Any]) -> Scales | None:
        """Return the scales of a run or of many, if the system states them.

        Args:
            values: each parameter, a number or an array (runs,).
        """
        if self.scales is None:
            return None
        parameters = {name: values[name] for name in self.parameters}
        return Scales(self.scales(Names("the system", parameters)))

    def sizes_in(self, values: Mapping[str, Any]) -> np.ndarray:
        """Return the typical sizes of the states, (states,) or, of many runs, (runs, states).

        Args:
            values: each parameter, a number or an array (runs,).
        """
        scales, sizes = self.scales_in(values), []
        for name, size in self.typical_sizes.items():
            if size is None:
                sizes.append(1.0 if scales is None else scales.of(self.units[name]))
            elif callable(size):
                parameters = {name: values[name] for name in self.parameters}
                sizes.append(size(Names("the system", parameters)))
            else:
                sizes.append(size)
        if all(isinstance(size, float) for size in sizes):
            return np.array(sizes)
        return np.stack(np.broadcast_arrays(*sizes), axis=-1).astype(float)

    @cached_property
    def start_names(self) -> dict[str, str]:
        """Map each state to the name of its start: ``x0``.

        Where some state is itself named like that, the starts of all are named ``x_0``.
        """
        mark = ""
        while any(f"{name}{mark}0" in self.units for name in self.units):
            mark += "_"
        return {name: f"{name}{mark}0" for name in self.units}

    def __repr__(self) -> str:
        switches = ", ".join(switch.name for switch in self.switches)
        return f"System({self.name!r}: {', '.join(self.states)}; switches {switches or 'none'})"

    def _check_names(self) -> None:
        for number, most, what in (
            (len(self.units), self.most_states, "states"),
            (len(self.regimes), self.most_regimes, "regimes"),
        ):
            if not 1 <= number <= most:
                raise ValueError(f"{number} {what}; 1 to {most} can be carried")
        own = {
            "state": self.units,
            "name": (*self.units, *self.outputs),
            "regime": self.regimes,
            "event": [switch.name for switch in self.switches],
        }
        starts = self.start_names.values()
        # no name of a system is that of an argument of its methods
        arguments = frozenset(
            (
                *("t_end", "t_start", "times", "start", "tol", "sensitivity", "t_late"),
                *(
                    "horizon",
                    "workers",
                    "max_steps",
                    "guess",
                    "periods",
                    "t_settle",
                    "to",
                    "n_points",
                ),
                *(
                    "parameter",
                    "parameters",
                    "label",
                    "run",
                    "regime",
                    "self",
                    "system",
                ),
            )
        )
        taken = arguments | names_in_results(own) | {*starts}
        self._check_free("state", self.units, taken)
        self._check_free("parameter", self.parameters, {*self.units, *taken})
        self._check_free(
            "output", self.outputs, {*self.units, *self.parameters, *taken}
        )
        self._check_free("stop", self.stops, {outcome.name for outcome in Outcome})
        if unknown := [
            name for name in self.start if name not in {*self.units, "regime"}
        ]:
            raise ValueError(
                f"start: {unknown[0]!r} is unknown; {suggestion(unknown[0], self.units)}"
            )
        if missing := [name for name in self.units if name not in self.start]:
            raise ValueError(f"start lacks the state {missing[0]!r}")
        self.check_regime(self.start)
        names = [switch.name for switch in self.switches]
        if len(set(names)) < len(names):
            raise ValueError(f"two switches share a name: {', '.join(names)}")

    def check_regime(self, start: Mapping[str, Any]) -> None:
        """Raise if the regime of a start does not exist."""
        self.composition.numbers(start.get("regime"))

    def check_parameter(self, name: str) -> None:
        """Raise if a parameter does not exist."""
        if name not in self.parameters:
            near = suggestion(name, self.parameters)
            raise ValueError(f"{self.name}: parameter {name!r} is unknown; {near}")

    @staticmethod
    def _check_free(what: str, names: Mapping[str, Any], taken: Any) -> None:
        for name in names:
            if name in taken:
                raise ValueError(
                    f"{what} {name!r}: the name is taken by an argument, a state, a start or a "
                    "result; choose another"
                )

    def name_of(self, regime: int) -> str:
        """Return the name of the regime of a number, with its component's."""
        return list(self.regimes)[regime]


def in_unit_of_state(units: Mapping[str, str], name: str, value: Any) -> Any:
    """Return a start in the unit of its state, from a number, a text with a unit or a quantity.

    Args:
        units: state → unit; what is no state, as ``regime``, is left as it is.

    Raises:
        ValueError: the unit is of another kind; names the state and the value.
    """
    if name not in units:
        return value
    return numbers_in_si(f"start: {name}", value, units[name])


def _components(
    regimes: Any, switches: Any, starts_in: Any, components: Any
) -> Mapping[str, Component]:
    """Return the components that are given, or the regimes that are given as the only one."""
    if components is None:
        if regimes is None:
            raise TypeError("System: regimes, or components, are needed")
        return {"": Component(regimes, switches, starts_in)}
    for name, value in (
        ("regimes", regimes),
        ("switches", switches),
        ("starts_in", starts_in),
    ):
        if value:
            raise ValueError(
                f"{name}: a system with components has them there; move them into a component"
            )
    return dict(components)
