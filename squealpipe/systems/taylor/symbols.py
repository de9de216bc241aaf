"""Expressions of a vector field, recorded from the laws as they are computed.

A law written with +, −, × and ``**`` runs on these symbols as on floats and leaves its operations
behind. Equal operations are one node, numbers are folded, and an operation on parameters alone
stays apart from one on the state, because the former is constant in time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, ClassVar, Self


class Symbol:
    """One operation: ``kind`` applied to ``arguments``.

    Attributes:
        kind: "variable", "parameter", "number", "+", "*", "**", a function of
            :data:`FUNCTIONS`, "joined": Σ c A B over triples whose B differ by constants, or
            "only": a value where a mark is 1, and 0 where it is 0, whatever the value is there.
        arguments: symbols; of a variable or parameter its name, of a number its value, of "**"
            the base and a float.
        varies: whether it depends on a variable.
    """

    _all: ClassVar[dict[tuple[Any, ...], Any]] = {}
    kind: str
    arguments: tuple[Any, ...]
    varies: bool

    def __new__(cls, kind: str, *arguments: Any) -> Self:
        """The one node of this operation."""
        key = (kind, *(id(a) if isinstance(a, Symbol) else a for a in arguments))
        if key not in cls._all:
            node = super().__new__(cls)
            node.kind, node.arguments = kind, arguments
            inner = (a.varies for a in arguments if isinstance(a, Symbol))
            node.varies = kind == "variable" or any(inner)
            cls._all[key] = node
        found: Self = cls._all[key]
        return found

    def __add__(self, other: Any) -> Symbol:
        """Sum."""
        return _add(self, symbol(other))

    __radd__ = __add__

    def __neg__(self) -> Symbol:
        """Negative."""
        return _multiply(symbol(-1.0), self)

    def __sub__(self, other: Any) -> Symbol:
        """Difference."""
        return _add(self, -symbol(other))

    def __rsub__(self, other: Any) -> Symbol:
        """Difference."""
        return _add(symbol(other), -self)

    def __mul__(self, other: Any) -> Symbol:
        """Product."""
        return _multiply(self, symbol(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Symbol:
        """Quotient."""
        return self * symbol(other) ** -1.0

    def __rtruediv__(self, other: Any) -> Symbol:
        """Quotient."""
        return symbol(other) * self**-1.0

    def __pow__(self, exponent: Any) -> Symbol:
        """Power: of a number that is a multiple of ½, or exp(b log a) of a positive base."""
        if isinstance(exponent, Symbol) and exponent.kind == "number":
            exponent = exponent.arguments[0]
        if isinstance(exponent, Symbol) or 2.0 * exponent != int(2.0 * exponent):
            return function("exp", symbol(exponent) * function("log", self))
        if exponent == 0.0:
            return symbol(1.0)
        if exponent == 1.0:
            return self
        if exponent > 1.0 and exponent == int(
            exponent
        ):  # a power's own recurrence divides by base
            half = self ** (exponent // 2.0)
            return _multiply(half * half, self ** (exponent % 2.0))
        if self.kind == "number":
            return symbol(self.arguments[0] ** float(exponent))
        return Symbol("**", self, float(exponent))

    def __rpow__(self, base: Any) -> Symbol:
        """Power of a positive number."""
        return symbol(base) ** self

    def _refuse(self, *_: Any) -> Any:
        raise TypeError(
            "a field, surface or condition is one smooth expression: comparisons, abs, min, max, "
            "sign and branches have no Taylor series; make each side a regime, with a switch"
        )

    __abs__ = __bool__ = __float__ = __int__ = __lt__ = __le__ = __gt__ = __ge__ = (
        _refuse
    )
    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        """Tell whether it is the same node; compared with a number it is refused."""
        return self is other if isinstance(other, Symbol) else self._refuse()

    def __call__(self, *_: Any) -> Any:
        """A value at another time is refused."""
        raise TypeError(
            "a function sees the present state alone: it cannot have delays"
        )

    __round__ = __floor__ = __ceil__ = __mod__ = __floordiv__ = _refuse


def symbol(value: Any) -> Symbol:
    """A number as a symbol."""
    return value if isinstance(value, Symbol) else Symbol("number", float(value))


def variables(*names: str) -> tuple[Symbol, ...]:
    """State variables."""
    return tuple(Symbol("variable", name) for name in names)


def parameter(name: str) -> Symbol:
    """A parameter, constant in time."""
    return Symbol("parameter", name)


FUNCTIONS = {
    name: getattr(math, name)
    for name in ("exp", "log", "sin", "cos", "tanh", "sinh", "cosh", "atan", "asin")
}
"""Functions of one argument that have a recurrence, as floats compute them."""


def function(name: str, value: Any) -> Symbol:
    """One of :data:`FUNCTIONS`."""
    value = symbol(value)
    if value.kind == "number":
        return symbol(FUNCTIONS[name](value.arguments[0]))
    return Symbol(name, value)


def only(mark: Symbol, value: Any) -> Symbol:
    """A value in the regime that a parameter marks with 1; 0 in others, where it may be NaN."""
    value = symbol(value)
    return value if _is(value, 0.0) else Symbol("only", mark, value)


def _is(value: Symbol, number: float) -> bool:
    return value.kind == "number" and value.arguments[0] == number


def _add(a: Symbol, b: Symbol) -> Symbol:
    if a.kind == b.kind == "number":
        return symbol(a.arguments[0] + b.arguments[0])
    if _is(a, 0.0):
        return b
    if _is(b, 0.0):
        return a
    first, second = _lever(a), _lever(b)
    if first and second and moving_part(first[2]) is moving_part(second[2]):
        return Symbol("joined", *first, *second)
    return Symbol("+", a, b)


def moving_part(value: Symbol) -> Symbol:
    """A sum without the constant that is added to it."""
    if value.kind == "+" and value.varies:
        a, b = value.arguments
        if not a.varies:
            return moving_part(b)
        if not b.varies:
            return moving_part(a)
    return value


def _lever(value: Symbol) -> tuple[Symbol, Symbol, Symbol] | None:
    """c, A and B of a product c A B whose B is a state variable plus a constant."""
    factor, product = symbol(1.0), value
    if value.kind == "*" and not value.arguments[0].varies:
        factor, product = value.arguments
    if product.kind != "*" or not all(each.varies for each in product.arguments):
        return None
    for a, b in (product.arguments, product.arguments[::-1]):
        if moving_part(b).kind == "variable" and moving_part(a).kind != "variable":
            return factor, a, b
    return None


def _multiply(a: Symbol, b: Symbol) -> Symbol:
    if a.kind == b.kind == "number":
        return symbol(a.arguments[0] * b.arguments[0])
    for first, second in ((a, b), (b, a)):
        if _is(first, 1.0):
            return second
        if _is(first, 0.0):
            return first
    # What is constant in time gathers in front, so that it meets each series once.
    if a.varies and not b.varies:
        a, b = b, a
    if not a.varies and b.kind == "*" and not b.arguments[0].varies and b.varies:
        return _multiply(_multiply(a, b.arguments[0]), b.arguments[1])
    if a.varies and a.kind == "*" and not a.arguments[0].varies:
        return _multiply(a.arguments[0], _multiply(a.arguments[1], b))
    if a.varies and b.kind == "*" and not b.arguments[0].varies:
        return _multiply(b.arguments[0], _multiply(a, b.arguments[1]))
    return Symbol("*", a, b)


@cache
def derivative(value: Symbol, by: Symbol) -> Any:
    """The partial derivative by a variable or a parameter."""
    if value is by:
        return symbol(1.0)
    fixed = by.kind == "variable" and not value.varies
    if fixed or value.kind in {"variable", "parameter", "number"}:
        return symbol(0.0)
    if value.kind == "+":
        return derivative(value.arguments[0], by) + derivative(value.arguments[1], by)
    if value.kind == "*":
        a, b = value.arguments
        return derivative(a, by) * b + a * derivative(b, by)
    if value.kind in FUNCTIONS:
        (inner,) = value.arguments
        return _slope(value, inner) * derivative(inner, by)
    if value.kind == "joined":
        c1, a1, b1, c2, a2, b2 = value.arguments
        return _of_lever(c1, a1, b1, by) + _of_lever(c2, a2, b2, by)
    if value.kind == "only":
        mark, inner = value.arguments
        return only(mark, derivative(inner, by))
    base, exponent = value.arguments
    return exponent * base ** (exponent - 1.0) * derivative(base, by)


def _of_lever(factor: Symbol, a: Symbol, b: Symbol, by: Symbol) -> Any:
    """The derivative of c A B, whose c may hold the parameter."""
    moved = derivative(a, by) * b + a * derivative(b, by)
    return derivative(factor, by) * a * b + factor * moved


def _slope(value: Symbol, inner: Symbol) -> Symbol:
    """The derivative of a function by its argument."""
    if value.kind == "exp":
        return value
    if value.kind == "log":
        return inner**-1.0
    if value.kind == "sin":
        return function("cos", inner)
    if value.kind == "cos":
        return -function("sin", inner)
    if value.kind in {"sinh", "cosh"}:
        return function("cosh" if value.kind == "sinh" else "sinh", inner)
    if value.kind == "atan":
        return slope_of_atan(inner)
    if value.kind == "asin":
        return slope_of_asin(inner)
    return 1.0 - value * value


def slope_of_atan(inner: Symbol) -> Symbol:
    """1/(1 + u²)."""
    return (1.0 + inner * inner) ** -1.0


def slope_of_asin(inner: Symbol) -> Symbol:
    """1/√(1 − u²), whose factors are exact next to u = ±1."""
    return ((1.0 - inner) * (1.0 + inner)) ** -0.5


@cache
def degree(value: Symbol) -> float:
    """Degree of a polynomial in the variables; infinite of anything else."""
    inner = [degree(a) if isinstance(a, Symbol) else 0.0 for a in value.arguments]
    if value.kind == "variable" or not value.varies:
        return float(value.kind == "variable")
    if value.kind in {"+", "only"}:
        return max(inner)
    if value.kind == "*":
        return sum(inner)
    if value.kind == "joined":
        return max(sum(inner[:3]), sum(inner[3:]))
    return math.inf


def in_order(roots: Sequence[Symbol]) -> list[Symbol]:
    """All nodes below the roots, arguments before what uses them."""
    found: dict[int, Symbol] = {}

    def visit(node: Symbol) -> None:
        if id(node) not in found:
            for argument in node.arguments:
                if isinstance(argument, Symbol):
                    visit(argument)
            found[id(node)] = node

    for each in roots:
        visit(each)
    return list(found.values())


def substituted(roots: Sequence[Symbol], given: dict[int, Symbol]) -> dict[int, Symbol]:
    """Replacement of each node below the roots, by ``id``, where some nodes are given."""
    made = dict(given)
    for node in in_order(roots):
        if id(node) not in made:
            inner = [
                made[id(a)] if isinstance(a, Symbol) else a for a in node.arguments
            ]
            made[id(node)] = Symbol(node.kind, *inner)
    return made


def constant_parts(roots: Sequence[Symbol], skipped: str | None) -> list[Symbol]:
    """The largest parts that hold parameters alone, none whose name begins with ``skipped``."""
    fixed: dict[int, bool] = {}
    found: dict[int, Symbol] = {}
    nodes = in_order(roots)
    for node in nodes:
        inner = [fixed[id(a)] for a in node.arguments if isinstance(a, Symbol)]
        own = node.kind != "variable" and not (
            skipped is not None
            and node.kind == "parameter"
            and node.arguments[0].startswith(skipped)
        )
        fixed[id(node)] = own and all(inner)
    uses = [
        a
        for n in nodes
        if not fixed[id(n)]
        for a in n.arguments
        if isinstance(a, Symbol)
    ]
    for node in (*uses, *roots):
        if fixed[id(node)] and node.kind not in {"parameter", "number"}:
            found[id(node)] = node
    return list(found.values())
