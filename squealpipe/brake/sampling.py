"""Instants at which a motion is looked at, and whether these resolve it."""

import math

import numpy as np

from squealpipe.parameters import Parameters
from squealpipe.vibration.spectrum import FEWEST

COARSE = 2.5
"""Samples per radian of the fastest linear oscillation: of a short run, and the fewest."""


def sample_times(params: Parameters, t_end: float) -> np.ndarray:
    """Instants at equal steps from 0 to ``t_end`` that resolve the fastest oscillation, s."""
    wanted = COARSE * params.fastest * t_end
    # four states of so many samples are 320 MB
    most_samples = 1e7
    if not wanted <= most_samples:
        raise ValueError(
            f"t_end = {t_end!r}: {wanted:.2g} samples would resolve the fastest oscillation up to "
            f"there, at most {most_samples:.0e} are taken; shorten t_end"
        )
    return np.linspace(0.0, t_end, max(FEWEST, math.ceil(wanted)) + 1)


def default_times(params: Parameters, t_end: float) -> np.ndarray:
    """The instants of :func:`sample_times`, more of them where the run is short."""
    # a run is sampled finely up to so many samples; a longer one as coarsely as its frequency
    # allows
    plenty = 20_000
    # of the fastest linear oscillation, in a short run
    samples_per_radian = 12.0
    fine = math.ceil(min(plenty, samples_per_radian * params.fastest * t_end))
    coarse = sample_times(params, t_end)
    return coarse if coarse.size > fine else np.linspace(0.0, t_end, fine + 1)


def unresolved(params: Parameters, times: np.ndarray) -> str:
    """One line about instants between which oscillations are missed; empty where none are."""
    if times.size < FEWEST:
        return ""
    period, step = 2.0 * math.pi / params.fastest, float(np.diff(times).max())
    if step <= 0.5 * period:
        return ""
    return (
        f"samples {step:.3g} s apart do not resolve oscillations of period {period:.3g} s: ask for "
        f"{math.ceil((times[-1] - times[0]) * COARSE * params.fastest) + 1} points or more, or for "
        "a shorter run"
    )
