"""Long sums of constants times series, as loops over tables."""

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe import Component, Switch, System
from squealpipe.systems.taylor import sums

SIZE, CONTACTS = 6, 2


def matrices():
    rng = np.random.default_rng(3)
    return rng.normal(size=(SIZE, SIZE)), rng.normal(size=(CONTACTS, SIZE))


def coupled():
    """x′ = A x + Σ gₖ bₖ with gₖ = 1 until bₖᵀx has fallen through −0.5, then a parameter."""
    matrix, rows = matrices()

    def product(row, s, constant=0.0):
        return sum(
            (float(a) * getattr(s, f"x{i}") for i, a in enumerate(row)), constant
        )

    def field(t, s, p, r):
        gains = [r.a.on + (1.0 - r.a.on) * p.gain, r.b.on + (1.0 - r.b.on) * p.gain]
        return {
            f"x{i}": product(row, s)
            + sum(float(b) * gain for b, gain in zip(rows[:, i], gains, strict=True))
            for i, row in enumerate(matrix)
        }

    def component(row):
        return Component(
            {"on": {"on": 1.0}, "off": {"on": 0.0}},
            [Switch("ends", "on", lambda t, s, p, r: product(row, s, 0.5), "off")],
        )

    return System(
        "coupled",
        states={f"x{i}": "1" for i in range(SIZE)},
        parameters={"gain": -0.7},
        components={"a": component(rows[0]), "b": component(rows[1])},
        field=field,
        start={f"x{i}": 0.1 * i for i in range(SIZE)},
    )


def exact(times, run):
    """The motion by matrix exponentials between the events of a run."""
    matrix, rows = matrices()
    state = np.array([*(0.1 * i for i in range(SIZE)), 1.0])
    gains, now, found = np.ones(CONTACTS), 0.0, []
    names = [
        run.event_kind.attrs["flag_meanings"].split()[k] for k in run.event_kind.values
    ]
    stops = [*zip(run.event_time.values, names, strict=True), (np.inf, "")]
    pending = list(times)
    for stop, name in stops:
        full = np.zeros((SIZE + 1, SIZE + 1))
        full[:SIZE, :SIZE], full[:SIZE, SIZE] = matrix, gains @ rows
        while pending and pending[0] <= stop:
            found.append(expm(full * (pending.pop(0) - now)) @ state)
        if name:
            state, now = expm(full * (stop - now)) @ state, stop
            place = "ab".index(name[0])
            assert abs(rows[place] @ state[:SIZE] + 0.5) < 1e-11 * abs(state).max()
            gains[place] = -0.7
    return np.array(found)[:, :SIZE]


def test_a_system_of_long_sums_moves_as_matrix_exponentials_say():
    system, times = coupled(), np.linspace(0.0, 3.0, 11)
    run = system.simulate(3.0, times=times)
    assert run.sizes["event"] == 2
    found = np.array([run[name].values for name in system.states]).T
    truth = exact(times, run)
    np.testing.assert_allclose(found, truth, rtol=0, atol=1e-11 * abs(truth).max())


@pytest.mark.parametrize("horizon", [False, True])
def test_loops_and_lines_agree(monkeypatch, horizon):
    options = {"start": {"x0": np.array([0.0, 0.2])}, "horizon": horizon}
    loops = coupled().ensemble(3.0, **options)
    assert sums.SHORTEST < SIZE
    monkeypatch.setattr(sums, "SHORTEST", 1000)
    lines = coupled().ensemble(3.0, **options)
    for name in ("x0", "x5", "count_a_ends", "first_b_ends"):
        np.testing.assert_allclose(loops[name], lines[name], rtol=1e-13)
