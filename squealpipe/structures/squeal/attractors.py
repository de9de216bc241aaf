"""Settled motions told apart by their statistics."""

import numpy as np
from scipy.sparse.csgraph import connected_components

from squealpipe.structures.schema.squealing import NO_ATTRACTOR
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.settling import difference, settling_of_verdicts


def grouped(settled: list[SettledRun], pushes: int) -> np.ndarray:
    """The number of the attractor of each run, those of most random starts first; −1: not settled.

    The first ``pushes`` runs are no random starts. Runs that have died out are
    one. Others are one if a chain of near statistics joins them.
    """
    count = len(settled)
    near = np.zeros((count, count), bool)
    for i, one in enumerate(settled):
        for j, other in enumerate(settled[:i]):
            if one.agrees and other.agrees:
                near[i, j] = near[j, i] = is_same(one, other)
    _, numbers = connected_components(near, directed=False)
    numbers = np.array(
        [
            n if each.agrees else NO_ATTRACTOR
            for n, each in zip(numbers, settled, strict=True)
        ]
    )
    known = np.unique(numbers[numbers >= 0])
    sizes = np.array([(numbers[pushes:] == number).sum() for number in known], int)
    order = {
        old: new for new, old in enumerate(known[np.argsort(-sizes, kind="stable")])
    }
    return np.array([order.get(number, NO_ATTRACTOR) for number in numbers], int)


def is_same(one: SettledRun, other: SettledRun) -> bool:
    """Tell whether two settled runs may show one motion."""
    if one.quiet or other.quiet:
        return one.quiet and other.quiet
    nearest = settling_of_verdicts.agreement
    # two runs of one motion differ by up to three times their own change between windows, but
    # runs whose statistics differ by more than 6 % are never one motion
    allowed = np.clip(3.0 * max(one.change, other.change), nearest, 0.06)
    return bool(difference(one.last.levels(1.0), other.last.levels(1.0)) <= allowed)
