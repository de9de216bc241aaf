"""Extrema inside integration steps, against harmonic motions in closed form."""

import numpy as np

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.codes import Event, Regime
from squealpipe.schema import Outcome

SIZE = 200
PERIODS = 20.0


def test_extrema_between_steps_are_as_exact_as_the_states():
    # Equal springs at equal angles without friction: x and y oscillate independently.
    rng = np.random.default_rng(11)
    alpha = rng.uniform(0.2, 1.3, SIZE)
    k3 = rng.uniform(0.5, 20.0, SIZE)
    omega_x = np.sqrt(2.0) * np.cos(alpha)
    omega_y = np.sqrt(2.0 * np.sin(alpha) ** 2 + k3)
    rest = k3 / omega_y**2
    amplitude_x, phase_x, phase_y = (
        rng.uniform(0.1, 1.0, SIZE),
        *rng.uniform(0, 6.2, (2, SIZE)),
    )
    amplitude_y = 0.9 * (1.0 - rest)
    x, vx = amplitude_x * np.cos(phase_x), -amplitude_x * omega_x * np.sin(phase_x)
    y, vy = (
        rest + amplitude_y * np.cos(phase_y),
        -amplitude_y * omega_y * np.sin(phase_y),
    )
    state = np.stack([x, y, vx, vy], axis=-1)
    t_end = PERIODS * 2 * np.pi / omega_x
    parameters = {"k1": 1.0, "k2": 1.0, "k3": k3, "mu": 0.0}
    options = {"model": "A4", "t_end": t_end, "t_late": 0.5 * t_end}
    run = run_ensemble(parameters, alpha, alpha, initial_state=state, **options)
    assert (run.separations == 0).all()
    exact = {
        "peak_contact_force": 1.0 - rest + amplitude_y,
        "lowest_contact_force": 1.0 - rest - amplitude_y,
        "early_max_x": amplitude_x,
        "late_max_x": amplitude_x,
        "late_max_vx": amplitude_x * omega_x,
    }
    for name, value in exact.items():
        np.testing.assert_allclose(
            getattr(run, name), value, rtol=0, atol=2e-11, err_msg=name
        )
    state[:, [0, 2]] = 0.0
    along_y = run_ensemble(parameters, alpha, alpha, initial_state=state, **options)
    np.testing.assert_allclose(
        along_y.max_displacement, rest + amplitude_y, rtol=0, atol=2e-11
    )


FOUND_BY_SEARCH = [272, 415, 2339, 3283, 5660, 7001]
"""Of 8,000 random runs, those in which an extremum was missed: by Newton's method, which left the
step, and where a quantity turns twice in one step."""


def test_no_sample_exceeds_an_extremum():
    """Linear springs: long steps, in which distances turn twice or have several inflections."""
    rng, size = np.random.default_rng(3), 8000
    ratio = {
        name: np.exp(rng.uniform(low, high, size))
        for name, low, high in (("k1", -1, 1), ("k2", -1, 1), ("k3", -2, 1.5))
    }
    ratio["mu"] = rng.uniform(0, 0.9, size)
    for name in ("length1", "length2"):
        ratio[name] = np.exp(rng.uniform(0.7, 3, size))
    ratio["belt_speed"] = rng.choice([-1, 1], size) * np.exp(rng.uniform(-2, 5, size))
    alpha1, alpha2 = rng.uniform(0, np.pi, (2, size))
    kept = [*FOUND_BY_SEARCH, *range(200)]
    times = np.linspace(0.0, 30.0, 6001)
    run = run_ensemble(
        {name: values[kept] for name, values in ratio.items()},
        alpha1[kept],
        alpha2[kept],
        t_end=30.0,
        model="A1-linear-springs",
        times=times,
        t_late=15.0,
    )
    done = run.outcome == Outcome.converged
    assert done[: len(FOUND_BY_SEARCH)].all()
    x, y = run.samples[done, :, 0], run.samples[done, :, 1]
    slack = 1e-10 * (1.0 + np.hypot(x, y).max(axis=1))
    assert (np.hypot(x, y).max(axis=1) <= run.max_displacement[done] + slack).all()
    early = np.abs(x[:, times < 15.0]).max(axis=1)
    assert (early <= run.early_max_x[done] + slack).all()


def test_forces_and_speeds_of_returns_and_sums_on_the_way():
    """Against samples and logged events; the peak force itself is that of the start."""
    angles = np.pi * np.array([[0.2, 0.8], [5 / 6, 5 / 6], [0.0, 0.0], [0.5, 1.0]])
    times = np.linspace(0.0, 200.0, 40_001)
    parameters = {"k3": 0.75, "length1": 5.0, "length2": 5.0}
    run = run_ensemble(
        parameters,
        *angles.T,
        t_end=200.0,
        times=times,
        sums=True,
        t_late="return",
        log_events=500,
    )
    assert (run.peak_contact_force >= 1.0).all()
    assert (run.return_peak_contact_force[:3] != run.peak_contact_force[:3]).any()
    assert np.isnan(run.impact_speed[3])
    assert np.isnan(run.return_peak_contact_force[3])
    for row in range(3):
        returns = run.event_kinds[row] == Event.contact
        assert run.impact_speed[row] == np.abs(run.event_states[row, returns, 3]).max()
        after = times >= run.event_times[row, returns][0]
        largest = 1.0 - run.samples[row, after, 1].min()
        np.testing.assert_allclose(
            run.return_peak_contact_force[row], largest, atol=1e-4
        )
        for at in (10_000, 30_000):
            before = run.event_times[row, returns] <= times[at]
            assert run.sample_contacts[row, at] == np.count_nonzero(before)
        apart = (
            np.mean(run.sample_regimes[row, :30_000] == Regime.separated)
            * times[30_000]
        )
        np.testing.assert_allclose(
            run.sample_separated_time[row, 30_000], apart, atol=0.1
        )
