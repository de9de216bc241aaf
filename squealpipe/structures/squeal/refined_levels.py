"""Levels of settled motions in a refined reduction: more coordinates of the same structure.

Idea: errors of eigenvalues do not bound a level, since impacts excite modes far beyond those that
grow. So each motion that lasts is carried over into twice as many coordinates, 64 at least, and run
on until it has settled there; its level there is told beside the first one. Invariant: where the
structure has no more coordinates the refined reduction is the whole, and the level is its own.
A small difference is no bound: motions of a hammering pad change again with many more modes. Cost:
some hundred periods of each motion, at about eight times the cost of a period.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from squealpipe.codes import Verdict
from squealpipe.structures.agreement import Truth
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.modes import free_degrees
from squealpipe.structures.reduction import Search
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.settling import settings_of, settle
from squealpipe.structures.squeal.windows import Running
from squealpipe.systems.linear.matrices import Caps
from squealpipe.systems.progress import stop_is_asked
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.verdicts import heard


@dataclass(frozen=True)
class Refinement:
    """Number of coordinates of the refined reduction."""

    factor: int = 2
    """Coordinates over those that were run. Twice as many: eight times the cost or more."""
    fewest: int = 64
    """Fewest coordinates. With half as many a pad with eight points, run in 12, looks as if its
    level was right within a third."""


class RefinedLevels(NamedTuple):
    """Levels and verdicts of motions in the refined reduction.

    Attributes:
        n_modes: its coordinates; 0: there is none.
        speeds: rms speed of vibration of all contacts, (motions,), m/s; NaN where the motion has
            died out before, or has not settled.
        verdicts: what is heard then, (motions,).
    """

    n_modes: int
    speeds: np.ndarray
    verdicts: np.ndarray


def refined_levels(
    plant: Plant,
    motions: list[SettledRun],
    t_end: float | None,
    how: Running,
    *,
    reduction: ContactStructure | None = None,
    modes: np.ndarray | None = None,
) -> RefinedLevels:
    """Run motions on in a refined reduction until they have settled.

    Args:
        plant: in which the motions were run.
        motions: runs that have settled, one of each attractor.
        t_end: longest time of a run, s; None as in :func:`squealpipe.squealing_modes`.
        reduction: reduced structure that is refined; None: that of the plant.
        modes: (n of the whole, n of the plant), amplitudes → displacements; None: the reduction's.
    """
    reduction = plant.structure if reduction is None else reduction
    modes = reduction.modes if modes is None else modes
    speeds = np.full(len(motions), np.nan)
    verdicts = np.full(len(motions), int(Verdict.undetermined))
    lasting = [index for index, run in enumerate(motions) if not run.quiet]
    refined = None
    if lasting and modes is not None and not stop_is_asked():
        refined = more_modes(reduction)
    if refined is None or modes is None:
        return RefinedLevels(0, speeds, verdicts)
    lift = _lift(modes, refined.structure)
    away = np.array([motions[index].last.final for index in lasting]) - plant.sliding
    # stretches of tangential springs are those of the same contacts
    q, v, stretches = np.split(away, [plant.size, 2 * plant.size], axis=1)
    states = refined.sliding + np.hstack([q @ lift.T, v @ lift.T, stretches])
    # nothing has to grow from a small push first
    rates = np.full(len(states), np.inf)
    how, _ = settings_of(refined, states[-1], rates, t_end, how)
    for index, run in zip(
        lasting, settle(refined, states, rates, t_end, how), strict=True
    ):
        if run.agrees:
            speeds[index] = np.sqrt((run.last.speed**2).mean())
            verdicts[index] = heard(run.last.losses, quiet=run.quiet)
    return RefinedLevels(refined.size, speeds, verdicts)


def more_modes(reduction: ContactStructure) -> Plant | None:
    """Return the structure in more coordinates; None if it has no more, or they cannot be run."""
    origin = reduction.reduced_from
    if origin is None:
        return None
    whole = origin.whole
    number = max(Refinement.factor * reduction.size, Refinement.fewest)
    number = min(number, free_degrees(whole), Caps().modes)
    if number <= reduction.size:
        return None
    truth = origin.truth or Truth.of(whole, origin.frequency_max)
    search = Search(whole, truth, origin.frequency_max)
    refined = Plant(search.structure(number), is_ready=True)
    return None if refined.obstacle else refined


def _lift(modes: np.ndarray, refined: ContactStructure) -> np.ndarray:
    """Return the matrix that turns amplitudes of some modes into coordinates of a reduction."""
    origin = refined.reduced_from
    assert origin is not None and refined.modes is not None  # noqa: S101, PT018
    return np.asarray(refined.modes.T @ (origin.whole.mass @ modes))
