"""Levels of an irregular motion against closed forms of its blocks, and what is held of them."""

import weakref

import numpy as np
import pytest

from squealpipe.codes import Regime, Verdict
from squealpipe.vibration.levels import Measurement, Record, levels
from squealpipe.vibration.settled_runs import SettledRun


def test_blocks_of_an_irregular_motion_are_averaged_and_not_held():
    """The 16 records of a disc brake that hammers took 2.5 GB together."""
    count, amplitudes = 12_800, np.array([1.0, 3.0])  # m/s, of two contacts
    alive, most = [], []

    def record(number: int) -> Record:
        times = np.arange(1, count + 1) * 400.0 / count
        velocities = np.zeros((count, 2, 2))
        # mean squares of the blocks are as 1 to 2
        wave = np.sqrt(1.0 + number % 2) * np.sin(2 * np.pi * times)
        velocities[:, :, 0] = wave[:, None] * amplitudes
        states = np.zeros((count, 4))
        alive.append(weakref.ref(states))
        most.append(sum(each() is not None for each in alive))
        return Record(
            times=times,
            states=states,
            displacements=np.zeros((count, 2, 2)),
            velocities=velocities,
            forces=np.ones((count, 2)),
            regimes=np.full((count, 2), Regime.separated),
            open_time=np.outer(times, [0.25, 0.5]),
            stick_time=np.zeros((count, 2)),
            landings=np.zeros((count, 2)),
            peak_forces=np.array([10.0, 20.0 + number]),
            impact_speed=0.5,
            event_times=np.empty(0),
            event_kinds=np.empty(0),
            end=number + 1,
            duration=400.0,
            finished=True,
        )

    settled = SettledRun(Verdict.hammers, None, 400.0, irregular=True)
    scalars, arrays = levels(
        record,
        settled,
        begin=0,
        period=1.0,
        loads=np.array([5.0, 5.0]),
        sliding_forces=None,
    )
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
