"""One module a solver, each with ``solve(problem, tol)``; see ``docs/benchmark.md``."""

import importlib
import runpy
from collections.abc import Callable, Iterable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

INPUT_FILES = ("*.py",)
"""Imported by name: every result that uses this module depends on them."""

SOLVERS: dict[str, tuple[str, str, dict[str, Any]]] = {
    "squealpipe": ("squealpipe", "numba", {}),
    **{
        name: ("scipy", "scipy", {"method": name})
        for name in ("DOP853", "RK45", "LSODA", "Radau")
    },
    "DOP853, bounded step": ("scipy", "scipy", {"longest": 0.01}),
    "DOP853, compiled field": ("scipy", "scipy", {"compiled": True}),
    "heyoka": ("heyoka", "heyoka", {}),
    "CyRK": ("cyrk", "CyRK", {}),
    "SUNDIALS": ("sundials", "sksundae", {}),
    "Assimulo": ("assimulo", "assimulo", {}),
    "diffrax": ("diffrax", "diffrax", {}),
    **{f"tanh, σ = {s:g}": ("tanh", "scipy", {"sigma": s}) for s in (10.0, 1e3, 1e7)},
    "Moreau–Jean": ("moreau_jean", "numpy", {}),
}
"""Solver → module here, what has to be installed for it, options."""


def solver(name: str) -> Callable[..., Any] | None:
    """The function that a name or FILE.py:FUNCTION means; None where its package is missing."""
    path, colon, function = name.rpartition(":")
    if colon:
        if not Path(path).is_file():
            raise ValueError(f"solver {name!r}: there is no file {path}")
        script = runpy.run_path(path)
        if function not in script:
            raise ValueError(f"solver {name!r}: {path} has no function {function}")
        return script[function]  # type: ignore[no-any-return]
    if name not in SOLVERS:
        known = "; ".join(SOLVERS)
        raise ValueError(
            f"solver {name!r} is unknown; one of {known}; or FILE.py:FUNCTION"
        )
    module, needs, options = SOLVERS[name]
    if find_spec(needs) is None:
        return None
    return partial(importlib.import_module(f"{__name__}.{module}").solve, **options)


def installed(names: Iterable[str]) -> dict[str, Callable[..., Any]]:
    """Solvers by name (without folders); those that are not installed are left out, and said so."""
    names = dict.fromkeys(names)
    adapters = {name.rpartition("/")[2]: solver(name) for name in names}
    if len(adapters) < len(names):
        raise ValueError(f"two solvers have the same name: {', '.join(names)}")
    for name, solve in adapters.items():
        if solve is None:
            print(f"{name}: {SOLVERS[name][1]} is not installed, left out")
    return {name: solve for name, solve in adapters.items() if solve is not None}
