"""Statements on what the model levels take for granted (Table 1, sections 3, 6 and 9)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.claims.evidence import Finding, Run, finding
from squealpipe.claims.maps import on_grid_of, share
from squealpipe.schema.claims import Verdict

LEVELS = ("A1", "A2", "A3", "A4")

DIFFERENCE = 0.1
"""Relative difference of an extreme from which leaving something out matters."""


def levels_have_assumptions(run: Run) -> Finding:
    """T1: how often each level's own assumptions held along the motion that it computes."""
    table = run["assumptions"].sel(level=list(LEVELS))
    broken = ((table.needed == 1) & (table.held == 0)).any("assumption")
    scenes = table.sizes["scene"]
    whole = {level: scenes - int(broken.sel(level=level).sum()) for level in LEVELS}
    counts = ", ".join(f"{level} {number}" for level, number in whole.items())
    turn = table.measure.sel(assumption="angles are constant", level="A4")
    return finding(
        min(whole.values()) / scenes,
        "≥",
        1.0,
        f"Of {scenes} scenes, the own assumptions of a level held along the motion it computes in: "
        f"{counts}. Constant angles fail first: in A4 a spring turns by at least "
        f"{float(turn.min()):.2g} rad in every scene.",
        otherwise=Verdict.holds_only_as_printed if whole["A1"] == scenes else Verdict.fails,
    )


def earlier_assumptions_fail(run: Run) -> Finding:
    """S2: scenes in which A1's motion loses contact or turns its springs."""
    motion = run["assumptions"].sel(level="A1")
    lost = motion.held.sel(assumption="contact is kept") == 0
    turn = motion.measure.sel(assumption="angles are constant")
    limit = float(motion.limit.sel(assumption="angles are constant"))
    turned = turn > limit
    return finding(
        min(int(lost.sum()), int(turned.sum())),
        ">",
        0,
        f"In A1 contact is lost in {int(lost.sum())} of {lost.size} scenes, and a spring turns by "
        f"more than {limit:g} rad in {int(turned.sum())}, at least by {float(turn.min()):.2g} and "
        f"at most by {float(turn.max()):.3g} rad.",
    )


def spring_pulls(run: Run) -> Finding:
    """F6e: where the linear model's contact spring pulls, and how much."""
    pull = run["linear_pull"]
    stable = on_grid_of(run["stability_map"], pull).regime_linear == 0
    pulls = pull.lowest_contact_force < 0
    strongest = -float(pull.lowest_contact_force.where(stable).min())
    fraction = float(pull.pulling_fraction.where(pulls).median())
    return finding(
        share(pulls),
        ">",
        0,
        f"From rest the linear model's k3 pulls in {100 * share(pulls):.3g} % of the cells, there "
        f"for {100 * fraction:.2g} % of the time (median), with up to {strongest:.3g} times the "
        "preload in linearly stable cells.",
    )


def contact_loss_matters(run: Run) -> Finding:
    """C4: extremes of A1 with and without contact loss, in the scenes that lose contact."""
    table = run["assumptions"]
    lost = table.held.sel(level="A1", assumption="contact is kept").values == 0
    changes = xr.concat(
        [_relative_change(table[name]) for name in ("largest_y", "largest_x")], "extreme"
    ).max("extreme")
    if not lost.any():
        return finding(0, ">", 0, "No scene loses contact.")
    changed = changes.values[lost]
    kept = changes.values[~lost]
    names = table.scene.values[lost]
    worst = int(np.argmax(changed))
    return finding(
        float(np.median(changed)),
        ">",
        DIFFERENCE,
        f"Without contact loss the largest displacement changes by {100 * changed.min():.2g} to "
        f"{100 * changed.max():.3g} % in the {lost.sum()} scenes that lose contact (most in "
        f"{names[worst]}), and by at most {100 * kept.max(initial=0.0):.1g} % in the others.",
    )


def _relative_change(extreme: xr.DataArray) -> xr.DataArray:
    """Change of an extreme of A1 when contact cannot be lost, relative to A1's."""
    with_loss = extreme.sel(level="A1", drop=True)
    without = extreme.sel(level="A1-no-separation", drop=True)
    return abs(without - with_loss) / with_loss
