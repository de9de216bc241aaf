"""The paper's misprints and gaps: each printed form as a statement, with what it changes."""

import numpy as np

from squealpipe.brake.schema.backbones import Form
from squealpipe.paper.claims.checks import figures_6_and_7, figures_8_and_9
from squealpipe.paper.claims.checks.motions import scene
from squealpipe.paper.claims.datasets import PRINTED_SCENE
from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.maps import cell, coupling_is_negative, share, stiffness
from squealpipe.paper.claims.statement import StatementRows
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.schema import Outcome
from squealpipe.study.evidence import Evidence, MissingDataError

rows = StatementRows(figure="harmonic_forms", recorded=ClaimVerdict.fails)


GROUPS = ("k3/k", "μ", "L/l_pre", "V/(l_pre √(k/m))")
"""The dimensionless groups on which all results depend."""
READ_IN_THE_PAPER: tuple[str, ...] = ()
"""Those of them whose values the paper prints: read by hand, so E9 is no result of a dataset."""


@rows.add(
    "E1",
    "friction with μ(V_r) = μ sgn(V_r), V_r = ẋ − V, drags the mass along, as in Eqs."
    " (6), (9), (18), (20)",
    figure="fig01",
    section="4, Eq. (4)",
)
def friction_drags_along(run: Evidence) -> Finding:
    """Mean x with the printed sign, in the direction of the static state, over l_pre."""
    printed = float(scene(run, PRINTED_SCENE).x.mean() / run.parameters.preload)
    static = float(
        cell(run, "quasi_static_map", 0.5, 1.0).x_static / run.parameters.preload
    )
    return finding(
        (printed * np.sign(static), ">", 0),
        f"At (0.5π, π) the mass rests on average at x = {printed:.3g} l_pre with the printed sign; "
        f"Eq. (15), from the paper's own linear equations, has {static:.3g} l_pre.",
    )


@rows.add(
    "E2",
    "with K11·a + K12·b, Eq. (34) is the residual of Eq. (32)",
    section="7, Eq. (34)",
)
def printed_residual_converges_right(run: Evidence) -> Finding:
    """Largest relative error of ω with the printed residual."""
    forms = run["harmonic_forms"]
    error = abs(forms.omega / forms.omega_exact - 1)
    converged = forms.outcome.sel(form=Form.as_printed) == Outcome.converged
    scaled = run.parameters.time_unit * forms.omega.sel(form=Form.as_printed)
    exact = run.parameters.time_unit * forms.omega_exact
    pairs = ", ".join(
        f"{a:.4f} instead of {b:.4f}"
        for a, b in zip(scaled.values, exact.values, strict=True)
    )
    # a relative error of ω that truncation and smoothing do not explain
    return finding(
        (float(error.sel(form=Form.as_printed).max()), "≤", 1e-3),
        f"As printed, ω √(m/k1) converges in {int(converged.sum())} of {converged.size} scenes, "
        f"to {pairs}; with K12·a + K22·b it is right to "
        f"{float(error.sel(form=Form.mended).max()):.1g}.",
    )


rows.add(
    "E3",
    "as printed, Eq. (11) is the condition for a positive contact force",
    figure="fig06",
    section="5, Eq. (11)",
)(figures_6_and_7.printed_bound_is_physical)


@rows.add(
    "E4",
    "X + X* moves the origin to the static state",
    figure="fig02",
    section="6, before Eq. (16)",
)
def shift_is_added(run: Evidence) -> Finding:
    """Distance of the mean y from −y*, against its distance from y*."""
    preload = run.parameters.preload
    mean = float(scene(run, "F2a").y.mean() / preload)
    static = float(cell(run, "quasi_static_map", 0.5, 1.0).y_static / preload)
    return finding(
        (abs(mean + static), "<", abs(mean - static)),
        f"With X + X* the motion would rest at y = {-static:.3g} l_pre, with X − X* at "
        f"{static:.3g} l_pre; in A1 at (0.5π, π) y oscillates about {mean:.3g} l_pre.",
    )


@rows.add("E5", "ω12 is a real frequency", figure="fig06", section="6, Eq. (12b)")
def coupling_frequency_is_real(run: Evidence) -> Finding:
    """Share of cells with K12 < 0."""
    negative = coupling_is_negative(run)
    return finding(
        (share(negative), "≤", 0),
        f"K12 is negative in {100 * share(negative):.3g} % of the cells, and ω12 imaginary there; "
        "only its square enters Eqs. (13)–(17).",
    )


@rows.add("E6", "N ≥ 2N_h samples are enough for Γ", section="7, Eq. (29)")
def samples_suffice(run: Evidence) -> Finding:
    """Columns of Γ minus its rank at N = 2N_h."""
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
        (columns - ranks[2 * harmonics], "≤", 0),
        f"At N_h = {harmonics}, Γ has {columns} columns but rank {ranks[2 * harmonics]} at "
        f"N = {2 * harmonics}; the rank is full at N = {enough}. Aliasing stays: shifting the "
        f"start's phase changes the largest y by {spread}.",
    )


@rows.add(
    "E7",
    "Newton's method of Eq. (35) has a regular Jacobian",
    section="7, Eqs. (31)–(36)",
)
def jacobian_is_regular(run: Evidence) -> Finding:
    """Columns of the Jacobian minus its rank."""
    forms = run["harmonic_forms"]
    deficits = forms.rank_deficit.sel(form=Form.mended)
    return finding(
        (int(deficits.min()), "≤", 0),
        f"At the solutions the Jacobian of Eq. (36) has more columns than its rank, by "
        f"{int(deficits.min())} or more in all {deficits.size} scenes: ω is one unknown too many "
        "and J has no inverse. Nor is the phase fixed: starts shifted in time end in solutions "
        f"whose ω differs by up to {float(forms.phase_spread_omega.max()):.1g}. Conditions on "
        "amplitude and phase, and continuation, are needed.",
    )


rows.add(
    "E8",
    "ω1 is maximal at α1 + α2 = 0.5nπ, for every n and in both contact states",
    figure="fig08",
    section="7",
    consequence="F8c",
)(figures_8_and_9.first_is_largest_on_lines)


@rows.add(
    "E9",
    "the paper prints the parameters that its results need",
    figure="parameter_inference",
    section="all",
)
def parameters_are_printed(run: Evidence) -> Finding:
    """How many of the four dimensionless groups the paper prints."""
    evidence = (
        "Read by hand in the paper, not computed: of "
        f"{', '.join(GROUPS)} it prints {', '.join(READ_IN_THE_PAPER) or 'none'}."
    )
    reading_in_words = {
        "as_printed": "as printed",
        "along_plus_x": "along +x",
        "along_minus_x": "along −x",
    }
    if "parameter_inference" in run:
        inference = run["parameter_inference"]
        counts = ", ".join(
            f"{int(each)} {reading_in_words[str(each.reading.item())]}"
            for each in inference.feasible_count
        )
        evidence += (
            f" Of {inference.sizes['sample']} parameter sets tried, those that agree with every "
            f"statement are, by the reading of the sign of friction: {counts}."
        )
    return finding((len(READ_IN_THE_PAPER), "≥", len(GROUPS)), evidence)


@rows.add(
    "E10",
    "Fig. 7 has a region of unstable motion without separation (black)",
    figure="fig07",
    section="6, Fig. 7",
    recorded=ClaimVerdict.holds_only_as_printed,
    consequence="F7_black",
)
def black_region_is_there(run: Evidence) -> Finding:
    """Cells that keep contact in A1 and are unstable in A3."""
    validity = run["validity_map"]
    unstable, kept = validity.regime_linear > 0, validity.separates == 0
    black = int((unstable & kept).sum())
    growing = int(
        (kept & (validity.response_growth >= WordsInNumbers.growth_threshold)).sum()
    )
    evidence = (
        f"Of the {int(unstable.sum())} cells that A3 calls unstable {black} keep contact in their "
        f"runs (the text's reading). Of the {int(kept.sum())} cells that keep it, |x| grows in "
        f"{growing} as fast as time or faster: it is {WordsInNumbers.growth_threshold:g} times as "
        f"large in the second half of the run as in the first (the caption's reading)."
    )
    if "validity_boundary" in run:
        within = int((unstable.values & run["validity_boundary"].kept.values).sum())
        evidence += f" Within the curves of the boundary lie {within} unstable cells."
    return finding((max(black, growing), ">", 0), evidence)


@rows.add(
    "E11",
    "A2's reaction force decides about the equilibrium of Eq. (15)",
    figure="fig06",
    section="5 and 6",
)
def reaction_is_that_of_equilibrium(run: Evidence) -> Finding:
    """Cells in which A2's R_n and the equilibrium's N* differ in sign."""
    sliding = run["quasi_static_map"]
    pushes = sliding.contact_force_static > 1e-12 * sliding.contact_force_static.max()
    known = sliding.outcome == 0
    refused = int((known & (sliding.possible == 0) & pushes).sum())
    allowed = int((known & (sliding.possible == 1) & ~pushes).sum())
    scene = cell(run, "quasi_static_map", 0.4, 0.6)
    load = run.parameters.k3 * run.parameters.preload
    return finding(
        (refused + allowed, "≤", 0),
        f"{refused} cells are not possible by A2 though the equilibrium of Eq. (15) presses on "
        f"the belt; {allowed} are possible though it does not. At (0.4π, 0.6π) "
        f"R_n = {float(scene.reaction_force) / load:.3g} and "
        f"N* = {float(scene.contact_force_static) / load + 0.0:.2g}, over the preload.",
    )


@rows.add(
    "E12",
    "the nondimensional equations exist at every pair of angles",
    figure="fig06",
    section="6, Eq. (12g)",
)
def nondimensional_time_exists(run: Evidence) -> Finding:
    """K11 at (0.5π, 0.5π), as a share of k1 + k2."""
    largest = run.parameters.k1 + run.parameters.k2
    k11 = float(cell(run, "quasi_static_map", 0.5, 0.5).stiffness_x) / largest
    # stiffnesses below this share of k1 + k2 are round-off and count as zero
    vanishing_stiffness = 4.0 * np.finfo(float).eps
    undefined = stiffness(run, "stiffness_x") <= vanishing_stiffness * largest
    return finding(
        (k11, ">", vanishing_stiffness),
        f"At (0.5π, 0.5π) K11, by which Eqs. (12)–(17) divide, is {k11:.1g} of k1 + k2; on the "
        f"grid it vanishes in {int(undefined.sum())} of {undefined.size} cells.",
    )
