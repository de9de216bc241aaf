"""The friction laws by name: how the coefficient depends on the sliding speed w = |V − ẋ|.

A law is a module of this folder, and its name in the import below.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any, Protocol, cast

from squealpipe.laws.friction_laws import coulomb, exponential, hyperbolic  # noqa: F401


class FrictionLaw(Protocol):
    """What a module of a friction law holds; w ≥ 0 is the sliding speed, m/s."""

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
    if isinstance(module, ModuleType)
}
"""Friction laws by name."""
FALLING = [name for name, law in LAWS.items() if getattr(law, "FALLING", False)]
"""Laws in which μ falls from its static value to that of sliding: Coulomb's where both agree."""


def coefficient(speed: Any, p: Any) -> Any:
    """μ at a sliding speed w ≥ 0, m/s, by the law that ``p.friction_law`` names."""
    return LAWS[p.friction_law].coefficient(speed, p)


def slope(speed: Any, p: Any) -> Any:
    """dμ/dw at a sliding speed w ≥ 0, s/m."""
    return LAWS[p.friction_law].slope(speed, p)
