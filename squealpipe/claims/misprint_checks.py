"""What the misprints change, by numbers."""

from __future__ import annotations

import numpy as np

from squealpipe.claims.evidence import Finding, MissingDataError, Run, finding
from squealpipe.claims.maps import cell
from squealpipe.claims.response import scene
from squealpipe.schema import Outcome
from squealpipe.schema.claims import Verdict

WRONG_FREQUENCY = 1e-3
"""Relative error of ω that truncation and smoothing do not explain."""

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
        f"that was tried, for either direction of the belt, with {ranges}.",
        otherwise=Verdict.fails if number else Verdict.cannot_be_decided,
    )


def printed_residual_converges_right(run: Run) -> Finding:
    """E2: ω found with Eq. (34) as printed and mended, against the exact orbit."""
    forms = run["harmonic_forms"]
    error = abs(forms.omega / forms.omega_exact - 1)
    names = forms.form.attrs["flag_meanings"].split()
    printed, mended = names.index("as_printed"), names.index("mended")
    converged = forms.outcome.isel(form=printed) == Outcome.converged
    pairs = ", ".join(
        f"{float(found):.4f} for {float(exact):.4f}"
        for found, exact in zip(
            forms.omega.isel(form=printed).values, forms.omega_exact.values, strict=True
        )
    )
    return finding(
        float(error.isel(form=printed).max()),
        "≤",
        WRONG_FREQUENCY,
        f"As printed, ω converges in {int(converged.sum())} of {converged.size} scenes, to "
        f"{pairs}; with K12·a + K22·b it is right to {float(error.isel(form=mended).max()):.1g}.",
    )


def samples_suffice(run: Run) -> Finding:
    """E6: rank of Γ at N = 2N_h, and how far the answer still depends on the phase."""
    forms = run["harmonic_forms"]
    columns, harmonics = int(forms.fourier_columns), int(forms.n_harmonics)
    ranks = {int(row.samples): int(row) for row in forms.fourier_rank}
    if 2 * harmonics not in ranks:
        raise MissingDataError(f"harmonic_forms has no row N = {2 * harmonics}")
    enough = min(samples for samples, rank in ranks.items() if rank == columns)
    spreads = forms.phase_spread_y.dropna("samples")
    spread = " and still ".join(
        f"{float(spreads.sel(samples=number)):.1g} at N = {number}"
        for number in (enough, int(spreads.samples.max()))
    )
    return finding(
        columns - ranks[2 * harmonics],
        "≤",
        0,
        f"At N_h = {harmonics}, Γ has {columns} columns but rank {ranks[2 * harmonics]} at "
        f"N = {2 * harmonics}; the rank is full at N = {enough}. Aliasing stays: shifting the "
        f"start's phase changes the largest y by {spread}.",
    )


def jacobian_is_regular(run: Run) -> Finding:
    """E7: columns of the Jacobian of Eq. (36) minus its rank at the solutions."""
    forms = run["harmonic_forms"]
    deficits = forms.rank_deficit
    mended = deficits.isel(form=deficits.form.attrs["flag_meanings"].split().index("mended"))
    return finding(
        int(mended.min()),
        "≤",
        0,
        f"At the solutions the Jacobian of Eq. (36) has more columns than its rank, by "
        f"{int(mended.min())} or more in all {mended.size} scenes: ω is one unknown too many and "
        "J has no inverse. Nor is the phase fixed: starts shifted in time end in solutions whose "
        f"ω differs by up to {float(forms.phase_spread_omega.max()):.1g}. Conditions on amplitude "
        "and phase, and continuation, are needed.",
    )
