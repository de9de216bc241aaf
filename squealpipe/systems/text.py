"""A traced system as text: what its datasets record of it."""

from __future__ import annotations

from collections.abc import Sequence

from squealpipe.methods.taylor.scalar import REGIME
from squealpipe.methods.taylor.symbols import FUNCTIONS, Symbol
from squealpipe.systems.components import Composition
from squealpipe.systems.trace import Traced


def describe(
    traced: Traced,
    composition: Composition,
    states: Sequence[str],
    outputs: Sequence[str],
) -> dict[str, str]:
    """Rates, surfaces, resets and regimes, each as an expression in names."""
    regimes = list(composition.regimes)
    found = {
        f"d{name}/dt": expression(rate)
        for name, rate in zip(states, traced.rates, strict=False)
    }
    for switch, symbols in zip(composition.switches, traced.switches, strict=True):
        leaves = (
            switch.leaves
            if isinstance(switch.leaves, str)
            else ", ".join(switch.leaves)
        )
        found[f"{switch.name} leaves {leaves} when"] = expression(symbols.surface)
        for regime, condition, kind in symbols.targets:
            name = regimes[regime]
            text = "otherwise" if condition is None else f"{expression(condition)} >= 0"
            found[f"{switch.name} to {name} as {traced.kinds[kind]}"] = text
        for place, value in symbols.reset.items():
            found[f"{switch.name} resets {states[place]}"] = expression(value)
    for name, output in zip(outputs, traced.outputs, strict=True):
        found[name] = expression(output)
    for row, component, name in zip(
        traced.regimes, traced.component_of, regimes, strict=True
    ):
        columns = traced.columns(component)
        values = (
            f"{c.removeprefix(REGIME)}={v:g}"
            for c, v in zip(traced.constants[columns], row[columns], strict=True)
        )
        found[f"regime {name}"] = ", ".join(values)
    return found


def expression(node: Symbol) -> str:
    """A symbol as a Python expression."""
    if node.kind in {"variable", "parameter"}:
        return str(node.arguments[0]).removeprefix(REGIME)
    if node.kind == "number":
        return f"{node.arguments[0]:.17g}"
    inner = [
        expression(a) if isinstance(a, Symbol) else f"{a:g}" for a in node.arguments
    ]
    if node.kind in FUNCTIONS:
        return f"{node.kind}({inner[0]})"
    if node.kind == "joined":
        return f"({inner[0]} * {inner[1]} * {inner[2]} + {inner[3]} * {inner[4]} * {inner[5]})"
    return f"({f' {node.kind} '.join(inner)})"
