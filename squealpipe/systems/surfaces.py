"""Surfaces in their simplest form: x in place of x⁷ or tanh(3 x), which cross zero with it."""

import math
from collections import Counter
from collections.abc import Iterator

from squealpipe.systems.taylor.symbols import Symbol, symbol


def simplest(surface: Symbol) -> Symbol:
    """A surface that falls through zero where this one does, and whose root is a simple one.

    Of a multiple root round-off hides the place: that of x⁷ is known to 0.005 only, and no slope
    says when it comes. What cannot change the sign goes: numbers, even powers of factors, and
    functions such as tanh around all.
    """
    # these grow, and vanish where their argument does
    if surface.kind in frozenset({"tanh", "sinh", "atan", "asin"}):
        return simplest(surface.arguments[0])
    if surface.kind != "*":
        return surface
    factors = list(_factors(surface))
    times = Counter(map(id, factors))
    sign, product = 1.0, symbol(1.0)
    for factor in {id(factor): factor for factor in factors}.values():
        if factor.kind == "number":
            sign *= math.copysign(1.0, factor.arguments[0]) ** times[id(factor)]
        elif not factor.varies:
            product = product * factor ** float(times[id(factor)])
        elif times[id(factor)] % 2:
            product = product * simplest(factor)
    return sign * product if product.varies else surface


def _factors(product: Symbol) -> Iterator[Symbol]:
    """Return the factors of a product, each as often as it occurs."""
    if product.kind == "*":
        for factor in product.arguments:
            yield from _factors(factor)
    else:
        yield product
