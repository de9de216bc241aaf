"""The paper's statements as constraints on the parameters, each with a margin.

A margin is positive where the statement holds and dimensionless. Motions are those of A1 from
rest over the scenes' ``t_end``, on maps over :data:`squealpipe.parameters.HORIZON`.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import wraps
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.models import a2
from squealpipe.brake.models.damped import damped_system, is_undamped, stability
from squealpipe.codes import LinearRegime
from squealpipe.laws.dashpots import linear_damping
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.paper.inference.angle_maps import keeping_share, separating_share
from squealpipe.paper.inference.candidates import Candidates, StatementMargin
from squealpipe.paper.schema.growth import RULE, GrowthRule, growth_margin
from squealpipe.paper.schema.inference import Holds, WordsInNumbers
from squealpipe.parameters import SCENES, Scene
from squealpipe.schema import Outcome


class Stage(IntEnum):
    """Statements that are judged together; cheap ones, and those that refute most, come first.

    Milliseconds for one set, and how many of 100 sets are left: contact 0.2, 55 to 85; level 0.1,
    75; bound 0.2, 95; black 1.6, 25 to 45; maps 3.3, 85; growth 4 to 9, 0 to 85.
    """

    linear = 0
    printed = 1
    contact = 2
    level = 3
    bound = 4
    black = 5
    maps = 6
    growth = 7


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


@dataclass(frozen=True)
class SeveralStarts:
    """Judge a statement whose measure depends on round-off from several starts.

    A chaotic run of 6,000 √(m/k1) forgets its start. Its size in a window is then chance, and so is
    a verdict near the threshold: the last bit of another processor may change it. Such a statement
    holds or fails only if it does from several starts that nobody can tell apart.

    Attributes:
        apart: displacement of the others from the first, over l_pre.
        directions: of the displacement, (x, y), so that there are five starts with the first one.
            All have both components, since some scenes keep motions along one axis to it.
        alike: if the margins of two starts differ by less than this share, no third one is run: the
            motion is regular, or chance does not carry it over the threshold.
        near: margin below which starts are compared even if the motion is short and regular.
    """

    apart: float = 1e-9
    directions: tuple[tuple[int, int], ...] = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    alike: float = 0.1
    near: float = 1e-6

    def moved(self, candidates: Candidates, number: int) -> Candidates:
        """The sets from another start."""
        x, y = (self.apart * np.sqrt(0.5) * c for c in self.directions[number])
        return candidates.moved(x, y)


registered_constraints: list[Constraint] = []
"""Statements of the paper on its figures that constrain the parameters: the functions below."""

Check = Callable[[Candidates], StatementMargin]


def constrains(name: str, stage: Stage, criterion: str) -> Callable[[Check], Check]:
    """Decorator of a check; the arguments are those of :class:`Constraint`."""

    def keep(check: Check) -> Check:
        registered_constraints.append(Constraint(name, stage, criterion, check))
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
        linear = stability(damped_system(params, *scene))
        decay = -linear.growth_rate[0] * params.time_unit
        # what decays or grows by no more than round-off is as without damping
        if linear.regime[0] != LinearRegime.stable or decay > a2.FEW_ULPS:
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


def from_several_starts(check: Check) -> Check:
    """Decorator of a check of long motions, which may be chaotic: see :class:`SeveralStarts`."""

    @wraps(check)
    def judged(candidates: Candidates) -> StatementMargin:
        if candidates.sampled:
            return check(candidates)
        pairs = candidates.joined(SeveralStarts().moved(candidates, 0))
        both = check(replace(pairs, paired=True))
        first, second = (
            StatementMargin(*each)
            for each in zip(
                np.split(both.margin, 2), np.split(both.outcome, 2), strict=True
            )
        )
        margins = [first.margin, second.margin]
        with np.errstate(invalid="ignore"):
            change = np.abs(margins[1] - margins[0])
            regular = change <= SeveralStarts.alike * np.min(np.abs(margins), axis=0)
        return _agreed(check, candidates, first, np.flatnonzero(~regular), second)

    return judged


def compared_near_the_threshold(check: Check) -> Check:
    """Decorator of a check of short, regular motions: starts are compared at the threshold."""

    @wraps(check)
    def judged(candidates: Candidates) -> StatementMargin:
        first = check(candidates)
        near = np.flatnonzero(np.abs(first.margin) < SeveralStarts.near)
        return _agreed(check, candidates, first, near)

    return judged


def _agreed(
    check: Check,
    candidates: Candidates,
    first: StatementMargin,
    rows: np.ndarray,
    second: StatementMargin | None = None,
) -> StatementMargin:
    """Return the margins of the first start, NaN where other starts of these rows disagree.

    The other starts run side by side, which costs little more than one of them.

    Args:
        second: of the first of the other starts, of all rows, if it is known.
    """
    margin, mine = first.margin.copy(), verdicts(first)
    others = range(len(SeveralStarts.directions))
    if second is not None:  # one start that disagrees says enough
        agree = verdicts(second)[rows] == mine[rows]
        margin[rows[~agree]] = np.nan
        rows, others = rows[agree], others[1:]
    if rows.size:
        some = candidates.subset(rows)
        starts = [SeveralStarts().moved(some, number) for number in others]
        answers = verdicts(check(starts[0].joined(*starts[1:])))
        differ = answers.reshape(len(starts), -1) != mine[rows]
        margin[rows[differ.any(axis=0)]] = np.nan
    return StatementMargin(margin, first.outcome)


def _keeps_contact(name: str) -> Check:
    return compared_near_the_threshold(lambda candidates: candidates.contact[name])


for _name in ("F2a", "F2b", "F2c"):
    constrains(_name, Stage.contact, "contact is kept; margin lowest N/(k3 l_pre)")(
        _keeps_contact(_name)
    )


@constrains(
    "F2d",
    Stage.contact,
    "contact is lost; margin −lowest N/(k3 l_pre) if the contact spring could pull",
)
@compared_near_the_threshold
def _loses_contact(candidates: Candidates) -> StatementMargin:
    lowest = candidates.contact["F2d"]
    return StatementMargin(-lowest.margin, lowest.outcome)


@constrains(
    "F2e",
    Stage.contact,
    f"lowest N/(k3 l_pre) of F2a to F2c within {WordsInNumbers.minimal_difference}; "
    f"margin {WordsInNumbers.minimal_difference} − spread",
)
@compared_near_the_threshold
def _alike(candidates: Candidates) -> StatementMargin:
    runs = [candidates.contact[name] for name in ("F2a", "F2b", "F2c")]
    lowest = np.stack([np.maximum(run.margin, 0.0) for run in runs])
    return StatementMargin(
        WordsInNumbers.minimal_difference - np.ptp(lowest, axis=0),
        np.max([run.outcome for run in runs], axis=0),
    )


def _growth_and_size(
    candidates: Candidates, scene: Scene
) -> tuple[Any, Any, np.ndarray]:
    """ln of late over early |x| and of |x| over 2L, and how the runs ended."""
    run = candidates.run(scene, tracked="x")
    bound = WordsInNumbers.bounded_within * np.maximum(
        candidates.fields["length1"], candidates.fields["length2"]
    )
    size = np.maximum(run.early_max_x, run.late_max_x) / bound
    return np.log(run.late_max_x / run.early_max_x), np.log(size), run.outcome


@constrains(
    "F3",
    Stage.growth,
    f"largest |x|: {RULE}; margin ln(least ratio/{GrowthRule.least_ratio:g}), "
    "none where starts 1e-9 "
    "l_pre apart disagree",
)
@from_several_starts
def _grows(candidates: Candidates) -> StatementMargin:
    sizes, outcome = candidates.windows(SCENES["F3"])
    return StatementMargin(growth_margin(sizes), outcome)


@constrains(
    "F4",
    Stage.bound,
    f"|x| stays below 2L and its second half below "
    f"{WordsInNumbers.growth_threshold:g} times the first; "
    f"margin min(ln(2L/|x|), ln({WordsInNumbers.growth_threshold:g}/growth)), "
    f"none where starts 1e-9 l_pre apart "
    "disagree",
)
@from_several_starts
def _stays_bounded(candidates: Candidates) -> StatementMargin:
    growth, size, outcome = _growth_and_size(candidates, SCENES["F4"])
    return StatementMargin(
        np.minimum(np.log(WordsInNumbers.growth_threshold) - growth, -size), outcome
    )


@constrains(
    "F5a",
    Stage.level,
    f"peak force and time off the belt at (π, π) and (0, 0) differ by d < "
    f"{WordsInNumbers.same_force}; margin ({WordsInNumbers.same_force} − d)/"
    f"({WordsInNumbers.same_force} + d)",
)
def _same_levels(candidates: Candidates) -> StatementMargin:
    first, second = candidates.level, candidates.run(SCENES["F5b"])
    force = np.abs(first.peak_contact_force - second.peak_contact_force)
    share = np.abs(first.separated_time - second.separated_time) / first.time
    difference = np.maximum(force, share)
    margin = (WordsInNumbers.same_force - difference) / (
        WordsInNumbers.same_force + difference
    )
    return StatementMargin(margin, np.maximum(first.outcome, second.outcome))


@constrains(
    "F5b",
    Stage.level,
    f"at least {WordsInNumbers.again_and_again} separations at (π, π); "
    f"margin (separations − {WordsInNumbers.again_and_again - 0.5})/"
    f"{WordsInNumbers.again_and_again}",
)
def _jumps(candidates: Candidates) -> StatementMargin:
    run = candidates.level
    return StatementMargin(
        (run.separations - (WordsInNumbers.again_and_again - 0.5))
        / WordsInNumbers.again_and_again,
        run.outcome,
    )


@constrains(
    "F6b_printed",
    Stage.printed,
    "no unstable cell fulfils Eq. (11) taken literally, μ < K11/K12; margin 1, or −their share of "
    "the unstable cells",
)
def _unstable_only_without_sliding(candidates: Candidates) -> StatementMargin:
    """Look at the cells where friction drags along −x, for along +x the statement always holds.

    Divergence, K11 K22 − K12² + k3 (K11 − μ K12) < 0, needs K11 < μ K12. Flutter needs
    K12 (K12 + μ k3) < 0 and so K12 < 0, where Eq. (11) as printed is never fulfilled.
    """
    share = np.zeros(candidates.size)
    rows = np.arange(candidates.size)
    if not candidates.extended:
        rows = rows[candidates.drag < 0]
    # unless margins are wanted, one cell in 16 comes first: one that fulfils it decides
    for every in (1,) if candidates.exact else (16, 1):
        left = rows[share[rows] == 0]
        share[left] = _sliding_share(candidates.subset(left), every)
    return _closed(np.where(share > 0, -share, 1.0))


def _sliding_share(candidates: Candidates, every: int) -> np.ndarray:
    """Share of the unstable cells that fulfil Eq. (11) as printed; 0 of none."""
    owner, alpha1, alpha2, _ = candidates.unstable_cells(every=every)
    number = np.bincount(owner, minlength=candidates.size)
    p = SimpleNamespace(**{k: candidates.fields[k][owner] for k in ("k1", "k2")})
    allowed = a2.possible_as_printed(
        linear_stiffness(p, geometry(alpha1, alpha2)), candidates.drag[owner]
    )
    count = np.bincount(owner[allowed], minlength=candidates.size)
    return np.asarray(count / np.maximum(number, 1))


@constrains(
    "F7a",
    Stage.maps,
    "A1 separates in more than half of the angle map; margin share/½ − 1",
)
def _separates_mostly(candidates: Candidates) -> StatementMargin:
    return _closed(separating_share(candidates) / WordsInNumbers.large_region - 1.0)


@constrains(
    "F7_black",
    Stage.black,
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
        constraint.name: constraint.check(candidates)
        for constraint in registered_constraints
        if constraint.stage in stages
    }


def verdicts(found: StatementMargin) -> np.ndarray:
    """:class:`squealpipe.paper.schema.inference.Holds` of each candidate."""
    decided = (found.outcome == Outcome.converged) & np.isfinite(found.margin)
    return np.where(decided, found.margin > 0, int(Holds.undecided))


def judge(
    candidates: Candidates, *, failures: int | np.ndarray = 0, exact: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Margins and verdicts (``Holds``), both (size, statement).

    Args:
        exact: compute margins to their end, where else bounds of the right sign do.
        failures: a set, or each of them, that more statements than this have refuted goes to no
            further stage: there its margins are NaN and its verdicts ``not_judged``.
    """
    candidates = replace(candidates, exact=exact)
    margin = np.full((candidates.size, len(registered_constraints)), np.nan)
    holds = np.full(margin.shape, int(Holds.not_judged), np.int8)
    for stage in Stage:
        left = np.flatnonzero((holds == Holds.no).sum(axis=1) <= failures)
        if not left.size:
            break
        measured = measure(candidates.subset(left), [stage])
        for column, constraint in enumerate(registered_constraints):
            if constraint.stage == stage:
                margin[left, column] = measured[constraint.name].margin
                holds[left, column] = verdicts(measured[constraint.name])
    return margin, holds
