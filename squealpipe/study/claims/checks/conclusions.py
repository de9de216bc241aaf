"""The paper's conclusions (sections 7 and 9)."""

import numpy as np
import xarray as xr

from squealpipe.codes import Event
from squealpipe.schema.claims import Verdict
from squealpipe.study.claims.checks import figures_6_and_7
from squealpipe.study.claims.checks.figures_10_to_13 import branch
from squealpipe.study.claims.checks.motions import events, frequency, scene
from squealpipe.study.claims.evidence import Finding, Run, finding
from squealpipe.study.claims.maps import order_turns_over, share, unstable_cells
from squealpipe.study.claims.statement import Rows

rows = Rows("9")

SAME_TREND = 0.1
"""Relative difference of frequencies up to which two descriptions show the same trend."""

DIFFERENCE = 0.1
"""Relative difference of an extreme from which leaving something out matters."""


@rows.add(
    "C1",
    "the modes switch when the surfaces separate",
    figure="fig13",
    recorded=Verdict.depends_on_the_parameters,
)
def modes_switch_at_separation(run: Run) -> Finding:
    """Share of cells in which the order of the x and y directions turns over at separation,
    K22 < K11 < K22 + k3.
    """
    switched = order_turns_over(run)
    return finding(
        (share(switched), ">", 0),
        f"The order of the directions turns over in {100 * share(switched):.3g} % of the cells, "
        "those with 0 < K11 − K22 < k3; in the others it is the same in contact and separated.",
        passed=Verdict.holds
        if bool(switched.all())
        else Verdict.depends_on_the_parameters,
    )


rows.add(
    "C2",
    "unstable motion occurs only where quasi-static sliding is impossible",
    figure="fig06",
    recorded=Verdict.holds_only_as_printed,
    consequence="F6b",
)(figures_6_and_7.unstable_only_without_sliding)


@rows.add(
    "C3",
    "time and frequency domain show the same trends",
    figure="fig10_to_12",
    section="7, 9",
)
def time_and_frequency_agree(run: Run) -> Finding:
    """Largest relative difference of the frequency in A1 from ω2 of A4."""
    differences, lines = [], []
    for name, twin in (("F2a", "F10"), ("F2b", "F11"), ("F2c", "F12")):
        measured = frequency(scene(run, name))
        predicted = float(branch(run, twin, 2).omega[0])
        differences.append(abs(measured / predicted - 1))
        lines.append(f"{measured:.4g} and {predicted:.4g}")
    lost = events(scene(run, "F2d"), Event.separation).size
    reached = float(branch(run, "F13", 1).y_peak.max()) / run.parameters.preload
    return finding(
        (max(differences), "≤", SAME_TREND),
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
def contact_loss_matters(run: Run) -> Finding:
    """Median relative change of the largest displacement in scenes that lose contact."""
    table = run["assumptions"]
    lost = table.held.sel(level="A1", assumption="contact is kept").values == 0
    changes = _relative_change(table[["largest_y", "largest_x"]].to_array()).max(
        "variable"
    )
    if not lost.any():
        return finding((0, ">", 0), "No scene loses contact.")
    changed, kept = changes.values[lost], changes.values[~lost]
    worst = table.scene.values[lost][changed.argmax()]
    return finding(
        (float(np.median(changed)), ">", DIFFERENCE),
        f"Without contact loss the largest displacement changes by {100 * changed.min():.2g} to "
        f"{100 * changed.max():.3g} % in the {lost.sum()} scenes that lose contact (most in "
        f"{worst}), and by at most {100 * kept.max(initial=0.0):.1g} % in the others.",
    )


@rows.add("C5", "the directions of the constraints decide stability", figure="fig07")
def directions_decide(run: Run) -> Finding:
    """Smaller of the shares of cells that keep and that lose contact."""
    lost = run["validity_map"].separates == 1
    unstable = unstable_cells(run)
    smaller = min(share(lost), 1 - share(lost))
    return finding(
        (smaller, ">", 0.05),
        f"At equal parameters the angles alone decide: contact is kept in "
        f"{100 * (1 - share(lost)):.3g} % of the cells and lost in the rest; A3 is unstable in "
        f"{100 * share(unstable):.2g} %.",
        also=bool(unstable.any()),
    )


def _relative_change(extreme: xr.DataArray) -> xr.DataArray:
    """Change of an extreme of A1 when contact cannot be lost, relative to A1's."""
    with_loss = extreme.sel(level="A1", drop=True)
    without = extreme.sel(level="A1-no-separation", drop=True)
    return abs(without - with_loss) / with_loss
