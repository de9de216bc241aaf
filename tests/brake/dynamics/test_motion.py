"""Labels of motions say what was tested, last as long as they say, and know no left and right."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import ks_2samp

from squealpipe.brake.dynamics import motion as motions
from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.brake.dynamics.motion import _distance, linear_time, regular_kind
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.normal_form import NormalForm
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.schema import Outcome
from tests.former import FORMER

BASELINE = FORMER
FALLING = FORMER.with_(
    belt_speed=0.1,
    friction_law="exponential",
    mu_static=0.6,
    friction_speed=0.2,
    damping1=0.1,
)
"""Sticks again and again; with Coulomb's law the last stick ends early."""
PERIODIC, TORUS = MotionFlag.periodic_hammering, MotionFlag.quasi_periodic_hammering
REGULAR = (PERIODIC, TORUS, MotionFlag.undetermined)


@pytest.mark.parametrize(
    ("motion", "first", "second", "params"),
    [
        (MotionFlag.contact_kept, 0.5, 1.0, BASELINE),
        (MotionFlag.stick_slip, 0.5, 1.0, FALLING),
        (TORUS, 1 / 6, 1 / 4, BASELINE),
        (MotionFlag.irregular_hammering, 0.2, 0.8, BASELINE),
        (MotionFlag.whirl, 0.5, 0.5, BASELINE),
        (MotionFlag.periodic_hammering, 0.0, 0.0, FORMER.with_(mu=0.0)),
    ],
)
def test_motions_are_told_apart(motion, first, second, params):
    result = hammering_map(params, [first * np.pi], [second * np.pi], t_end=500.0)
    assert int(result.motion.item()) == motion


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_labels_follow_from_the_events_of_a_single_run(mu):
    """The same rule applied to ``simulate``, whose runs carry no tangent vector."""
    params, angles = FORMER.with_(mu=mu), np.linspace(0.0, np.pi, 7)
    result = hammering_map(params, angles, angles, t_end=300.0)
    regular = np.argwhere(
        np.isin(result.motion.values, REGULAR) & (result.outcome.values == 0)
    )
    assert len(regular) > 5
    for row, column in regular:
        run = simulate(params, angles[row], angles[column], t_end=300.0, times=[0.0])
        label = regular_kind(run.event_time.values, run.event_kind.values, 300.0)
        assert label == result.motion.values[row, column]


@pytest.mark.release
def test_labels_of_damped_motion_say_what_it_has_become():
    """Of hammering cells most had no event in the second half, and kept their label."""
    params = FORMER.with_(damping1=0.05, damping2=0.025)
    grid = np.linspace(0.1, 3.0, 12)
    result = hammering_map(params, grid, grid, t_end=1000.0)
    moving = [PERIODIC, TORUS, MotionFlag.irregular_hammering, MotionFlag.whirl]
    hammers = np.isin(result.motion, moving)
    seen = set()
    for row, column in np.ndindex(result.motion.shape):
        angles = result.alpha1.values[row], result.alpha2.values[column]
        times = np.linspace(500.0, 1000.0, 5001)
        run = simulate(params, *angles, t_end=1000.0, times=times)
        label = int(result.motion[row, column])
        seen.add(label)
        events = run.event_time.values
        moved = max(np.ptp(run.x.values), np.ptp(run.y.values))
        moved /= float(result.max_displacement[row, column])
        if (np.abs(events - 500.0) < 10.0).any():
            continue
        assert (events > 500.0).any() or not hammers[row, column]
        if not 5e-4 <= moved <= 4e-3:
            assert (label == MotionFlag.at_rest) == (moved < 5e-4)
        if label in {MotionFlag.hammered_then_contact, MotionFlag.contact_kept}:
            assert (events.size > 0) == (label == MotionFlag.hammered_then_contact)
            assert not (events >= 500.0).any()
    assert {
        MotionFlag.at_rest,
        MotionFlag.hammered_then_contact,
        MotionFlag.contact_kept,
    } <= seen


def si_parameters(rng, *, damped):
    mass, k1, preload = 10.0 ** rng.uniform([-1.5, 5.0, -6.0], [1.0, 8.0, -3.0])
    critical = np.sqrt(mass * k1)
    c1, c2 = critical * 10.0 ** rng.uniform(-4.0, -0.7, 2) if damped else (0.0, 0.0)
    length1, length2 = preload * 10.0 ** rng.uniform(0.4, 1.8, 2)
    return FORMER.with_(
        mass=mass,
        k1=k1,
        k2=k1 * 10.0 ** rng.uniform(-0.5, 0.5),
        k3=k1 * 10.0 ** rng.uniform(-0.6, 0.4),
        mu=rng.uniform(0.0, 0.6) if damped else 0.0,
        belt_speed=rng.choice([-1, 1])
        * 10.0 ** rng.uniform(-1, 2)
        * preload
        * critical
        / mass,
        preload=preload,
        length1=length1,
        length2=length2,
        damping1=c1,
        damping2=c2,
    )


@pytest.mark.parametrize(
    ("damped", "t_end", "least"),
    [(True, 500.0, 0), pytest.param(False, 1000.0, 50, marks=pytest.mark.release)],
)
def test_a_motion_on_a_torus_is_one_at_twice_the_time(damped, t_end, least):
    """Damped motion never is; without friction and dashpots a quarter of the cells is."""
    rng, found, kept = np.random.default_rng(7), 0, 0
    for _ in range(8):
        params, angles = (
            si_parameters(rng, damped=damped),
            rng.uniform(0.0, np.pi, (2, 6)),
        )
        end = t_end * linear_time(params)
        now, later = (
            hammering_map(params, *angles, t_end=each) for each in (end, 2 * end)
        )
        torus = now.motion == TORUS
        found += int(torus.sum())
        kept += int((later.motion.where(torus) == TORUS).sum())
    assert found >= least
    assert kept >= 0.95 * found


def test_a_torus_has_the_same_statistics_in_both_halves():
    """A drift of the intervals, as slow damping makes it, is none."""
    number = np.arange(400)
    kinds = number % 2
    torus = np.cumsum(1.0 + 0.2 * np.sin(number * np.sqrt(2.0)))
    drift = np.cumsum(1.0 + 0.2 * np.sin(number * np.sqrt(2.0)) - 1e-3 * number)
    assert regular_kind(torus, kinds, torus[-1]) == TORUS
    assert regular_kind(drift, kinds, drift[-1]) == MotionFlag.undetermined
    assert regular_kind(torus[:99], kinds[:99], torus[98]) == MotionFlag.undetermined


def random_parameters(seed, *, equal):
    rng = np.random.default_rng(seed)
    k1, k2 = rng.uniform(0.4, 2.5, 2)
    length1, length2 = rng.uniform(3.0, 20.0, 2)
    return FORMER.with_(
        mass=rng.uniform(0.2, 5.0),
        k1=k1,
        k2=k1 if equal else k2,
        k3=rng.uniform(0.3, 1.5),
        mu=rng.uniform(0.0, 0.6),
        belt_speed=rng.choice([-1, 1]) * rng.choice([0.4, 3.0, 50.0]),
        preload=rng.uniform(0.5, 2.0),
        length1=length1,
        length2=length1 if equal else length2,
        damping1=0.0,
        damping2=0.0 if equal else 0.03,
    )


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_system_and_its_mirror_image_have_the_same_labels(seed, equal):
    """x → −x: (α1, α2, V, k1, k2, L1, L2) and (α2, α1, −V, k2, k1, L2, L1)."""
    params = random_parameters(seed, equal=equal)
    image = params.with_(
        belt_speed=-params.belt_speed,
        k1=params.k2,
        k2=params.k1,
        length1=params.length2,
        length2=params.length1,
        damping1=params.damping2,
        damping2=params.damping1,
    )
    assert linear_time(image) == linear_time(params)
    first, second = np.random.default_rng(seed).uniform(0.0, np.pi, (2, 6))
    t_end = 150.0 * linear_time(params)
    here = hammering_map(params, first, second, t_end=t_end)
    there = hammering_map(image, second, first, t_end=t_end)
    for name in (
        "motion",
        "motion_changed",
        "impact_rate",
        "lyapunov_exponent",
        "outcome",
    ):
        np.testing.assert_array_equal(
            here[name].values, there[name].values.T, err_msg=name
        )
    np.testing.assert_array_equal(here.turns.values, -there.turns.values.T)


@pytest.mark.parametrize("seed", range(4))
def test_the_normal_form_is_the_same_system(seed):
    """Its run, turned back, is the run of the system itself."""
    params = random_parameters(seed, equal=seed == 3)
    angles = np.random.default_rng(seed).uniform(0.0, np.pi, 2)
    form = NormalForm.of(params)
    assert form.params.belt_speed >= 0.0
    assert form.params.k1 >= form.params.k2
    times = np.linspace(0.0, 20.0, 41)
    own = simulate(params, *angles, t_end=20.0, times=times)
    normal = simulate(form.params, *form.angles(*angles), t_end=20.0, times=times)
    sign = -1.0 if form.mirrored else 1.0
    np.testing.assert_allclose(sign * normal.x, own.x, atol=1e-7)
    np.testing.assert_allclose(normal.y, own.y, atol=1e-7)


def test_the_distance_of_two_samples_is_that_of_scipy():
    rng = np.random.default_rng(4)
    for sizes in ((3, 3), (7, 40), (200, 150)):
        first, second = (rng.normal(size=size).round(1) for size in sizes)
        assert _distance(first, second) == pytest.approx(
            ks_2samp(first, second).statistic
        )


def test_a_map_of_runs_that_make_no_step_gives_their_reason():
    """A dashpot whose force leaves the range of doubles at the start."""
    stiff = FORMER.with_(damping2=1e155)
    found = hammering_map(stiff, [0.2, 1.0], [1.0, 2.0], t_end=1.0, workers=1)
    assert (found.outcome == Outcome.not_finite).all()
    assert (found.max_displacement == 0.0).all()


def test_labels_do_not_depend_on_the_room_of_the_first_log(monkeypatch):
    first, second = np.array([1 / 6, 0.2, 0.5]) * np.pi, np.array([0.25, 0.8]) * np.pi
    at_once = hammering_map(FORMER, first, second, t_end=500.0)
    short = replace(motions.limits, events_per_time=0.02)
    monkeypatch.setattr(motions, "limits", short)
    again = hammering_map(FORMER, first, second, t_end=500.0)
    assert at_once.equals(again)
    assert TORUS in at_once.motion.values
