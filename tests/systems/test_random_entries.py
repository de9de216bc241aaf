"""Two hundred entries beyond a surface, event by event against another integrator."""

import os
from collections import Counter
from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest

from squealpipe.schema import Outcome
from tests.oracles.written import written
from tests.systems.random_entries import MOST_EVENTS, T_END, random_entries

SYSTEMS = int(os.environ.get("SQUEALPIPE_SYSTEMS", "2"))
EACH, TRIED = 10, 40
"""Runs of a system, in each of which some regime is entered beyond, and starts that are tried."""


def regimes_of(made, chosen):
    return {"regime": chosen if len(chosen) > 1 else chosen[""]}


def entered_beyond(seed):
    """A random system, its place among those of a seed, and ten (start, regimes, their run) of it.

    At most two runs end in regimes that send the motion back and forth.
    """
    rng = np.random.default_rng(1000 + seed)
    for place, made in enumerate(random_entries(seed)):
        cases, causes = [], Counter()
        for number in range(TRIED):
            if len(cases) < number // 4:
                break
            start = rng.normal(size=len(made.names)).tolist()
            chosen = {
                o: str(rng.choice(list(parts))) for o, parts in made.parts.items()
            }
            theirs = run_apart(seed, place, start, chosen, 0.1)
            new = Counter(set(theirs.causes)) + Counter(trap=theirs.trapped)
            enough = causes["trap"] == 2 if theirs.trapped else causes["start"] >= 4
            if theirs.unclear or not new or (enough and set(new) <= {"start", "trap"}):
                continue
            if theirs.trapped and causes["trap"] == 2:
                continue
            causes.update(new)
            cases.append((start, chosen, theirs))
            if len(cases) == EACH:
                return made, place, cases
    raise AssertionError


def run_apart(*asked):
    """What the integrator apart says of a run."""
    return SimpleNamespace(**parts_apart(*asked))


@written
def parts_apart(seed, place, start, chosen, step):
    """Events of a random system's run, what led beyond surfaces, and how it ends, by DOP853."""
    run = next(islice(random_entries(seed), place, None)).run(start, chosen, step)
    parts = "events", "causes", "trapped", "unclear", "t", "z"
    return {name: getattr(run, name) for name in parts}


def names(flags):
    meanings = flags.attrs["flag_meanings"].split()
    return tuple(meanings[number] for number in flags.values)


def agrees(made, ours, theirs):
    """Whether events, their times, regimes entered and the end are the same."""
    trapped = int(ours.outcome) == Outcome.accumulation
    events = theirs.events
    if len(events) >= MOST_EVENTS and not theirs.trapped:
        trapped = False
    elif trapped and theirs.trapped:
        events = [event for event in events if event[0] < theirs.t - 1e-8]
    elif trapped or theirs.trapped or int(ours.outcome) != Outcome.converged:
        return False
    size = min(len(events), MOST_EVENTS)
    whole = size < MOST_EVENTS and not trapped
    if whole and ours.sizes["event"] != size:
        return False
    times, kinds, entered = zip(*events[:size], strict=True) if size else ((), (), ())
    same = (
        names(ours.event_kind[:size]) == kinds
        and names(ours.event_regime[:size]) == entered
        and np.allclose(ours.event_time[:size], times, rtol=0.0, atol=1e-8)
    )
    if trapped:
        return same and abs(float(ours.end_time) - theirs.t) < 1e-8
    ends = [float(ours[name][-1]) for name in made.names]
    return same and (not whole or np.allclose(ends, theirs.z, atol=1e-7))


@pytest.mark.parametrize(
    "seed",
    [0, *(pytest.param(n, marks=pytest.mark.release) for n in range(1, SYSTEMS))],
)
def test_what_is_entered_beyond_a_surface_is_left_as_dop853_leaves_it(seed):
    made, place, cases = entered_beyond(seed)
    for start, chosen, theirs in cases:
        given = dict(zip(made.names, start, strict=True)) | regimes_of(made, chosen)
        ours = made.system.simulate(T_END, start=given)
        if not agrees(made, ours, theirs):  # two crossings in one of its steps
            theirs = run_apart(seed, place, start, chosen, 0.002)
        assert theirs.unclear or agrees(made, ours, theirs), (start, chosen)
