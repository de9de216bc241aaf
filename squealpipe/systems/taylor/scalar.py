"""Compiled functions of one state, written from symbols: surfaces, switches, resets, saltation.

Arguments are addresses: ``z`` of the state (with the time last, if it is explicit), ``p`` of a
lane's parameters, which the constants of its regimes follow, ``out`` of the results.
"""

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import CodeType
from typing import Any

import numpy as np

from squealpipe.systems.taylor import simd
from squealpipe.systems.taylor.lines import Writer
from squealpipe.systems.taylor.sums import Sums
from squealpipe.systems.taylor.symbols import Symbol, derivative, in_order, symbol

REGIME = "regime "
"""Begins the names of parameters that are a regime's constants."""


@dataclass(frozen=True, eq=False)
class SwitchSymbols:
    """One switch as symbols: its surface, where it may lead, and the states that jump.

    Attributes:
        resets: value by state, of each regime that it may lead to.
    """

    surface: Symbol
    targets: tuple[tuple[int, Symbol | None, int], ...]
    resets: dict[int, dict[int, Symbol]]

    @property
    def after(self) -> list[Symbol]:
        """All values that states may jump to."""
        return [value for reset in self.resets.values() for value in reset.values()]

    @cached_property
    def has_one_reset(self) -> bool:
        """True if states jump alike, whatever regime is entered."""
        first, *others = self.resets.values()
        return all(each == first for each in others)

    def changes_nothing_in(self, regime: int) -> bool:
        """Tell whether it keeps the regime and the state, and only marks an event."""
        return {each for each, _, _ in self.targets} == {regime} and not self.after


class ScalarSource:
    """Writes the three functions of a system."""

    def __init__(
        self,
        variables: Sequence[Symbol],
        rates: Sequence[Symbol],
        parameters: Sequence[str],
        constants: Sequence[str],
        surfaces: Sequence[Symbol],
        switches: Sequence[SwitchSymbols],
        size: int,
        outputs: Sequence[Symbol] = (),
    ) -> None:
        self.place = {id(each): index for index, each in enumerate(variables)}
        self.variables, self.rates = variables, rates
        names = (*parameters, *constants)
        self.rows = {name: index for index, name in enumerate(names)}
        self.n_parameters = len(parameters)
        self.surfaces, self.switches, self.size = surfaces, switches, size
        self.outputs = outputs

    def _writer(
        self,
        prefix: str,
        state: str = "z",
        regime: str = "",
        roots: Sequence[Symbol] = (),
    ) -> Writer:
        """Make a writer for some roots; with ``regime``, constants are those at this address."""

        def load(node: Symbol) -> str:
            if node.kind == "variable":
                return f"number({state} + {8 * self.place[id(node)]})"
            name = node.arguments[0]
            if regime and name.startswith(REGIME):
                return f"number({regime} + {8 * (self.rows[name] - self.n_parameters)})"
            return f"number(p + {simd.ROW * self.rows[name]})"

        return Writer(load, prefix, Sums(roots))

    def settle(self, switched: Sequence[Symbol]) -> str:
        """``settle(p)``: what parameters and constants alone decide goes into the last rows."""
        writer = self._writer("v")
        first = len(self.rows) - len(switched)
        for place, root in enumerate(switched):
            at = simd.ROW * (first + place)
            writer.lines.append(f"put(p + {at}, {writer.value(root)})")
        return _function("settle(p)", writer.lines)

    def gauge(self) -> str:
        """``gauge(z, sizes, p, out)``: value and size of the terms of each surface and its rate.

        Three numbers a surface: its value, the size of its terms, and that of its rate's terms.
        Likewise of each output after them, but for its rate.
        """
        writer = self._writer("v", roots=[*self.surfaces, *self.rates, *self.outputs])

        def size(node: Symbol) -> str:
            return f"number(sizes + {8 * self.place[id(node)]})"

        rates = [writer.scale(rate, size) for rate in self.rates]
        of_rates = {id(v): r for v, r in zip(self.variables, rates, strict=True)}
        for index, surface in enumerate(self.surfaces):
            for place, code in enumerate(
                (
                    writer.value(surface),
                    writer.scale(surface, size),
                    writer.rate_scale(surface, of_rates),
                )
            ):
                writer.lines.append(f"put(out + {24 * index + 8 * place}, {code})")
        for index, output in enumerate(self.outputs, len(self.surfaces)):
            for place, code in enumerate(
                (writer.value(output), writer.scale(output, size))
            ):
                writer.lines.append(f"put(out + {24 * index + 8 * place}, {code})")
        lines = [*writer.room(), *writer.lines]
        return _function("gauge(z, sizes, p, out)", lines)

    def change(self) -> str:
        """``change(switch, z, p, out)``: next regime, kind of event, state after the reset."""
        head = self._writer("z")
        state = [head.value(each) for each in self.variables[: self.size]]
        lines = [
            *head.lines,
            *(f"put(out + {16 + 8 * i}, {z})" for i, z in enumerate(state)),
        ]
        for index, switch in enumerate(self.switches):
            conditions = [c for _, c, _ in switch.targets if c is not None]
            writer = self._writer(f"v{index}_", roots=[*switch.after, *conditions])
            values = {id(each): writer.value(each) for each in switch.after}
            body = writer.lines
            for regime, condition, kind in switch.targets:
                found = [
                    f"put(out + {16 + 8 * place}, {values[id(value)]})"
                    for place, value in switch.resets[regime].items()
                ]
                found += [f"put(out, {regime}.0)", f"put(out + 8, {kind}.0)", "return"]
                if condition is not None:
                    body.append(f"if {writer.value(condition)} >= 0.0:")
                    found = [f" {line}" for line in found]
                body += found
            body = [*writer.room(), *body]
            lines += [f"if switch == {index}:", *(f" {line}" for line in body)]
        return _function("change(switch, z, p, out)", lines)

    def jump(self) -> str:
        """``jump(switch, regime, at_once, delay, z, after, p, r, d, out)``: d across a switch.

        ``regime`` is the one entered, ``r`` are the constants before it, ``delay`` is the address
        of δτ, and d is a perturbation.

        With h the surface, g the reset and f, f₊ the fields before and after: the switch comes
        δτ = −∇h·d / (∇h·f + ∂h/∂t) later, and d becomes Dg (d + f δτ) + ∂g/∂t δτ − f₊ δτ.
        One that fires at once, beyond its surface, is as late as the switch that led there.
        """
        size = self.size
        before, after = self._writer("b", regime="r"), self._writer("a", "after")
        rates = [before.value(rate) for rate in self.rates]
        later = [after.value(rate) for rate in self.rates]
        head = [*before.lines, *after.lines]
        head += [f"d{i} = number(d + {8 * i})" for i in range(size)]
        lines: list[str] = []
        for index, switch in enumerate(self.switches):
            writer = Writer(before.load, "v")
            slopes = self._slopes(writer, switch.surface)
            rate = " + ".join(f"{s} * {rates[j]}" for j, s in slopes)
            along = " + ".join(f"{s} * d{j}" for j, s in slopes if j < size) or "0.0"
            writer.lines += [f"w = {rate or '0.0'}", "tau = number(delay)"]
            writer.lines += ["if at_once == 0:", " tau = 0.0", " if w != 0.0:"]
            writer.lines += [f"  tau = -({along}) / w", "put(delay, tau)"]
            resets = switch.resets
            if switch.has_one_reset:
                writer.lines += self._jumped(
                    writer, next(iter(resets.values())), rates, later
                )
                resets = {}
            ways = {
                k: self._jumped(writer, reset, rates, later)
                for k, reset in resets.items()
            }
            for regime, way in ways.items():
                writer.lines += [f"if regime == {regime}:", *(f" {x}" for x in way)]
            lines += [f"if switch == {index}:", *(f" {line}" for line in writer.lines)]
        head_of = "jump(switch, regime, at_once, delay, z, after, p, r, d, out)"
        return _function(head_of, [*head, *lines])

    def _jumped(
        self,
        writer: Writer,
        reset: Mapping[int, Symbol],
        before: Sequence[str],
        later: Sequence[str],
    ) -> list[str]:
        """Lines that put a perturbation after a reset; those of its slopes go to the writer."""
        lines = []
        for i in range(self.size):
            moved = self._slopes(writer, reset.get(i, self.variables[i]))
            terms = [
                f"{s} * (d{j} + {before[j]} * tau)"
                if j < self.size
                else f"{s} * {before[j]} * tau"
                for j, s in moved
            ]
            total = " + ".join(terms) or "0.0"
            lines.append(f"put(out + {8 * i}, {total} - {later[i]} * tau)")
        return lines

    def _slopes(self, writer: Writer, root: Symbol) -> list[tuple[int, str]]:
        found = [(j, symbol(derivative(root, v))) for j, v in enumerate(self.variables)]
        return [
            (j, writer.value(each))
            for j, each in found
            if not (each.kind == "number" and each.arguments[0] == 0.0)
        ]


def _function(head: str, lines: Sequence[str]) -> str:
    return "\n".join([f"def {head}:", *(f" {line}" for line in lines), " return\n"])


def evaluate(roots: Sequence[Symbol], values: Mapping[str, Any]) -> tuple[Any, ...]:
    """Symbols as floats or arrays, from those of variables and parameters by name.

    Node by node: code for so many as a structure has takes longer to compile than to run once.
    """
    found: dict[int, Any] = {}
    with np.errstate(invalid="ignore", divide="ignore"):
        for node in in_order(roots):
            given = [
                found[id(a)] if isinstance(a, Symbol) else a for a in node.arguments
            ]
            found[id(node)] = _value(node.kind, given, values)
    return tuple(found[id(root)] for root in roots)


def _value(kind: str, given: Sequence[Any], values: Mapping[str, Any]) -> Any:
    """One operation on the values of its arguments."""
    if kind == "number":
        return given[0]
    if kind in {"variable", "parameter"}:
        return values[given[0]]
    if kind in _OPERATIONS:
        return _OPERATIONS[kind](*given)
    return getattr(np, kind)(*given)


def python_function(
    roots: Sequence[Symbol], arguments: Sequence[Symbol], module: Any
) -> Any:
    """The values of symbols as a function of some, with the functions of ``math`` or ``numpy``."""
    names = {id(each): f"a{index}" for index, each in enumerate(arguments)}
    writer = Writer(lambda node: names[id(node)], "v")
    values = [writer.value(root) for root in roots]
    lines = [*writer.lines, f"return ({', '.join([*values, ''])})"]
    source = f"def function({', '.join(names.values())}):\n" + "".join(
        f" {x}\n" for x in lines
    )
    scope: dict[str, Any] = {"math": module, "only": _only}
    exec(_code(source), scope)  # noqa: S102
    if "only(" not in source:
        return scope["function"]
    # fields of other regimes need not be numbers
    return np.errstate(invalid="ignore", divide="ignore")(scope["function"])


@lru_cache(4096)
def _code(source: str) -> CodeType:
    """Return the code of a text: in a process systems of the same laws are traced many times."""
    return compile(source, "<string>", "exec")


def _only(mark: Any, value: Any) -> Any:
    """A value where a mark is above zero, else zero."""
    if isinstance(mark, float) and isinstance(value, float):
        return value if mark > 0.0 else 0.0
    return np.where(np.asarray(mark) > 0.0, value, 0.0)


def _joined(c1: Any, a1: Any, b1: Any, c2: Any, a2: Any, b2: Any) -> Any:
    return c1 * (a1 * b1) + c2 * (a2 * b2)


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "*": operator.mul,
    "**": operator.pow,
    "only": _only,
    "joined": _joined,
}


def numpy_function(roots: Sequence[Symbol]) -> tuple[Any, list[str]]:
    """The values of symbols as a function of arrays, and the names of its arguments."""
    nodes = [n for n in in_order(list(roots)) if n.kind in {"variable", "parameter"}]
    return python_function(roots, nodes, np), [n.arguments[0] for n in nodes]
