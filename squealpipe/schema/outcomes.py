"""Why a cell, point or run holds what it holds, and what helps."""

from enum import IntEnum


class Outcome(IntEnum):
    """Why a cell, point or run holds what it holds. No bare NaN: its reason is one of these."""

    converged = 0
    separated = 1
    not_computed = 2
    step_limit = 3
    event_limit = 4
    singular_geometry = 5
    not_finite = 6
    singular_static_state = 7
    complex_pair = 8
    divergence = 9
    rigid_mode = 10
    linear_mode = 11
    isolated_mode = 12
    no_convergence = 13
    branch_lost = 15
    pole = 16
    tongue_end = 17
    retraced = 18
    grazing = 19
    beyond_horizon = 20
    infeasible = 21
    unresolved = 22
    amplitude_reached = 24
    unconfirmed = 25
    other_branch = 26
    equilibrium = 27
    family_member = 28
    no_doubling = 29
    inherited = 30
    not_reached = 31
    already_unstable = 32
    no_sliding_state = 33
    point_limit = 34
    returned = 35
    closed = 36
    tangency = 37
    accumulation = 38


REMEDIES: dict[Outcome, str] = {
    Outcome.converged: "none needed",
    Outcome.separated: "none needed: contact was lost and the question is answered",
    Outcome.not_computed: "nothing was asked of it",
    Outcome.step_limit: "too many steps: shorten t_end (cycles: t_settle; branches: y_peak_max)",
    Outcome.event_limit: "events accumulate (Zeno-like chatter); shorten t_end (cycles: t_settle)",
    Outcome.singular_geometry: "the mass met a pivot (d = 0), where the spring force is undefined",
    Outcome.not_finite: "the state overflowed; check the parameters",
    Outcome.singular_static_state: "no static state: the stiffness matrix is singular there",
    Outcome.complex_pair: "flutter: the pair is complex, omega holds |Im s|",
    Outcome.divergence: "ω² < 0: there is no oscillation at this mode, omega is 0",
    Outcome.rigid_mode: "ω = 0: the springs leave one direction free",
    Outcome.linear_mode: "below contact loss: the orbit is the linear mode",
    Outcome.isolated_mode: "the x mode is decoupled: y is constant and the branch is vertical",
    Outcome.no_convergence: "Newton did not converge; try a smaller step or another start",
    Outcome.branch_lost: "continuation could not go on; reduce its smallest step",
    Outcome.pole: "an internal resonance ω = ω_x/n ends the branch; ask for its other side",
    Outcome.tongue_end: "the branch closes on another one here",
    Outcome.retraced: "the branch turned back onto itself",
    Outcome.grazing: "contact is just touched: derivatives are one-sided",
    Outcome.beyond_horizon: "chaotic beyond the predictability horizon: trust statistics only",
    Outcome.infeasible: "the sample breaks a statement of the paper",
    Outcome.unresolved: "the check could not decide; refine the grid or the horizon",
    Outcome.amplitude_reached: "the asked amplitude was reached",
    Outcome.unconfirmed: "no exact orbit is close to the series; more harmonics or method=exact",
    Outcome.no_doubling: "no such period doubling on the branch; follow it further",
    Outcome.other_branch: "an exact orbit, not reached along the mode's branch; see backbone",
    Outcome.equilibrium: "at rest: no cycle from this start, or it has shrunk to a point",
    Outcome.family_member: "one of a family: without damping cycles are not isolated",
    Outcome.inherited: "not run: the answer is a neighbour's; see `inherited_error`",
    Outcome.not_reached: "by no disturbance tried within the bound; raise bound or t_end",
    Outcome.already_unstable: "steady sliding is unstable: any disturbance grows",
    Outcome.no_sliding_state: "no steady sliding in contact was found from r = 0 (none exists "
    "with a belt at rest or N* ≤ 0)",
    Outcome.point_limit: "the branch goes on: raise n_points",
    Outcome.returned: "the branch came back to its first parameter value, on another motion",
    Outcome.closed: "the branch is a closed curve, followed once round",
    Outcome.accumulation: "events accumulate: the limit is the time reached; end there, or add a "
    "regime of rest",
    Outcome.tangency: "a surface is just touched, or stick ends so: no motion like it follows",
}
