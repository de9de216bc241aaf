"""A traced system as text: what its datasets record of it."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from squealpipe.systems.components import Composition
from squealpipe.systems.taylor.scalar import REGIME
from squealpipe.systems.taylor.symbols import FUNCTIONS, Symbol, in_order
from squealpipe.systems.trace import Traced


def describe(
    traced: Traced,
    composition: Composition,
    states: Sequence[str],
    outputs: Sequence[str],
) -> dict[str, str]:
    """Rates, surfaces, resets and regimes, each as an expression in names."""
    regimes = list(composition.regimes)
    roots = {
        f"d{name}/dt": rate for name, rate in zip(states, traced.rates, strict=False)
    }
    margins: dict[str, Symbol | None] = {}
    for switch, symbols in zip(composition.switches, traced.switches, strict=True):
        leaves = (
            switch.leaves
            if isinstance(switch.leaves, str)
            else ", ".join(switch.leaves)
        )
        roots[f"{switch.name} leaves {leaves} when"] = symbols.surface
        for regime, condition, kind in symbols.targets:
            name = regimes[regime]
            margins[f"{switch.name} to {name} as {traced.kinds[kind]}"] = condition
        for regime, reset in symbols.resets.items():
            into = "" if symbols.has_one_reset else f" into {regimes[regime]}"
            for place, value in reset.items():
                roots[f"{switch.name}{into} resets {states[place]}"] = value
    roots |= dict(zip(outputs, traced.outputs, strict=True))
    written = _written(roots, margins)
    for row, component, name in zip(
        traced.regimes, traced.component_of, regimes, strict=True
    ):
        columns = traced.columns(component)
        values = (
            f"{c.removeprefix(REGIME)}={v:g}"
            for c, v in zip(traced.constants[columns], row[columns], strict=True)
        )
        written[f"regime {name}"] = ", ".join(values)
    return written


def _written(
    roots: dict[str, Symbol], margins: dict[str, Symbol | None]
) -> dict[str, str]:
    """Expressions, and conditions that are to be at least zero."""
    every = [
        *roots.values(),
        *(margin for margin in margins.values() if margin is not None),
    ]
    nodes = in_order(every)
    lengths: dict[int, int] = {}
    uses = dict.fromkeys(map(id, nodes), 0)
    for node in nodes:
        inner = [
            argument for argument in node.arguments if isinstance(argument, Symbol)
        ]
        lengths[id(node)] = 8 + sum(lengths[id(each)] for each in inner)
        for each in inner:
            uses[id(each)] += 1
    names: dict[int, str] = {}
    written: dict[str, str] = {}
    # in longer texts parts that occur several times are written once, under a name
    if sum(lengths[id(each)] for each in every) > 20_000:
        for node in nodes:
            if uses[id(node)] > 1 and lengths[id(node)] > 20:
                text = expression(node, names)
                names[id(node)] = f"part{len(names) + 1}"
                written[names[id(node)]] = text
    written |= {what: expression(root, names) for what, root in roots.items()}
    for what, margin in margins.items():
        text = "otherwise" if margin is None else f"{expression(margin, names)} >= 0"
        written[what] = text
    return written


def expression(node: Symbol, names: Mapping[int, str] = MappingProxyType({})) -> str:
    """A symbol as a Python expression; parts that have a name, by ``id``, by their name."""
    if id(node) in names:
        return names[id(node)]
    if node.kind in {"variable", "parameter"}:
        return str(node.arguments[0]).removeprefix(REGIME)
    if node.kind == "number":
        return f"{node.arguments[0]:.17g}"
    inner = [
        expression(a, names) if isinstance(a, Symbol) else f"{a:g}"
        for a in node.arguments
    ]
    if node.kind in FUNCTIONS:
        return f"{node.kind}({inner[0]})"
    if node.kind == "only":
        return f"({inner[1]} if {inner[0]} else 0)"
    if node.kind == "joined":
        return f"({inner[0]} * {inner[1]} * {inner[2]} + {inner[3]} * {inner[4]} * {inner[5]})"
    return f"({f' {node.kind} '.join(inner)})"
