"""Levels of motions beside those in more modes, where a reduction is right by its eigenvalues."""

import numpy as np
import pytest
import xarray as xr

from squealpipe import labels, squealing_modes
from squealpipe.codes import Verdict
from squealpipe.structures import elastic_pad
from squealpipe.structures.assess.assess import judge_structure
from squealpipe.study.report.answer import level
from squealpipe.study.report.squealing import level_in_more_modes, lines
from squealpipe.vibration.settling import settling_of_verdicts
from tests.structures.test_reduction import random_structure
from tests.structures.test_runs_of_the_whole import settled


@pytest.fixture(scope="module")
def pad():
    """36 degrees of freedom; nine coordinates have the same unstable modes within 1 %."""
    return elastic_pad(contacts=3, elements=(5, 2), modal_damping=0.01)


@pytest.fixture(scope="module")
def answer(pad):
    reduced = pad.reduce()
    assert reduced.size == 9
    assert reduced.record["growth_rate_error"] < 0.01
    return squealing_modes(reduced, samples=1, workers=1)


def test_a_level_that_more_modes_change_is_not_told_as_if_it_was_known(answer):
    """Eigenvalues agreed within 1 %, and the level was a third too high without a word."""
    assert int(answer.refined_n_modes) == 36
    assert labels(answer.refined_motion)[0] == "hammers"
    first, refined = (
        float(answer.velocity_rms[0]),
        float(answer.refined_velocity_rms[0]),
    )
    assert first > 1.25 * refined
    (told,) = [line for line in lines(answer) if line.startswith("The level")]
    assert told == (
        f"The level is uncertain: {1e3 * first:.3g} mm/s (rms) in 9 modes, but "
        f"{1e3 * refined:.3g} mm/s in 36."
    )


@pytest.mark.release
def test_the_level_in_all_modes_is_that_of_a_run_of_the_whole_from_its_own_push(
    pad, answer
):
    """The motion is carried over in place of a start of its own, and ends in the same one."""
    whole = squealing_modes(pad.reduce(n_modes=36), samples=1, workers=1)
    assert int(whole.refined_n_modes) == 0
    assert level_in_more_modes(whole) is None
    assert float(answer.refined_velocity_rms[0]) == pytest.approx(
        float(whole.velocity_rms[int(whole.ends_in[0])]),
        rel=settling_of_verdicts.agreement,
    )


def test_assess_tells_the_same_level_in_all_modes(pad, answer):
    """Its runs have coordinates of their own, from which the motion is carried over."""
    told = judge_structure(pad, samples=1, seed=0, tol=1e-12, workers=1).without_cures()
    assert int(told.refined_n_modes) == 36
    assert float(told.refined_velocity_rms) == pytest.approx(
        float(answer.refined_velocity_rms[0]), rel=settling_of_verdicts.agreement
    )
    assert "The level is uncertain: " in level(told)
    assert "(rms) in 9 modes, but " in level(told)


@pytest.mark.release
def test_the_level_in_all_modes_is_that_of_exponentials(pad, answer):
    """The whole is run by code that shares nothing with the package."""
    _, level, losses = settled(pad)
    assert losses >= 2
    # root of the sum over contacts there, of the mean here
    ours = np.sqrt(3) * float(answer.refined_velocity_rms[0])
    assert ours == pytest.approx(level, rel=0.03)


@pytest.mark.release
def test_in_twice_as_many_modes_a_random_structure_has_the_level_of_the_whole():
    """Of 71 degrees of freedom and 4 contacts: 49 modes miss more than a quarter of its level."""
    structure, _ = random_structure(90, 80)
    reduced = structure.reduce()
    answer = squealing_modes(reduced, samples=1, workers=1)
    _, level, _ = settled(structure)
    motion = answer.isel(attractor=int(answer.ends_in[0]))
    assert reduced.size < int(answer.refined_n_modes) <= structure.size
    assert np.linalg.norm(motion.contact_velocity_rms) < 0.8 * level
    assert 2.0 * float(motion.refined_velocity_rms) == pytest.approx(level, rel=0.03)


def told(first, refined, motion=Verdict.hammers, size=64, whole=350):
    """The sentence on a motion that hammers with a level in 12 modes, m/s."""
    return level_in_more_modes(
        xr.Dataset(
            {
                "ends_in": ("mode", [0]),
                "motion": ("attractor", [int(Verdict.hammers)]),
                "velocity_rms": ("attractor", [first]),
                "refined_velocity_rms": ("attractor", [refined]),
                "refined_motion": ("attractor", [int(motion)]),
                "refined_n_modes": size,
                "degrees_of_freedom": whole,
                "n_modes": 12,
            }
        )
    )


def test_words_on_a_level_name_what_would_tell_more():
    assert (
        told(0.28, 0.3) == "Its level is 0.28 m/s (rms) in 12 modes, and 0.3 m/s in 64."
    )
    assert told(0.28, 0.52) == (
        "The level is uncertain: 0.28 m/s (rms) in 12 modes, but 0.52 m/s in 64: see what more "
        "modes change (n_modes=64 and above)."
    )
    assert told(0.28, 0.28, Verdict.squeals, whole=64) == (
        "The level is uncertain: 0.28 m/s (rms) in 12 modes, but 0.28 m/s in 64, where it squeals."
    )
    assert told(0.28, np.nan, Verdict.undetermined).endswith(
        "the motion did not settle."
    )
    assert told(0.28, 0.28, size=0) is None
