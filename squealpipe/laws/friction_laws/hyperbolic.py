"""The hyperbolic law: friction falls from its static value like 1/(1 + w/v0)."""

from typing import Any

PARAMETERS = ("mu", "mu_static", "friction_speed")
FALLING = True


def coefficient(speed: Any, p: Any) -> Any:
    """μ(w) = μ + (μs − μ)/(1 + w/v0)."""
    return (
        p.mu
        + (p.static_mu - p.mu) * p.friction_speed * (p.friction_speed + speed) ** -1.0
    )


def slope(speed: Any, p: Any) -> Any:
    """dμ/dw = −(μs − μ) v0/(v0 + w)², s/m."""
    return -(
        (p.static_mu - p.mu) * p.friction_speed * (p.friction_speed + speed) ** -2.0
    )
