"""The fold at which a cycle that squeals meets an unstable one, and that one, by the exact map.

The unstable cycle is the smallest vibration that is still drawn to squeal at its friction.
"""

import numpy as np

from squealpipe.structures.squeal.descent import Track, UnstableCycles
from squealpipe.structures.squeal.kinds import stable_cycle
from squealpipe.structures.squeal.plant import Plant
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles.branch import first_point
from squealpipe.systems.cycles.following import Follower
from squealpipe.systems.cycles.trail import BranchPoint


def add_fold(plant: Plant, track: Track, onset: float, width: float) -> None:
    """Locate where a track dies by the cycle that it lasts in, if it is one that folds there."""
    last = track.lasts
    cycle = stable_cycle(plant, last.state, last.regimes, last.frequency, mu=last.mu)
    first = first_point(cycle, "mu", 0.0) if cycle and cycle.events else None
    if first is None:
        return
    # the unstable cycle is followed almost to the onset, where it vanishes
    follower = Follower(0.0, (1.0 - 1e-9) * onset, 32)
    follower.run(*first)
    points = follower.points
    frictions = np.array([point.parameter for point in points])
    place = int(frictions.argmin())
    fold = float(frictions[place])
    # a stable cycle ends smoothly, or where events change, as friction falls
    is_fold = points[place].label in {
        Label.fold,
        Label.border_collision,
    } and place + 1 < len(points)
    if not is_fold or not track.dies - width <= fold <= track.lasts.mu:
        return
    track.fold = fold
    track.unstable = UnstableCycles(
        frictions[place:], np.array([_speed(plant, point) for point in points[place:]])
    )


def _speed(plant: Plant, point: BranchPoint) -> float:
    """rms speed of vibration of all contacts."""
    cycle = point.cycle
    samples = 512
    times = cycle.period * np.arange(samples) / samples
    states, _ = cycle.states_at(times)
    return float(np.sqrt((plant.contact_speeds(states) ** 2).mean()))
