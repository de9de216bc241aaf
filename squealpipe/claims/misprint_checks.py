"""What the misprints change, by numbers."""

from __future__ import annotations

import numpy as np

from squealpipe.claims.evidence import Finding, Run, finding
from squealpipe.claims.maps import cell
from squealpipe.claims.response import scene
from squealpipe.schema.claims import Verdict

REVERSED = "F2a_reversed"
"""The scene (π/2, π) with the belt running the other way: the friction of Eq. (4) as printed."""


def friction_drags_along(run: Run) -> Finding:
    """E1: mean x with the friction as printed, against the static state of Eq. (15)."""
    printed = float(scene(run, REVERSED).x.mean() / run.parameters.preload)
    mended = float(scene(run, "F2a").x.mean() / run.parameters.preload)
    static = float(cell(run["quasi_static_map"], 0.5, 1.0).x_static / run.parameters.preload)
    return finding(
        printed * np.sign(static),
        ">",
        0,
        f"At (0.5π, π) the mass rests on average at x = {printed:.3g} l_pre with the printed sign "
        f"and at {mended:.3g} l_pre with the mended one; Eq. (15), from the paper's own linear "
        f"equations, has {static:.3g} l_pre.",
    )


def shift_is_added(run: Run) -> Finding:
    """E4: mean y in contact against y* and −y*, the rest positions of X − X* and X + X*."""
    motion = scene(run, "F2a")
    static = float(cell(run["quasi_static_map"], 0.5, 1.0).y_static)
    mean = float(motion.y.mean())
    return finding(
        abs(mean + static),
        "<",
        abs(mean - static),
        f"With X + X* the motion would rest at y = {-static:.3g}, with X − X* at {static:.3g}; in "
        f"A1 at (0.5π, π) y oscillates about {mean:.3g}.",
    )


def parameters_are_printed(run: Run) -> Finding:
    """E9: how much of the parameter space shows what the paper shows."""
    inference = run["parameter_inference"]
    feasible = inference.feasible == 1
    number = int(feasible.sum())
    ranges = ", ".join(
        f"{symbol} from {float(values.min()):.2g} to {float(values.max()):.3g}"
        for symbol, values in (
            ("k3/k", inference.kappa.where(feasible)),
            ("μ", inference.mu.where(feasible)),
            ("L/l_pre", inference.length_ratio.where(feasible)),
        )
    )
    return finding(
        number,
        "≤",
        1,
        f"No number is printed, and the pictures do not fix them: {number} of {feasible.size} "
        f"parameter sets tried ({100 * number / feasible.size:.2g} %) agree with every statement "
        f"on Figs. 2–5, with {ranges}.",
        otherwise=Verdict.fails if number else Verdict.cannot_be_decided,
    )
