"""The study's parameters by their rule: the simple numbers whose smallest margin is the largest."""

from itertools import product

import numpy as np
import pytest

from squealpipe.parameters import Parameters
from squealpipe.schema.inference import Holds
from squealpipe.tasks.inference.candidates import sets_of
from squealpipe.tasks.inference.constraints import judge

SIMPLE = {
    "kappa": np.arange(6, 27) / 20,
    "mu": (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8),
    "length_ratio": (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 50.0, 100.0),
    "speed_ratio": (10.0, 20.0, 50.0, 100.0),
}
"""Numbers that count as simple, of each group, within the ranges of the inference."""


@pytest.mark.release
def test_no_set_of_simple_numbers_has_a_larger_smallest_margin():
    """Of sets that differ after six digits the fastest belt wins: A3 takes ẋ < V for granted."""
    groups = dict(zip(SIMPLE, np.array(list(product(*SIMPLE.values()))).T, strict=True))
    margin, holds = judge(sets_of(groups, tol=1e-9, workers=None).read("as_printed"))
    meets = np.flatnonzero((holds == Holds.yes).all(axis=1))
    smallest = margin[meets].min(axis=1).round(6)
    best = meets[np.lexsort((-groups["speed_ratio"][meets], -smallest))[0]]
    study = Parameters()
    own = study.kappa, study.mu, study.length1 / study.preload, study.speed_ratio
    assert [values[best] for values in groups.values()] == pytest.approx(own)
