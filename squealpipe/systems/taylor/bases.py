"""Bases of powers and logarithms: where one vanishes, an expression may jump or have a pole.

All functions that systems may be written with are analytic on the real axis, but for powers that
are negative or not whole and for the logarithm, where their base is zero (``asin`` has such a power
in its slope). So atan(sin/cos), sin/√sin² and x/√x² jump where cos, sin² and x² vanish, and neither
the states' series nor the ends of a step need show it: the series of such an expression is that
of one of its branches, which converges anywhere, and two jumps in a step may cancel.

The series of each base is known, so a step stays before its roots: it may lead at most ``room`` of
the way that b₀ + Σ min(0, ± b_k hᵏ) leaves to zero. Steps then shrink geometrically towards a root,
down to a least step, which leads across; there rates on both sides are compared (``checking``).
Where no base is near a root, a bound of |b_k| hᵏ is all that it costs.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from squealpipe.systems.taylor.symbols import Symbol


@dataclass(frozen=True)
class RootSettings:
    """Thresholds of steps next to the root of a base.

    Attributes:
        room: share of the way to zero that a step may lead; half of it costs twice as many steps.
        nearest: shortest step before a jump or a pole, over the longest recent one. Two jumps
            closer together go unseen; below 1e-14 a series of 20 orders overflows.
        nearest_kink: shortest step before a kink, whose error is its square.
        noise: value of a base, over its terms, that a step across must leave behind; a smaller one
            may be exactly zero, and its power not a number.
        tries: how often such a step is lengthened.
    """

    room: float = 0.9
    nearest: float = 1e-10
    nearest_kink: float = 1e-7
    noise: float = 1e-12
    tries: int = 6


@dataclass(frozen=True, eq=False)
class Base:
    """A base that may vanish.

    Attributes:
        node: its symbol.
        jumps: whether what is computed from it may jump, or have a pole, at its root.
        marks: parameters of which one is 1 in regimes that need it; empty if all do.
    """

    node: Symbol
    jumps: bool
    marks: tuple[Symbol, ...]

    @property
    def nearest(self) -> float:
        """Shortest step before its root, over the longest recent one."""
        return RootSettings.nearest if self.jumps else RootSettings.nearest_kink


def bases_of(moving: Iterable[Symbol], roots: Sequence[Symbol]) -> list[Base]:
    """Return the bases among some nodes that may vanish.

    Args:
        moving: nodes that vary, those that series alone read among them.
        roots: rates and events, which say in which regimes a node counts.
    """
    found: dict[int, Base] = {}
    marks = _marks(roots)
    for node in moving:
        if node.kind not in {"**", "log"}:
            continue
        base = node.arguments[0]
        if is_positive(base):
            continue
        jumps = node.kind == "log" or node.arguments[1] < 0.0
        if id(base) in found:
            jumps |= found[id(base)].jumps
        found[id(base)] = Base(base, jumps, marks.get(id(base), ()))
    return list(found.values())


def _marks(roots: Sequence[Symbol]) -> dict[int, tuple[Symbol, ...]]:
    """The marks of the regimes that need a node, by its ``id``; none of one that all need."""
    found: dict[int, set[Symbol | None]] = {}
    waiting: list[tuple[Symbol, Symbol | None]] = [(root, None) for root in roots]
    while waiting:
        node, mark = waiting.pop()
        if mark in found.setdefault(id(node), set()):
            continue
        found[id(node)].add(mark)
        inner = [each for each in node.arguments if isinstance(each, Symbol)]
        if node.kind == "only":
            waiting.append((inner[1], inner[0] if mark is None else mark))
        else:
            waiting += [(each, mark) for each in inner]
    return {
        key: () if None in each else tuple(m for m in each if m is not None)
        for key, each in found.items()
    }


def is_positive(node: Symbol) -> bool:
    """Tell whether a symbol is above zero for all values of its variables, as 1 + u² is."""
    if node.kind in {"exp", "cosh"}:
        return True
    if node.kind == "number":
        return bool(node.arguments[0] > 0.0)
    if node.kind == "+":
        a, b = node.arguments
        return (is_positive(a) and _is_no_less(b)) or (
            is_positive(b) and _is_no_less(a)
        )
    if node.kind == "*":
        return all(map(is_positive, node.arguments))
    return node.kind == "**" and is_positive(node.arguments[0])


def _is_no_less(node: Symbol) -> bool:
    """Tell whether a symbol is nowhere below zero for all values of its variables."""
    if is_positive(node):
        return True
    if node.kind in {"number", "+", "*"}:
        a, *others = node.arguments
        square = node.kind == "*" and a is others[0]
        return square or (
            bool(a >= 0.0)
            if node.kind == "number"
            else all(map(_is_no_less, (a, *others)))
        )
    return node.kind == "**" and node.arguments[1] % 1.0 == 0.5
