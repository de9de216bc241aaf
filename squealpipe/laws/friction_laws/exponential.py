"""The exponential (Stribeck) law: friction falls from its static value over a speed v0."""

from typing import Any

from squealpipe.systems.natural_exponential import exp

PARAMETERS = ("mu", "mu_static", "friction_speed")
FALLING = True


def coefficient(speed: Any, p: Any) -> Any:
    """μ(w) = μ + (μs − μ) exp(−w/v0)."""
    return p.mu + (p.static_mu - p.mu) * exp(-speed * p.friction_speed**-1.0)


def slope(speed: Any, p: Any) -> Any:
    """dμ/dw = −(μs − μ)/v0 exp(−w/v0), s/m."""
    rate = p.friction_speed**-1.0
    return -((p.static_mu - p.mu) * rate * exp(-speed * rate))
