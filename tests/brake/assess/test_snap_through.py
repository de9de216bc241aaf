"""Steady sliding that ends in a fold: where it snaps, against the fold of the equations."""

import numpy as np
import pytest
from scipy.optimize import fsolve

from squealpipe.brake.assess.designs import cures_of
from squealpipe.brake.assess.sliding import Design
from squealpipe.brake.assess.snap_through import snap_throughs
from squealpipe.parameters import Parameters

PAD = Parameters(
    mass=0.3,
    k1=66e3,
    k2=276e3,
    k3=695e3,
    mu=0.43,
    belt_speed=-3.0,
    preload=0.66e-3,
    length1=0.11,
    length2=0.13,
    damping1=30.0,
    damping2=30.0,
)
ANGLES = np.radians([130.0, 66.6])


def fold(guess):
    """Where the balance of A1's forces has a double root in x and y, over mu."""
    (a, b), p = ANGLES, PAD
    ends = np.array(
        [
            [p.length1 * np.cos(a), p.length1 * np.sin(a)],
            [-p.length2 * np.cos(b), p.length2 * np.sin(b)],
        ]
    )

    def force(x, y, mu):
        total = p.k3 * (p.preload - y) * np.array([-mu, 1.0])
        springs = zip((p.k1, p.k2), ends, (p.length1, p.length2), strict=True)
        for k, end, free in springs:
            away = np.array([x, y]) - end
            length = np.hypot(*away)
            total = total - k * (length - free) / length * away
        return total

    def equations(unknowns):
        x, y, mu = unknowns
        step = 1e-7
        slopes = [
            (force(x + dx, y + dy, mu) - force(x - dx, y - dy, mu)) / (2.0 * step)
            for dx, dy in ((step, 0.0), (0.0, step))
        ]
        balance = force(x, y, mu) / (p.k3 * p.preload)
        return [*balance, np.linalg.det(slopes) / (p.k1 * p.k3)]

    return fsolve(equations, guess, xtol=1e-12)


def test_a_pad_snaps_at_the_fold_of_its_steady_sliding():
    cures = {"mu": cures_of(Design(PAD, *ANGLES))["mu"]}
    snap = snap_throughs(cures, {})["mu"]
    x, y, mu = fold([-1.5e-3, 0.3e-3, 0.5])
    assert snap.value == pytest.approx(mu, rel=1e-6)
    assert snap.distance > 50.0 * np.hypot(x, y)


def test_what_lies_beyond_the_end_of_quiet_is_not_told():
    cures = {"mu": cures_of(Design(PAD, *ANGLES))["mu"]}
    assert np.isnan(snap_throughs(cures, {"mu": 0.45})["mu"].value)


def test_a_place_that_moves_smoothly_does_not_snap():
    """Stiff springs under a small preload: the place of steady sliding is nearly linear in mu."""
    stiff = PAD.with_(k1=6e7, k2=6e7)
    cures = cures_of(Design(stiff, *np.radians([60.0, 60.0])))
    chosen = {name: cures[name] for name in ("mu", "k3", "preload", "belt_speed")}
    found = snap_throughs(chosen, {})
    assert all(np.isnan(each.value) for each in found.values())
