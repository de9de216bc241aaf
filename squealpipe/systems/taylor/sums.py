"""Long sums of constants times series, written as loops over tables.

A structure's accelerations are products of matrices with series. One line of code for each entry
is compiled in minutes where there are thousands; a loop over a table of the entries in a second,
and it is as fast. Terms keep their order, and so the sum its last bit.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from squealpipe.systems.taylor.symbols import Symbol, in_order

SHORTEST = 4
"""Terms from which a loop pays."""


class Term(NamedTuple):
    """A number times what moves."""

    factor: float
    moving: Symbol


class Sum(NamedTuple):
    """``first``, then plus one term after the other."""

    first: Symbol
    terms: tuple[Term, ...]


class Sums:
    """The long sums among the nodes below some roots.

    Attributes:
        of: the sums by the ``id`` of their last node.
        inside: ``id`` of nodes that are parts of one sum alone, which no line computes.
        slots: number of each moving node that loops read, by its ``id``, in order.
    """

    def __init__(self, roots: Sequence[Symbol]) -> None:
        nodes = in_order(list(roots))
        uses = Counter(id(a) for n in nodes for a in _below(n))
        uses.update(id(root) for root in roots)
        self.of: dict[int, Sum] = {}
        self.inside: set[int] = set()
        self.slots: dict[int, int] = {}
        taken: set[int] = set()
        absorbed: Counter[int] = Counter()
        for node in reversed(nodes):
            if node.kind != "+" or not node.varies or id(node) in taken:
                continue
            chain = _chain(node, uses)
            if len(chain) < SHORTEST:
                continue
            terms = tuple(term for _, _, term in chain)
            self.of[id(node)] = Sum(chain[0][0], terms)
            inner = [partial for partial, _, _ in chain[1:]]
            taken.update(map(id, inner))
            self.inside.update(map(id, inner))
            absorbed.update(id(added) for _, added, _ in chain if added.kind == "*")
        self.inside |= {key for key, count in absorbed.items() if count == uses[key]}
        read = {id(t.moving) for each in self.of.values() for t in each.terms}
        for node in nodes:
            if id(node) in read:
                self.slots[id(node)] = len(self.slots)

    def written(self, nodes: Iterable[Symbol]) -> Iterator[Symbol]:
        """Those nodes that lines compute."""
        return (node for node in nodes if id(node) not in self.inside)


def _below(node: Symbol) -> Iterator[Symbol]:
    return (a for a in node.arguments if isinstance(a, Symbol))


def _chain(node: Symbol, uses: Counter[int]) -> list[tuple[Symbol, Symbol, Term]]:
    """(sum so far, what is added, as a term) up to a node, for terms that a loop can add."""
    found: list[tuple[Symbol, Symbol, Term]] = []
    while node.kind == "+":
        before, added = node.arguments
        term = _term(added)
        if term is None:
            break
        found.append((before, added, term))
        if uses[id(before)] != 1:
            break
        node = before
    return found[::-1]


def _term(value: Symbol) -> Term | None:
    if value.kind == "variable":
        return Term(1.0, value)
    if value.kind != "*" or value.arguments[0].kind != "number":
        return None
    factor, moving = value.arguments
    return Term(factor.arguments[0], moving)
