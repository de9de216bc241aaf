"""Judge by a long run whether a motion grows without bound: the one rule for all who ask.

How far |x| gets from one half of a short run to the next is chance where the motion is chaotic, and
a motion that ends in a whirl grows at first too. What tells them apart is the long run.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np


@dataclass(frozen=True)
class GrowthRule:
    """Rule that decides whether a long run grows without bound."""

    window: float = 1000.0
    """Length of a window, √(m/k1)."""
    n_windows: int = 6
    """Windows of a run."""
    n_judged: int = 3
    """The last windows, whose sizes decide."""
    least_ratio: float = 1.05
    """Least ratio of each of these sizes to the one before in growth without bound."""
    n_compared: int = 3
    """Windows after which a run is compared with that from a start beside its own. After two, some
    that agree are chaotic later."""
    alike: float = 1e-6
    """Share by which their sizes may differ in every window where the motion is regular, and the
    run beside it need not go on. Of sets whose starts come to disagree, the first differ by
    2e-5."""


GROWTH_HORIZON = GrowthRule.n_windows * GrowthRule.window
"""Length of a run, √(m/k1)."""
RULE = (
    f"of a run to t = {GROWTH_HORIZON:g} √(m/k1), each of the last {GrowthRule.n_judged} windows "
    f"of {GrowthRule.window:g} exceeds the one before "
    f"by {100 * (GrowthRule.least_ratio - 1):.0f} %"
)


class Growth(IntEnum):
    """Verdict of a long run: it grows without bound, has stopped growing, or is undecided."""

    saturates = 0
    grows = 1
    undecided = 2


def _ratios(sizes: Any) -> np.ndarray:
    """Return the ratio of each of the last sizes to the one before; ``sizes``: (…, windows)."""
    last = np.asarray(sizes, float)[..., -GrowthRule.n_judged - 1 :]
    return np.asarray(last[..., 1:] / last[..., :-1])


def least_growth(sizes: Any) -> np.ndarray:
    """Smallest ratio of one of the last sizes to that before it; ``sizes``: (…, ``n_windows``)."""
    return np.asarray(_ratios(sizes).min(axis=-1))


def judge_growth(sizes: Any) -> np.ndarray:
    """:class:`Growth` of runs from the largest |x| in each window, (…, ``n_windows``)."""
    last = np.asarray(sizes, float)[..., -GrowthRule.n_judged :]
    # a motion whose sizes agree to 2 % has stopped growing
    agree = last.max(axis=-1) <= 1.02 * last.min(axis=-1)
    otherwise = np.where(agree, Growth.saturates, Growth.undecided)
    return np.where(
        least_growth(sizes) >= GrowthRule.least_ratio, Growth.grows, otherwise
    )


def growth_fails(sizes: Any) -> np.ndarray:
    """Tell whether a window that is known already rules out growth by the rule.

    Args:
        sizes: (…, ``n_windows``), NaN of windows that were not run.
    """
    return np.asarray((_ratios(sizes) < GrowthRule.least_ratio).any(axis=-1))


def growth_margin(sizes: Any) -> np.ndarray:
    """ln of the least growth over its bound: positive if it grows, NaN if unknown.

    Args:
        sizes: (…, ``n_windows``), NaN from the window on that follows one in which growth fails.
    """
    least = np.fmin.reduce(_ratios(sizes), axis=-1)
    return np.asarray(np.log(least / GrowthRule.least_ratio))
