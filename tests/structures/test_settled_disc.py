"""The disc brake's settled motion, irregular, beside time steps that locate no event.

From one state the paths agree as far as chaos allows, the closer the smaller the steps; behind it
the statistics do.
"""

import numpy as np
import pytest

from squealpipe.structures import disc_brake
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.windows import Running, run_windows
from tests.oracles.time_stepping import TimeStepping

pytestmark = pytest.mark.release


@pytest.fixture(scope="module")
def plant():
    return Plant(disc_brake(modal_damping=5e-4).reduce(frequency_max=5e3))


@pytest.fixture(scope="module")
def loud(plant):
    """The motion 60 ms after three random starts of nearly its energy."""
    away = plant.random_states(3, 0) - plant.sliding
    states = plant.sliding + 40.0 * away
    return run_windows(plant, states, 0.06, Running(1e-12, workers=1))


def test_paths_from_one_state_come_closer_as_steps_get_smaller(plant, loud):
    """Friction jumps within a step, so that the error is of first order."""
    size = plant.size
    state, times = loud.final[0], np.linspace(0.0, 4e-4, 201)[1:]
    names = [f"{kind}{i + 1}" for kind in "qv" for i in range(size)]
    start = dict(zip(names, state.tolist(), strict=True))
    motion = plant.structure.system().simulate(times[-1], times=times, start=start)
    ours = np.stack([motion[f"v{i + 1}"].values for i in range(size)], axis=1)
    other = TimeStepping(plant.structure)
    errors = []
    for between in (80, 160, 320):  # in 2 µs
        theirs = other.run(state, 2e-6 / between, len(times), between).velocities
        errors.append(np.abs(theirs - ours[-len(times) :]).max() / np.abs(ours).max())
    assert errors[0] < 0.02
    assert errors[2] < 0.4 * errors[0]


def test_statistics_are_those_of_time_steps(plant, loud):
    ours = run_windows(plant, loud.final, 0.06, Running(1e-12, workers=1), loud.regimes)
    other = TimeStepping(plant.structure)
    runs = [other.run(state, 1e-7, 30_000, 20) for state in loud.final]
    energies = [0.5 * (run.velocities**2).sum(axis=1).mean() for run in runs]
    # it swings by 5 % from window to window
    assert np.mean(energies) == pytest.approx(0.5 * (ours.total**2).mean(), rel=0.06)
    separated = np.mean([run.separated for run in runs], axis=0)
    assert separated == pytest.approx(ours.separated.mean(axis=0), abs=0.02)
    # a reversal within a step passes for stick
    assert ours.stuck.mean() < np.mean([run.stuck for run in runs]) < 1e-3
