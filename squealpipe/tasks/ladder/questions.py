"""The questions of the model ladder, answered from runs and from samples of a motion."""

import math
from typing import Any

import numpy as np

from squealpipe.parameters import Parameters


def answer_of(run: Any, question: str, times: np.ndarray) -> np.ndarray:
    """The answer that an ensemble holds.

    Args:
        run: :class:`squealpipe.solvers.a1.ensemble.Ensemble`; for "frequency" sampled at ``times``.
    """
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
        return np.asarray(_highest(y) > params.preload, dtype=float)
    if question == "peak_contact_force":
        return np.asarray(1.0 + _highest(-y) / params.preload)
    if question == "max_displacement":
        return np.asarray(np.sqrt(_highest(x * x + y * y)))
    return dominant_frequency(y, times)


def dominant_frequency(samples: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Angular frequency of the largest spectral line of (…, n) samples, rad/s.

    Hann window; the line is located between bins by a parabola through the logarithms. NaN
    where samples are missing.
    """
    window = np.hanning(samples.shape[-1])
    mean = samples.mean(axis=-1, keepdims=True)
    spectrum = np.abs(np.fft.rfft((samples - mean) * window, axis=-1))
    top = np.clip(spectrum[..., 1:-1].argmax(axis=-1) + 1, 1, spectrum.shape[-1] - 2)
    before, here, after = (
        np.log(np.take_along_axis(spectrum, (top + step)[..., None], axis=-1)[..., 0] + 1e-300)
        for step in (-1, 0, 1)
    )
    curvature = before - 2.0 * here + after
    offset = _over_curvature(0.5 * (before - after), curvature)
    bin_width = 2.0 * math.pi / (samples.shape[-1] * (times[1] - times[0]))
    found = (top + np.clip(offset, -0.5, 0.5)) * bin_width
    return np.asarray(np.where(np.isfinite(samples).all(axis=-1), found, np.nan))


def _highest(values: np.ndarray) -> np.ndarray:
    """Largest of (…, n) samples, raised to the vertex of the parabola around it."""
    top = np.clip(values.argmax(axis=-1), 1, values.shape[-1] - 2)
    before, here, after = (
        np.take_along_axis(values, (top + step)[..., None], axis=-1)[..., 0] for step in (-1, 0, 1)
    )
    rise = _over_curvature(0.125 * (after - before) ** 2, before - 2.0 * here + after)
    return np.asarray(np.maximum(values.max(axis=-1), here - rise))


def _over_curvature(share: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """share/curvature at a maximum, 0 where there is none."""
    return np.asarray(
        np.divide(share, curvature, out=np.zeros(np.shape(share)), where=curvature < 0.0)
    )
