"""The contact laws by name: the normal force over the compression δ = l_pre − y and its rate.

A law is a module of this folder, and its name in the import below; or a table of the user's own
(:mod:`squealpipe.laws.tables`). Contact ends where the force has fallen to zero: no law pulls.
"""

from functools import lru_cache
from types import ModuleType
from typing import Any, Protocol, cast

from squealpipe.laws.contact_laws import dashpot, linear  # noqa: F401
from squealpipe.laws.tables import (
    OwnLawRules,
    Pieces,
    is_table,
    knots_of,
    pieces_of,
    polynomial,
    scaled,
)

own_law_rules = OwnLawRules(
    columns=("compression", "force"),
    units=("m", "N"),
    files="or a table (FILE.csv)",
    refused={
        "hertz": "d^1.5 has no Taylor series at d = 0, where contact begins and ends, so its "
        "order would be lost there; give a table of it, whose pieces have one"
    },
    in_table=("k3",),
    in_source=(),
)


class ContactLaw(Protocol):
    """Contents of a module that defines a contact law."""

    def force(self, compression: Any, closing: Any, p: Any) -> Any:
        """N at a compression δ, m, that grows with the rate ``closing``, m/s."""

    def stiffness(self, compression: Any, p: Any) -> Any:
        """∂N/∂δ, N/m."""


LINEAR = "linear"
LAWS = {
    name: cast("ContactLaw", module)
    for name, module in globals().items()
    if isinstance(module, ModuleType) and module.__package__ == __name__
}
"""Contact laws by name."""


class ContactTable:
    """A measured law; its last slope goes on beyond the last knot.

    Compressions are over l_pre and forces over k3 l_pre, which is the force at l_pre.
    """

    def __init__(self, pieces: Pieces) -> None:
        self.pieces = pieces

    def force(self, compression: Any, closing: Any, p: Any) -> Any:  # noqa: ARG002
        """N."""
        return p.k3 * p.preload * self.pieces.value(compression * p.preload**-1.0)

    def stiffness(self, compression: Any, p: Any) -> Any:
        """∂N/∂δ, N/m; at a knot that of larger compressions."""
        return p.k3 * self.pieces.value(compression * p.preload**-1.0, derivative=True)


class ContactPiece:
    """One piece of a table, whose start and coefficients are the constants of a regime."""

    def __init__(self, start: Any, coefficients: Any) -> None:
        self.start, self.coefficients = start, coefficients

    def force(self, compression: Any, closing: Any, p: Any) -> Any:  # noqa: ARG002
        """N."""
        distance = compression * p.preload**-1.0 - self.start
        return p.k3 * p.preload * polynomial(self.coefficients, distance)


@lru_cache(maxsize=64)
def relative(name: str, preload: float) -> str:
    """A law in units of l_pre and the force there: a table is rescaled, other names stay."""
    if not is_table(name):
        return name
    knots, forces = knots_of(name)
    if (knots[0], forces[0]) != (0.0, 0.0) or len(knots) < 2:
        raise ValueError("a table of contact begins with compression 0 and force 0")
    load = preload_force(name, preload)
    if not load > 0:
        raise ValueError(f"the table has no force at preload = {preload!r}")
    return scaled(name, preload, load)


@lru_cache(maxsize=64)
def lines_of(name: str) -> tuple[tuple[float, float, float, float], ...]:
    """Return the pieces of a table: start and end, m, force at the start, N, and stiffness, N/m.

    The last goes on; neighbours of one slope are one piece.

    Raises:
        ValueError: it is joined by cubics, does not begin with force 0 at compression 0, or does
            not rise.
    """
    knots, forces = knots_of(name)
    if name.startswith("cubic"):
        raise ValueError(
            "contacts of structures have tables that are joined by lines: write between: linear, "
            "with more rows where the curve bends"
        )
    if (knots[0], forces[0]) != (0.0, 0.0) or len(knots) < 2:
        raise ValueError("a table of contact begins with compression 0 and force 0")
    rows: list[tuple[float, float, float, float]] = []
    for start, end, low, high in zip(
        knots, knots[1:], forces, forces[1:], strict=False
    ):
        if not high > low:
            raise ValueError(
                f"the force of a contact must rise with its compression: {high:g} N at {end:g} m "
                f"is not above {low:g} N at {start:g} m; leave rows out in which it does not"
            )
        slope = (high - low) / (end - start)
        if rows and abs(slope - rows[-1][3]) <= 1e-12 * slope:
            first, _, force, _ = rows[-1]
            rows[-1] = first, end, force, (high - force) / (end - first)
        else:
            rows.append((start, end, low, slope))
    return tuple(rows)


def preload_force(name: str, preload: float) -> float:
    """N of a table at the compression l_pre, N."""
    return float(pieces_of(name, goes_on=True).value(preload))


def preload_of(name: str, force: float, k3: float) -> float:
    """The compression at which a law has a force, m: the first one of a table.

    Raises:
        ValueError: the table does not reach the force.
    """
    if not is_table(name):
        return force / k3
    pieces = pieces_of(name, goes_on=True)
    last = len(pieces.starts) - 1
    for piece, (start, row) in enumerate(zip(*pieces, strict=True)):
        c0, slope = float(row[0]), float(row[1])
        if piece == last:
            if slope > 0:
                return float(start) + (force - c0) / slope
            break
        width = float(pieces.starts[piece + 1] - start)
        if polynomial(row, width) < force:
            continue
        if not row[2:].any():
            return float(start) + (force - c0) / slope
        from scipy.optimize import brentq

        def lacking(at: float, row: Any = row) -> float:
            return float(polynomial(row, at) - force)

        at = brentq(lacking, 0.0, width, xtol=1e-16 * width, rtol=1e-15)
        return float(start + at)
    raise ValueError(
        f"the table of contact does not reach {force:g} N: it ends at {c0:g} N without rising"
    )


def law_of(name: Any, preload: float = 1.0) -> ContactLaw | None:
    """The law of a name, None if there is none; a law itself is given back."""
    if not isinstance(name, str):
        return cast("ContactLaw", name)
    if is_table(name):
        return ContactTable(pieces_of(relative(name, preload), goes_on=True))
    return LAWS.get(name)
