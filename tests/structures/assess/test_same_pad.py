"""A pad given by its parameters and by its matrices has one answer."""

import numpy as np
import pytest

from squealpipe import Contact, Parameters, Structure, assess
from squealpipe.brake.assess.assess import judge
from squealpipe.codes import Regime
from squealpipe.structures.assess.assess import judge_structure

LEVELS = (
    "frequency", "velocity_rms_along", "velocity_rms_across", "displacement_peak",
    "peak_contact_force", "peak_contact_force_over_preload", "impact_rate",
    "separated_fraction", "stick_fraction", "sliding_growth_rate",
)  # fmt: skip
PEAKS = ("displacement_peak", "peak_contact_force", "peak_contact_force_over_preload")
CURES = ("mu", "preload", "belt_speed")


def structure_of(pad, alpha1, alpha2):
    """The matrices of both springs and dashpots at their angles."""
    ways = np.array(
        [[np.cos(alpha1), np.sin(alpha1)], [-np.cos(alpha2), np.sin(alpha2)]]
    )
    stiffness = ways.T @ np.diag([pad.k1, pad.k2]) @ ways
    damping = ways.T @ np.diag([pad.damping1, pad.damping2]) @ ways
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, pad.k3, pad.k3 * pad.preload)
    return Structure(
        pad.mass * np.eye(2),
        stiffness,
        damping,
        contacts=[contact],
        load=0,
        **{
            name: getattr(pad, name)
            for name in (
                "mu",
                "belt_speed",
                "friction_law",
                "mu_static",
                "friction_speed",
            )
        },
    )


def random_pad(seed):
    rng = np.random.default_rng(seed)
    stiffness = 10.0 ** rng.uniform(6.5, 7.5, 3)
    law = {}
    mu = rng.uniform(0.2, 0.7)
    if seed % 2:
        law = {
            "friction_law": "exponential",
            "mu_static": mu + 0.2,
            "friction_speed": 1.5,
        }
    pad = Parameters(
        mass=rng.uniform(0.2, 1.0), k1=stiffness[0], k2=stiffness[1], k3=stiffness[2],
        preload=rng.uniform(2e-4, 8e-4), mu=mu, length1=1e4, length2=1e4,
        belt_speed=rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 4.0),
        damping1=rng.uniform(20.0, 80.0), damping2=rng.uniform(20.0, 80.0), **law,
    )  # fmt: skip
    return pad, rng.uniform(0.2, 1.4, 2)


def check_levels(one, other, seed):
    """Verdicts, causes and levels of both starts agree."""
    for start in ("", "sudden_"):
        for name in ("verdict", "periodic"):
            assert one[start + name].item() == other[start + name].item(), (seed, name)
    assert one.mechanism.item() == other.mechanism.item()
    is_chance = one.velocity_rms_along_error.item() > 0.0
    for name in LEVELS:
        first, second = one[name].item(), other[name].item()
        error = 0.0
        if is_chance and name in PEAKS:
            continue
        if is_chance and f"{name}_error" in one:
            error = 2.0 * (one[f"{name}_error"].item() + other[f"{name}_error"].item())
        allowed = 1e-3 * abs(first) + error
        assert np.isnan([first, second]).all() or abs(first - second) <= allowed, (
            seed,
            name,
        )


def check_boundaries(pad, one, other, seed):
    """The nearest boundaries of what is changed alike agree."""
    for cure in CURES:
        factor = one.value.sel(cure=cure).item() / other.value.sel(cure=cure).item()
        if cure == "mu" and pad.friction_law != "coulomb":
            factor = float("nan")  # the law is scaled there, its parameter here
        first = one.quiet_from.sel(cure=cure).item()
        second = factor * other.quiet_from.sel(cure=cure).item()
        if np.isfinite(factor) and max(abs(first), abs(second)) < 3.0 * abs(
            one.value.sel(cure=cure).item()
        ):
            assert first == pytest.approx(second, rel=2e-3), (seed, cure)


@pytest.mark.release
def test_pads_as_parameters_and_as_matrices_have_one_level():
    for seed in (1, 2, 9):
        pad, angles = random_pad(seed)
        one = judge(pad, *angles, tol=1e-12).without_cures()
        other = judge_structure(
            structure_of(pad, *angles), samples=0, seed=0, tol=1e-12, workers=1
        ).without_cures()
        check_levels(one, other, seed)


def test_slip_is_told_along_the_belts_own_motion():
    """A contact whose direction is reversed as well as the belt is the same one."""
    pad = Parameters(
        mass=0.45, k1=1e7, k2=1e7, k3=7e6, preload=5.714e-4, mu=0.6, belt_speed=1.0,
        length1=1e4, length2=1e4, damping1=42.4, damping2=42.4,
    )  # fmt: skip
    along = structure_of(pad, *np.radians((30.0, 60.0)))
    contact = along.contacts[0]
    reversed_ = Contact("pad", {1: 1.0}, {0: -1.0}, contact.stiffness, contact.preload)
    against = along.with_(contacts=[reversed_], belt_speed=-pad.belt_speed)
    one, other = (
        judge_structure(each, samples=0, seed=0, tol=1e-10, workers=1).without_cures()
        for each in (along, against)
    )
    known = np.isfinite(one.path_x.values)
    regimes = one.path_regime.values[known]
    np.testing.assert_array_equal(other.path_regime.values[known], regimes)
    assert (regimes == Regime.slip_slower).mean() > 0.5


@pytest.mark.release
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 30))]
)
def test_thirty_pads_as_parameters_and_as_matrices_have_one_answer(seed):
    pad, angles = random_pad(seed)
    one = assess(pad, *angles)
    other = assess(structure_of(pad, *angles), samples=4, workers=1)
    check_levels(one, other, seed)
    check_boundaries(pad, one, other, seed)
