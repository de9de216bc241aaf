"""The paper's misprints and gaps: each printed form as a statement, with what it changes."""

from __future__ import annotations

from squealpipe.claims import frequencies, misprint_checks, sliding
from squealpipe.claims.statement import Statement
from squealpipe.schema.claims import Verdict

MISPRINTS = (
    Statement(
        id="E1",
        section="4, Eq. (4)",
        text="friction with μ(V_r) = μ sgn(V_r), V_r = ẋ − V, drags the mass along, as in "
        "Eqs. (6), (9), (18), (20)",
        measure="mean x with the printed sign, in the direction of the static state, over l_pre",
        figure="fig01",
        recorded=Verdict.fails,
        check=misprint_checks.friction_drags_along,
    ),
    Statement(
        id="E2",
        section="7, Eq. (34)",
        text="with K11·a + K12·b, Eq. (34) is the residual of Eq. (32)",
        measure="largest relative error of ω with the printed residual",
        figure="harmonic_forms",
        recorded=Verdict.fails,
        check=misprint_checks.printed_residual_converges_right,
    ),
    Statement(
        id="E3",
        section="5, Eq. (11)",
        text="as printed, Eq. (11) is the condition for a positive contact force",
        measure="cells in which the printed condition and the sign of the reaction force differ",
        figure="fig06",
        recorded=Verdict.holds_only_as_printed,
        check=sliding.printed_bound_is_physical,
    ),
    Statement(
        id="E4",
        section="6, before Eq. (16)",
        text="X + X* moves the origin to the static state",
        measure="distance of the mean y from −y*, against its distance from y*",
        figure="fig02",
        recorded=Verdict.fails,
        check=misprint_checks.shift_is_added,
    ),
    Statement(
        id="E5",
        section="6, Eq. (12b)",
        text="ω12 is a real frequency",
        measure="share of cells with K12 < 0",
        figure="fig06",
        recorded=Verdict.fails,
        check=sliding.coupling_frequency_is_real,
    ),
    Statement(
        id="E6",
        section="7, Eq. (29)",
        text="N ≥ 2N_h samples are enough for Γ",
        measure="columns of Γ minus its rank at N = 2N_h",
        figure="harmonic_forms",
        recorded=Verdict.fails,
        check=misprint_checks.samples_suffice,
    ),
    Statement(
        id="E7",
        section="7, Eqs. (31)–(36)",
        text="Newton's method of Eq. (35) has a regular Jacobian",
        measure="columns of the Jacobian minus its rank",
        figure="harmonic_forms",
        recorded=Verdict.fails,
        check=misprint_checks.jacobian_is_regular,
    ),
    Statement(
        id="E8",
        section="7",
        text="ω1 is maximal at α1 + α2 = 0.5nπ, for every n and in both contact states",
        measure="excess of the largest ω1² over that on the lines",
        figure="fig08",
        recorded=Verdict.holds_only_as_printed,
        check=frequencies.first_is_largest_on_lines,
    ),
    Statement(
        id="E9",
        section="all",
        text="the paper prints the parameters that its results need",
        measure="parameter sets that agree with all statements",
        figure="parameter_inference",
        recorded=Verdict.fails,
        check=misprint_checks.parameters_are_printed,
    ),
    Statement(
        id="E10",
        section="6, Fig. 7",
        text="Fig. 7 has a region of unstable motion without separation (black)",
        measure="cells that keep contact in A1 and are unstable in A3",
        figure="fig07",
        recorded=Verdict.fails,
        check=sliding.black_region_is_there,
    ),
    Statement(
        id="E11",
        section="5 and 6",
        text="A2's reaction force decides about the equilibrium of Eq. (15)",
        measure="cells in which A2's R_n and the equilibrium's N* differ in sign",
        figure="static_state",
        recorded=Verdict.fails,
        check=sliding.reaction_is_that_of_equilibrium,
    ),
    Statement(
        id="E12",
        section="6, Eq. (12g)",
        text="the nondimensional equations exist at every pair of angles",
        measure="cells with K11 = 0",
        figure="fig06",
        recorded=Verdict.fails,
        check=sliding.nondimensional_time_exists,
    ),
)
