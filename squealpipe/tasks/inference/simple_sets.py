"""The study's parameters by a rule: the simple numbers whose smallest margin is the largest."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from squealpipe.schema.inference import Holds
from squealpipe.tasks.inference.candidates import Candidates
from squealpipe.tasks.inference.constraints import CONSTRAINTS, judge

SIMPLE: dict[str, tuple[float, ...]] = {
    "kappa": tuple(round(0.05 * number, 2) for number in range(1, 27)),
    "mu": (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8),
    "length_ratio": (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 50.0, 100.0),
    "speed_ratio": (10.0, 20.0, 50.0, 100.0),
}
"""Numbers that count as simple, of each group."""
ALIKE = 6
"""Digits after the point of a margin; of sets that differ by less the fastest belt comes first, for
the linear models take ẋ < V for granted."""


def rank_simple_sets(
    ranges: dict[str, tuple[float, float]], reading: str, *, tol: float, workers: int | None
) -> dict[str, Any]:
    """Simple sets within ``ranges`` that meet all statements, by falling smallest margin.

    Returns:
        Group → values of the sets, and "margin", (set, statement).
    """
    grid = [
        [value for value in SIMPLE[name] if low <= value <= high]
        for name, (low, high) in ranges.items()
    ]
    groups = dict(zip(ranges, np.array(list(product(*grid))).reshape(-1, len(grid)).T, strict=True))
    margin, holds = judge(sets_of(groups, tol=tol, workers=workers).read(reading))
    meets = np.flatnonzero((holds == Holds.yes).all(axis=1))
    smallest = margin[meets].min(axis=1).round(ALIKE)
    order = meets[np.lexsort((-groups["speed_ratio"][meets], -smallest))]
    ranked: dict[str, Any] = {name: values[order] for name, values in groups.items()}
    return ranked | {"margin": margin[order].reshape(-1, len(CONSTRAINTS))}


def sets_of(groups: dict[str, np.ndarray], *, tol: float, workers: int | None) -> Candidates:
    """Candidates with equal springs, in units of m = k = l_pre = 1."""
    ones = np.ones(len(groups["mu"]))
    fields = {
        "mass": ones,
        "k1": ones,
        "k2": ones,
        "k3": groups["kappa"],
        "mu": groups["mu"],
        "preload": ones,
        "length1": groups["length_ratio"],
        "length2": groups["length_ratio"],
        "belt_speed": groups["speed_ratio"],
    }
    return Candidates(fields, tol, workers)
