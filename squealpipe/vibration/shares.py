"""Shares of a sample, with their intervals of confidence."""

import math

CONFIDENCE = 0.95
"""Confidence of every interval that is given for a share."""


def wilson_interval(count: int, size: int) -> tuple[float, float]:
    """Wilson's interval for the share count/size of a random sample; NaN without a sample."""
    if size == 0:
        return math.nan, math.nan
    # scipy.stats has this interval as `binomtest(count, size).proportion_ci(method="wilson")`, and
    # takes a second to import; every job that gives a share would wait for it.
    from scipy.special import ndtri

    share, z = count / size, float(ndtri(0.5 + 0.5 * CONFIDENCE))
    width = 2 * (size + z**2)
    center = (2 * size * share + z**2) / width
    reach = z / width * math.sqrt(4 * size * share * (1 - share) + z**2)
    # in exact arithmetic these ends are 0 and 1
    low = 0.0 if count == 0 else center - reach
    high = 1.0 if count == size else center + reach
    return low, high
