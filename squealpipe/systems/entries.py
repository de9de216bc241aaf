"""Whether the field of a regime has a Taylor series where a switch enters it."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from squealpipe.methods.taylor.scalar import REGIME, evaluate, numpy_function
from squealpipe.methods.taylor.symbols import Symbol, symbol
from squealpipe.systems.text import expression
from squealpipe.systems.trace import Traced, Tracer

SAMPLES, HALVINGS = 64, 55
"""States that are tried, and halvings of the way to a surface."""
VANISHES, ALIKE = 1e-14, 1e-6
"""A base this small vanishes, unless it has the same value within this share at every entry."""


def check_entries(
    tracer: Tracer,
    traced: Traced,
    names: Sequence[str],
    leaves: Sequence[Sequence[int]],
) -> None:
    """Refuse a power that is not whole and whose base vanishes where its regime is entered.

    So does the depth d of a Hertz contact d^1.5, whatever the state in which contact begins.
    """
    powers: dict[int, list[Symbol]] = {}
    bases: dict[int, Any] = {}
    for name, switch, left in zip(names, traced.switches, leaves, strict=True):
        states = None
        for regime in sorted({target for target, _, _ in switch.targets}):
            if regime not in powers:
                powers[regime] = list(_powers(tracer, traced, regime))
                roots = [symbol(power.arguments[0]) for power in powers[regime]]
                bases[regime] = numpy_function(roots)
            if not powers[regime]:
                continue
            states = states or _after(tracer, traced, switch, left[0])
            function, arguments = bases[regime]
            values = states | _held(traced, regime)
            with np.errstate(all="ignore"):
                found = function(*(values[argument] for argument in arguments))
            for power, base in zip(powers[regime], found, strict=True):
                if _vanishes(np.asarray(base)):
                    _refuse(name, tracer.regimes[regime], power)


def _vanishes(base: np.ndarray) -> bool:
    """Whether a base is zero but for round-off at every entry, and not a small number there."""
    if not base.size or not (np.abs(base) < VANISHES).all():
        return False
    return bool(np.ptp(base) >= ALIKE * np.abs(base).max())


def _powers(tracer: Tracer, traced: Traced, regime: int) -> Iterator[Symbol]:
    """Powers in the field of a regime that have no series where their base is zero."""
    marks = {f"{REGIME}is {other}" for other in tracer.regimes}
    marks -= {f"{REGIME}is {tracer.regimes[regime]}"}
    seen: set[int] = set()
    waiting = list(traced.rates)
    while waiting:
        node = waiting.pop()
        elsewhere = node.kind == "only" and node.arguments[0].arguments[0] in marks
        if id(node) in seen or elsewhere:
            continue
        seen.add(id(node))
        waiting += [each for each in node.arguments if isinstance(each, Symbol)]
        if node.varies and (
            node.kind == "log" or (node.kind == "**" and node.arguments[1] % 1.0)
        ):
            yield node


def _held(traced: Traced, regime: int) -> dict[str, float]:
    """The constants of a regime by name."""
    columns = traced.columns(int(traced.component_of[regime]))
    row = traced.regimes[regime, columns].tolist()
    return dict(zip(traced.constants[columns], row, strict=True))


def _after(tracer: Tracer, traced: Traced, switch: Any, left: int) -> dict[str, Any]:
    """States after a switch, where lines between random states meet its surface; maybe none."""
    rng = np.random.default_rng(0)
    values = tracer.samples(rng, SAMPLES) | _held(traced, left)
    low, high = rng.uniform(-3.0, 3.0, (2, len(tracer.states), SAMPLES))
    surface, arguments = numpy_function([switch.surface])

    def at(share: np.ndarray) -> dict[str, Any]:
        between = low + share * (high - low)
        return values | dict(zip(tracer.states, between, strict=True))

    def height(share: np.ndarray) -> Any:
        state = at(share)
        (found,) = surface(*(state[name] for name in arguments))
        return np.broadcast_to(found, SAMPLES)

    with np.errstate(all="ignore"):
        first, last = np.zeros(SAMPLES), np.ones(SAMPLES)
        start = height(first)
        meets = start * height(last) < 0.0
        for _ in range(HALVINGS):
            middle = 0.5 * (first + last)
            same = height(middle) * start > 0.0
            first, last = np.where(same, middle, first), np.where(same, last, middle)
        states = at(first)
        resets = evaluate(list(switch.reset.values()), states)
    states |= {
        tracer.states[place]: value
        for place, value in zip(switch.reset, resets, strict=True)
    }
    return {
        name: np.broadcast_to(value, SAMPLES)[meets] for name, value in states.items()
    }


def _refuse(switch: str, regime: str, power: Symbol) -> None:
    base = expression(power.arguments[0])
    what = "log" if power.kind == "log" else f"power {power.arguments[1]:g}"
    shifted = f"{base} * {base} + 1e-12"
    remedy = (
        f"0.5 * log({shifted})"
        if power.kind == "log"
        else f"({shifted}) ** {0.5 * power.arguments[1]:g}"
    )
    raise ValueError(
        f"switch {switch!r} enters regime {regime!r} where {base} is zero, and the field has its "
        f"{what}: there is no Taylor series there; write {remedy}, which is smooth, with a number "
        "that is small beside the square of what it usually is in place of 1e-12"
    )
