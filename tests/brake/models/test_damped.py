"""A3 with dashpots and falling friction: eigenvalues in 60 digits, Routh–Hurwitz, limits."""

import math

import mpmath as mp
import numpy as np
import pytest

from squealpipe.brake.linear.critical import critical_damping_map, critical_friction_map
from squealpipe.brake.linear.maps import stability_map
from squealpipe.brake.models.damped import (
    critical_friction,
    damped_system,
    eigenvalues,
    stability,
)
from squealpipe.laws.friction_laws import LAWS
from squealpipe.parameters import Parameters
from tests.former import FORMER
from tests.oracles import sliding

RNG = np.random.default_rng(41)


def random_parameters():
    """Unequal springs, both belt directions, any law, damping from none to overcritical."""
    mu = RNG.uniform(0, 1)
    return FORMER.with_(
        mass=RNG.uniform(0.2, 5),
        k1=RNG.uniform(0.2, 5),
        k2=RNG.uniform(0.2, 5),
        k3=RNG.uniform(0.2, 5),
        mu=mu,
        belt_speed=RNG.choice([-1, 1]) * RNG.uniform(0.1, 5),
        preload=RNG.uniform(0.3, 3),
        damping1=RNG.choice([0.0, 1e-6, 0.1, 5.0]),
        damping2=RNG.uniform(0, 2),
        friction_law=str(RNG.choice(list(LAWS))),
        mu_static=mu + RNG.uniform(0, 1),
        friction_speed=RNG.uniform(0.1, 5),
    )


@pytest.mark.parametrize(
    ("count", "change", "digits"),
    [
        (60, {}, 1e-12),
        (20, {"damping1": 1e5}, 1e-13),
        (20, {"damping1": 1e8}, 1e-13),
        pytest.param(200, {}, 1e-12, marks=pytest.mark.release),
    ],
)
def test_eigenvalues_of_random_sets_to_twelve_digits(count, change, digits):
    """One stiff dashpot costs none: det C is no difference of two products of its square."""
    for _ in range(count):
        params, alpha = random_parameters().with_(**change), RNG.uniform(0, np.pi, 2)
        found = eigenvalues(damped_system(params, *map(np.longdouble, alpha))).astype(
            complex
        )
        for value in sliding.eigenvalues(params, *alpha):
            assert np.abs(found - value).min() <= digits * abs(value)


def test_the_map_is_that_of_the_eigenvalues_and_mirrors_with_the_belt():
    params = random_parameters().with_(friction_law="exponential")
    alpha1, alpha2 = np.sort(RNG.uniform(0, np.pi, (2, 4)))
    found = stability_map(params, alpha1, alpha2)
    for i, first in enumerate(alpha1):
        for j, second in enumerate(alpha2):
            exact = sliding.eigenvalues(params, first, second)
            cell = found.isel(alpha1=i, alpha2=j)
            growth = max(value.real for value in exact)
            assert float(cell.growth_rate) == pytest.approx(
                growth, rel=1e-11, abs=1e-13
            )
            upper = np.maximum(sorted(value.imag for value in exact)[2:], 0.0)
            np.testing.assert_allclose(cell.frequency, upper, rtol=1e-11, atol=1e-9)
            assert (int(cell.regime_linear) > 0) == (growth > 0)
    other = params.with_(belt_speed=-params.belt_speed)
    mirrored = stability_map(other, np.pi - alpha1, np.pi - alpha2)
    np.testing.assert_allclose(
        mirrored.growth_rate, found.growth_rate, rtol=1e-10, atol=1e-12
    )


@pytest.mark.parametrize("damped", [True, False])
def test_critical_friction_agrees_with_the_eigenvalues_on_either_side(damped):
    """Stable just below it and from 0 on, unstable just above; undamped by the closed form."""
    judged, edge = 0, 1e-7 if damped else 1e-9
    given = {"friction_law": "coulomb", "mu": 0.0, "mu_static": None}
    given |= {"damping1": 0.3} if damped else {"damping1": 0.0, "damping2": 0.0}
    for _ in range(100):
        params = random_parameters().with_(**given)
        alpha = RNG.uniform(0, np.pi, (2, 1)).astype(np.longdouble if damped else float)
        critical = float(critical_friction(params, *alpha)[0 if damped else 1][0])
        if not 1e-3 < critical < 50:
            continue
        judged += 1
        for share, stable in ((0.3, True), (1 - edge, True), (1 + edge, False)):
            there = params.with_(mu=share * critical, mu_static=None)
            if damped:
                assert (
                    stability(damped_system(there, *alpha)).growth_rate[0] < 0
                ) == stable
            else:
                assert (
                    stability_map(there, *alpha).regime_linear.item() == 0
                ) == stable
    assert judged >= 25


def test_hoffmann_and_gaul_damping_destabilizes():
    """Their minimal model: y reversed, K = [[2, −1 + μk3], [−1, 2]], undamped onset μ = 0.75.

    With C vanishing at the ratio c1:c2, the onset is where p3/p1 meets one of ω² = 2 ∓ √(1 − μk3),
    a quadratic in μ; no ratio but the symmetric one keeps 0.75.
    """
    springs = {
        "k1": 2 / 3 * (2 - math.sqrt(3)),
        "k2": 2 / 3 * (2 + math.sqrt(3)),
        "k3": 4 / 3,
    }
    angle = np.array([math.pi / 6])
    for ratio in (0.01, 0.1, 0.4, 1.0, 3.0, 20.0):
        params = FORMER.with_(**springs, damping1=ratio, damping2=1.0)
        found = critical_friction_map(params, angle, angle)
        assert found.critical_mu_undamped.item() == pytest.approx(0.75, abs=1e-12)
        vanishing = found.critical_mu_vanishing.item()
        with mp.workdps(40):
            cosine, sine = mp.cos_sin(mp.pi / 6)
            c11, c22 = (ratio + 1) * cosine**2, (ratio + 1) * sine**2
            c12 = (ratio - 1) * cosine * sine
            # K11 = K22 = 2 and K12 = −1: q = p3/p1 = 2 − c12 (−2 + μk3)/p1 must meet 2 ∓ √(1 − μk3)
            slope = c12 / (c11 + c22)
            # (slope (2 − h))² = 1 − h with h = μ k3
            a, b, c = slope**2, 1 - 4 * slope**2, 4 * slope**2 - 1
            expected = (
                (-c / b if a == 0 else (-b + mp.sqrt(b * b - 4 * a * c)) / (2 * a))
                * 3
                / 4
            )
        assert vanishing == pytest.approx(float(expected), abs=1e-9)
        assert vanishing < 0.75 or c12 == 0
        assert bool(found.destabilized) == (found.critical_mu.item() < 0.75)
        # the limit is reached linearly or faster, from the eigenvalues themselves
        tiny = params.with_(damping1=1e-6 * ratio, damping2=1e-6)
        assert critical_friction_map(
            tiny, angle, angle
        ).critical_mu.item() == pytest.approx(vanishing, abs=1e-9)
        if vanishing < 0.749:
            between = 0.5 * (vanishing + 0.75)
            growth = stability_map(
                tiny.with_(mu=between), angle, angle
            ).growth_rate.item()
            assert growth > 0
            assert (
                stability_map(
                    params.with_(damping1=0, damping2=0, mu=between), angle, angle
                ).regime_linear.item()
                == 0
            )


def test_the_map_over_dashpots_is_that_over_the_angles_cell_by_cell():
    """Unequal springs, a belt against x, and stability just below and above by eigenvalues."""
    params = FORMER.with_(
        mass=1.7, k1=2.0, k2=0.6, k3=1.1, belt_speed=-0.4, preload=0.5
    )
    angles, c1, c2 = (2.1, 2.6), np.array([0.0, 0.03, 0.4]), np.array([0.0, 0.2])
    found = critical_damping_map(params, *angles, c1, c2)
    for i, first in enumerate(c1):
        for j, second in enumerate(c2):
            damped = params.with_(damping1=first, damping2=second)
            cell = critical_friction_map(damped, angles[:1], angles[1:])
            assert float(found.critical_mu[i, j]) == cell.critical_mu.item()
            assert bool(found.destabilized[i, j]) == bool(cell.destabilized.item())
            for factor, stable in ((1 - 1e-6, True), (1 + 1e-6, False)):
                there = damped.with_(mu=factor * cell.critical_mu.item())
                regime = stability_map(
                    there, angles[:1], angles[1:]
                ).regime_linear.item()
                assert (regime == 0) == stable
    assert float(found.critical_mu_undamped) == found.critical_mu[0, 0]


@pytest.mark.parametrize(
    "springs", [{}, {"k2": 1.3, "length2": 7.0, "belt_speed": -40.0}]
)
def test_round_off_of_the_dashpots_coupling_gives_no_critical_friction(springs):
    """C12 = K12 = 0 for springs along the axes, and wherever C is proportional to such a K."""
    angles = np.linspace(0.0, np.pi, 61)
    undamped = critical_friction_map(FORMER, angles, angles).critical_mu_undamped
    assert np.isinf(np.diagonal(undamped)).all()  # α1 = α2 with equal springs: K12 = 0
    dashpots = FORMER.with_(damping1=0.03, damping2=0.01, **springs)
    unlike = critical_friction_map(dashpots, angles, angles)
    assert unlike.critical_mu.where(np.isfinite(unlike.critical_mu)).max() < 1e6
    assert np.isinf(unlike.critical_mu.values[::30, ::30]).sum() >= 5
    params = FORMER.with_(**springs)
    alike = params.with_(damping1=0.02 * params.k1, damping2=0.02 * params.k2)
    found = critical_friction_map(alike, angles, angles)
    free = np.isinf(found.critical_mu_undamped)
    assert np.isinf(found.critical_mu.where(free, np.inf)).all()


@pytest.mark.parametrize(
    ("angles", "dashpots", "speed"),
    [
        ((3.1415927, 1.5707963), (0.1, 0.0), -1.0),
        ((1.57079633, 0.0), (0.0, 0.1), 1.0),
        ((0.0, 1.5708), (0.1, 0.0), -1.0),
        ((0.8562937104837142, 0.6322501818389592), (0.0, 1e7), 1.0),
    ],
)
def test_critical_friction_where_a_mode_moves_hardly_a_dashpot(angles, dashpots, speed):
    """Round-off once gave 0, which says unstable at any friction, or a few digits."""
    springs = {"k2": 2.3, "k3": 0.6} if max(dashpots) < 1 else {"k2": 0.2, "k3": 0.18}
    damping1, damping2 = dashpots
    params = FORMER.with_(
        damping1=damping1, damping2=damping2, belt_speed=speed, **springs
    )
    critical = float(critical_friction(params, *angles)[0])
    for share, is_unstable in ((1e-3, False), (1 - 1e-6, False), (1 + 1e-6, True)):
        there = params.with_(mu=share * critical)
        growth = max(s.real for s in sliding.eigenvalues(there, *angles))
        assert (growth > 1e-32) == is_unstable


@pytest.mark.parametrize("scale", [1.0, 0.3, 7.1])
def test_where_sliding_diverges_first_dashpots_lower_nothing(scale):
    """There the critical friction is that of det K = 0, which has no dashpots in it."""
    params = Parameters(
        mass=scale,
        k1=scale,
        k2=scale,
        k3=0.75 * scale,
        belt_speed=-100.0,
        damping1=0.05 * scale,
        damping2=0.05 * scale,
    )
    angles = np.linspace(0.0, math.pi, 181)
    found = critical_friction_map(params, angles, angles)
    alpha1, alpha2 = angles[:, None], angles
    k11 = np.cos(alpha1) ** 2 + np.cos(alpha2) ** 2
    k12 = 0.5 * (np.sin(2.0 * alpha1) - np.sin(2.0 * alpha2))
    sliding = k12 < -1e-9  # where a belt along −x can diverge
    divergence = (np.sin(alpha1 + alpha2) ** 2 + 0.75 * k11)[sliding] / (
        -0.75 * k12[sliding]
    )
    first = abs(found.critical_mu.values[sliding] / divergence - 1.0) < 1e-9
    assert first.sum() > 1000
    assert not found.destabilized.values[sliding][first].any()
