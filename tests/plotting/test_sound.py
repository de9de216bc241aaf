"""Sounds of runs, against their own Fourier transforms and against tones that are known exactly."""

import io
import re

import numpy as np
import pytest
import scipy.io.wavfile
import xarray as xr

from squealpipe import Parameters, assess, load, simulate
from squealpipe.brake.dynamics.again import settled_run, simulated_again
from squealpipe.cli import run
from squealpipe.plotting.sound import SAMPLING_RATE, TooCoarseError, sound
from squealpipe.store import save

PAD = Parameters(
    mass=0.45,
    k1=1e7,
    k2=1e7,
    k3=7e6,
    preload=5.714e-4,
    mu=0.37,
    mu_static=0.55,
    friction_speed=1.7,
    friction_law="exponential",
    belt_speed=2.0,
    length1=0.1,
    length2=0.1,
    damping1=42.4,
    damping2=42.4,
)


def strongest(signal, rate):
    """Frequency of the highest line of a Hann-windowed signal, Hz, by its own FFT."""
    lines = np.abs(np.fft.rfft((signal - signal.mean()) * np.hanning(signal.size)))
    top = int(lines[1:].argmax()) + 1
    before, middle, after = np.log(lines[top - 1 : top + 2])
    shift = 0.5 * (before - after) / (before - 2 * middle + after)
    return (top + shift) * rate / signal.size


def heard(content):
    """Samples of a wav file, as scipy reads them."""
    rate, samples = scipy.io.wavfile.read(io.BytesIO(content))
    assert rate == SAMPLING_RATE
    assert samples.dtype == np.int16
    return samples.astype(float)


def written(x, y, step):
    """A run with velocities that are given."""
    time = step * np.arange(len(x))
    zeros = np.zeros(len(x))
    angles = {"alpha1": 0.4, "alpha2": 0.8, "preload": 1e-3}
    return xr.Dataset(
        {
            "x": ("time", np.cumsum(x) * step),
            "y": ("time", np.cumsum(y) * step),
            "vx": ("time", x),
            "vy": ("time", y),
            "normalized_contact_force": ("time", zeros),
            "regime": ("time", zeros.astype(int)),
        }
        | angles,
        {"time": time},
        {
            "schema": "simulation",
            "parameters": '{"length1": 0.1, "length2": 0.1, "belt_speed": 2.0}',
        },
    )


def tones(frequencies, seconds, rate):
    """Sum of sines with a phase of their own each."""
    time = np.arange(round(seconds * rate)) / rate
    return sum(
        np.sin(2 * np.pi * f * time + k) / (k + 1) for k, f in enumerate(frequencies)
    )


@pytest.mark.parametrize(
    ("params", "degrees", "t_end", "speed"),
    [
        (PAD, (22.0, 46.0), 0.3, 1.0),
        (PAD, (35.0, 50.0), 0.2, 1.0),
        (PAD.with_(belt_speed=-3.0), (30.0, 60.0), 0.2, 1.0),
        (Parameters(mu=0.2), (150.0, 150.0), 100.0, 1000.0),
    ],
)
def test_the_strongest_line_of_a_pad_is_heard(params, degrees, t_end, speed):
    pad = simulate(params, *np.radians(degrees), t_end=t_end)
    half = pad.sizes["time"] // 2
    louder = max((pad.vx.values[half:], pad.vy.values[half:]), key=np.std)
    truth = strongest(louder, 1.0 / float(pad.time[1]))
    samples = heard(sound(pad, speed=speed).wav(3.0))
    assert samples.size == 3 * SAMPLING_RATE
    assert strongest(samples, SAMPLING_RATE) == pytest.approx(truth * speed, rel=2e-3)
    if degrees == (22.0, 46.0):
        assert strongest(samples, SAMPLING_RATE) == pytest.approx(830.9, abs=5.0)


def test_a_periodic_motion_is_looped_without_a_click():
    """Between the harmonics of a tone a click would be heard; there is silence, 80 dB down."""
    base = 437.31
    tone = tones([base, 2 * base, 3 * base], 0.2, 30e3)
    made = sound(written(0.1 * tone, tone, 1 / 30e3))
    samples = heard(made.wav(3.0))[SAMPLING_RATE // 4 : -SAMPLING_RATE // 4]
    lines = np.abs(np.fft.rfft(samples * np.blackman(samples.size)))
    frequency = np.fft.rfftfreq(samples.size, 1 / SAMPLING_RATE)
    away = np.abs(frequency / base - np.round(frequency / base)) * base
    between = lines[(away > 10.0) | (frequency < 100.0) | (frequency > 1400.0)]
    assert between.max() < 1e-4 * lines.max()
    assert strongest(samples, SAMPLING_RATE) == pytest.approx(base, abs=0.1)
    assert "cross-faded" not in made.told()


def test_a_motion_that_does_not_repeat_keeps_its_level_across_the_fade():
    rng = np.random.default_rng(3)
    lines = rng.uniform(500.0, 900.0, 40)
    noise = sum(
        np.sin(2 * np.pi * f * np.arange(40_000) / 4e4 + p)
        for f, p in zip(lines, rng.uniform(0, 6, 40), strict=True)
    )
    made = sound(written(noise, 0.1 * noise, 1 / 4e4), seconds=2.0)
    assert "does not repeat" in made.told()
    samples = heard(made.wav(2.0))[480:-480]
    jumps = np.abs(np.diff(samples, 2)).max() / np.abs(samples).max()
    assert jumps < 1.2 * (2 * np.pi * 900.0 / SAMPLING_RATE) ** 2
    loop = made.loop
    quarter = loop.size // 4
    last, rest = loop[-quarter:], loop[:-quarter]
    assert last.std() == pytest.approx(rest.std(), rel=0.3)


def test_the_file_says_how_fast_it_is_played_and_stays_below_full_scale():
    tone = tones([41_600.0, 83_200.0], 0.01, 1e6)
    made = sound(written(tone, 0 * tone, 1e-6), speed=0.1)
    content = made.wav(1.5)
    assert content.index(b"LIST") > content.index(b"data")
    assert int.from_bytes(content[4:8], "little") == len(content) - 8
    told = re.search(rb"ICMT....([^\0]+)", content, re.DOTALL).group(1).decode()
    assert told == made.told()
    assert "10 times slower than in reality: heard at 4.16 kHz" in told
    samples = heard(content)
    assert strongest(samples, SAMPLING_RATE) == pytest.approx(4160.0, abs=2.0)
    peak = 20 * np.log10(np.abs(samples).max() / 32767)
    assert peak == pytest.approx(-3.0, abs=0.01)


def test_a_coarse_run_is_integrated_again_by_what_it_states(tmp_path):
    times = np.linspace(0.0, 0.2, 700)
    coarse = load(
        save(
            simulate(PAD, *np.radians((22, 46)), t_end=0.2, times=times),
            tmp_path / "r.nc",
        )
    )
    with pytest.raises(TooCoarseError, match="--points"):
        sound(coarse)
    made = sound(coarse, again=lambda times: simulated_again(coarse, times))
    assert made.frequency == pytest.approx(828.0, abs=3.0)


def test_the_remedy_for_a_coarse_run_suffices():
    angles = np.radians((22, 46))
    coarse = simulate(PAD, *angles, t_end=0.2, times=np.linspace(0.0, 0.2, 700))
    with pytest.raises(TooCoarseError) as refused:
        sound(coarse)
    points = int(re.search(r"--points (\d+)", str(refused.value)).group(1))
    fine = simulate(PAD, *angles, t_end=0.2, times=np.linspace(0.0, 0.2, points))
    assert sound(fine).frequency == pytest.approx(828.0, abs=3.0)


@pytest.mark.parametrize(
    ("factor", "message"),
    [
        (lambda t: np.exp(-60.0 * t), "nothing is heard: the motion has died out"),
        (lambda t: np.exp(3.0 * t), "has not settled"),
        (lambda t: 0.0 * t, "nothing is heard"),
    ],
)
def test_a_quiet_or_growing_run_is_refused(factor, message):
    rate = 20e3
    tone = tones([500.0], 1.0, rate)
    tone *= factor(np.arange(tone.size) / rate)
    with pytest.raises(ValueError, match=message):
        sound(written(tone, 0.3 * tone, 1 / rate))


def test_a_short_run_and_a_pitch_that_nobody_hears_are_refused_with_a_remedy_that_works():
    with pytest.raises(ValueError, match="too short"):
        sound(written(np.ones(5), np.ones(5), 1e-3))
    with pytest.raises(ValueError, match=r"too short.*--t-end"):
        sound(written(*2 * [tones([500.0], 0.015, 2e4)], 5e-5))
    for frequency, option in ((41_600.0, "--slow 10"), (0.157, "--fast 1000")):
        tone = tones([frequency], 60 / frequency, 20 * frequency)
        slowly = written(tone, 0.5 * tone, 0.05 / frequency)
        with pytest.raises(ValueError, match=option):
            sound(slowly)
        factor = float(option.split()[1])
        speed = factor if "fast" in option else 1 / factor
        assert sound(slowly, speed=speed).frequency == pytest.approx(
            frequency, rel=1e-3
        )
    with pytest.raises(ValueError, match="is no run"):
        sound(xr.Dataset(attrs={"schema": "stability_map"}))
    # the answer for a structure, which has no angles
    with pytest.raises(ValueError, match="squeal --run"):
        sound(xr.Dataset(attrs={"schema": "assess"}))


def test_the_component_that_is_asked_for_is_heard():
    along, across = tones([300.0], 0.3, 2e4), 0.1 * tones([700.0], 0.3, 2e4)
    both = written(along, across, 5e-5)
    assert sound(both).frequency == pytest.approx(300.0, abs=0.5)
    assert sound(both, at="y").frequency == pytest.approx(700.0, abs=0.5)
    with pytest.raises(ValueError, match=r"at = 'z'.*x, y"):
        sound(both, at="z")


def test_the_command_writes_a_sound(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    save(simulate(PAD, *np.radians((22, 46)), t_end=0.15), "run.nc")
    assert run(["listen", "run.nc", "--fast", "2", "--seconds", "1.5"]) == 0
    told = capsys.readouterr().out
    assert "828.5 Hz, played 2 times faster than in reality: heard at 1.657 kHz" in told
    samples = heard((tmp_path / "run.wav").read_bytes())
    assert samples.size == 1.5 * SAMPLING_RATE
    assert strongest(samples, SAMPLING_RATE) == pytest.approx(2 * 828.5, abs=2.0)
    assert run(["listen", "run.nc"]) == 2
    assert "--force" in capsys.readouterr().err
    assert run(["listen", "run.nc", "--fast", "2", "--slow", "2", "--force"]) == 2


@pytest.mark.release
def test_the_settled_motion_of_an_answer_is_run_on_to_be_heard():
    answer = assess(PAD, *np.radians((22, 46)), tol=1e-9)
    longer = settled_run(answer)
    made = sound(longer)
    assert made.frequency == pytest.approx(float(answer.frequency), rel=5e-3)
    half = longer.vy.values[longer.sizes["time"] // 2 :]
    assert half.std() == pytest.approx(float(answer.velocity_rms_across), rel=0.05)
