"""Atlas of periodic motions of model A4: both modes at one peak over both spring angles."""

from __future__ import annotations

import math
import os
from collections import deque
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.methods.balance.harmonic_balance import cosines_of
from squealpipe.methods.orbits.orbit_shape import sample
from squealpipe.methods.orbits.orbits import Orbit, is_primitive, solve_orbit
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.backbones import ORBIT_ATLAS
from squealpipe.solvers.a4.orbits import find_orbit, orbit_across
from squealpipe.solvers.a4.system import ScaledSystem, scaled_system
from squealpipe.tasks.backbones.orbit import check_length
from squealpipe.validation import Angles, Positive, Workers, checked

_RESUMABLE = (
    Outcome.tongue_end,
    Outcome.retraced,
    Outcome.pole,
    Outcome.branch_lost,
    Outcome.step_limit,
    Outcome.no_convergence,
)
_ENDED = (Outcome.tongue_end, Outcome.retraced)
_SMALL_CHANGE = 0.05
_CLEARLY_PURER = 0.01
_PHASES = np.linspace(0.0, np.pi, 33)
Cell = tuple[int, int, int]
_SMALLEST_STEP = 0.05


@checked
def orbit_atlas(
    params: Parameters,
    alpha1: Angles,
    alpha2: Angles,
    *,
    y_peak: Positive | None = None,
    workers: Workers = None,
) -> xr.Dataset:
    """ω and stability index of the exact periodic motion of each mode, each found from cold.

    Args:
        params: physical parameters.
        alpha1, alpha2: 1-D arrays of angles, rad.
        y_peak: y at the symmetric instant, m; 2 l_pre by default.
        workers: threads (the kernels release the interpreter); None: all cores.

    Returns:
        Dataset over (alpha1, alpha2, mode): omega (rad/s), stability_index, outcome:
        ``converged`` where the branch of the linear mode leads to the peak, ``other_branch``
        where it ends before and the orbit comes from a neighbouring cell or from across.

    Raises:
        ValueError: y_peak is not a finite length above 0, or an angle is not finite.
    """
    peak = 2.0 * params.preload if y_peak is None else y_peak
    check_length("y_peak", peak, params.preload)

    found = _Cells(params, alpha1, alpha2, peak / params.preload)
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        list(pool.map(found.fill_line, range(len(alpha1))))
    found.fill_from_neighbours()
    found.fill_across()
    return build(
        ORBIT_ATLAS,
        {
            "omega": found.values[..., 0],
            "stability_index": found.values[..., 1],
            "outcome": found.outcome,
            "y_peak": peak,
        },
        {"alpha1": alpha1, "alpha2": alpha2, "mode": [1, 2]},
    )


class _Cells:
    """The cells of an atlas while it is being made.

    Where an internal resonance lies between the linear mode and the peak, the branch turns into
    the resonance's tongue. The orbit beyond the tongue is then reached from a neighbouring cell,
    at constant peak, by small steps of the angles. Several may be reached; an orbit that is
    locked to a resonance has strong higher harmonics, so the one with the largest share of the
    first harmonic is kept.
    """

    def __init__(
        self,
        params: Parameters,
        rows: NDArray[np.float64],
        columns: NDArray[np.float64],
        peak: float,
    ) -> None:
        self.params, self.peak = params, peak
        self.angles = rows, columns
        self.scenes: dict[tuple[int, int], ScaledSystem] = {}
        shape = (len(rows), len(columns), 2)
        self.values = np.full((*shape, 2), np.nan)
        self.points = np.full((*shape, 3), np.nan)
        self.outcome = np.full(shape, Outcome.not_computed, dtype=int)
        self.purity = np.full(shape, np.nan)

    def fill_line(self, row: int) -> None:
        """Find the orbits of one row of cells from their linear modes."""
        for column in range(self.outcome.shape[1]):
            scene = self._scene(row, column)
            for mode in (1, 2):
                self._fill_cold(scene, (row, column, mode - 1), mode)

    def _fill_cold(self, scene: ScaledSystem, cell: Cell, mode: int) -> None:
        if scene.obstacle == Outcome.converged and self.peak <= scene.rest[1]:
            self.outcome[cell] = Outcome.separated
            return
        orbit, self.outcome[cell] = find_orbit(scene, mode, self.peak)
        if orbit is not None:
            self._keep(cell, scene, orbit)
        elif self.outcome[cell] == Outcome.isolated_mode:
            self.values[cell] = scene.omega(mode) * scene.frequency, np.nan

    def _keep(self, cell: Cell, scene: ScaledSystem, orbit: Orbit) -> None:
        self.points[cell] = orbit.point
        self.values[cell] = orbit.omega * scene.frequency, orbit.stability_index

    def fill_from_neighbours(self) -> None:
        """Let orbits spread into the cells that hold none, the purest one of several winning."""
        open_cells = np.isin(self.outcome, _RESUMABLE)
        border = [cell for cell in self._cells(~open_cells) if any(self._around(cell, open_cells))]
        spreading = deque(border)
        while spreading:
            near = spreading.popleft()
            for cell in self._around(near, open_cells):
                found = self._carry(near, cell)
                if found is None:
                    continue
                scene, orbit = found
                purity = _purity(scene, orbit)
                if not purity <= self.purity[cell] + _CLEARLY_PURER:
                    self.purity[cell] = purity
                    self.outcome[cell] = Outcome.other_branch
                    self._keep(cell, scene, orbit)
                    spreading.append(cell)

    def fill_across(self) -> None:
        """Cross the resonances that end a branch where no neighbour's orbit could be carried."""
        for i, j, k in np.argwhere(np.isin(self.outcome, _ENDED)):
            cell = int(i), int(j), int(k)
            scene = self._scene(*cell[:2])
            orbit = orbit_across(scene, cell[2] + 1, self.peak)
            if orbit is not None:
                self.outcome[cell] = Outcome.other_branch
                self._keep(cell, scene, orbit)

    def _cells(self, mask: NDArray[np.bool_]) -> list[Cell]:
        """Cells of a mask that hold an orbit."""
        held = mask & (self.outcome == Outcome.converged)
        return [(int(i), int(j), int(k)) for i, j, k in np.argwhere(held)]

    def _around(self, cell: Cell, mask: NDArray[np.bool_]) -> list[Cell]:
        """The four neighbours of a cell that are in a mask."""
        row, column, mode = cell
        around = [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
        return [
            (i, j, mode)
            for i, j in around
            if 0 <= i < mask.shape[0] and 0 <= j < mask.shape[1] and mask[i, j, mode]
        ]

    def _carry(self, near: Cell, cell: Cell) -> tuple[ScaledSystem, Orbit] | None:
        """One cell's orbit carried to another cell at constant peak; None if it does not arrive."""
        point, share, step = self.points[near], 0.0, 1.0
        while step >= _SMALLEST_STEP:
            ahead = min(share + step, 1.0)
            scene = self._between(near, cell, ahead)
            orbit = None
            if scene.obstacle == Outcome.converged and not scene.system.decoupled:
                orbit = solve_orbit(scene.system, point)
            reach = _SMALL_CHANGE * (1.0 + math.hypot(*point))
            if (
                orbit is None
                or math.dist(orbit.point, point) > reach
                or not is_primitive(scene.system, orbit)
            ):
                step *= 0.5
                continue
            if ahead == 1.0:
                return scene, orbit
            point, share = orbit.point, ahead
        return None

    def _scene(self, row: int, column: int) -> ScaledSystem:
        """The system at a cell."""
        rows, columns = self.angles
        return scaled_system(self.params, float(rows[row]), float(columns[column]))

    def _between(self, near: Cell, cell: Cell, share: float) -> ScaledSystem:
        """The system at a share of the way from one cell to another, many times the same one."""
        if share == 1.0:
            if cell[:2] not in self.scenes:
                self.scenes[cell[:2]] = self._scene(*cell[:2])
            return self.scenes[cell[:2]]
        ways = zip(self.angles, near[:2], cell[:2], strict=True)
        ahead = [axis[i] + share * (axis[j] - axis[i]) for axis, i, j in ways]
        return scaled_system(self.params, *map(float, ahead))


def _purity(scene: ScaledSystem, orbit: Orbit) -> float:
    """Share of the first harmonic in the motion of y."""
    y = cosines_of(sample(scene.system.rows, orbit.point, _PHASES)[:, 1])
    return float(y[1] ** 2 / np.sum(y[1:] ** 2))
