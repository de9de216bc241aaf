"""Systems with fields, surfaces and outputs of all shipped functions against another integrator."""

import os

import numpy as np
import pytest

from squealpipe.schema import Outcome
from tests.systems.random_functions import (
    DRIVES,
    NAMES,
    STARTS,
    T_END,
    Lanes,
    random_functions,
)

SEEDS = int(os.environ.get("SQUEALPIPE_SYSTEMS", "2"))


def judged(seed):
    """(right, said so, unclear, wrong) of fifty runs of a system."""
    system, inner = random_functions(seed)
    ours = system.ensemble(T_END, start={"x": STARTS}, drive=DRIVES, workers=1)
    starts, drives = (
        axis.ravel() for axis in np.meshgrid(STARTS, DRIVES, indexing="ij")
    )
    coarse, fine = (Lanes(system, inner, starts, drives).run(h) for h in (0.02, 0.008))
    outcome = ours.outcome.values.ravel()
    said = outcome != Outcome.converged
    unclear = coarse.unclear | fine.unclear | (fine.margin < 1e-9)
    agrees = np.ones(len(starts), bool)
    to_the_end = ~fine.trapped
    for switch in system.switches:
        name = switch.name
        unclear |= (coarse.counts[name] != fine.counts[name]) & to_the_end
        same = ours[f"count_{name}"].values.ravel() == fine.counts[name]
        agrees &= same | ~to_the_end
        first, theirs = ours[f"first_{name}"].values.ravel(), fine.firsts[name]
        near = np.abs(first - theirs) < 1e-8
        agrees &= near | (np.isnan(first) & np.isnan(theirs))
    # two regimes beyond each other's surface send a motion back and forth: so it is told
    trapped = fine.trapped & coarse.trapped & (outcome == Outcome.accumulation)
    trapped &= agrees
    for place, name in enumerate(NAMES):
        off = np.abs(coarse.z[place] - fine.z[place])
        agrees &= np.abs(ours[name].values.ravel() - fine.z[place]) < 1e-7 + 2.0 * off
    span = fine.highest - fine.lowest
    for name, theirs in (("seen_min", fine.lowest), ("seen_max", fine.highest)):
        off = np.abs(ours[name].values.ravel() - theirs)
        agrees &= off < 2e-3 * span + 1e-9
    said &= ~trapped
    right = trapped | (agrees & ~said)
    wrong = ~agrees & ~said & ~unclear & ~trapped
    return right, said & ~right, unclear & ~right & ~said, wrong


@pytest.mark.release
@pytest.mark.parametrize("seed", range(SEEDS))
def test_fifty_runs_of_all_functions_agree_with_another_integrator(seed):
    right, said, _, wrong = judged(seed)
    assert not wrong.any(), np.flatnonzero(wrong)
    assert right.mean() > 0.8
    assert said.mean() <= 0.05
