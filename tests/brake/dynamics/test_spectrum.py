"""The spectrum of a run against SciPy's windowed transform, and its lines against the motion."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.signal import periodogram

from squealpipe import Parameters, load, save, simulate, spectrum, stability_map
from squealpipe.cli import run

PAD = Parameters(
    mass=0.45,
    k1=1e7,
    k2=1e7,
    k3=7e6,
    preload=5.7e-4,
    mu=0.1,
    belt_speed=50.0,
    length1=0.1,
    length2=0.1,
)
ANGLES = np.radians((80.0, 20.0))


@pytest.fixture(scope="module")
def motion():
    times = np.linspace(0.0, 0.4, 8001)
    start = (0.0, 1e-4, 0.0, 0.0)
    return simulate(PAD, *ANGLES, t_end=0.4, times=times, initial_state=start)


def test_amplitudes_are_those_of_scipy(motion):
    found = spectrum(motion)
    signal = motion.vy.values
    window = np.hanning(signal.size + 1)[:-1]
    centred = signal - np.average(signal, weights=window)
    step = float(motion.time[1])
    frequency, power = periodogram(
        centred,
        1 / step,
        window="hann",
        nfft=8 * signal.size,
        detrend=False,
        scaling="spectrum",
    )
    np.testing.assert_allclose(found.frequency, frequency, atol=1e-9)
    # power of a sinusoid is half the square of its amplitude
    np.testing.assert_allclose(
        found.velocity_across[1:-1],
        np.sqrt(2 * power[1:-1]),
        atol=1e-9 * np.sqrt(power.max()),
    )
    assert float(found.resolution) == pytest.approx(1 / 0.4, rel=1e-3)


def test_lines_of_a_small_motion_are_the_modes_of_the_linear_model(motion):
    found = spectrum(motion, last=0.2)
    modes = np.sort(stability_map(PAD, *ANGLES[:, None]).frequency.values.ravel())
    assert np.sort(found.peak_frequency)[:2] == pytest.approx(
        modes / (2 * math.pi), rel=0.01
    )
    assert float(found.resolution) == pytest.approx(1 / 0.2, rel=1e-2)


def test_the_command_writes_it_in_hertz(motion, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    save(motion, "run.nc")
    words = ["spectrum", "run.nc", "--last", "200 ms", "-p", "s.png"]
    assert run([*words, "-o", "s.nc"]) == 0
    told = capsys.readouterr().out
    highest = float(load("s.nc").peak_frequency[0])
    assert f"{highest:.4g} Hz" in told or f"{highest / 1e3:.4g} kHz" in told
    assert run([*words, "-o", "s.csv", "--force"]) == 0
    assert "frequency [Hz]" in (tmp_path / "s.csv").read_text()
    table = pd.read_csv("s.csv", comment="#")
    at = table.contact_force.idxmax()
    assert table.frequency[at] == pytest.approx(highest, abs=1.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda run: run.isel(time=slice(5)), "too few for a spectrum"),
        (lambda run: run.isel(time=[*range(30), *range(31, 60)]), "not uniform"),
        (lambda _: stability_map(PAD, *ANGLES[:, None]), "is no run"),
    ],
)
def test_what_has_no_spectrum_is_refused(motion, change, message):
    with pytest.raises(ValueError, match=message):
        spectrum(change(motion))
