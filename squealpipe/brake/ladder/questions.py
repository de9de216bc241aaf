"""The questions of the model ladder, answered from runs and from samples of a motion."""

import math
from typing import Any

import numpy as np

from squealpipe.parameters import Parameters
from squealpipe.vibration.parabola import largest, neighbours, vertex


def answer_of(run: Any, question: str, times: np.ndarray) -> np.ndarray:
    """The answer that an ensemble holds."""
    if question == "contact_lost":
        return np.asarray(run.separations > 0, dtype=float)
    if question == "peak_contact_force":
        return np.asarray(run.peak_contact_force)
    if question == "max_displacement":
        return np.asarray(run.max_displacement)
    return dominant_frequency(run.samples[..., 1], times)


def answer_of_samples(
    x: np.ndarray, y: np.ndarray, question: str, params: Parameters, times: np.ndarray
) -> np.ndarray:
    """The answer from samples (…, n) of a motion, extremes sharpened by parabolas."""
    if question == "contact_lost":
        return np.asarray(largest(y) > params.preload, dtype=float)
    if question == "peak_contact_force":
        return np.asarray(1.0 + largest(-y) / params.preload)
    if question == "max_displacement":
        return np.asarray(np.sqrt(largest(x * x + y * y)))
    return dominant_frequency(y, times)


def dominant_frequency(samples: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Angular frequency of the largest spectral line of (…, n) samples, rad/s.

    Hann window; the line is located between bins by a parabola through the logarithms. NaN
    where samples are missing.
    """
    window = np.hanning(samples.shape[-1])
    mean = samples.mean(axis=-1, keepdims=True)
    spectrum = np.abs(np.fft.rfft((samples - mean) * window, axis=-1))
    top = spectrum[..., 1:-1].argmax(axis=-1) + 1
    offset, _ = vertex(*neighbours(np.log(spectrum + 1e-300), top))
    bin_width = 2.0 * math.pi / (samples.shape[-1] * (times[1] - times[0]))
    frequency = (top + np.clip(offset, -0.5, 0.5)) * bin_width
    return np.asarray(np.where(np.isfinite(samples).all(axis=-1), frequency, np.nan))
