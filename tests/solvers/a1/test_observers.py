"""Extrema inside integration steps, against harmonic motions in closed form."""

from __future__ import annotations

import numpy as np

from squealpipe.solvers.a1.ensemble import run_ensemble

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
    amplitude_x, phase_x, phase_y = rng.uniform(0.1, 1.0, SIZE), *rng.uniform(0, 6.2, (2, SIZE))
    amplitude_y = 0.9 * (1.0 - rest)
    state = np.stack(
        [
            amplitude_x * np.cos(phase_x),
            rest + amplitude_y * np.cos(phase_y),
            -amplitude_x * omega_x * np.sin(phase_x),
            -amplitude_y * omega_y * np.sin(phase_y),
        ],
        axis=-1,
    )
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
    }
    for name, value in exact.items():
        np.testing.assert_allclose(getattr(run, name), value, rtol=0, atol=2e-11, err_msg=name)
    state[:, [0, 2]] = 0.0
    along_y = run_ensemble(parameters, alpha, alpha, initial_state=state, **options)
    np.testing.assert_allclose(along_y.max_displacement, rest + amplitude_y, rtol=0, atol=2e-11)
