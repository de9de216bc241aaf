"""Statements on quasi-static sliding and linear stability (Figs. 6 and 7)."""

from __future__ import annotations

import xarray as xr

from squealpipe.claims.evidence import Finding, Run, finding
from squealpipe.claims.maps import cell, on_grid_of, share
from squealpipe.schema.claims import Verdict

GROWTH_OF_STABLE_CELL = 1e-9
"""Growth rates below this, times the time unit, are round-off of zero."""

LARGE_REGION = 0.5
"""Share of the angle map from which a region is called large."""

ADEQUATE_AGREEMENT = 0.95
"""Share of cells in which A3 would have to agree with A1 to be of use."""


GROWTH = 2.0
"""Ratio of |x| in the second half of a run to that in the first from which it is growing."""


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


def printed_bound_is_physical(run: Run) -> Finding:
    """F6a, E3: Eq. (11) as printed against a positive reaction force."""
    sliding = run["quasi_static_map"]
    differ = sliding.possible_as_printed != sliding.possible
    negative_coupling = _negative_coupling(run, sliding)
    outside = int((differ & ~negative_coupling).sum())
    return finding(
        int(differ.sum()),
        "≤",
        0,
        f"As printed, sliding is possible in {100 * share(sliding.possible_as_printed == 1):.3g} % "
        f"of the cells; the reaction force is positive in {100 * share(sliding.possible == 1):.3g} "
        f"%. The two differ in {int(differ.sum())} cells, {outside} of them with K12 ≥ 0.",
        otherwise=Verdict.fails if outside else Verdict.holds_only_as_printed,
    )


def unstable_only_without_sliding(run: Run) -> Finding:
    """F6b, C2: unstable cells that lie where sliding is possible, in both readings."""
    unstable, sliding = _unstable(run), run["quasi_static_map"]
    printed = int((unstable & (sliding.possible_as_printed == 1)).sum())
    physical = int((unstable & (sliding.possible == 1)).sum())
    return finding(
        physical,
        "≤",
        0,
        f"Of {int(unstable.sum())} unstable cells, {printed} lie where Eq. (11) as printed allows "
        f"sliding, but {physical} where the reaction force is positive.",
        otherwise=Verdict.fails if printed else Verdict.holds_only_as_printed,
    )


def stable_where_sliding(run: Run) -> Finding:
    """F6c: share of the cells with sliding that are unstable, in both readings."""
    unstable, sliding = _unstable(run), run["quasi_static_map"]
    printed, physical = (
        float(unstable.where(allowed == 1).mean())
        for allowed in (sliding.possible_as_printed, sliding.possible)
    )
    return finding(
        physical,
        "≤",
        0,
        f"Unstable are {100 * printed:.2g} % of the cells that Eq. (11) as printed allows, and "
        f"{100 * physical:.2g} % of those with a positive reaction force.",
        otherwise=Verdict.fails if printed > 0 else Verdict.holds_only_as_printed,
    )


def invalid_where_separated(run: Run) -> Finding:
    """F7a: share of the map on which A1 loses contact."""
    lost = run["validity_map"].separates == 1
    return finding(
        share(lost),
        ">",
        LARGE_REGION,
        f"A1 loses contact in {int(lost.sum())} of {lost.size} cells and keeps it in "
        f"{int((~lost).sum())}.",
    )


def linear_analysis_misleads(run: Run) -> Finding:
    """F7b: how often A3's "stable" comes with kept contact in A1, and the reverse."""
    validity = run["validity_map"]
    unstable = on_grid_of(run["stability_map"], validity).regime_linear > 0
    lost = validity.separates == 1
    agree = share(unstable == lost)
    return finding(
        agree,
        "<",
        ADEQUATE_AGREEMENT,
        f"A3 and A1 agree in {100 * agree:.3g} % of the cells: A3 calls "
        f"{int((~unstable & lost).sum())} cells stable that lose contact in A1, and "
        f"{int((unstable & ~lost).sum())} unstable that keep it.",
    )


def black_region_is_there(run: Run) -> Finding:
    """E10: cells of Fig. 7 that keep contact and are unstable, in both readings."""
    validity = run["validity_map"]
    unstable = on_grid_of(run["stability_map"], validity).regime_linear > 0
    black = unstable & (validity.separates == 0)
    growing = int((validity.response_growth > GROWTH).sum())
    return finding(
        max(int(black.sum()), growing),
        ">",
        0,
        f"Of the {int((validity.separates == 0).sum())} cells that keep contact in A1, "
        f"{int(black.sum())} are unstable by A3 (the text's reading) and {growing} have a growing "
        "response in A1 (the caption's reading).",
    )


def directions_decide(run: Run) -> Finding:
    """C5: both outcomes occur, by the angles alone."""
    lost = run["validity_map"].separates == 1
    unstable = _unstable(run)
    smaller = min(share(lost), 1 - share(lost))
    return finding(
        smaller,
        ">",
        0.05,
        f"At equal parameters the angles alone decide: contact is kept in "
        f"{100 * (1 - share(lost)):.3g} % of the cells and lost in the rest; A3 is unstable in "
        f"{100 * share(unstable):.2g} %.",
        also=bool(unstable.any()),
    )


def reaction_is_that_of_equilibrium(run: Run) -> Finding:
    """E11: A2's verdict (y = 0) against the contact force of the equilibrium of Eq. (15)."""
    sliding = run["quasi_static_map"]
    pushes = sliding.contact_force_static > 1e-12 * sliding.contact_force_static.max()
    known = sliding.outcome == 0
    refused = int((known & (sliding.possible == 0) & pushes).sum())
    allowed = int((known & (sliding.possible == 1) & ~pushes).sum())
    scene = cell(sliding, 0.4, 0.6)
    return finding(
        refused + allowed,
        "≤",
        0,
        f"{refused} cells are not possible by A2 though the equilibrium of Eq. (15) presses on "
        f"the belt; {allowed} are possible though it does not, among them (0.4π, 0.6π): "
        f"R_n = {float(scene.reaction_force):.3g}, "
        f"N* = {abs(float(scene.contact_force_static)):.2g}.",
    )


def coupling_frequency_is_real(run: Run) -> Finding:
    """E5: where K12 < 0, ω12 of Eq. (12b) is imaginary."""
    negative = _negative_coupling(run, run["quasi_static_map"])
    return finding(
        share(negative),
        "≤",
        0,
        f"K12 is negative in {100 * share(negative):.3g} % of the cells, so ω12 is imaginary "
        "there; only its square enters Eqs. (13)–(17).",
    )


def nondimensional_time_exists(run: Run) -> Finding:
    """E12: cells where K11 = 0, so that τ = ω11·t and Eqs. (13)–(17) do not exist."""
    sliding = run["quasi_static_map"]
    undefined = sliding.reaction_force.isnull()
    here = bool(cell(sliding, 0.5, 0.5).reaction_force.isnull())
    return finding(
        int(undefined.sum()),
        "≤",
        0,
        f"K11 = 0 in {int(undefined.sum())} cell of the map"
        + (", (0.5π, 0.5π): ω11 = 0 divides in Eqs. (12)–(17)." if here else "."),
    )


def _unstable(run: Run) -> xr.DataArray:
    unstable: xr.DataArray = run["stability_map"].regime_linear > 0
    return unstable


def _negative_coupling(run: Run, sliding: xr.Dataset) -> xr.DataArray:
    """K12 < 0, told from A2's reaction force, which is then below the actuation k3·l_pre."""
    actuation = run.parameters.k3 * run.parameters.preload
    ratio = sliding.reaction_force / actuation
    negative: xr.DataArray = (ratio >= 0) & (ratio < 1 - 1e-12)
    return negative
