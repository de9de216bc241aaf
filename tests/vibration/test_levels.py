"""Levels of an irregular motion against closed forms of its blocks, and what is held of them."""

import weakref
from dataclasses import replace

import numpy as np
import pytest

from squealpipe.codes import Regime, Verdict
from squealpipe.vibration.levels import Measurement, Record, levels
from squealpipe.vibration.settled_runs import SettledRun

COUNT = 12_800
"""Samples of a record."""


def block(number, wave, amplitudes=(1.0, 3.0)):
    """One record of 400 s of two contacts that move along the belt, m/s."""
    times = np.arange(1, COUNT + 1) * 400.0 / COUNT
    velocities = np.zeros((COUNT, 2, 2))
    velocities[:, :, 0] = wave(times)[:, None] * amplitudes
    return Record(
        times=times,
        states=np.zeros((COUNT, 4)),
        displacements=np.zeros((COUNT, 2, 2)),
        velocities=velocities,
        forces=np.ones((COUNT, 2)),
        regimes=np.full((COUNT, 2), Regime.separated),
        open_time=np.outer(times, [0.25, 0.5]),
        stick_time=np.zeros((COUNT, 2)),
        landings=np.zeros((COUNT, 2)),
        peak_forces=np.array([10.0, 20.0 + number]),
        impact_speed=0.5,
        event_times=np.empty(0),
        event_kinds=np.empty(0),
        end=number + 1,
        duration=400.0,
        finished=True,
    )


def measured(record):
    """Levels of an irregular motion that hammers, from its records."""
    return levels(
        record,
        SettledRun(Verdict.hammers, None, 400.0, irregular=True),
        begin=0,
        period=1.0,
        loads=np.array([5.0, 5.0]),
        sliding_forces=None,
    )


@pytest.mark.parametrize(("louder", "counts_as"), [(2.95, 2.95 / 3), (2.5, 2.5)])
def test_a_multiple_that_is_loudest_in_some_blocks_is_no_scatter(louder, counts_as):
    """Impacts of a disc brake made 8.1 kHz lead in parts of a motion at 2.76 kHz."""

    def record(number):
        other = 1.5 * (number % 4 == 3)
        return block(
            number,
            lambda t: np.sin(2 * np.pi * t) + other * np.sin(2 * np.pi * louder * t),
        )

    scalars, _ = measured(record)
    assert scalars["frequency"] == pytest.approx(1.0, abs=1e-3)
    lines = np.where(np.arange(Measurement.blocks) % 4 == 3, counts_as, 1.0)
    assert scalars["frequency_error"] == pytest.approx(lines.std(ddof=1), rel=1e-2)


def test_blocks_of_an_irregular_motion_are_averaged_and_not_held():
    """The 16 records of a disc brake that hammers took 2.5 GB together."""
    amplitudes = np.array([1.0, 3.0])  # m/s, of two contacts
    alive, most = [], []

    def record(number: int) -> Record:
        # mean squares of the blocks are as 1 to 2
        size = np.sqrt(1.0 + number % 2)
        made = block(number, lambda t: size * np.sin(2 * np.pi * t), amplitudes)
        alive.append(weakref.ref(made.states))
        most.append(sum(each() is not None for each in alive))
        return made

    scalars, arrays = measured(record)
    assert len(alive) == Measurement.blocks
    assert (
        max(most) <= 3
    )  # the first, the one that is measured, and the one that is made
    rms = np.sqrt(1.5 * amplitudes**2 / 2)
    assert arrays["contact_velocity_rms"][:, 0] == pytest.approx(rms, rel=1e-4)
    assert arrays["contact_velocity_rms"][:, 1] == pytest.approx(0.0)
    assert arrays["contact_separated_fraction"] == pytest.approx([0.25, 0.5])
    assert arrays["contact_peak_force"] == pytest.approx([10.0, 35.0])
    assert scalars["velocity_rms_along"] == pytest.approx(
        np.sqrt(np.mean(rms**2)), rel=1e-4
    )
    assert scalars["separated_fraction"] == pytest.approx(0.5)
    assert scalars["frequency"] == pytest.approx(1.0, abs=1e-3)


def test_the_largest_displacement_is_that_from_the_mean():
    """A contact moves on an ellipse about a point that is not where it has no force."""

    def record(number):
        made = block(number, lambda t: np.sin(2 * np.pi * t))
        turn = 2 * np.pi * made.times
        moved = made.displacements.copy()
        moved[:, 1] = np.stack([0.3 + 4.0 * np.sin(turn), 3.0 * np.cos(turn) - 0.2], -1)
        return replace(made, displacements=moved)

    scalars, _ = measured(record)
    assert scalars["displacement_peak"] == pytest.approx(4.0, rel=1e-3)
