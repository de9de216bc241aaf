"""Coulomb's law, the paper's: friction does not depend on speed."""

from typing import Any

PARAMETERS = ("mu", "mu_static")
"""``mu_static`` is the limit of stick alone; by default it equals ``mu``."""


def coefficient(speed: Any, p: Any) -> Any:  # noqa: ARG001
    """μ(w) = μ."""
    return p.mu


def slope(speed: Any, p: Any) -> Any:  # noqa: ARG001
    """dμ/dw = 0, s/m."""
    return 0.0
