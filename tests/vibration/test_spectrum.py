"""Spectrum and its peaks against signals whose lines are known."""

import numpy as np
import pytest

from squealpipe.vibration.spectrum import (
    amplitude_spectrum,
    highest_peaks,
    loudest_line,
)


def test_sinusoid_on_a_line_has_its_amplitude_there_and_a_constant_has_none():
    step, count = 0.1, 400
    omega = 2 * np.pi * 20 / (count * step)
    time = step * np.arange(count)
    signals = np.array([5.0 + 3.0 * np.cos(omega * time + 0.4), np.ones(count)])
    frequency, (amplitude, silence) = amplitude_spectrum(signals, step)
    assert silence.max() < 1e-14
    assert frequency[20] == pytest.approx(omega)
    assert amplitude[20] == pytest.approx(3.0)
    assert amplitude[:18].max() < 1e-12


@pytest.mark.parametrize("offset", [0.0, 0.31, 0.5, 0.87])
def test_two_sinusoids_between_lines_are_found(offset):
    step, count = 0.05, 2000
    resolution = 2 * np.pi / (count * step)
    low, high = (20 + offset) * resolution, (55.3 + offset) * resolution
    time = step * np.arange(count)
    signal = 2.0 * np.sin(low * time) + 0.5 * np.sin(high * time + 1.0)
    found, height = highest_peaks(*amplitude_spectrum(signal, step, padding=8), count=2)
    np.testing.assert_allclose(found, [low, high], atol=resolution / 200)
    np.testing.assert_allclose(height, [2.0, 0.5], rtol=2e-3)


def test_a_motion_has_the_frequency_of_the_loudest_contact_by_its_louder_component():
    """The loudest single line, of contact 0, and what both contacts share are others."""
    step = 1e-4
    time = step * np.arange(1, 4001)

    def sine(amplitude, frequency):
        return amplitude * np.sin(2 * np.pi * frequency * time)

    along = [sine(2.0, 50.0), sine(1.6, 50.0)]
    across = [sine(0.1, 400.0), sine(1.7, 123.4) + sine(0.4, 900.0)]
    velocities = np.array([along, across])
    assert loudest_line([velocities], step) == pytest.approx(123.4, abs=0.05)
    halves = np.split(velocities, 2, axis=-1)
    assert loudest_line(halves, step) == pytest.approx(123.4, abs=0.1)
    assert np.isnan(loudest_line([0.0 * velocities], step))
