"""Amplitude spectrum of a uniformly sampled signal, and its highest peaks."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from squealpipe.vibration.parabola import vertex

FEWEST = 16
"""Samples from which a motion, and its spectrum, can be seen."""


def step_of(time: NDArray[np.float64]) -> float:
    """The step of uniform samples.

    Raises:
        ValueError: they are not uniform.
    """
    steps = np.diff(time)
    if np.ptp(steps) > 1e-6 * steps[0]:
        raise ValueError("the samples are not uniform in time; give uniform `times`")
    return float(steps[0])


def lasts(force: NDArray[np.float64]) -> bool:
    """Return whether a contact force acts in the second half of its run, so that it has a spectrum.

    That of a force that ends for good shows its end, not an oscillation.
    """
    return bool(np.any(force[force.size // 2 :]))


def amplitude_spectrum(
    signal: NDArray[np.float64], step: float, *, padding: int = 1
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One-sided amplitude spectrum with a Hann window, the mean removed.

    A sinusoid of amplitude A on a line of the grid gives a peak of height A.

    Args:
        padding: zeros are added up to ``padding`` n samples, for a finer grid.

    Returns:
        Angular frequency (m,), rad per unit of ``step``, and amplitude (..., m), in the
        signal's unit, with m = padding n // 2 + 1.
    """
    count = signal.shape[-1]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    centred = signal - (signal * window).sum(-1, keepdims=True) / window.sum()
    amplitude = (
        np.abs(np.fft.rfft(centred * window, n=padding * count)) * 2.0 / window.sum()
    )
    frequency = 2.0 * np.pi * np.fft.rfftfreq(padding * count, step)
    return frequency.astype(np.float64), amplitude.astype(np.float64)


def highest_peaks(
    frequency: NDArray[np.float64], amplitude: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequency and height of the highest local maxima, highest first; fewer if there are fewer.

    Each is refined by the parabola through the logarithms of its three highest lines, so the
    spectrum should be padded (by 4 or more). Maxima below a twentieth of the highest are left out:
    the window's own side lobes reach a thirty-fifth.
    """
    middle = amplitude[1:-1]
    places = 1 + np.flatnonzero((middle > amplitude[:-2]) & (middle >= amplitude[2:]))
    places = places[amplitude[places] > 0.05 * amplitude.max(initial=0.0)]
    places = places[np.argsort(-amplitude[places], kind="stable")][:count]
    shift, height = vertex(
        *(np.log(amplitude[places + k] + 1e-300) for k in (-1, 0, 1))
    )
    return frequency[places] + shift * (frequency[1] - frequency[0]), np.exp(height)


def strongest_lines(
    frequency: NDArray[np.float64],
    amplitude: NDArray[np.float64],
    count: int,
    resolution: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The peaks that are oscillations, as :func:`highest_peaks`, each line once.

    Args:
        resolution: 2π over the length of the signal. What has fewer than three periods
            in it is drift, and a peak within the width of a higher one is part of it.
    """
    # periods in a signal from which it oscillates
    fewest_periods = 3.0
    fast = np.where(frequency >= fewest_periods * resolution, amplitude, 0.0)
    lines, heights = highest_peaks(frequency, fast, len(frequency))
    kept: list[int] = []
    for i, line in enumerate(lines):
        # neither the cut through a drift's flank nor its side lobes are lines
        # over 2π/T: from here the window's side lobes are small
        lobe = line < 12.0 * resolution and heights[i] < 0.1 * amplitude.max()
        is_line = line > (fewest_periods + 0.25) * resolution and not lobe
        # over 2π/T: half the main lobe of a Hann window
        apart = all(abs(line - lines[k]) > 2.0 * resolution for k in kept)
        if is_line and apart and len(kept) < count:
            kept.append(i)
    return lines[kept], heights[kept]


def strongest_line(signals: NDArray[np.float64], step: float) -> float:
    """Return the strongest line of several signals together, Hz; NaN where nothing oscillates.

    Args:
        signals: (signals, samples), of which squares of amplitudes are added up.
        step: between samples, s.
    """
    # spectral lines per resolved line; with 2 the peak is off by a hundredth of a resolved line
    padding = 4
    omega, amplitude = amplitude_spectrum(signals, step, padding=padding)
    total = np.sqrt((amplitude**2).sum(axis=0))
    resolution = 2.0 * np.pi / (step * signals.shape[-1])
    lines, _ = strongest_lines(omega, total, 1, resolution)
    return float(lines[0] / (2.0 * np.pi)) if lines.size else np.nan


def loudest(variances: NDArray[np.float64]) -> tuple[int, int]:
    """Return the contact that moves most and its louder component, 0 along and 1 across the belt.

    Args:
        variances: of its velocities, (2, contacts).
    """
    contact = int(np.argmax(variances.sum(axis=0)))
    return contact, int(variances[1, contact] > variances[0, contact])


def loudest_line(blocks: Sequence[NDArray[np.float64]], step: float) -> float:
    """Return the frequency by which a motion is named, Hz; NaN where nothing oscillates.

    It is the strongest line of the contact that moves most, by its louder component.

    Args:
        blocks: velocities along, then across the belt in each block of a record, (2, contacts,
            samples), m/s; the line is that of all blocks together.
        step: between samples, s.
    """
    variances = np.mean([block.var(axis=-1) for block in blocks], axis=0)
    if not np.isfinite(variances).all():
        return np.nan
    contact, component = loudest(variances)
    signals = np.stack([block[component, contact] for block in blocks])
    return strongest_line(signals, step)
