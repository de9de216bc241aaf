"""Decide when a motion has settled: when two successive windows of its run agree.

Idea: a run is looked at in windows that double in length. Equal levels in two of them are not
enough: a component may still grow far beneath the loudest one, and what decays slowly is no part of
the settled motion. So a small perturbation is followed beside the run, in all components at once.
Where it keeps its size the motion is regular, and everything that is stated, the largest force
among it, has to agree closely. Where it grows from round-off to the size of the motion within each
window the motion is irregular, and only its statistics have to agree. Where it grows, but by less,
the motion is leaving a place that repels it, as a cycle that a second mode destabilizes: that is
not settled, however equal two windows look. What has died out is decided by the thresholds of
quiet in :mod:`squealpipe.vibration.settled_runs`.

Source: the largest Lyapunov exponent by a renormalized tangent vector (Benettin, Galgani, Giorgilli
and Strelcyn, Meccanica 15 (1980) 9-30). Cost: the perturbation adds a quarter to that of a run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

ALWAYS = 1.0 - 1e-9
"""Share of a window from which on it is the whole one: tapered shares have a round-off."""


@dataclass(frozen=True)
class Settling:
    """Thresholds of settling; each comment says what another value would do."""

    agreement: float
    """Largest difference of two windows that agree: of velocities over their total, of shares of
    time as they are. Twice as much: numbers are off by up to twice as much."""
    peak_agreement: float = math.inf
    """Largest relative difference of the largest force, and of each velocity and share. Without it
    a decaying component enters that force long after it has left the mean squares."""
    least: float = 0.005
    """Smallest denominator of a relative difference: velocity over the total, or share of time.
    Half as much: sampling noise of what hardly moves keeps it from settling."""
    irregular_agreement: float = 0.03
    """Agreement of statistics of an irregular motion, whose scatter is stated beside its numbers.
    Half as much is not reached within the longest run by intermittent motions."""
    shortest: float = 0.0
    """Fewest periods of the later window. Growth that takes ten times as long is not seen."""
    still_grows: float = 0.05
    """ln of a perturbation's growth from the third to the last quarter of a window; less may be a
    swing within a period. Twice as much: growth that is twice as fast is not seen."""
    proportional: float = 1.2
    """Late growth over that of the window before, which is half as long. Up to this it is the shear
    of an undamped motion, the same in both; exponential growth at least doubles it."""
    irregular: float = 15.0
    """ln of the growth in each of two windows from which a motion is irregular: round-off becomes
    motion. Half as much: first swings away from a cycle pass for statistics."""
    mode_grows: float = math.log(1.5)
    """ln of the growth from one window to the next by which a component still grows, where no
    perturbation is followed. Scatter of irregular motions is below it."""
    smallest: float = 1e-9
    """Velocity of a component, over the total, below which it is round-off."""
    samples: int = 512
    """Instants of a window; fewer than two in a period miss none of the statistics by more than
    the agreement, since they are not in step with it."""

    @property
    def follows_perturbation(self) -> bool:
        """Tell whether a perturbation has to be followed."""
        return math.isfinite(self.peak_agreement)


settling_of_verdicts = Settling(agreement=0.03)
"""Rules that suffice for the kind of motion; thousands of designs are judged by them."""
settling_of_numbers = Settling(
    agreement=0.005, peak_agreement=0.005, shortest=400.0, samples=4096
)
"""Rules for levels that are printed to about 1 %."""


class Agreement(IntEnum):
    """Kind of motion that two successive windows show, none if they disagree."""

    none = 0
    regular = 1
    irregular = 2


@dataclass(frozen=True)
class WindowLevels:
    """Statistics by which windows are compared.

    Attributes:
        velocities: rms of each component or mode, in one unit.
        separated, stuck: shares of the time, of each contact.
        peaks: largest force of each contact.
        growth: ln of the growth of a small perturbation; NaN where none was followed.
        late_growth: ln of its growth from the third to the last quarter.
        periods: length of the window, in periods.
    """

    velocities: np.ndarray
    separated: np.ndarray
    stuck: np.ndarray
    peaks: np.ndarray
    growth: float = math.nan
    late_growth: float = math.nan
    periods: float = math.inf

    @property
    def total(self) -> float:
        """rms of all components together."""
        return float(np.sqrt((self.velocities**2).sum()))


def agreement(before: WindowLevels, now: WindowLevels, rules: Settling) -> Agreement:
    """Return what two successive windows show by the rules."""
    if now.periods < rules.shortest:
        return Agreement.none
    if not rules.follows_perturbation:
        agrees = difference(before, now) <= rules.agreement
        settled = agrees and not _component_grows(before, now, rules)
        return Agreement.regular if settled else Agreement.none
    if min(before.growth, now.growth) >= rules.irregular:
        agrees = difference(before, now) <= rules.irregular_agreement
        return Agreement.irregular if agrees else Agreement.none
    grows = now.late_growth > rules.still_grows
    if grows and now.late_growth > rules.proportional * before.late_growth:
        return Agreement.none
    least = rules.least * max(before.total, now.total)
    relative = max(
        _differ(before.peaks, now.peaks, 0.0),
        _differ(before.velocities, now.velocities, least),
        _differ(before.separated, now.separated, rules.least),
        _differ(before.stuck, now.stuck, rules.least),
    )
    close = difference(before, now) <= rules.agreement
    close = close and relative <= rules.peak_agreement
    return Agreement.regular if close else Agreement.none


def difference(one: WindowLevels, other: WindowLevels) -> float:
    """Return the largest difference of two windows: of velocities over the total, and of shares."""
    total = max(one.total, other.total, np.finfo(float).tiny)
    return float(
        max(
            np.abs(one.velocities - other.velocities).max() / total,
            np.abs(one.separated - other.separated).max(),
            np.abs(one.stuck - other.stuck).max(),
        )
    )


def _differ(one: np.ndarray, other: np.ndarray, least: float) -> float:
    """Return the largest relative difference, over ``least`` where both values are below it."""
    size = np.maximum(np.maximum(np.abs(one), np.abs(other)), least)
    return float(np.max(np.abs(one - other) / np.where(size > 0.0, size, 1.0)))


def _component_grows(before: WindowLevels, now: WindowLevels, rules: Settling) -> bool:
    """Tell whether the rms velocity of a component grows from one window to the next."""
    seen = before.velocities > rules.smallest * now.total
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = np.log(now.velocities[seen] / before.velocities[seen])
    return bool((grown > rules.mode_grows).any())


def tapered(increments: np.ndarray) -> np.ndarray:
    """Weighted mean over the first axis of what is known at many instants of a window.

    By a Hann window, the mean of a periodic quantity is that of whole periods but for terms that
    fall with the cube of their number, so that two windows of a cycle agree.
    """
    count = increments.shape[0]
    weights = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** 2
    return np.asarray(np.tensordot(weights, increments, axes=(0, 0)) / weights.sum())


def late_growth(growth: np.ndarray) -> Any:
    """ln of the growth from the third to the last quarter of the instants of a window, (…,).

    Args:
        growth: ln of a perturbation's growth since the window began, (instants, …).
    """
    _, _, third, last = np.array_split(growth, 4)
    return last.mean(axis=0) - third.mean(axis=0)
