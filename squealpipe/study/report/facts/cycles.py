"""Numbers about limit cycles of the damped full model."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import Outcome
from squealpipe.study.claims.evidence import Run
from squealpipe.text import number

CLOSE = 0.05
"""A long run whose size is this close to a cycle's, relative, counts as one that has reached it."""


def cycles(run: Run) -> dict[str, Any]:
    """The cycle of Fig. 3's scene, where its branch turns, and where long runs end."""
    cycle, extremes = run["cycles/limit_F3"], run["cycles/extremes"]
    parameters = json.loads(cycle.attrs["parameters"])
    found = int(cycle.outcome) == Outcome.converged
    return {
        "damping": parameters["damping1"] / np.sqrt(parameters["k1"] * parameters["mass"]),
        "own_damping": any(
            own not in (0.0, parameters["damping1"])
            for own in (run.parameters.damping1, run.parameters.damping2)
        ),
        "mu": parameters["mu"],
        "found": found,
        "reason": Outcome(int(cycle.outcome)).name.replace("_", " "),
        "size": float(max(abs(cycle.x_min), abs(cycle.x_max)) / run.parameters.preload)
        if found
        else None,
        "period": float(cycle.period / run.parameters.time_unit) if found else None,
        "contact": float(cycle.contact_fraction) if found else None,
        "stable": bool(cycle.stable),
        "largest_multiplier": float(
            np.abs(cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values)[1:].max()
        )
        if found
        else None,
        **_turn(run["cycles/branch_F3_down"]),
        "runs": int(extremes.sizes["start"]),
        "frictions": int(extremes.sizes["mu"]),
        "both": _both(run),
        "close": CLOSE,
        "rest_2d": how_it_ends(run),
        "far_2d": _far(extremes, parameters),
    }


def _turn(branch: xr.Dataset) -> dict[str, Any]:
    """Friction of the branch's first fold, and its lowest friction."""
    fold = str(branch.label.attrs["flag_meanings"]).split().index("fold")
    folds = branch.mu.values[branch.label.values == fold]
    points = branch.sizes["point"]
    return {
        "fold": float(folds[0]) if len(folds) else None,
        "lowest": float(branch.mu.min()) if points else None,
        "points": points,
    }


def _both(run: Run) -> int:
    """Frictions at which some long runs end with the stable cycle's size and others do not."""
    extremes, count = run["cycles/extremes"].sel(scene="F3"), 0
    friction, size = [], []
    for way in ("down", "up"):
        branch = run[f"cycles/branch_F3_{way}"]
        stable = branch.stable.values == 1
        friction += branch.mu.values[stable].tolist()
        size += np.maximum(abs(branch.x_min), abs(branch.x_max)).values[stable].tolist()
    if not friction:
        return 0
    order = np.argsort(friction)
    low, high = min(friction), max(friction)
    for mu, reached in zip(extremes.mu.values, extremes.late_max_x.values, strict=True):
        if not low <= mu <= high:
            continue
        expected = np.interp(mu, np.array(friction)[order], np.array(size)[order])
        near = np.abs(reached / expected - 1.0) < CLOSE
        count += bool(near.any() and not near.all())
    return count


def how_it_ends(run: Run) -> str | None:
    """How the run from rest of Fig. 2(d)'s scene ends, in words; None where it was not run."""
    if "cycles/limit_F2d" not in run:
        return None
    cycle = run["cycles/limit_F2d"]
    outcome = Outcome(int(cycle.outcome))
    if outcome == Outcome.equilibrium:
        return "comes to rest (with this damping its hammering is a transient)"
    if outcome != Outcome.converged:
        return f"leads to no limit cycle that was found ({outcome.name.replace('_', ' ')})"
    share = number(100 * float(cycle.contact_fraction))
    return (
        "settles on a stable limit cycle" if cycle.stable else "leads to an unstable limit cycle"
    ) + f", in contact for {share} % of its period"


def _far(extremes: xr.Dataset, parameters: dict[str, Any]) -> list[int]:
    """Runs of Fig. 2(d)'s scene that end with |x| beyond two spring lengths, of how many."""
    late = extremes.late_max_x.sel(scene="F2d").values
    beyond = late > 2.0 * max(parameters["length1"], parameters["length2"])
    return [int(beyond.sum()), int(np.isfinite(late).sum())]
