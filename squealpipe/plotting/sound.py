"""Make the settled part of a run audible: 48 kHz, 16 bit, looped without a click.

Idea: a loop is a stretch of the motion whose end is cross-faded into what came before its
beginning. Its length is the lag at which the motion resembles itself most, so a periodic motion is
repeated after a whole number of periods, and its cross-fade changes nothing. The less both ends
resemble one another the more the sum of both would be too quiet; so it is divided by the rms that
their correlation ρ leaves, √((1 − w)² + w² + 2 ρ w (1 − w)).

Source: Fink, Holters and Zölzer, Signal-matched power-complementary cross-fading and dry-wet
mixing, DAFx-16 (2016). The loop is resampled as what it is, one period of a periodic signal
(`scipy.signal.resample`), so that nothing above half the rate of the file is folded down.
Invariant: pitch is right to half a sample of a loop. Cost: some Fourier transforms of as many
samples as are heard.
"""

import io
import math
import struct
import wave
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.interpolate import make_interp_spline
from scipy.signal import correlate, resample

from squealpipe.codes import Regime
from squealpipe.plotting.pad_motion import PadMotion
from squealpipe.plotting.structure_motion import SCHEMA as STRUCTURE_RUN
from squealpipe.plotting.structure_motion import StructureMotion
from squealpipe.store.whole_files import whole_file
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number
from squealpipe.vibration.parabola import vertex
from squealpipe.vibration.settling import WindowLevels, difference
from squealpipe.vibration.spectrum import (
    FEWEST,
    amplitude_spectrum,
    step_of,
    strongest_lines,
)

SAMPLING_RATE = 48_000
"""Samples of a file in a second."""


@dataclass(frozen=True)
class Listening:
    """Thresholds of what is heard; each comment says what another value would do."""

    peak: float = -3.0
    """Largest sample, dB of full scale. 0 clips in players that resample."""
    level_agreement: float = 0.12
    """Largest difference of the levels of both halves of a settled part, over the level: 1 dB,
    which nobody hears. Twice as much: motions that still grow or die out are looped."""
    tails: tuple[float, ...] = (0.5, 0.75)
    """Shares of a run after which it may have settled, tried in turn. Earlier ones let in the
    transient, which changes the level little but the pitch."""
    fewest_periods: float = 5.0
    """Periods of the strongest line in a settled part. Half as many: no line, only drift."""
    quiet: float = 1e-3
    """Rms velocity over the largest of the run, and 1000 times that over the belt's speed, below
    which a motion has died out (60 dB). A tenth: round-off is amplified to a tone."""
    audible: float = 1e-2
    """Amplitude over that of the strongest line above which a line counts as heard (40 dB below
    it). A tenth: kinks at stick demand rates far beyond what an ear resolves."""
    samples_per_period: float = 4.0
    """Samples in a period of the highest line that is heard. Half as many is the least that holds
    the line at all, and its amplitude is lost between samples."""
    finest: int = 64
    """Factor by which a run is sampled more finely at most when it is integrated again."""
    hearing: tuple[float, float] = (20.0, 20e3)
    """Frequencies that an ear hears, Hz."""
    comfortable: tuple[float, float] = (100.0, 8e3)
    """Frequencies to which a remedy leads, Hz."""
    repeats: float = 0.999
    """Correlation of both ends of a loop from which the motion repeats. Below it a short loop has
    a beat of its own, which is said."""
    fade: float = 0.005
    """Length of the fades at both ends of a file, s. Without them a player clicks there."""


COMPONENTS = ("x", "y")


class TooCoarseError(ValueError):
    """A run is sampled too coarsely to be heard."""


@dataclass(frozen=True)
class Sound:
    """A loop of the velocity of a settled motion.

    Attributes:
        loop: (n,) samples of the loop at 48 kHz, −1 to 1.
        component: words for what moves.
        frequency: strongest line of the velocity, Hz.
        speed: how many times faster than in reality it is played.
        correlation: of both ends of the loop; 1 where the motion repeats.
    """

    loop: np.ndarray
    component: str
    frequency: float
    speed: float
    correlation: float

    def samples(self, seconds: float) -> np.ndarray:
        """Return the loop repeated for some time, faded in and out, (n,) of 16 bit."""
        count = max(round(seconds * SAMPLING_RATE), 2)
        played = np.resize(self.loop, count)
        edge = min(round(Listening.fade * SAMPLING_RATE), count // 2)
        ramp = np.sin(0.5 * np.pi * (np.arange(edge) + 0.5) / edge) ** 2
        played[:edge] *= ramp
        played[-edge:] *= ramp[::-1]
        top = 10 ** (Listening.peak / 20) / max(float(np.abs(played).max()), 1e-300)
        return np.round(32767 * top * played).astype("<i2")

    def told(self) -> str:
        """Say in a line what is heard, and at which speed."""
        line = f"velocity {self.component}, strongest line {engineering(self.frequency, 'Hz', 4)}"
        if self.speed != 1.0:
            faster = self.speed > 1.0
            factor = number(self.speed if faster else 1.0 / self.speed)
            heard = engineering(self.frequency * self.speed, "Hz", 4)
            line += (
                f", played {factor} times {'faster' if faster else 'slower'} than in reality: "
                f"heard at {heard}"
            )
        length = self.loop.size / SAMPLING_RATE
        if self.correlation < Listening.repeats:
            line += f"; it does not repeat, and is cross-faded every {engineering(length, 's', 2)}"
        return line

    def wav(self, seconds: float) -> bytes:
        """Return the contents of a wav file, whose metadata say what is heard."""
        content = io.BytesIO()
        with wave.open(content, "wb") as file:
            file.setnchannels(1)
            file.setsampwidth(2)
            file.setframerate(SAMPLING_RATE)
            file.writeframes(self.samples(seconds).tobytes())
        facts = {
            "title": f"Velocity {self.component}",
            "comment": self.told(),
            "software": "squealpipe",
        }
        return _with_facts(content.getvalue(), facts)


def write_wav(sound: Sound, path: Path, seconds: float = 3.0) -> None:
    """Write a sound to a wav file, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_bytes(sound.wav(seconds))


def _with_facts(riff: bytes, facts: dict[str, str]) -> bytes:
    """Return a RIFF file with a list of metadata, which Python's writer does not know."""
    listed = b"INFO"
    # chunks of a RIFF file's list of metadata
    chunk_names = {"title": b"INAM", "comment": b"ICMT", "software": b"ISFT"}
    for name, words in facts.items():
        text = words.replace("−", "-").encode("latin-1", "replace") + b"\0"
        listed += (
            chunk_names[name]
            + struct.pack("<I", len(text))
            + text
            + b"\0" * (len(text) % 2)
        )
    riff += b"LIST" + struct.pack("<I", len(listed)) + listed
    return b"RIFF" + struct.pack("<I", len(riff) - 8) + riff[8:]


def sound(
    run: xr.Dataset,
    *,
    at: str | None = None,
    seconds: float = 3.0,
    speed: float = 1.0,
    again: Callable[[np.ndarray], xr.Dataset] | None = None,
) -> Sound:
    """Make the settled part of a run audible.

    Args:
        run: dataset ``simulation`` or ``structure_run``, or the settled motion of ``assess``.
        at: ``x`` or ``y`` of a pad, a node or contact of a structure; by default what has the
            largest rms velocity.
        seconds: length that the sound will be repeated to, s; a loop is no longer.
        speed: how many times faster than in reality it is played.
        again: integrates the run again, given instants (n,), s; used where the run is sampled too
            coarsely.

    Raises:
        TooCoarseError: the run is sampled too coarsely, and cannot be integrated again.
        ValueError: it is no run, too short, quiet, has not settled or is beyond hearing; with a
            remedy.
    """
    if not (math.isfinite(seconds) and seconds > 0):
        raise ValueError(f"seconds = {seconds!r}: a time above 0 is needed")
    if not (math.isfinite(speed) and speed > 0):
        raise ValueError(f"speed = {speed!r}: a factor above 0 is needed")
    time, signal, words = _signal(run, at, again)
    signal = signal - signal.mean()
    frequency = _strongest(signal, step_of(time))
    periods = frequency * (time[-1] - time[0])
    if not periods >= Listening.fewest_periods:
        remedy = (
            "reduce the structure to fewer modes (squealpipe squeal --n-modes)"
            if run.attrs.get("schema") == STRUCTURE_RUN
            else "run it longer (--t-end)"
        )
        raise ValueError(
            "the settled part of the run is too short to be heard: "
            f"{number(periods, 2) if math.isfinite(periods) else 'fewer than 3'} periods of its "
            f"strongest line, {Listening.fewest_periods:g} are needed; {remedy}"
        )
    _check_audible(frequency, speed)
    loop, correlation = _loop(signal, step_of(time), seconds * speed, speed)
    return Sound(loop, words, frequency, speed, correlation)


def _signal(
    run: xr.Dataset, at: str | None, again: Callable[[np.ndarray], xr.Dataset] | None
) -> tuple[np.ndarray, np.ndarray, str]:
    """Return instants and velocity of what is heard, both (n,), and words for it."""
    if run.attrs.get("schema") == STRUCTURE_RUN:
        structure = StructureMotion.read(run)
        signal, words = structure.heard(at)
        missing = _missing(structure.time, signal, of_structure=True)
        if missing is not None:
            raise TooCoarseError(missing)
        return structure.time, signal, words
    motion = _audible(run)
    name = _component(motion, at)
    column = COMPONENTS.index(name)
    if not motion.settled:
        motion = _settled_part(motion)
    step = (motion.time[-1] - motion.time[0]) / (motion.time.size - 1)
    words_of = {"x": "along the belt (x)", "y": "across the belt (y)"}
    for _ in range(int(math.log2(Listening.finest)) // 2 + 1):
        missing = _missing(motion.time, motion.velocity[:, column])
        if missing is None:
            return motion.time, motion.velocity[:, column], words_of[name]
        if again is None or motion.settled:
            break
        step /= 4.0
        count = math.ceil((motion.time[-1] - motion.time[0]) / step) + 1
        motion = PadMotion.read(
            again(np.linspace(motion.time[0], motion.time[-1], count))
        )
    raise TooCoarseError(missing)


def _audible(run: xr.Dataset) -> PadMotion:
    """Read a motion that has enough samples to be heard."""
    motion = PadMotion.read(run)
    if motion.time.size < 8 * FEWEST:
        raise ValueError(
            f"the run is too short to be heard: {motion.time.size} samples; run it longer (--t-end)"
        )
    return motion


def _component(motion: PadMotion, at: str | None) -> str:
    """Return the component that is asked for, or the one with the larger rms in the later half."""
    if at is None:
        late = motion.velocity[motion.time.size // 2 :]
        return COMPONENTS[int(late.std(axis=0).argmax())]
    if at not in COMPONENTS:
        raise ValueError(f"at = {at!r}: the run has {', '.join(COMPONENTS)}")
    return at


def _settled_part(motion: PadMotion) -> PadMotion:
    """Return the part of a run after which levels stay what they are.

    Raises:
        ValueError: the motion has died out, or has not settled.
    """
    count = motion.time.size
    level = float(np.sqrt(motion.velocity[3 * count // 4 :].var(axis=0).sum()))
    largest = float(np.abs(motion.velocity).max())
    if not level > Listening.quiet * max(largest, 1e-3 * abs(motion.belt_speed)):
        raise ValueError(
            "nothing is heard: the motion has died out, its rms velocity is "
            f"{engineering(level, 'm s-1', 2)} in the last quarter of the run"
        )
    for share in Listening.tails:
        halves = np.array_split(np.arange(int(share * count), count), 2)
        change = difference(*(_levels(motion, half) for half in halves))
        if change <= Listening.level_agreement:
            return motion.from_(motion.time[halves[0][0]])
    raise ValueError(
        f"the motion has not settled: its level changes by {100.0 * change:.0f} % within the last "
        f"part of the run, {engineering(float(motion.time[-1]), 's', 3)} long; run it longer "
        "(--t-end)"
    )


def _levels(motion: PadMotion, part: np.ndarray) -> WindowLevels:
    separated, stuck = (
        np.array([(motion.regimes[part] == each).mean()])
        for each in (Regime.separated, Regime.stick)
    )
    rms = motion.velocity[part].std(axis=0)
    return WindowLevels(rms, separated, stuck, peaks=np.zeros(1))


def _missing(
    time: np.ndarray, signal: np.ndarray, *, of_structure: bool = False
) -> str | None:
    """Return why samples cannot be heard, with a remedy; None if they can."""
    try:
        step = step_of(time)
    except ValueError as error:
        return str(error)
    omega, amplitude = amplitude_spectrum(signal, step)
    loud = omega[amplitude > Listening.audible * amplitude.max()]
    highest = float(loud.max(initial=0.0)) / (2.0 * math.pi)
    needed = Listening.samples_per_period * highest
    if 1.0 / step >= needed:
        return None
    # what is between the samples may lie higher still
    points = math.ceil(2.0 * needed * time[-1])
    remedy = (
        "write the run again with `squealpipe squeal --run`"
        if of_structure
        else f"simulate it with --points {points} or more"
    )
    return (
        f"the run is sampled too coarsely to be heard: {engineering(1.0 / step, 'Hz', 3)}, and its "
        f"lines reach {engineering(highest, 'Hz', 3)}; {remedy}"
    )


def _strongest(signal: np.ndarray, step: float) -> float:
    omega, amplitude = amplitude_spectrum(signal, step, padding=4)
    lines, _ = strongest_lines(
        omega, amplitude, 1, 2.0 * math.pi / (step * signal.size)
    )
    return float(lines[0]) / (2.0 * math.pi) if lines.size else math.nan


def comfortable_speed(frequency: float) -> float:
    """Return the gentlest power of ten of speed at which a frequency, Hz, is heard well.

    It is 1 where the frequency is heard as it is.
    """
    low, high = Listening.hearing
    if not math.isfinite(frequency) or low <= frequency <= high:
        return 1.0
    below, above = (math.log10(limit / frequency) for limit in Listening.comfortable)
    power = math.ceil(below) if frequency < low else math.floor(above)
    return float(10.0**power)


def _check_audible(frequency: float, speed: float) -> None:
    """Refuse a pitch that no ear hears."""
    low, high = Listening.hearing
    heard = frequency * speed
    if low <= heard <= high:
        return
    better = comfortable_speed(frequency)
    remedy = f"--fast {better:g}" if better > 1.0 else f"--slow {1.0 / better:g}"
    if better == 1.0:
        remedy = "neither --fast nor --slow"
    side = "below" if heard < low else "beyond"
    raise ValueError(
        f"the strongest line would be played at {engineering(heard, 'Hz', 3)}, {side} hearing "
        f"({low:g} Hz to {high / 1e3:g} kHz); give {remedy}"
    )


def _loop(
    signal: np.ndarray, step: float, longest: float, speed: float
) -> tuple[np.ndarray, float]:
    """Return a loop of a signal at the rate of the file, and the correlation of its ends.

    Args:
        signal: (n,) without its mean.
        step: between its samples, s.
        longest: length that a loop may have, s.
    """
    # lag and cross-fade together: of the lags tried the longest is three quarters
    signal = signal[-max(math.ceil(longest / 0.75 / step), 4 * FEWEST) :]
    count = signal.size
    lags = np.arange(count // 2, 3 * count // 4 + 1)
    products = correlate(signal, signal, method="fft")[count - 1 + lags]
    squares = np.concatenate([[0.0], np.cumsum(signal**2)])
    ends = squares[count - lags] * (squares[-1] - squares[lags])
    alike = products / np.sqrt(np.maximum(ends, 1e-300))
    best = int(np.argmax(alike[1:-1])) + 1
    shift, peak = vertex(*(alike[best + k] for k in (-1, 0, 1)))
    lag = float(lags[best] + np.clip(shift, -1.0, 1.0))
    fade = count - 1 - lag
    curve = make_interp_spline(np.arange(count), signal, k=5)
    places = fade + lag * np.arange(2 * count) / (2 * count)
    weight = np.clip((places - lag) / fade, 0.0, 1.0)
    weight = weight**2 * (3.0 - 2.0 * weight)
    before = curve(np.maximum(places - lag, 0.0))
    correlation = float(np.clip(peak, -0.5, 1.0))
    power = (1 - weight) ** 2 + weight**2 + 2 * correlation * weight * (1 - weight)
    looped = ((1.0 - weight) * curve(places) + weight * before) / np.sqrt(power)
    number_ = max(round(lag * step / speed * SAMPLING_RATE), 2)
    played = resample(looped - looped.mean(), number_)
    return np.asarray(played / np.abs(played).max()), correlation
