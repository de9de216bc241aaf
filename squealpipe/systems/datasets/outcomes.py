"""Outcomes of cells, points and runs: a reason, and a remedy where one exists."""

from enum import IntEnum
from typing import Self


class Outcome(IntEnum):
    """A reason with its remedy. No bare NaN: its reason is one of these."""

    remedy: str

    converged = 0, "none needed"
    separated = 1, "none needed: contact was lost and the question is answered"
    not_computed = 2, "none needed: this entry was not asked for"
    step_limit = (
        3,
        "too many steps: shorten t_end, or raise max_steps (branches: lower y_peak_max)",
    )
    event_limit = (
        4,
        "events accumulate (Zeno-like chatter); shorten t_end (cycles: t_settle)",
    )
    singular_geometry = (
        5,
        "the mass met a pivot (d = 0), where the spring force is undefined",
    )
    not_finite = 6, "the state overflowed; check the parameters"
    singular_static_state = 7, "no static state: the stiffness matrix is singular there"
    complex_pair = 8, "flutter: the pair is complex, omega holds |Im s|"
    divergence = 9, "ω² < 0: there is no oscillation at this mode, omega is 0"
    rigid_mode = 10, "ω = 0: the springs leave one direction free"
    linear_mode = 11, "below contact loss: the orbit is the linear mode"
    isolated_mode = (
        12,
        "the x mode is decoupled: y is constant and the branch is vertical",
    )
    no_convergence = 13, "Newton did not converge; try a smaller step or another start"
    order_changes = 14, "the order of the events changes, as `change` says"
    branch_lost = 15, "continuation could not go on; reduce its smallest step"
    pole = 16, "an internal resonance ω = ω_x/n ends the branch; ask for its other side"
    tongue_end = 17, "the branch closes on another one here"
    retraced = 18, "the branch turned back onto itself"
    grazing = 19, "contact is just touched: derivatives are one-sided"
    beyond_horizon = (
        20,
        "chaotic beyond the predictability horizon: trust statistics only",
    )
    infeasible = 21, "the sample breaks a statement of the paper"
    unresolved = 22, "the check could not decide; refine the grid or the horizon"
    real_multipliers = 23, "the torus curve ends: its multipliers meet on the real axis"
    amplitude_reached = 24, "none needed: the requested amplitude was reached"
    unconfirmed = (
        25,
        "no exact orbit is close to the series; more harmonics or method=exact",
    )
    other_branch = (
        26,
        "an exact orbit that does not lie on the mode's branch; see backbone",
    )
    equilibrium = 27, "at rest: no cycle from this start, or it has shrunk to a point"
    family_member = 28, "one of a family: without damping cycles are not isolated"
    no_doubling = 29, "no such period doubling on the branch; follow it further"
    inherited = (
        30,
        "not run: the answer is a neighbour's; see `inherited_error_interval`",
    )
    not_reached = 31, "no disturbance within the bound reaches it; raise bound or t_end"
    already_unstable = 32, "steady sliding is unstable: any disturbance grows"
    no_sliding_state = (
        33,
        "no steady sliding in contact found from r = 0 (belt at rest or N* ≤ 0)",
    )
    point_limit = 34, "the branch goes on: raise n_points"
    returned = (
        35,
        "the branch came back to its first parameter value, on another motion",
    )
    closed = 36, "the branch is a closed curve, followed once round"
    tangency = (
        37,
        "a surface is just touched, or stick ends: no similar motion continues the branch",
    )
    accumulation = (
        38,
        "events accumulate at the time reached: end there, or add a regime of rest",
    )
    unsettled = (
        39,
        "no settled cycle: chaos, a torus or slow; raise t_settle and max_steps, or give guess",
    )
    hidden_event = (
        40,
        "round-off hides the crossing: write the surface with a simple root (u instead of u**3)",
    )

    discontinuity = (
        41,
        "an expression jumps or has a pole at the time reached: make each side a regime",
    )
    period_unbounded = (
        42,
        "the period grows without bound: the branch ends in a homoclinic or heteroclinic orbit",
    )

    def __new__(cls, number: int, remedy: str = "") -> Self:
        """An outcome from its record."""
        outcome = int.__new__(cls, number)
        outcome._value_, outcome.remedy = number, remedy
        return outcome
