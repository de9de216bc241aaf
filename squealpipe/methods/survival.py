"""Lifetimes of which some are only known to be longer than a run: survival."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
HALF = 0.5 + 1e-12
"""One half, and the rounding of a product of shares."""


class Survival(NamedTuple):
    """Share that is still alive after each time, from 0 on, with its confidence band."""

    time: np.ndarray
    share: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def at(self, ages: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Share, low and high at some ages, each the value of the last step before."""
        step = np.searchsorted(self.time, ages, side="right") - 1
        return self.share[step], self.low[step], self.high[step]

    def median(self) -> tuple[float, float, float]:
        """Time at which half is gone, and the ends of its confidence interval; ∞ where not seen.

        The interval holds the times at which the band contains one half (Brookmeyer and Crowley
        1982).
        """

        def first(values: np.ndarray) -> float:
            below = np.flatnonzero(values <= HALF)
            return float(self.time[below[0]]) if below.size else np.inf

        return first(self.share), first(self.low), first(self.high)


def survival(lifetimes: np.ndarray, seen: np.ndarray) -> Survival:
    """Kaplan–Meier estimate with log–log confidence band.

    Args:
        lifetimes: (n,) time of the end, or time until which a run was followed.
        seen: (n,) whether the end was seen.
    """
    if not seen.any():
        time = np.array([0.0, float(lifetimes.max(initial=0.0))])
        return Survival(time, np.ones(2), np.ones(2), np.ones(2))
    data = stats.CensoredData.right_censored(lifetimes, ~seen)
    estimate = stats.ecdf(data).sf
    with warnings.catch_warnings():
        # undefined where the share is 0 or 1; those places are filled below
        warnings.filterwarnings("ignore", "The confidence interval is undefined", RuntimeWarning)
        band = estimate.confidence_interval(CONFIDENCE, method="log-log")
    share = np.append(1.0, estimate.probabilities)
    low = np.append(1.0, band.low.probabilities)
    high = np.append(1.0, band.high.probabilities)
    # Greenwood's variance has no meaning at 0 and 1: from 1 the band is a point, at 0 it keeps
    # its last upper end
    low = np.where(np.isfinite(low), low, np.where(share < 1.0, 0.0, 1.0))
    missing = ~np.isfinite(high)
    high[missing & (share == 1.0)] = 1.0
    if missing[-1] and share[-1] < 1.0:
        high[-1] = high[:-1][np.isfinite(high[:-1])][-1]
    return Survival(np.append(0.0, estimate.quantiles), share, low, high)
