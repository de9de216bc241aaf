"""The paper's statements as constraints on the parameters, each with a margin.

A margin is positive where the statement holds and dimensionless. Motions are those of A1 from
rest over the scenes' ``t_end``, on maps over :data:`squealpipe.parameters.HORIZON`.
"""

from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.codes import LinearRegime
from squealpipe.laws.dashpots import linear_damping
from squealpipe.laws.springs import geometry
from squealpipe.models import a2
from squealpipe.models.contact_system import contact_system
from squealpipe.models.damped import damped_system, is_undamped, stability
from squealpipe.parameters import SCENES, Scene
from squealpipe.schema import Outcome
from squealpipe.schema.dynamics.growth import GROWS, RULE, growth_margin
from squealpipe.schema.dynamics.runs import GROWTH_THRESHOLD
from squealpipe.schema.inference import (
    BOUND,
    JUMPS,
    LARGE_REGION,
    LITTLE,
    SAME_FORCE,
    Holds,
)
from squealpipe.tasks.inference.angle_maps import keeping_share, separating_share
from squealpipe.tasks.inference.candidates import Candidates, StatementMargin


class Stage(IntEnum):
    """Statements that are judged together; cheap ones come first."""

    linear = 0
    contact = 1
    level = 2
    bound = 3
    growth = 4
    maps = 5


class Constraint(NamedTuple):
    """One statement as a constraint on the parameters.

    Attributes:
        stage: with which others it is judged.
        criterion: what is checked, in words, with thresholds.
    """

    name: str
    stage: Stage
    criterion: str
    check: Callable[[Candidates], StatementMargin]


CONSTRAINTS: list[Constraint] = []
"""What the paper says of its figures, where it constrains the parameters: the functions below."""

Check = Callable[[Candidates], StatementMargin]


def constrains(name: str, stage: Stage, criterion: str) -> Callable[[Check], Check]:
    """Decorator of a check; the arguments are those of :class:`Constraint`."""

    def keep(check: Check) -> Check:
        CONSTRAINTS.append(Constraint(name, stage, criterion, check))
        return check

    return keep


@constrains(
    "F6d",
    Stage.linear,
    "A3 stable at (0.4π, 0.6π): undamped, μ sgn V < cot 0.4π and no flutter; margin det/(K11 k3), "
    "or disc/(trace/2)² in flutter; damped, less the growth rate times √(m/k1)",
)
def _linearly_stable(candidates: Candidates) -> StatementMargin:
    stiffness, _, invariants = candidates.linear(SCENES["F3"])
    fields = candidates.fields
    divergence = (
        invariants.determinant * fields["mass"] ** 2 / (stiffness.k11 * fields["k3"])
    )
    flutter = invariants.discriminant / invariants.half_trace**2
    margin = np.minimum(divergence, np.where(flutter < 0, flutter, np.inf))
    scene = np.array([SCENES["F3"].alpha1]), np.array([SCENES["F3"].alpha2])
    for i, params in enumerate(candidates.extended):
        if is_undamped(params):
            continue
        found = stability(damped_system(params, *scene))
        decay = -found.growth_rate[0] * params.time_unit
        # what decays or grows by no more than round-off is as without damping
        if found.regime[0] != LinearRegime.stable or decay > a2.FEW_ULPS:
            margin[i] = decay
    return _closed(margin)


@constrains(
    "F13",
    Stage.linear,
    "isolated x mode first at (3π/4, 3π/4) and second at (5π/6, 5π/6); margin of K11 against "
    "K22 + k3, over k1: 1 − κ at the latter; if coupled, −|K12|/k1 or, by unequal dashpots, "
    "−|C12|/√(m k1)",
)
def _modes_switched(candidates: Candidates) -> StatementMargin:
    fields = candidates.fields
    before = candidates.linear(SCENES["F12"]).stiffness
    after = candidates.linear(SCENES["F13"]).stiffness
    first = before.k22 + fields["k3"] - before.k11
    second = after.k11 - after.k22 - fields["k3"]
    by_springs = np.maximum(np.abs(before.k12), np.abs(after.k12))
    coupling = np.maximum(by_springs, _coupling_by_dashpots(fields))
    isolated = coupling <= a2.FEW_ULPS * fields["k1"]
    return _closed(
        np.where(isolated, np.minimum(first, second), -coupling) / fields["k1"]
    )


def _keeps_contact(name: str) -> Check:
    return lambda candidates: candidates.contact[name]


for _name in ("F2a", "F2b", "F2c"):
    constrains(_name, Stage.contact, "contact is kept; margin lowest N/(k3 l_pre)")(
        _keeps_contact(_name)
    )


@constrains(
    "F2d",
    Stage.contact,
    "contact is lost; margin −lowest N/(k3 l_pre) if the contact spring could pull",
)
def _loses_contact(candidates: Candidates) -> StatementMargin:
    lowest = candidates.contact["F2d"]
    return StatementMargin(-lowest.margin, lowest.outcome)


@constrains(
    "F2e",
    Stage.contact,
    f"lowest N/(k3 l_pre) of F2a to F2c within {LITTLE}; margin {LITTLE} − spread",
)
def _alike(candidates: Candidates) -> StatementMargin:
    runs = [candidates.contact[name] for name in ("F2a", "F2b", "F2c")]
    lowest = np.stack([np.maximum(run.margin, 0.0) for run in runs])
    return StatementMargin(
        LITTLE - np.ptp(lowest, axis=0), np.max([run.outcome for run in runs], axis=0)
    )


def _growth_and_size(
    candidates: Candidates, scene: Scene
) -> tuple[Any, Any, np.ndarray]:
    """ln of late over early |x| and of |x| over 2L, and how the runs ended."""
    run = candidates.run(scene)
    bound = BOUND * np.maximum(
        candidates.fields["length1"], candidates.fields["length2"]
    )
    size = np.maximum(run.early_max_x, run.late_max_x) / bound
    return np.log(run.late_max_x / run.early_max_x), np.log(size), run.outcome


@constrains(
    "F3",
    Stage.growth,
    f"largest |x|: {RULE}; margin ln(least ratio/{GROWS:g}), none where it is undecided",
)
def _grows(candidates: Candidates) -> StatementMargin:
    sizes, outcome = candidates.windows(SCENES["F3"])
    return StatementMargin(growth_margin(sizes), outcome)


@constrains(
    "F4",
    Stage.bound,
    f"|x| stays below 2L and its second half below {GROWTH_THRESHOLD:g} times the first; "
    f"margin min(ln(2L/|x|), ln({GROWTH_THRESHOLD:g}/growth))",
)
def _stays_bounded(candidates: Candidates) -> StatementMargin:
    growth, size, outcome = _growth_and_size(candidates, SCENES["F4"])
    return StatementMargin(
        np.minimum(np.log(GROWTH_THRESHOLD) - growth, -size), outcome
    )


@constrains(
    "F5a",
    Stage.level,
    f"peak force and time off the belt at (π, π) and (0, 0) differ by d < {SAME_FORCE}; "
    f"margin ({SAME_FORCE} − d)/({SAME_FORCE} + d)",
)
def _same_levels(candidates: Candidates) -> StatementMargin:
    first, second = candidates.level, candidates.run(SCENES["F5b"])
    force = np.abs(first.peak_contact_force - second.peak_contact_force)
    share = np.abs(first.separated_time - second.separated_time) / first.time
    difference = np.maximum(force, share)
    margin = (SAME_FORCE - difference) / (SAME_FORCE + difference)
    return StatementMargin(margin, np.maximum(first.outcome, second.outcome))


@constrains(
    "F5b",
    Stage.level,
    f"at least {JUMPS} separations at (π, π); margin (separations − {JUMPS - 0.5})/{JUMPS}",
)
def _jumps(candidates: Candidates) -> StatementMargin:
    run = candidates.level
    return StatementMargin((run.separations - (JUMPS - 0.5)) / JUMPS, run.outcome)


@constrains(
    "F6b_printed",
    Stage.maps,
    "no unstable cell fulfils Eq. (11) taken literally, μ < K11/K12; margin 1, or −their share of "
    "the unstable cells",
)
def _unstable_only_without_sliding(candidates: Candidates) -> StatementMargin:
    shares = []
    for params, cells in zip(candidates.sets, candidates.unstable, strict=True):
        springs = contact_system(params, cells.alpha1, cells.alpha2).stiffness
        allowed = a2.possible_as_printed(springs, abs(params.drag))
        shares.append(allowed.mean() if allowed.any() else -1.0)
    return _closed(-np.array(shares))


@constrains(
    "F7a",
    Stage.maps,
    "A1 separates in more than half of the angle map; margin share/½ − 1",
)
def _separates_mostly(candidates: Candidates) -> StatementMargin:
    return _closed(separating_share(candidates) / LARGE_REGION - 1.0)


@constrains(
    "F7_black",
    Stage.maps,
    "A1 keeps contact in an unstable cell of A3, the black region; margin share of such cells "
    "around the disc of flutter, 5 % inside, or −1",
)
def _unstable_in_contact(candidates: Candidates) -> StatementMargin:
    share = keeping_share(candidates)
    return _closed(np.where(share > 0, share, -1.0))


def _coupling_by_dashpots(fields: Mapping[str, np.ndarray]) -> np.ndarray:
    """Largest |C12| √(k1/m) at the scenes of Figs. 12 and 13, N/m: as stiff as K12 at √(k1/m)."""
    p = SimpleNamespace(**{"damping1": 0.0, "damping2": 0.0, **fields})
    scenes = SCENES["F12"], SCENES["F13"]
    c12 = [
        linear_damping(p, geometry(scene.alpha1, scene.alpha2)).k12 for scene in scenes
    ]
    return np.asarray(np.max(np.abs(c12), axis=0) * np.sqrt(p.k1 / p.mass))


def _closed(margin: np.ndarray) -> StatementMargin:
    return StatementMargin(
        margin, np.full(np.shape(margin), int(Outcome.converged), np.int8)
    )


def measure(
    candidates: Candidates, stages: Iterable[Stage] = Stage
) -> dict[str, StatementMargin]:
    """The margin of every statement of some stages, for every candidate."""
    return {
        each.name: each.check(candidates)
        for each in CONSTRAINTS
        if each.stage in stages
    }


def verdicts(found: StatementMargin) -> np.ndarray:
    """:class:`squealpipe.schema.inference.Holds` of each candidate."""
    decided = (found.outcome == Outcome.converged) & np.isfinite(found.margin)
    return np.where(decided, found.margin > 0, int(Holds.undecided))


def judge(
    candidates: Candidates, *, failures: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Margins and verdicts (``Holds``), both (size, statement).

    A set that more than ``failures`` statements have refuted goes to no further stage: there its
    margins are NaN and its verdicts ``not_judged``.
    """
    margin = np.full((candidates.size, len(CONSTRAINTS)), np.nan)
    holds = np.full(margin.shape, int(Holds.not_judged), np.int8)
    for stage in Stage:
        left = np.flatnonzero((holds == Holds.no).sum(axis=1) <= failures)
        if not left.size:
            break
        measured = measure(candidates.subset(left), [stage])
        for column, constraint in enumerate(CONSTRAINTS):
            if constraint.stage == stage:
                margin[left, column] = measured[constraint.name].margin
                holds[left, column] = verdicts(measured[constraint.name])
    return margin, holds
