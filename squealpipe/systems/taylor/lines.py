"""Lines of code that compute symbols of one state: values, sizes of terms, sizes of rates."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from squealpipe.systems.taylor.sums import Sums
from squealpipe.systems.taylor.symbols import FUNCTIONS, Symbol, in_order


@dataclass
class Writer:
    """Lines that compute symbols, each once; ``load`` gives the code of a variable or parameter.

    With ``sums`` long ones are loops over what lines put into the function's ``room``: values,
    then sizes, then sizes of rates, 8 bytes for each slot.
    """

    load: Callable[[Symbol], str]
    prefix: str
    sums: Sums = field(default_factory=lambda: Sums([]))
    lines: list[str] = field(default_factory=list)
    names: dict[int, str] = field(default_factory=dict)
    sizes: dict[int, str] = field(default_factory=dict)
    rates: dict[int, str] = field(default_factory=dict)

    def room(self) -> list[str]:
        """Lines in front of all others."""
        if not self.sums.of:
            return []
        # compilers unroll a loop whose length they know
        return [
            f"{self.prefix}room = space({3 * len(self.sums.slots)})",
            f"{self.prefix}zero = p % 8",
        ]

    def value(self, root: Symbol) -> str:
        """Lines for a value; returns its name."""
        for node in self.sums.written(in_order([root])):
            if node.kind == "number":
                self.names[id(node)] = repr(node.arguments[0])
            elif id(node) not in self.names:
                name = self.names[id(node)] = f"{self.prefix}{len(self.names)}"
                if id(node) in self.sums.of:
                    self._add_up(name, node, self.names, 0)
                else:
                    self.lines.append(f"{name} = {self._code(node)}")
                self._put(node, name, 0)
        return self.names[id(root)]

    def _put(self, node: Symbol, name: str, block: int) -> None:
        """Put what loops read into its slot."""
        if id(node) in self.sums.slots:
            slots = self.sums.slots
            at = 8 * (block * len(slots) + slots[id(node)])
            self.lines.append(f"put({self.prefix}room + {at}, {name})")

    def _add_up(
        self, name: str, node: Symbol, known: Mapping[int, str], block: int
    ) -> None:
        """Lines for a long sum of values (block 0) or of sizes."""
        first, terms = self.sums.of[id(node)]
        slots, factors = self.sums.slots, [each.factor for each in terms]
        if block:
            factors = list(map(abs, factors))
        at = (8 * (block * len(slots) + slots[id(each.moving)]) for each in terms)
        room, zero = f"{self.prefix}room", f"{self.prefix}zero"
        self.lines += [
            f"{name} = {known.get(id(first), '0.0')}",
            f"{name}f = table({', '.join(map(repr, factors))})",
            f"{name}p = table({', '.join(map(repr, at))})",
            f"for j in range({len(terms)} + {zero}):",
            f" term = number({name}f + 8 * j) * number({room} + whole({name}p + 8 * j))",
            f" {name} = {name} + term",
        ]

    def _code(self, node: Symbol) -> str:
        if node.kind in {"variable", "parameter"}:
            return self.load(node)
        given = [
            self.names[id(a)] if isinstance(a, Symbol) else repr(a)
            for a in node.arguments
        ]
        if node.kind in FUNCTIONS:
            return f"math.{node.kind}({given[0]})"
        if node.kind == "only":
            return f"only({given[0]}, {given[1]})"
        if node.kind == "joined":
            c1, a1, b1, c2, a2, b2 = given
            return f"{c1} * ({a1} * {b1}) + {c2} * ({a2} * {b2})"
        return f" {node.kind} ".join(given)

    def _without_size(self, root: Symbol) -> list[Symbol]:
        """Nodes whose size no line computes yet: each is written once for all roots."""
        nodes = self.sums.written(in_order([root]))
        return [node for node in nodes if id(node) not in self.sizes]

    def scale(self, root: Symbol, scale_of: Callable[[Symbol], str]) -> str:
        """Lines for the size of the terms that cancel in a sum, to which round-off is relative."""
        self.value(root)
        sizes = self.sizes
        for node in self._without_size(root):
            if node.kind == "number":
                sizes[id(node)] = repr(abs(node.arguments[0]))
                continue
            name = sizes[id(node)] = f"{self.prefix}z{len(self.lines)}"
            if id(node) in self.sums.of:
                self._add_up(name, node, sizes, 1)
                self._put(node, name, 1)
                continue
            code = scale_of(node) if node.kind == "variable" else self._size_code(node)
            self.lines.append(f"{name} = {code}")
            self._put(node, name, 1)
        return sizes[id(root)]

    def _size_code(self, node: Symbol) -> str:
        """Code of the size of a node's terms from those of its arguments."""
        inner = [self.sizes[id(a)] for a in node.arguments if isinstance(a, Symbol)]
        value = self.names[id(node)]
        if node.kind == "+":
            return " + ".join(inner)
        if node.kind == "*":
            return " * ".join(inner)
        if node.kind == "only":
            return f"only({self.names[id(node.arguments[0])]}, {inner[1]})"
        if node.kind == "joined":
            first, second = inner[:3], inner[3:]
            return f"{' * '.join(first)} + {' * '.join(second)}"
        if node.kind in FUNCTIONS:
            slope = _slope_size(self, node)
            # Size of the terms of a function from its value, its slope and the size of
            # its argument.
            sizes = {
                # of a long time an angle has lost digits
                "sin": "{inner} + abs({value})",
                "cos": "{inner} + abs({value})",
                "tanh": "min(1.0, {inner}) + abs({value})",
                "atan": "min(2.0, {inner}) + abs({value})",
                "asin": "{slope} * {inner} + abs({value})",
                "sinh": "{slope} * {inner} + abs({value})",
                "cosh": "{slope} * {inner} + abs({value})",
                "exp": "abs({value}) * (1.0 + {inner})",
                "log": "1.0 + abs({value})",
            }
            return sizes[node.kind].format(value=value, inner=inner[0], slope=slope)
        return f"abs({value})"

    def rate_scale(self, root: Symbol, of_rates: Mapping[int, str]) -> str:
        """Lines for the size of the terms of a rate, from those of the variables' rates.

        Forward, node by node: derivatives by each variable would be as many lines for each. Sizes
        of all nodes must have been written.
        """
        rates = self.rates
        for node in self.sums.written(in_order([root])):
            if not node.varies or id(node) in rates:
                continue
            if node.kind == "variable":
                rates[id(node)] = of_rates[id(node)]
                self._put(node, rates[id(node)], 2)
                continue
            name = f"{self.prefix}r{len(self.lines)}"
            if id(node) in self.sums.of:
                self._add_up(name, node, rates, 2)
                rates[id(node)] = name
                self._put(node, name, 2)
                continue
            moving = [a for a in node.arguments if isinstance(a, Symbol) and a.varies]
            if node.kind == "+":
                code = " + ".join(rates[id(a)] for a in moving)
            elif node.kind == "only":
                mark = self.names[id(node.arguments[0])]
                code = f"only({mark}, {rates[id(moving[0])]})"
            elif node.kind in {"*", "joined"}:
                code = " + ".join(self._rates_of_products(node))
            else:
                code = f"{_slope_size(self, node)} * {rates[id(moving[0])]}"
            rates[id(node)] = name
            self.lines.append(f"{name} = {code}")
            self._put(node, name, 2)
        return rates.get(id(root), "0.0")

    def _rates_of_products(self, node: Symbol) -> Iterator[str]:
        """Each product of a node with one of its factors replaced by the size of its rate."""
        factors = node.arguments
        for product in (
            (factors[:3], factors[3:]) if node.kind == "joined" else [factors]
        ):
            for place, factor in enumerate(product):
                if factor.varies:
                    others = [
                        self.sizes[id(a)] for i, a in enumerate(product) if i != place
                    ]
                    yield " * ".join([*others, self.rates[id(factor)]])


def _slope_size(writer: Writer, node: Symbol) -> str:
    """Size of the terms of a function's, or power's, slope."""
    inner = node.arguments[0]
    value, size = writer.names[id(node)], writer.sizes[id(inner)]
    if node.kind == "exp":
        return f"abs({value}) * (1.0 + {size})"
    if node.kind == "log":
        return f"abs(1.0 / {writer.names[id(inner)]})"
    if node.kind in {"sin", "cos"}:
        return f"({size} + 1.0)"
    if node.kind in {"sinh", "cosh"}:
        return f"(1.0 + abs({value}))"
    if node.kind == "atan":
        return f"(1.0 / (1.0 + {writer.names[id(inner)]} * {writer.names[id(inner)]}))"
    if node.kind == "asin":
        square = f"{writer.names[id(inner)]} * {writer.names[id(inner)]}"
        return f"(1.0 / (1.0 - {square})) ** 0.5"
    if node.kind == "**":
        return f"abs({node.arguments[1]!r} * {value} / {writer.names[id(inner)]})"
    return f"(1.0 + {value} * {value})"
