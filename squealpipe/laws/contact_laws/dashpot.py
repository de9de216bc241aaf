"""The linear contact spring with a dashpot beside it, which does not pull.

N = k3 δ + c3 δ̇ vanishes before the mass has left the spring's free length: contact ends there, and
begins again where the force would be positive. It jumps up by c3 δ̇ where the mass strikes at δ = 0.
"""

from typing import Any

from squealpipe.laws.contact_laws.linear import stiffness

__all__ = ["force", "stiffness"]


def force(compression: Any, closing: Any, p: Any) -> Any:
    """N = k3 δ + c3 δ̇."""
    return p.k3 * compression + p.damping3 * closing
