"""Read the motion of a pad from a run, or the settled motion of an answer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import xarray as xr
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from squealpipe.codes import Regime
from squealpipe.plotting.origin import parameter, slip_along_belt


@dataclass(frozen=True)
class PadMotion:
    """A motion of a pad, at instants in rising order.

    Attributes:
        time: (n,), s.
        place, velocity: along and across the belt, (n, 2), m and m/s.
        force: contact force over the preload force, (n,).
        regimes: codes of :class:`squealpipe.codes.Regime`, (n,); slower and faster count along the
            belt's motion.
        angles, lengths: of both springs, rad and m.
        preload: compression of the contact at rest, m.
        belt_speed: m/s.
        settled: whether it is known to have settled.
    """

    time: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    regimes: np.ndarray
    angles: tuple[float, float]
    lengths: tuple[float, float]
    preload: float
    belt_speed: float
    settled: bool

    @classmethod
    def read(cls, dataset: xr.Dataset) -> Self:
        """Read a motion as far as it was reached.

        Raises:
            ValueError: the dataset holds none.
        """
        schema = dataset.attrs.get("schema", "the file")
        schemas_of_motions = ("simulation", "assess")
        if schema not in schemas_of_motions:
            raise ValueError(
                f"{schema} is no run that can be seen or heard; give what `squealpipe simulate`, "
                "`squealpipe assess -o` (of a pad) or `squealpipe squeal --run` writes"
            )
        if "alpha1" not in dataset:
            raise ValueError(
                "the answer is of a structure, which is seen and heard by its run; write that with "
                "`squealpipe squeal --run`"
            )
        settled = schema == "assess"
        names = ("path_time", "path_x", "path_y", "path_force", "path_regime")
        if not settled:
            names = ("time", "x", "y", "normalized_contact_force", "regime")
        time, x, y, force, regimes = (dataset[name].values for name in names)
        # an answer repeats its first sample to fill its dimension
        reached = np.isfinite(x) & (np.diff(time, append=np.inf) > 0.0)
        time, place = time[reached], np.stack([x, y], axis=1)[reached]
        if time.size < 4:
            raise ValueError(
                f"the dataset holds no motion that can be seen or heard: {time.size} samples"
            )
        velocity = (
            CubicSpline(time, place).derivative()(time)
            if settled
            else np.stack([dataset.vx.values, dataset.vy.values], axis=1)[reached]
        )
        belt_speed = parameter(dataset, "belt_speed")
        return cls(
            time=time,
            place=place,
            velocity=velocity,
            force=force[reached],
            regimes=slip_along_belt(regimes[reached], belt_speed),
            angles=(float(dataset.alpha1), float(dataset.alpha2)),
            lengths=(parameter(dataset, "length1"), parameter(dataset, "length2")),
            preload=float(dataset.preload),
            belt_speed=belt_speed,
            settled=settled,
        )

    def at(self, instants: np.ndarray) -> Self:
        """Return the motion at other instants (m,), by cubics with the right velocities."""
        curve = CubicHermiteSpline(self.time, self.place, self.velocity)
        nearest = np.abs(
            np.searchsorted(0.5 * (self.time[1:] + self.time[:-1]), instants)
        )
        return replace(
            self,
            time=instants,
            place=curve(instants),
            velocity=curve.derivative()(instants),
            force=np.interp(instants, self.time, self.force),
            regimes=self.regimes[nearest],
        )

    def from_(self, begin: float) -> Self:
        """Return the motion from an instant on, s."""
        kept = self.time >= begin
        return replace(
            self,
            time=self.time[kept],
            place=self.place[kept],
            velocity=self.velocity[kept],
            force=self.force[kept],
            regimes=self.regimes[kept],
        )

    @property
    def separated(self) -> np.ndarray:
        """True if contact is lost, (n,)."""
        return np.asarray(self.regimes == Regime.separated)
