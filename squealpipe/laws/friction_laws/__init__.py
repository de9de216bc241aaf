"""The friction laws by name: how the coefficient depends on the sliding speed w = |V − ẋ|.

A law is a module of this folder, and its name in the import below; or a table of the user's own
or a Python file with ``coefficient(speed, p)``, of m/s and ``p.mu``
(:mod:`squealpipe.laws.tables`).
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from types import ModuleType, SimpleNamespace
from typing import Any, Protocol, cast

from squealpipe.laws.friction_laws import coulomb, exponential, hyperbolic  # noqa: F401
from squealpipe.laws.tables import (
    OwnLawRules,
    Pieces,
    functions_of,
    is_table,
    pieces_of,
    polynomial,
)

own_law_rules = OwnLawRules(
    columns=("speed", "coefficient"),
    units=("m s-1", "1"),
    files="or a table (FILE.csv), or a law in Python (FILE.py)",
    refused={},
    in_table=("mu", "mu_static", "friction_speed"),
    # its speeds are in m/s, 1 m/s in the engine's units
    in_source=("friction_speed",),
)


class FrictionLaw(Protocol):
    """Contents of a module that defines a friction law; w ≥ 0 is the sliding speed, m/s."""

    @property
    def PARAMETERS(self) -> tuple[str, ...]:  # noqa: N802
        """Fields of ``Parameters`` that the law reads."""

    def coefficient(self, speed: Any, p: Any) -> Any:
        """μ(w)."""

    def slope(self, speed: Any, p: Any) -> Any:
        """dμ/dw, s/m."""


COULOMB = "coulomb"
LAWS = {
    name: cast("FrictionLaw", module)
    for name, module in globals().items()
    if isinstance(module, ModuleType) and module.__package__ == __name__
}
"""Friction laws by name."""
FALLING = [name for name, law in LAWS.items() if getattr(law, "FALLING", False)]
"""Laws in which μ falls from its static value to that of sliding: Coulomb's where both agree."""


def _is_complex(speed: Any) -> bool:
    """Tell whether a number is complex, without NumPy, so that ``--help`` does not load it."""
    dtype = getattr(speed, "dtype", None)
    return isinstance(speed, complex) or getattr(dtype, "kind", None) == "c"


class FrictionTable:
    """A measured law; speeds in units of ``p.friction_speed``, which is 1 m/s in SI parameters."""

    PARAMETERS = ()

    def __init__(self, pieces: Pieces) -> None:
        self.pieces = pieces

    def coefficient(self, speed: Any, p: Any) -> Any:
        """μ(w); of a complex speed to first order, so that a complex step gives :meth:`slope`."""
        if _is_complex(speed):
            rate = self.slope(speed.real, p)
            return self.coefficient(speed.real, p) + 1j * rate * speed.imag
        return self.pieces.value(speed * p.friction_speed**-1.0)

    def slope(self, speed: Any, p: Any) -> Any:
        """dμ/dw, s/m; at a knot the mean of both sides.

        A small vibration about a knot spends half of its time on either side, so it grows by the
        mean.
        """
        unit = p.friction_speed**-1.0
        # relative to the speed of the knot: a speed converted from other units may miss its knot
        # by round-off, so both slopes count this close to it
        beside = 1e-12
        below, above = (
            self.pieces.value(speed * unit * factor, derivative=True)
            for factor in (1.0 - beside, 1.0 + beside)
        )
        return unit * 0.5 * (below + above)


class FrictionPiece:
    """One piece of a table, whose start and coefficients are the constants of a regime."""

    PARAMETERS = ()

    def __init__(self, start: Any, coefficients: Any) -> None:
        self.start, self.coefficients = start, coefficients

    def coefficient(self, speed: Any, p: Any) -> Any:
        """μ(w)."""
        return polynomial(
            self.coefficients, speed * p.friction_speed**-1.0 - self.start
        )


@contextmanager
def _faults_named(what: str) -> Iterator[None]:
    """Whatever a user's code raises becomes an error that says where and what to do."""
    try:
        yield
    except ValueError:
        raise
    except ImportError as error:
        raise ValueError(
            f"friction_law: {what} imports what is not there ({error}); a law is one file, so put "
            "its code in there"
        ) from error
    except (Exception, SystemExit) as error:
        raise ValueError(
            f"friction_law: {what} failed with {type(error).__name__}: {error}; it must return "
            "the coefficient for a speed in m/s and p, which has p.mu"
        ) from error


@lru_cache(maxsize=64)
def _own(name: str) -> FrictionLaw | None:
    """A law of the user's own; None if the name is none."""
    if is_table(name):
        return FrictionTable(pieces_of(name))
    if "\n" not in name:
        return None
    with _faults_named("the file of the law"):
        functions = functions_of(name)
    if "coefficient" not in functions:
        raise ValueError("the file has no function coefficient(speed, p)")

    def coefficient(speed: Any, p: Any) -> Any:
        with _faults_named("coefficient(speed, p)"):
            return functions["coefficient"](
                speed * p.friction_speed**-1.0, SimpleNamespace(mu=p.mu)
            )

    def slope(speed: Any, p: Any) -> Any:
        # a complex step is exact for a smooth law
        return coefficient(speed + 1e-30j, p).imag / 1e-30

    return cast(
        "FrictionLaw",
        SimpleNamespace(PARAMETERS=(), coefficient=coefficient, slope=slope),
    )


def law_of(name: Any) -> FrictionLaw | None:
    """The law of a name, None if there is none; a law itself is given back."""
    if not isinstance(name, str):
        return cast("FrictionLaw", name)
    return LAWS.get(name) or _own(name)


def coefficient(speed: Any, p: Any) -> Any:
    """μ at a sliding speed w ≥ 0, m/s, by the law that ``p.friction_law`` names."""
    return cast("FrictionLaw", law_of(p.friction_law)).coefficient(speed, p)


def slope(speed: Any, p: Any) -> Any:
    """dμ/dw at a sliding speed w ≥ 0, s/m."""
    return cast("FrictionLaw", law_of(p.friction_law)).slope(speed, p)


def static_coefficient(p: Any) -> Any:
    """Return the static coefficient: ``p.mu_static``, where that is None the law's at speed 0.

    A formula that falls to μ from a static coefficient that is none of its own is μ throughout.
    """
    if p.mu_static is not None:
        return p.mu_static
    if isinstance(p.friction_law, str) and p.friction_law in LAWS:
        return p.mu
    return coefficient(0.0, p)
