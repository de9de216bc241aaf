"""The paper's conclusions (sections 7 and 9)."""

import numpy as np
import xarray as xr

from squealpipe.codes import Event
from squealpipe.paper.claims.checks import figures_6_and_7
from squealpipe.paper.claims.checks.figures_10_to_13 import branch
from squealpipe.paper.claims.checks.motions import events, frequency, scene
from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.maps import cell, order_turns_over, share, unstable_cells
from squealpipe.paper.claims.statement import StatementRows
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.study.evidence import Evidence

rows = StatementRows("9")


@rows.add(
    "C1",
    "the modes switch when the surfaces separate",
    figure="fig13",
    recorded=ClaimVerdict.fails,
)
def modes_switch_at_separation(run: Evidence) -> Finding:
    """Share of the paper's scenes, Figs. 10 to 13, in which the order of the x and y directions
    turns over at separation, K22 < K11 < K22 + k3.
    """
    # Angles over π of the scenes of Figs. 10 to 13
    responses = ((0.5, 1.0), (1.0, 0.5), (0.75, 0.75), (5 / 6, 5 / 6))
    switched = [
        bool(order_turns_over(run, cell(run, "quasi_static_map", *angles)))
        for angles in responses
    ]
    plane = share(order_turns_over(run, run["quasi_static_map"]))
    at_last = cell(run, "quasi_static_map", *responses[-1])
    softer = float(at_last.stiffness_x - at_last.stiffness_y) / run.parameters.k3
    return finding(
        (sum(switched) / len(switched), "≥", 1.0),
        f"At separation the order turns over in {sum(switched)} of {len(switched)} scenes. At "
        f"(5π/6, 5π/6) K11 − K22 is {softer:.3g} k3; the order turns over where that lies "
        f"between 0 and k3. Over all angles it does so in {100 * plane:.3g} % of the cells.",
    )


rows.add(
    "C2",
    "unstable motion occurs only where quasi-static sliding is impossible",
    figure="fig06",
    recorded=ClaimVerdict.holds_only_as_printed,
    consequence="F6b",
    physics=figures_6_and_7.no_pressed_cell_is_unstable,
)(figures_6_and_7.unstable_only_without_sliding)


@rows.add(
    "C3",
    "time and frequency domain show the same trends",
    figure="fig10_to_12",
    section="7, 9",
)
def time_and_frequency_agree(run: Evidence) -> Finding:
    """Largest relative difference of the frequency in A1 from ω2 of A4."""
    differences, lines = [], []
    for name, twin in (("F2a", "F10"), ("F2b", "F11"), ("F2c", "F12")):
        measured = frequency(scene(run, name))
        predicted = float(branch(run, twin, 2).omega[0])
        differences.append(abs(measured / predicted - 1))
        lines.append(f"{measured:.4g} and {predicted:.4g}")
    lost = events(scene(run, "F2d"), Event.separation).size
    reached = float(branch(run, "F13", 1).y_peak.max()) / run.parameters.preload
    # two descriptions whose frequencies agree to 10 % show the same trend
    return finding(
        (max(differences), "≤", 0.1),
        f"Frequency of the contact force in A1 and ω2 of A4, in rad/s: {'; '.join(lines)} "
        f"(Figs. 2a–c and 10–12). In the fourth configuration A1 loses contact {lost} times "
        f"(Fig. 2d), and y reaches {reached:.3g} l_pre on A4's first mode (Fig. 13).",
        also=lost > 0 and reached > 1,
    )


@rows.add(
    "C4",
    "the contact loss must not be left out (A1 against A1 without separation)",
    figure="fig02",
)
def contact_loss_matters(run: Evidence) -> Finding:
    """Median relative change of the largest distance from the start, √(x² + y²), in scenes that
    lose contact.
    """
    table = run["assumptions"]
    lost = table.held.sel(level="A1", assumption="contact is kept").values == 0
    changes = _relative_change(table.max_displacement).values
    if not lost.any():
        return finding((0, ">", 0), "No scene loses contact.")
    changed, kept = changes[lost], changes[~lost]
    listed = ", ".join(
        f"{name} {100 * change:.2g} %"
        for name, change in zip(table.scene.values[lost], changed, strict=True)
    )
    median = float(np.median(changed))
    # leaving something out matters from a change of 10 % of an extreme
    return finding(
        (median, ">", 0.1),
        f"Without contact loss the largest distance from the start, √(x² + y²), changes by "
        f"{100 * median:.2g} % in the median of the {lost.sum()} scenes that lose contact "
        f"({listed}), and by at most {100 * kept.max(initial=0.0):.1g} % in the others.",
    )


@rows.add("C5", "the directions of the constraints decide stability", figure="fig06")
def directions_decide(run: Evidence) -> Finding:
    """Smaller of the shares of cells that are stable and unstable by A3."""
    unstable = share(unstable_cells(run))
    return finding(
        (min(unstable, 1 - unstable), ">", 0),
        f"At equal parameters the angles alone make A3 unstable in {100 * unstable:.2g} % of the "
        "cells and leave it stable in the rest.",
    )


def _relative_change(extreme: xr.DataArray) -> xr.DataArray:
    """Change of an extreme of A1 when contact cannot be lost, relative to A1's."""
    with_loss = extreme.sel(level="A1", drop=True)
    without = extreme.sel(level="A1-no-separation", drop=True)
    return abs(without - with_loss) / with_loss
