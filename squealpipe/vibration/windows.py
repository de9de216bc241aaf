"""Windows of many runs: the statistics by which their motions are compared and judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from squealpipe.vibration.settling import WindowLevels


@dataclass(frozen=True, kw_only=True)
class Windows:
    """Statistics of one window of some runs, rows first.

    Attributes:
        final: states at the end.
        regimes: regime of each component there, in which the next window starts.
        velocities: rms of each component or mode, in one unit.
        largest_velocity: largest value of all components together, at the samples.
        separated, stuck: shares of the time, of each contact.
        separations: losses of contact, of each contact.
        forces: largest force of each contact.
        switched: whether a contact was lost, stuck or reversed, or is not as in steady sliding.
        finished: whether the run reached the end of its window.
        length: of the window, s.
        growth, late_growth: ln of the growth of a small perturbation in the window, and of that
            from its third to its last quarter; NaN where none was followed.
        fades: whether the motion is shown to die out without another event, although it may still
            be large.
    """

    final: np.ndarray
    regimes: np.ndarray
    velocities: np.ndarray
    largest_velocity: np.ndarray
    separated: np.ndarray
    stuck: np.ndarray
    separations: np.ndarray
    forces: np.ndarray
    switched: np.ndarray
    finished: np.ndarray
    length: np.ndarray
    growth: np.ndarray
    late_growth: np.ndarray
    fades: np.ndarray

    def row(self, rows: Any) -> Self:
        """Return some of the runs, or one."""
        return type(self)(**{name: value[rows] for name, value in vars(self).items()})

    @property
    def total(self) -> np.ndarray:
        """rms of the velocities of all components together."""
        return np.asarray(np.sqrt((self.velocities**2).sum(-1)))

    @property
    def losses(self) -> int:
        """Count the losses of the contact that is lost most often, in one run."""
        return int(np.max(self.separations, initial=0))

    def levels(self, period: float) -> WindowLevels:
        """Return the statistics by which the window of one run is compared.

        Args:
            period: unit of its length, s.
        """
        return WindowLevels(
            self.velocities,
            self.separated,
            self.stuck,
            self.forces,
            float(self.growth),
            float(self.late_growth),
            float(self.length) / period,
        )


def joined(parts: Sequence[tuple[Any, Windows]]) -> Windows:
    """Return windows of runs that were made in parts.

    Args:
        parts: places of the runs of a part, and their windows.
    """
    count = sum(len(places) for places, _ in parts)
    first = parts[0][1]
    whole: dict[str, np.ndarray] = {}
    for name, values in vars(first).items():
        whole[name] = np.empty((count, *values.shape[1:]), values.dtype)
        for places, windows in parts:
            whole[name][places] = getattr(windows, name)
    return type(first)(**whole)
