"""Modes beyond the band that was asked for neither grow nor enter the answer."""

import numpy as np
import pytest

from squealpipe import squealing_modes
from squealpipe.structures import elastic_pad
from squealpipe.structures.assess import assess
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.squeal.plant import Plant
from squealpipe.study.report.squealing import damped_beyond, lines
from squealpipe.systems.progress import shown

BAND = 20e3


@pytest.fixture(scope="module")
def pad():
    """An elastic pad whose fastest unstable mode, 41.7 kHz, lies beyond the band."""
    return elastic_pad(modal_damping=0.002)


def _own_growth(structure, limit):
    """Growth and frequency of the modes of matrices up to a limit, rad/s, by their own."""
    mass, damping, stiffness = (
        each.toarray()
        for each in (structure.mass, structure.damping, structure.stiffness)
    )
    drag = structure.mu_of_contacts * np.sign(structure.speeds * structure.belt_speed)
    acting = structure.normals + structure.tangentials * drag
    stiffness = stiffness + acting * structure.stiffnesses @ structure.normals.T
    size = len(mass)
    solved = np.linalg.solve(mass, np.hstack([stiffness, damping]))
    first = np.block([[np.zeros((size, size)), np.eye(size)], [-solved]])
    values = np.linalg.eigvals(first)
    inside = (values.imag > 0.0) & (values.imag <= limit)
    return values[inside], values[values.imag > limit]


def test_modes_beyond_the_band_decay_and_those_within_are_the_same(pad):
    reduced = pad.reduce(frequency_max=BAND)
    within, beyond = _own_growth(reduced, 2.0 * np.pi * BAND)
    assert beyond.real.max() > 0.0
    assert within.real.max() > 0.0
    plant = Plant(reduced)
    after, damped = _own_growth(plant.structure, 2.0 * np.pi * BAND)
    assert damped.real.max() < 0.0
    leading, kept = (each[each.real.argmax()] for each in (within, after))
    assert kept.imag == pytest.approx(leading.imag, rel=1e-3)
    assert kept.real == pytest.approx(leading.real, abs=1e-4 * leading.imag)
    # the same holds of what is changed, in coordinates of its own
    changed = Design.of(reduced).changed(Design.of(reduced).whole).structure
    assert _own_growth(changed, 2.0 * np.pi * BAND)[1].real.max() < 0.0


def test_what_changes_the_verdict_is_searched_in_the_band_alone(monkeypatch):
    """Above this friction 41.7 kHz grows first, then 9.7 kHz, up to which modes count."""
    pad = elastic_pad(modal_damping=0.009, mu=0.3)
    reduced = pad.reduce(frequency_max=BAND, n_modes=11)

    def friction_alone(design, modifications):
        cures, units = cures_of(design, modifications)
        return {"mu": cures["mu"]}, units

    monkeypatch.setattr(assess, "cures_of", friction_alone)
    judged = assess.judge_structure(reduced, samples=1, seed=0, tol=1e-6)
    (critical,) = judged.with_cures().quiet_from.values
    for friction, grows in ((0.999 * critical, False), (1.001 * critical, True)):
        changed = reduced.with_(mu=friction)
        within, beyond = _own_growth(changed, 2.0 * np.pi * BAND)
        assert (within.real.max() > 0.0) == grows
        assert beyond.real.max() > 0.0


@pytest.mark.release
def test_damping_beyond_the_band_is_told(pad):
    reduced = pad.reduce(frequency_max=BAND)
    period = 1.0 / Plant(reduced).slowest
    answer = squealing_modes(reduced, samples=1, t_end=8 * period, tol=1e-9)
    ratio = float(answer.damping_beyond_band)
    assert ratio == Plant(reduced).damping_beyond > 0
    assert f"damping ratio of {ratio:g} there" in lines(answer)[-1]
    assert damped_beyond(answer.assign(damping_beyond_band=0.0)) is None


@pytest.mark.release
def test_cause_and_frequency_lie_in_the_band(pad):
    told = []
    with shown(None, told.append):
        judged = assess.judge_structure(
            pad.reduce(frequency_max=BAND), samples=1, seed=0, tol=1e-9, workers=1
        )
    # before the random starts, which take longest
    assert told[0].startswith(f"  after a push: {judged.verdict.name}; from rest")
    assert judged.facts["leading_frequency"] < BAND
    assert judged.facts["frequency"] < BAND
