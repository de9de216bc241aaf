"""The linear contact spring, the paper's."""

from typing import Any


def force(compression: Any, closing: Any, p: Any) -> Any:  # noqa: ARG001
    """N = k3 δ, N."""
    return p.k3 * compression


def stiffness(compression: Any, p: Any) -> Any:  # noqa: ARG001
    """∂N/∂δ = k3, N/m."""
    return p.k3
