"""Taylor series of a vector field and of its event functions, for ``LANES`` runs at once.

From the symbols of a :class:`HybridSystem` functions are written and compiled. One computes
the Taylor coefficients of the state and of the event functions, order after order: a product is a
convolution, a power or an exponential a recurrence (Jorba and Zou 2005), everything linear costs
next to nothing. Another carries a perturbation along these polynomials, in steps that its own
rate limits: near rest those of the state are as long as one likes.
"""

import functools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.systems.taylor import simd
from squealpipe.systems.taylor.bases import Base, RootSettings, bases_of
from squealpipe.systems.taylor.sums import Sums
from squealpipe.systems.taylor.symbols import (
    FUNCTIONS,
    Symbol,
    degree,
    derivative,
    function,
    in_order,
    moving_part,
    slope_of_asin,
    slope_of_atan,
    symbol,
)

Name = Callable[[Symbol], str]


def gauss(points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes in (0, 1), weights, and the integrals of Lagrange's polynomials up to each node."""
    places, weights = np.polynomial.legendre.leggauss(points)
    nodes = 0.5 * (places + 1.0)
    powers = nodes[:, None] ** np.arange(points)
    integrals = powers * nodes[:, None] / np.arange(1, points + 1)
    return nodes, 0.5 * weights, np.linalg.solve(powers.T, integrals.T).T


GAUSS, GAUSS_WEIGHTS, GAUSS_MATRIX = (each.tolist() for each in gauss(4))
"""Four-point Gauss collocation: order 8, and neither damps nor excites an oscillation."""
PARTNERS: dict[str, Callable[[Symbol], Symbol]] = {
    "sin": lambda node: function("cos", node.arguments[0]),
    "cos": lambda node: function("sin", node.arguments[0]),
    "tanh": lambda node: Symbol("*", node, node),
    "sinh": lambda node: function("cosh", node.arguments[0]),
    "cosh": lambda node: function("sinh", node.arguments[0]),
    "atan": lambda node: slope_of_atan(node.arguments[0]),
    "asin": lambda node: slope_of_asin(node.arguments[0]),
}
"""Whose lower orders the recurrence of a function reads in place of its own."""


@dataclass(frozen=True, eq=False)
class HybridSystem:
    """A vector field with switched parameters and the functions whose roots switch them.

    Attributes:
        events: a root of one of these may end a step.
        parameters: names of the parameters, in the order of their rows.
        explicit_time: the last variable is the time, which is not perturbed.
    """

    variables: tuple[Symbol, ...]
    rates: tuple[Symbol, ...]
    events: tuple[Symbol, ...]
    parameters: tuple[str, ...]
    explicit_time: bool = False

    @property
    def size(self) -> int:
        """Number of the variables that are perturbed."""
        return len(self.variables) - self.explicit_time

    @property
    def steep(self) -> np.ndarray:
        """(states,) 1 where a rate is no polynomial."""
        return _no_polynomials(self.rates[: self.size])

    @property
    def bent(self) -> np.ndarray:
        """(events,) 1 where a surface or an output shows less in its series than the states do."""
        # polynomials up to this degree are as good as the states: order K of uⁿ is up to n^K
        # times that of u
        most_degree = 2
        return np.array(
            [degree(event) > most_degree for event in self.events], np.int64
        )

    def checked(self) -> dict[int, Symbol]:
        """Rates and events that a step's end is checked by, by their rows.

        Rates that are polynomials need no check: they hold as far as the states do.
        """
        marks = [*self.steep, *self.bent]
        roots = [*self.rates[: self.size], *self.events]
        return {i: root for i, root in enumerate(roots) if marks[i]}


def _no_polynomials(roots: Sequence[Symbol]) -> np.ndarray:
    return np.array([degree(root) == math.inf for root in roots], np.int64)


def series_source(system: HybridSystem) -> tuple[str, int]:
    """Source of ``series(base, parameters, inverses, terms)`` and the number of its series.

    Row k of series i is at ``base + (i terms + k) ROW``: the state's series first, whose order 0
    is given, then those of the events (one order short if not linear), then inner ones.
    ``inverses`` is the address of 1/k.
    """
    return _SeriesWriter(system).source()


class _SeriesWriter:
    """Writes the series of a system.

    Constants enter order 0 alone: (a + c)(b + d) has the coefficients of a b plus
    (c b + d a), so series are kept without the constants added to them, and what is a difference
    of nearly equal numbers (the distance from a fixed end) is formed once, at order 0.
    """

    def __init__(self, system: HybridSystem) -> None:
        self.system = system
        expressions = in_order([*system.rates, *system.events])
        n_expressions = len(expressions)
        self.nodes = _with_partners(expressions)
        self.number = {id(node): index for index, node in enumerate(self.nodes)}
        self.moving = [node for node in self.nodes if node.varies]
        self.place = {id(node): index for index, node in enumerate(system.variables)}
        self.events = len(self.place)
        self.count = self.events + len(system.events)
        self.joined: dict[tuple[int, ...], int] = {}
        self.sums = Sums([*system.rates, *system.events, *self.nodes[n_expressions:]])
        for node in self.moving:
            self._prepare(node)
            if id(node) in self.sums.slots:
                self._keep(node)
        self.level = self._levels()
        self.order = "o"
        """Begins the names of one order: o of order 0, v of order k, w of the highest."""

    def _prepare(self, node: Symbol) -> None:
        """Places of the series that a node's sums read."""
        if node.kind == "*" and _is_sum(node):
            for each in node.arguments:
                self._keep(moving_part(each))
        elif node.kind == "**" or node.kind in FUNCTIONS:
            self._keep(moving_part(node.arguments[0]))
            self._keep(node if node.kind not in PARTNERS else PARTNERS[node.kind](node))
        elif node.kind == "joined":
            self._keep(moving_part(node.arguments[2]))
            key = _levers(node)
            if key not in self.joined:
                self.joined[key] = self.count
                self.count += 1

    def _keep(self, node: Symbol) -> None:
        if id(node) not in self.place:
            self.place[id(node)] = self.count
            self.count += 1

    def _levels(self) -> dict[int, int]:
        level: dict[int, int] = {}
        for node in self.moving:
            below = [
                level[id(a)]
                for a in node.arguments
                if isinstance(a, Symbol) and a.varies
            ]
            level[id(node)] = max(below, default=0) + _is_sum(node)
        return level

    def source(self) -> tuple[str, int]:
        """The function and the number of its series."""
        body = [f"s{i} = base + {i} * stride" for i in range(self.count)]
        body += [
            f"{self._v(n)} = {constant(self.system, n, self._v)}"
            for n in self.nodes
            if not n.varies
        ]
        body += self._tables()
        for node in self.sums.written(self.moving):
            body += self._first(node)
        body += self._outputs("0")
        self.order = "v"
        body += ["for k in range(1, terms - 1):"]
        inner = [f"r = k * {simd.ROW}", "inverse = number(inverses + 8 * k)"]
        for level in range(max(self.level.values(), default=-1) + 1):
            here = [node for node in self.moving if self.level[id(node)] == level]
            inner += self._sums([node for node in here if _is_sum(node)])
            for node in self.sums.written(here):
                inner += self._later(node)
        inner += self._outputs("r")
        body += [f" {line}" for line in inner]
        self.order = "w"
        body += [f"r = (terms - 1) * {simd.ROW}", *self._last_events()]
        head = [
            "def series(base, parameters, inverses, terms):",
            f" stride = terms * {simd.ROW}",
        ]
        return "\n".join(head + [f" {line}" for line in body]) + "\n", self.count

    def _v(self, node: Symbol) -> str:
        """A constant, or the order that is being computed."""
        return f"{self.order if node.varies else 'c'}{self.number[id(node)]}"

    def _o(self, node: Symbol) -> str:
        """Order 0."""
        return f"o{self.number[id(node)]}"

    def _s(self, node: Symbol) -> str:
        return f"s{self.place[id(moving_part(node))]}"

    def _stored(self, node: Symbol, row: str) -> Iterator[str]:
        if id(node) in self.place and node.kind != "variable":
            yield f"store(s{self.place[id(node)]} + {row}, {self._v(node)})"
        if node.kind == "joined":
            c1, a1, _, c2, a2, _ = (self._v(each) for each in node.arguments)
            total = f"fma({c1}, {a1}, {c2} * {a2})"
            yield f"store(s{self.joined[_levers(node)]} + {row}, {total})"

    def _first(self, node: Symbol) -> Iterator[str]:
        """Order 0."""
        name = self._v(node)
        if node.kind == "variable":
            yield f"{name} = load({self._s(node)})"
        elif id(node) in self.sums.of:
            yield from self._sum(node, "")
        else:
            yield f"{name} = {pointwise(node, self._v)}"
        if node.kind in {"**", "log"}:
            yield f"i{self.number[id(node)]} = splat(1.0) / {self._v(node.arguments[0])}"
        yield from self._stored(node, "0")

    def _later(self, node: Symbol) -> Iterator[str]:
        """Order k from the sums over lower orders."""
        name = self._v(node)
        if node.kind == "variable":
            yield f"{name} = load({self._s(node)} + r)"
            return
        if id(node) in self.sums.of:
            yield from self._sum(node, " + r")
        elif not _is_sum(node):
            yield f"{name} = {_linear(node, self._v)}"
        elif node.kind == "*":
            a, b = node.arguments
            total = f"q{self.number[id(node)]}"
            if a is b:
                yield f"{name} = fma({self._o(a)} + {self._o(a)}, {self._v(a)}, {total})"
            else:
                crossed = f"fma({self._v(a)}, {self._o(b)}, {total})"
                yield f"{name} = fma({self._o(a)}, {self._v(b)}, {crossed})"
        elif node.kind == "joined":
            c1, a1, b1, c2, a2, b2 = node.arguments
            yield f"{name} = q{self.number[id(node)]}"
            for c, a, b in ((c1, a1, b1), (c2, a2, b2)):
                yield f"{name} = fma({self._v(c)} * {self._v(a)}, {self._o(b)}, {name})"
        yield from self._stored(node, "r")

    def _tables(self) -> Iterator[str]:
        """Factors of long sums, and which series they multiply.

        Compilers unroll a loop whose length they know, and compiling would take as long as before.
        """
        if self.sums.of:
            yield "zero = inverses % 8"
        for key, (_, terms) in self.sums.of.items():
            yield f"f{self.number[key]} = table({_listed(each.factor for each in terms)})"
            places = _listed(self.place[id(each.moving)] for each in terms)
            yield f"p{self.number[key]} = table({places})"

    def _sum(self, node: Symbol, row: str) -> Iterator[str]:
        """A long sum at one order."""
        name, number = self._v(node), self.number[id(node)]
        first, terms = self.sums.of[id(node)]
        begins = first.varies or not row
        yield f"{name} = {self._v(first) if begins else 'splat(0.0)'}"
        yield f"for j in range({len(terms)} + zero):"
        yield f" x = load(base + whole(p{number} + 8 * j) * stride{row})"
        factor = f"splat(number(f{number} + 8 * j))"
        added = f"fma({factor}, x, {name})" if row else f"{name} + {factor} * x"
        yield f" {name} = {added}"

    def _sums(self, nodes: list[Symbol]) -> Iterator[str]:
        """The sums over lower orders that nodes of one level need, a few in each loop."""
        squares = [
            n for n in nodes if n.kind == "*" and n.arguments[0] is n.arguments[1]
        ]
        same: dict[str, list[Symbol]] = {}
        for node in squares:
            same.setdefault(self._s(node.arguments[0]), []).append(node)
        for group in _groups(list(same)):
            names = [f"q{self.number[id(same[s][0])]}" for s in group]
            yield from self._half(group, names)
            for s, name in zip(group, names, strict=True):
                yield from (f"q{self.number[id(n)]} = {name}" for n in same[s][1:])
        for group in _groups([n for n in nodes if n.kind == "*" and n not in squares]):
            pairs = [tuple(self._s(each) for each in node.arguments) for node in group]
            yield from self._full(group, pairs, "range(1, k)", "")
        for group in _groups([n for n in nodes if n.kind == "joined"]):
            pairs = [
                (f"s{self.joined[_levers(n)]}", self._s(n.arguments[2])) for n in group
            ]
            yield from self._full(group, pairs, "range(k)", "")
        for kind in ("**", *FUNCTIONS):
            for group in _groups([n for n in nodes if n.kind == kind]):
                yield from self._recurrence(kind, group)

    def _recurrence(self, kind: str, group: list[Symbol]) -> Iterator[str]:
        """Orders k of powers or of one function f(u), from u and from f or its partner."""
        inner = [self._s(n.arguments[0]) for n in group]
        outer = [
            f"s{self.place[id(PARTNERS[kind](n) if kind in PARTNERS else n)]}"
            for n in group
        ]
        pairs = list(
            zip(outer, inner, strict=True)
            if kind == "log"
            else zip(inner, outer, strict=True)
        )
        weights = [
            f"{n.arguments[1] + 1.0!r} * j - k" if kind == "**" else "1.0 * j"
            for n in group
        ]
        orders = "range(1, k)" if kind in {"log", "tanh"} else "range(1, k + 1)"
        yield from self._full(group, pairs, orders, weights)
        for node in group:
            number, value = self.number[id(node)], self._v(node.arguments[0])
            total = f"q{number} * splat(inverse)"
            yield f"{self._v(node)} = " + {
                "**": f"{total} * i{number}",
                "cos": f"splat(0.0) - {total}",
                "log": f"({value} - {total}) * i{number}",
                "tanh": f"{value} * (splat(1.0) - {self._o(node)} * {self._o(node)}) - {total}",
            }.get(kind, total)

    def _half(self, series: list[str], names: list[str]) -> Iterator[str]:
        """Σ a_j a_{k−j} for 0 < j < k, each pair once."""
        yield from (f"{name} = splat(0.0)" for name in names)
        yield "for j in range(1, (k + 1) // 2):"
        yield f" a = j * {simd.ROW}; b = r - a"
        for s, name in zip(series, names, strict=True):
            yield f" {name} = fma(load({s} + a), load({s} + b), {name})"
        yield from (f"{name} = {name} + {name}" for name in names)
        yield "if k % 2 == 0:"
        yield f" a = (k // 2) * {simd.ROW}"
        for s, name in zip(series, names, strict=True):
            yield f" w = load({s} + a)"
            yield f" {name} = fma(w, w, {name})"

    def _full(
        self, nodes: list[Symbol], pairs: list[Any], orders: str, weights: Any
    ) -> Iterator[str]:
        names = [f"q{self.number[id(node)]}" for node in nodes]
        yield from (f"{name} = splat(0.0)" for name in names)
        yield f"for j in {orders}:"
        yield f" a = j * {simd.ROW}; b = r - a"
        for index, (name, (s, t)) in enumerate(zip(names, pairs, strict=True)):
            weight = f" * splat({weights[index]})" if weights else ""
            yield f" {name} = fma(load({s} + a){weight}, load({t} + b), {name})"

    def _outputs(self, row: str) -> Iterator[str]:
        order = "1" if row == "0" else "k + 1"
        for index, rate in enumerate(self.system.rates):
            value = f"{self._part(rate, row)} * splat(number(inverses + 8 * ({order})))"
            yield f"store(s{index} + {row} + {simd.ROW}, {value})"
        for index, event in enumerate(self.system.events):
            yield f"store(s{self.events + index} + {row}, {self._part(event, row)})"

    def _part(self, node: Symbol, row: str) -> str:
        return self._v(node) if node.varies or row == "0" else "splat(0.0)"

    def _last_events(self) -> Iterator[str]:
        """The highest order of the events that are linear in the state."""
        linear: list[Symbol] = []
        for index, event in enumerate(self.system.events):
            moving = [node for node in in_order([event]) if node.varies]
            if moving and not any(_is_sum(node) for node in moving):
                linear.append(event)
            else:
                yield f"store(s{self.events + index} + r, splat(0.0))"
        moving = [node for node in in_order(linear) if node.varies]
        for node in self.sums.written(moving):
            yield from self._later(node)
        for index, event in enumerate(self.system.events):
            if event in linear:
                yield f"store(s{self.events + index} + r, {self._v(event)})"

    def shorten(self) -> str:
        """Source of ``shorten(base, parameters, row, terms)``: see :func:`shorten_source`."""
        # coefficients of these functions vanish to nothing beyond these arguments
        hidden_beyond = {"exp": 20.0, "tanh": 10.0}
        inner = {
            id(n.arguments[0]): (n.arguments[0], hidden_beyond[n.kind])
            for n in self.moving
            if n.kind in hidden_beyond
        }
        bases = bases_of(self.moving, [*self.system.rates, *self.system.events])
        if not (inner or bases):
            return ""
        fixed = [n for base in bases for n in in_order([base.node]) if not n.varies]
        fixed += [mark for base in bases for mark in base.marks]
        nodes = in_order([*(node for node, _ in inner.values()), *fixed])
        lines = [f"stride = terms * {simd.ROW}", "h = load(row)", "across = splat(0.0)"]
        for node in nodes:
            if node.kind == "variable":
                code = f"load(base + {self.place[id(node)]} * stride)"
            elif node.varies:
                code = pointwise(node, self._v)
            else:
                code = constant(self.system, node, self._v)
            lines.append(f"{self._v(node)} = {code}")
        # tries to make such a step long
        searches = 6
        # of the step that is left
        least_share = 1e-12
        # such an argument may go in a step over this share of what lies beyond, and at least so
        # far:
        share_of_argument = 0.3
        least_argument = 2.0
        for node, idle in inner.values():
            series = self.place[id(moving_part(node))]
            lines += [
                f"s = base + {series} * stride",
                f"m = (abs({self._v(node)}) - splat({idle!r})) * splat({share_of_argument!r})",
                f"m = larger(m, splat({least_argument!r}))",
                "x = h",
                f"low = h * splat({least_share!r})",
                f"for i in range({searches}):",
                f" u = abs(load(s + (terms - 1) * {simd.ROW}))",
                " for k in range(terms - 2, 0, -1):",
                f"  w = abs(load(s + k * {simd.ROW}))",
                "  u = fma(u, x, w)",
                " low = larger(low, smaller(m / u, x))",  # NaN in other regimes
                " x = root(low * h)",
                "h = smaller(low, h)",
            ]
        for base in bases:
            lines += self._before_root(base)
        lines += ["store(row, h)", f"store(row + {2 * simd.ROW}, across)"]
        head = "def shorten(base, parameters, row, terms):"
        return "\n".join([head, *(f" {line}" for line in lines)]) + "\n"

    def _before_root(self, base: Base) -> Iterator[str]:
        """Lines that keep steps before the roots of a base: see :mod:`bases`."""
        orders = "for k in range(terms - 2, 0, -1):"
        node, needed = base.node, " + ".join(map(self._v, base.marks))
        yield f"s = base + {self.place[id(moving_part(node))]} * stride"
        yield f"b = {self._at_start(node)}"
        yield f"m = abs(b) * splat({RootSettings.room!r})"
        yield "u = splat(0.0)"
        yield orders
        yield f" u = fma(u, h, abs(load(s + k * {simd.ROW})))"
        if needed:
            yield f"u = only({needed}, u)"
        yield "near = u * h - m"  # not a number in other regimes, maybe
        yield "bits = bits_below(splat(0.0), near)"
        yield "if bits != 0:"
        yield f" m = larger(m, {self._terms(node)} * splat({RootSettings.noise!r}))"
        yield " down = splat(0.0) - copysign(splat(1.0), b)"
        yield " x = h"
        yield f" least = load(row + {simd.ROW}) * splat({base.nearest!r})"
        yield " low = least"
        yield f" for i in range({RootSettings.tries}):"
        yield "  u = splat(0.0)"
        yield f"  {orders}"
        yield f"   u = fma(u, x, larger(load(s + k * {simd.ROW}) * down, splat(0.0)))"
        yield "  low = larger(low, smaller(m / u, x))"
        yield "  x = root(low * h)"
        yield " h = smaller(low, h)"
        if base.jumps:
            yield " at = only(near, only(least + least - h, splat(1.0)))"
            yield " across = larger(across, at)"

    def _at_start(self, node: Symbol) -> str:
        """Code of order 0 of a node whose moving part has a series."""
        moving = moving_part(node)
        if not node.varies:
            return self._v(node)
        if node is moving:
            return f"load(base + {self.place[id(moving)]} * stride)"
        return f"({' + '.join(map(self._at_start, node.arguments))})"

    def _terms(self, node: Symbol) -> str:
        """Code of the size of a base's terms: its round-off, from series that are kept anyway."""
        a, *others = node.arguments
        if node.kind == "*" and node.varies:
            if not a.varies:
                return f"abs({self._v(a)}) * {self._terms(others[0])}"
            b = others[0]
            first, second = (f"abs({self._at_start(n)})" for n in (a, b))
            return f"({first} * {self._terms(b)} + {second} * {self._terms(a)})"
        if node is not moving_part(node):
            return f"({self._terms(a)} + {self._terms(others[0])})"
        return f"abs({self._at_start(node)})"


def _listed(values: Iterable[float]) -> str:
    return ", ".join(map(repr, values))


def shorten_source(system: HybridSystem) -> str:
    """Source of ``shorten(base, parameters, row, terms)``; empty where nothing can hide.

    Far from where it acts, exp or tanh has coefficients that round to nothing, so that neither
    the states' last orders nor a step's end show a layer that the step leads into, or through.
    With U = Σ |u_k| hᵏ how far its argument u may go, the neglected orders of exp(u) are at most
    exp(u_0 + U) Uᴷ / K!. A step may lead through a share m of the way to where that counts. U(h)/h
    grows with h, so that from any h a step of h m / U(h) is short enough; tried from a few h, it is
    not much shorter than need be.
    """
    return _SeriesWriter(system).shorten()


def verify_source(system: HybridSystem) -> str:
    """Source of ``verify(ends, parameters, out)``: what is checked, at the ends of steps.

    ``ends`` and ``out`` are addresses of a row per variable, and of one per state and event.
    """
    roots = system.checked()
    nodes = in_order(list(roots.values()))
    number = {id(node): index for index, node in enumerate(nodes)}

    def at(node: Symbol) -> str:
        return f"v{number[id(node)]}"

    lines = []
    for node in nodes:
        if node.kind == "variable":
            place = system.variables.index(node) * simd.ROW
            value = f"load(ends + {place})"
        else:
            value = pointwise(node, at) if node.varies else constant(system, node, at)
        lines.append(f"{at(node)} = {value}")
    lines += [f"store(out + {i * simd.ROW}, {at(root)})" for i, root in roots.items()]
    head = "def verify(ends, parameters, out):"
    return "\n".join([head, *(f" {line}" for line in lines), " return\n"])


def _levers(node: Symbol) -> tuple[int, ...]:
    """Identity of the series c₁ A₁ + c₂ A₂ of a joined node: its arguments, by ``id``."""
    return tuple(id(node.arguments[i]) for i in (0, 1, 3, 4))


def constant(system: HybridSystem, node: Symbol, name: Name) -> str:
    """Code of a node that is constant in time."""
    if node.kind == "number":
        return f"splat({node.arguments[0]!r})"
    if node.kind == "parameter":
        return f"load(parameters + {system.parameters.index(node.arguments[0]) * simd.ROW})"
    return pointwise(node, name)


def _slopes(system: HybridSystem) -> dict[tuple[int, int], Symbol]:
    """The derivatives of the rates that are not zero, by row and column."""
    return {
        (i, j): entry
        for i, rate in enumerate(system.rates[: system.size])
        for j, variable in enumerate(system.variables[: system.size])
        if (entry := derivative(rate, variable)).kind != "number" or entry.arguments[0]
    }


def longest_source(system: HybridSystem) -> str:
    """Source of ``longest(base, parameters, row, terms)``: the perturbation's longest steps.

    The largest rate of the slopes J where a step starts is at most the fourth root of |J|⁴.
    """
    slopes, size = _slopes(system), system.size
    nodes = in_order(list(slopes.values()))
    number = {id(node): index for index, node in enumerate(nodes)}

    def at(node: Symbol) -> str:
        return f"v{number[id(node)]}"

    lines = [f"stride = terms * {simd.ROW}"]
    for node in nodes:
        if node.kind == "variable":
            value = f"load(base + {system.variables.index(node)} * stride)"
        else:
            value = pointwise(node, at) if node.varies else constant(system, node, at)
        lines.append(f"{at(node)} = {value}")
    sums = ["splat(1.0)"] * size
    for power in range(4):
        for i in range(size):
            terms = [
                f"abs({at(n)}) * {sums[j]}"
                for (row, j), n in slopes.items()
                if row == i
            ]
            lines.append(f"r{i}_{power} = {' + '.join(terms) or 'splat(0.0)'}")
        sums = [f"r{i}_{power}" for i in range(size)]
    bound = functools.reduce(lambda a, b: f"larger({a}, {b})", sums)
    # longest step of the perturbation times a bound of its rate: the sweeps leave 1e-7 of it, and
    # few steps of a moving state are longer
    longest = 0.8
    lines.append(f"store(row, splat({longest!r}) / root(root({bound})))")
    head = "def longest(base, parameters, row, terms):"
    return "\n".join([head, *(f" {line}" for line in lines)]) + "\n"


def perturbation_source(system: HybridSystem) -> str:
    """Source of ``perturb(base, parameters, step, tangent, terms)``: one step of a perturbation.

    ``step`` and ``tangent`` are addresses: a row of step lengths, and a row per state variable.
    """
    slopes, size = _slopes(system), system.size
    nodes = in_order(list(slopes.values()))
    number = {id(node): index for index, node in enumerate(nodes)}

    def at(stage: int) -> Name:
        return lambda n: (
            f"v{number[id(n)]}_{stage}" if n.varies else f"c{number[id(n)]}"
        )

    lines = [f"stride = terms * {simd.ROW}", "h = load(step)"]
    lines += [f"z{i} = load(tangent + {i * simd.ROW})" for i in range(size)]
    lines += [
        f"{at(0)(n)} = {constant(system, n, at(0))}" for n in nodes if not n.varies
    ]
    used = [(n, system.variables.index(n)) for n in nodes if n.kind == "variable"]
    for stage, position in enumerate(GAUSS):
        lines.append(f"t = h * splat({position!r})")
        last = f"stride + (terms - 1) * {simd.ROW}"
        lines += [f"{at(stage)(n)} = load(base + {i} * {last})" for n, i in used]
        if used:
            lines.append("for k in range(terms - 2, -1, -1):")
            for node, i in used:
                name, place = at(stage)(node), f"base + {i} * stride + k * {simd.ROW}"
                lines.append(f" {name} = fma({name}, t, load({place}))")
        inner = [n for n in nodes if n.varies and n.kind != "variable"]
        lines += [f"{at(stage)(n)} = {pointwise(n, at(stage))}" for n in inner]
    lines += _collocation(slopes, size, at)
    head = "def perturb(base, parameters, step, tangent, terms):"
    return "\n".join([head, *(f" {line}" for line in lines)]) + "\n"


def _collocation(
    slopes: dict[tuple[int, int], Symbol], size: int, at: Callable[[int], Name]
) -> Iterator[str]:
    """Stage rates k = A (z + h Σ a k) by Gauss–Seidel sweeps, then the step."""
    stages = range(len(GAUSS))

    def rate(i: int, stage: int) -> str:
        terms = [
            f"w{j}_{stage}"
            if entry is symbol(1.0)
            else f"{at(stage)(entry)} * w{j}_{stage}"
            for (row, j), entry in slopes.items()
            if row == i
        ]
        return " + ".join(terms) or "splat(0.0)"

    yield from (f"w{i}_{stage} = z{i}" for i in range(size) for stage in stages)
    # Gauss–Seidel sweeps over the stages of the perturbation; each gains a digit or two
    sweeps = 5
    for sweep in range(sweeps + 1):
        for i in range(size):
            yield from (f"k{i}_{stage} = {rate(i, stage)}" for stage in stages)
            if sweep < sweeps:
                for stage in stages:
                    row = zip(stages, GAUSS_MATRIX[stage], strict=True)
                    total = " + ".join(
                        f"k{i}_{s} * splat({weight!r})" for s, weight in row
                    )
                    yield f"w{i}_{stage} = fma(h, {total}, z{i})"
    for i in range(size):
        row = zip(stages, GAUSS_WEIGHTS, strict=True)
        total = " + ".join(f"k{i}_{s} * splat({weight!r})" for s, weight in row)
        yield f"store(tangent + {i * simd.ROW}, fma(h, {total}, z{i}))"


def pointwise(node: Symbol, name: Name) -> str:
    """Code of a node's value from those of its arguments."""
    if node.kind in {"+", "*"}:
        a, b = node.arguments
        return f"{name(a)} {node.kind} {name(b)}"
    if node.kind == "joined":
        c1, a1, b1, c2, a2, b2 = (name(each) for each in node.arguments)
        return f"{c1} * ({a1} * {b1}) + {c2} * ({a2} * {b2})"
    if node.kind == "only":
        return f"only({', '.join(map(name, node.arguments))})"
    if node.kind in FUNCTIONS:
        tanh = "(splat(1.0) - splat(2.0) / (exp({0} + {0}) + splat(1.0)))"
        code = tanh if node.kind == "tanh" else f"{node.kind}({{0}})"
        return code.format(name(node.arguments[0]))
    base, exponent = node.arguments
    value = name(base) if exponent > 0.0 else f"(splat(1.0) / {name(base)})"
    whole, half = divmod(abs(exponent), 1.0)
    return " * ".join([value] * int(whole) + [f"root({value})"] * bool(half))


def _linear(node: Symbol, name: Name) -> str:
    """Code of an order above 0 of what is linear in series."""
    a, b = node.arguments
    if node.kind == "*":
        return f"{name(a)} * {name(b)}"
    if node.kind == "only":
        return f"only({name(a)}, {name(b)})"
    if not a.varies:
        return name(b)
    if not b.varies:
        return name(a)
    for first, second in ((a, b), (b, a)):
        if first.kind == "*" and not first.arguments[0].varies:
            factor, series = first.arguments
            return f"fma({name(factor)}, {name(series)}, {name(second)})"
    return f"{name(a)} + {name(b)}"


def _is_sum(node: Symbol) -> bool:
    """Tell whether each order of a node is a sum over all lower ones."""
    if node.kind in {"**", "joined"} or node.kind in FUNCTIONS:
        return node.varies
    return node.kind == "*" and all(each.varies for each in node.arguments)


def _with_partners(nodes: list[Symbol]) -> list[Symbol]:
    found = list(nodes)
    for node in nodes:
        if node.varies and node.kind in PARTNERS:
            for each in in_order([PARTNERS[node.kind](node)]):
                if not any(other is each for other in found):
                    found.append(each)
    return found


def _groups(values: list[Any]) -> Iterator[list[Any]]:
    # the sums of so many convolutions in one loop fill the registers of AVX2
    together = 2
    return (
        values[first : first + together] for first in range(0, len(values), together)
    )
