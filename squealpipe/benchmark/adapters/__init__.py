"""One module a solver, each with ``solve(problem, tol)``; see ``docs/benchmark.md``."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable
from functools import partial
from importlib.util import find_spec
from typing import Any

SOLVERS: dict[str, tuple[str, str, dict[str, Any]]] = {
    "squealpipe": ("squealpipe", "numba", {}),
    **{name: ("scipy", "scipy", {"method": name}) for name in ("DOP853", "RK45", "LSODA", "Radau")},
    "heyoka": ("heyoka", "heyoka", {}),
    "CyRK": ("cyrk", "CyRK", {}),
    "SUNDIALS": ("sundials", "sksundae", {}),
    "diffrax": ("diffrax", "diffrax", {}),
    **{f"tanh, σ = {s:g}": ("tanh", "scipy", {"sigma": s}) for s in (10.0, 1e3, 1e7)},
    "Moreau–Jean": ("moreau_jean", "numpy", {}),
}
"""Solver → module here, what has to be installed for it, options."""


def solver(name: str) -> Callable[..., Any] | None:
    """The shipped adapter of a name; None where its package is not installed.

    Raises:
        ValueError: there is no such adapter.
    """
    if name not in SOLVERS:
        raise ValueError(f"solver {name!r} is unknown; one of {', '.join(SOLVERS)}")
    module, needs, options = SOLVERS[name]
    if find_spec(needs) is None:
        return None
    return partial(importlib.import_module(f"{__name__}.{module}").solve, **options)


def installed(names: Iterable[str]) -> dict[str, Callable[..., Any]]:
    """Those shipped adapters whose packages are there; the others are named and left out."""
    found = {name: solver(name) for name in names}
    for name, solve in found.items():
        if solve is None:
            print(f"{name}: {SOLVERS[name][1]} is not installed, left out")
    return {name: solve for name, solve in found.items() if solve is not None}
