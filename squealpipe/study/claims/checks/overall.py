"""Statements of the abstract and of Table 1: levels, hammering, earlier models, coupled modes."""

from __future__ import annotations

import numpy as np

from squealpipe.schema.claims import Verdict
from squealpipe.schema.dynamics.runs import EventFlag
from squealpipe.study.claims.checks.motions import events, scene
from squealpipe.study.claims.evidence import Finding, Run, finding
from squealpipe.study.claims.maps import share
from squealpipe.study.claims.statement import Rows

rows = Rows()

LEVELS = ("A1", "A2", "A3", "A4")

ABOVE = 1.0 + 1e-6
"""Peak force, in preloads, from which an impact presses harder than the mass at rest."""


@rows.add(
    "T1",
    "Table 1",
    "four model levels, each with its assumptions; where each assumption holds along the computed "
    "motions",
    "smallest share of scenes, over the levels, in which all of a level's assumptions held",
    "",
    Verdict.holds_only_as_printed,
)
def levels_have_assumptions(run: Run) -> Finding:
    """T1: how often each level's own assumptions held along the motion that it computes."""
    table = run["assumptions"].sel(level=list(LEVELS))
    broken = ((table.needed == 1) & (table.held == 0)).any("assumption")
    scenes = table.sizes["scene"]
    whole = {level: scenes - int(broken.sel(level=level).sum()) for level in LEVELS}
    counts = ", ".join(f"{level} {number}" for level, number in whole.items())
    turned = table.sel(assumption="angles are constant", level="A4")
    return finding(
        min(whole.values()) / scenes,
        "≥",
        1.0,
        f"Of {scenes} scenes, the own assumptions of a level held along the motion it computes in: "
        f"{counts}. In A4, which takes the angles as constant to {float(turned.limit):g} rad, a "
        f"spring turns by {float(turned.measure.min()):.2g} to {float(turned.measure.max()):.2g} "
        "rad.",
        otherwise=Verdict.holds_only_as_printed if whole["A1"] == scenes else Verdict.fails,
    )


@rows.add(
    "S1",
    "abstract, 3",
    "the pad loses contact and excites the disc with impulsive forces (hammering)",
    "returns to the belt after a loss of contact at (0.83π, 0.83π)",
    "fig02",
    Verdict.holds,
)
def hammering_occurs(run: Run) -> Finding:
    """S1: losses of contact, returns, how widespread they are, and how hard the impacts are."""
    motion = scene(run, "F2d")
    lost, found = events(motion, EventFlag.separation).size, events(motion, EventFlag.contact).size
    peak = float(motion.normalized_contact_force.max())
    hammering = run["hammering_map"]
    strikes = hammering.impact_rate > 0
    forces = hammering.peak_contact_force.values[strikes.values]
    harder = forces[forces > ABOVE]
    evidence = (
        f"At (0.83π, 0.83π) contact is lost {lost} times and regained {found} times, with forces "
        f"up to {peak:.3g} of the static preload. Over all angles the mass strikes the belt again "
        f"in {100 * share(strikes):.3g} % of {strikes.size} cells. "
    )
    if harder.size:
        evidence += (
            f"The force exceeds the static preload in {100 * harder.size / forces.size:.3g} % of "
            f"those, there up to {np.median(harder):.3g} (median) and {harder.max():.3g} (largest) "
            "times; in the others each return is a pulse from zero that does not exceed it."
        )
    elif forces.size:
        evidence += "The force exceeds the static preload in none of those."
    return finding(found, "≥", 2, evidence, also=lost > 0 and bool(strikes.any()))


@rows.add(
    "S2",
    "abstract, 4",
    "assumptions of earlier models (permanent contact, fixed spring angles) are not valid",
    "scenes in which A1 breaks each of the two, the smaller number",
    "fig02",
    Verdict.holds,
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


@rows.add(
    "S3",
    "abstract, 6",
    "the linear model has coupled modes (eigenvalues merge)",
    "cells with a complex pair of ω²",
    "fig06",
    Verdict.holds,
    consequence="S3",
)
def modes_couple(run: Run) -> Finding:
    """S3: eigenvalues merge (flutter) somewhere on the map."""
    flutter = run["stability_map"].regime_linear == 1
    return finding(
        int(flutter.sum()),
        ">",
        0,
        f"The two eigenvalues merge into a complex pair in {int(flutter.sum())} of "
        f"{flutter.size} cells ({100 * share(flutter):.2g} %).",
    )
