"""Labels of motions say what was tested, last as long as they say, and know no left and right."""

from __future__ import annotations

import numpy as np
import pytest

from squealpipe.parameters import Parameters
from squealpipe.schema.dynamics.runs import MotionFlag
from squealpipe.tasks.dynamics.hammering import hammering_map
from squealpipe.tasks.dynamics.motion import linear_time, tell_periodic
from squealpipe.tasks.dynamics.runs import simulate
from squealpipe.tasks.normal_form import NormalForm

BASELINE = Parameters()
REGULAR = (
    MotionFlag.periodic_hammering,
    MotionFlag.quasi_periodic_hammering,
    MotionFlag.regular_hammering,
)


@pytest.mark.parametrize(
    ("motion", "first", "second", "params"),
    [
        (MotionFlag.perpetual_contact, 0.5, 1.0, BASELINE),
        (MotionFlag.stick_slip, 0.0, 0.5, Parameters(belt_speed=0.1)),
        (MotionFlag.quasi_periodic_hammering, 5 / 6, 5 / 6, BASELINE),
        (MotionFlag.irregular_hammering, 0.2, 0.8, BASELINE),
        (MotionFlag.whirl, 0.5, 0.5, BASELINE),
        (MotionFlag.periodic_hammering, 0.0, 0.0, Parameters(mu=0.0)),
    ],
)
def test_motions_are_told_apart(motion, first, second, params):
    result = hammering_map(params, [first * np.pi], [second * np.pi], t_end=500.0)
    assert int(result.motion.item()) == motion


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_labels_follow_from_the_events_of_a_single_run(mu):
    """The same rule applied to ``simulate``, whose runs carry no tangent vector."""
    params, angles = Parameters(mu=mu), np.linspace(0.0, np.pi, 7)
    result = hammering_map(params, angles, angles, t_end=300.0)
    regular = np.argwhere(np.isin(result.motion.values, REGULAR))
    assert len(regular) > 5
    for row, column in regular:
        run = simulate(params, angles[row], angles[column], t_end=300.0, times=[0.0])
        label = tell_periodic(run.event_time.values, run.event_kind.values, 300.0)
        assert label == result.motion.values[row, column]


def test_the_label_at_twice_the_time_is_that_of_a_longer_run():
    angles = np.linspace(0.0, np.pi, 9)
    short = hammering_map(BASELINE, angles, angles, t_end=250.0)
    long = hammering_map(BASELINE, angles, angles, t_end=500.0)
    np.testing.assert_array_equal(short.motion_later, long.motion)
    assert (short.motion_later != short.motion).any()


def random_parameters(seed, *, equal):
    rng = np.random.default_rng(seed)
    k1, k2 = rng.uniform(0.4, 2.5, 2)
    length1, length2 = rng.uniform(3.0, 20.0, 2)
    return Parameters(
        mass=rng.uniform(0.2, 5.0), k1=k1, k2=k1 if equal else k2, k3=rng.uniform(0.3, 1.5),
        mu=rng.uniform(0.0, 0.6), belt_speed=rng.choice([-1, 1]) * rng.choice([0.4, 3.0, 50.0]),
        preload=rng.uniform(0.5, 2.0), length1=length1, length2=length1 if equal else length2,
        damping1=0.0, damping2=0.0 if equal else 0.03,
    )  # fmt: skip


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_system_and_its_mirror_image_have_the_same_labels(seed, equal):
    """x → −x: (α1, α2, V, k1, k2, L1, L2) and (α2, α1, −V, k2, k1, L2, L1)."""
    params = random_parameters(seed, equal=equal)
    image = params.with_(
        belt_speed=-params.belt_speed, k1=params.k2, k2=params.k1,
        length1=params.length2, length2=params.length1,
        damping1=params.damping2, damping2=params.damping1,
    )  # fmt: skip
    assert linear_time(image) == linear_time(params)
    first, second = np.random.default_rng(seed).uniform(0.0, np.pi, (2, 6))
    t_end = 150.0 * linear_time(params)
    here = hammering_map(params, first, second, t_end=t_end)
    there = hammering_map(image, second, first, t_end=t_end)
    for name in ("motion", "motion_later", "impact_rate", "lyapunov_exponent", "outcome"):
        np.testing.assert_array_equal(here[name].values, there[name].values.T, err_msg=name)
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
