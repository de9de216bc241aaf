"""Statements on quasi-static sliding and linear stability (Figs. 6 and 7)."""

from squealpipe.paper.claims.checks.motions import scene, windows
from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.maps import (
    cell,
    on_grid_of,
    share,
    stiffness,
    unstable_cells,
    unstable_yet_sliding,
)
from squealpipe.paper.claims.statement import StatementRows
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.paper.schema.growth import Growth, GrowthRule, judge_growth
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.study.evidence import Evidence

rows = StatementRows("6", "fig06")


@rows.add(
    "F6a",
    "Eq. (11) bounds where quasi-static sliding exists",
    section="5",
    recorded=ClaimVerdict.fails,
)
def printed_bound_is_physical(run: Evidence) -> Finding:
    """Cells in which Eq. (11) as printed and the sign of the reaction force differ."""
    sliding = run["quasi_static_map"]
    differ = sliding.possible_as_printed != sliding.possible
    pushes = run.parameters.belt_direction * stiffness(run, "stiffness_xy")
    outside = int((differ & (pushes >= 0)).sum())
    return finding(
        (int(differ.sum()), "≤", 0),
        f"As printed, sliding is possible in {100 * share(sliding.possible_as_printed == 1):.3g} % "
        f"of the cells; the reaction force is positive in {100 * share(sliding.possible == 1):.3g} "
        f"%. The two differ in {int(differ.sum())} cells, {outside} of them with K12 sgn V ≥ 0.",
    )


def no_pressed_cell_is_unstable(run: Evidence) -> Finding:
    """Unstable cells with a positive reaction force."""
    return _unstable_and_sliding(run, 1)


@rows.add(
    "F6b",
    "every linearly unstable cell lies where quasi-static sliding is impossible",
    recorded=ClaimVerdict.holds_only_as_printed,
    consequence="F6b",
    physics=no_pressed_cell_is_unstable,
)
def unstable_only_without_sliding(run: Evidence) -> Finding:
    """Unstable cells that Eq. (11) allows; with one sign, those with a positive reaction force."""
    return _unstable_and_sliding(run, 0)


def _unstable_and_sliding(run: Evidence, which: int) -> Finding:
    counts = [int(cells.sum()) for cells in unstable_yet_sliding(run)]
    return finding(
        (counts[which], "≤", 0),
        f"Of {int(unstable_cells(run).sum())} unstable cells, {counts[0]} lie where Eq. (11) as "
        f"printed allows sliding, and {counts[1]} where the reaction force is positive.",
    )


def no_pressed_share_is_unstable(run: Evidence) -> Finding:
    """Share of cells with a positive reaction force that are unstable."""
    return _unstable_share(run, 1)


@rows.add(
    "F6c",
    "the system is stable wherever quasi-static sliding persists",
    recorded=ClaimVerdict.holds_only_as_printed,
    consequence="F6b",
    physics=no_pressed_share_is_unstable,
)
def stable_where_sliding(run: Evidence) -> Finding:
    """Share of cells that Eq. (11) allows that are unstable; with one sign, of those with a
    positive reaction force.
    """
    return _unstable_share(run, 0)


def _unstable_share(run: Evidence, which: int) -> Finding:
    sliding = run["quasi_static_map"]
    shares = [
        float(cells.sum() / max(int(allowed.sum()), 1))
        for cells, allowed in zip(
            unstable_yet_sliding(run),
            (sliding.possible_as_printed, sliding.possible),
            strict=True,
        )
    ]
    return finding(
        (shares[which], "≤", 0),
        f"Unstable are {100 * shares[0]:.2g} % of the cells that Eq. (11) as printed allows, and "
        f"{100 * shares[1]:.2g} % of those with a positive reaction force.",
    )


@rows.add(
    "F6d",
    "(0.4π, 0.6π) is linearly stable although A1 is not",
    recorded=ClaimVerdict.holds_only_as_printed,
)
def linearly_stable_but_not(run: Evidence) -> Finding:
    """Growth rate of A3 there, times the time unit."""
    rate = (
        float(cell(run, "stability_map", 0.4, 0.6).growth_rate)
        * run.parameters.time_unit
    )
    sizes = windows(run, scene(run, "F3_long"))
    early, *_, late = sizes
    growth = Growth(int(judge_growth(sizes)))
    # Growth rate, times the unit of time, up to which a linear motion does not grow: round-off
    smallest_rate = 1e-9
    undecided = growth is Growth.undecided and rate <= smallest_rate
    return finding(
        (rate, "≤", smallest_rate),
        f"A3's largest growth rate there is {rate:.1g}; in a long run of A1 |x| reaches "
        f"{early:.5g} l_pre in the first window of {GrowthRule.window:g} √(m/k1) "
        f"and {late:.5g} l_pre "
        "in the last.",
        also=growth is Growth.grows,
        otherwise=ClaimVerdict.cannot_be_decided if undecided else ClaimVerdict.fails,
    )


@rows.add(
    "F6e",
    "the linear model lets k3 pull as well as push, which the contact cannot: by how much, where",
)
def spring_pulls(run: Evidence) -> Finding:
    """Share of cells in which the linear model's k3 pulls."""
    pull = run["linear_pull"]
    stable = on_grid_of(run["stability_map"], pull).regime_linear == 0
    pulls = pull.lowest_contact_force < 0
    if not pulls.any():
        return finding(
            (0, ">", 0), "From rest the linear model's k3 pulls in none of the cells."
        )
    strongest = max(0.0, -float(pull.lowest_contact_force.where(stable).min()))
    fraction = float(pull.pulling_fraction.where(pulls).median())
    return finding(
        (share(pulls), ">", 0),
        f"From rest the linear model's k3 pulls in {100 * share(pulls):.3g} % of the cells, there "
        f"for {100 * fraction:.2g} % of the time (median), with up to {strongest:.3g} times the "
        "preload in linearly stable cells.",
    )


@rows.add(
    "F7a",
    "A3 is invalid wherever A1 separates; the region is large",
    figure="fig07",
    consequence="F7a",
)
def invalid_where_separated(run: Evidence) -> Finding:
    """Share of the angles at which A1 separates: within curves, or of the cells without them."""
    cells = run["validity_map"].separates == 1
    evidence = (
        f"A1 loses contact in the runs of {int(cells.sum())} of {cells.size} cells."
    )
    lost = share(cells)
    if "validity_boundary" in run:
        boundary = run["validity_boundary"]
        lost, error = 1.0 - float(boundary.kept_share), float(boundary.kept_share_error)
        evidence += (
            f" By the curves of its boundary it loses it in {100 * lost:.4g} % of the square of "
            f"angles, right to {100 * error:.1g} %."
        )
    return finding((lost, ">", WordsInNumbers.large_region), evidence)


@rows.add(
    "F7b",
    "the linear analysis cannot be used to decide the stability of this system",
    figure="fig07",
)
def linear_analysis_misleads(run: Evidence) -> Finding:
    """Share of cells in which A3's stability and A1's contact agree."""
    validity = run["validity_map"]
    lost = validity.separates == 1
    unstable = validity.regime_linear > 0
    agree = share(unstable == lost)
    # A3 would have to agree with A1 in 95 % of the cells to be of use
    return finding(
        (agree, "<", 0.95),
        f"A3 and A1 agree in {100 * agree:.3g} % of the cells: A3 calls "
        f"{int((~unstable & lost).sum())} cells stable that lose contact in A1, and "
        f"{int((unstable & ~lost).sum())} unstable that keep it.",
    )
