"""Basins of model A1: motions from many starts at one configuration."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.dynamics.motion import judge, predictability, with_log
from squealpipe.brake.schema.basins import basin_schema, start_variables
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.systems.progress import with_progress
from squealpipe.validation import Angle, Line, NotNegative, Positive, Tolerance, Workers


@recorded(model="A1", method="Taylor series with located events")
def basin_map(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    x: Line = 0.0,
    y: Line = 0.0,
    vx: Line = 0.0,
    vy: Line = 0.0,
    t_end: Positive,
    t_late: NotNegative | None = None,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Runs of A1 from a grid of starts, and the kind of motion that each leads to.

    ``motion`` is judged from the second half of the run as in ``hammering_map``. Where the two
    quarters of that half have different labels, it is ``unsettled``.

    Args:
        alpha1, alpha2: angles, rad.
        x, y, vx, vy: start, each a number or a 1-D array, m and m/s; the arrays become the
            dimensions x0, y0, vx0, vy0.
        t_end: end of each run, s.
        t_late: from where the late extrema count, s; default 0.8 t_end.

    Returns:
        Dataset over the starts; see ``schema.basins``.
    """
    late = 0.8 * t_end if t_late is None else t_late
    if not late < t_end:
        raise ValueError(
            f"t_late = {t_late!r}: 0 or a time before t_end = {t_end!r} is needed, s"
        )
    axes = dict(zip(start_variables, map(np.asarray, (x, y, vx, vy)), strict=True))
    shape = tuple(axis.size for axis in axes.values() if axis.ndim)
    grid = np.meshgrid(*(np.atleast_1d(axis) for axis in axes.values()), indexing="ij")
    starts = np.stack([part.ravel() for part in grid], axis=-1)
    runs_at_once = 2000
    blocks = [
        _block(
            params,
            alpha1,
            alpha2,
            starts[at : at + runs_at_once],
            t_end,
            late,
            tol,
            workers,
        )
        for at in with_progress(range(0, len(starts), runs_at_once))
    ]
    columns = {
        name: np.concatenate([block[name] for block in blocks]).reshape(shape)
        for name in blocks[0]
    }
    swept = {name: axis for name, axis in axes.items() if axis.ndim}
    fixed = {name: float(axis) for name, axis in axes.items() if not axis.ndim}
    angles = {"alpha1": alpha1, "alpha2": alpha2}
    return build(
        basin_schema(tuple(swept)),
        {**columns, **fixed, **angles, "t_end": t_end},
        swept,
    )


def _block(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    starts: np.ndarray,
    t_end: float,
    t_late: float,
    tol: float,
    workers: int | None,
) -> dict[str, np.ndarray]:
    """Variables of some starts."""
    run = run_ensemble(
        params,
        alpha1,
        alpha2,
        **with_log(t_end, params),
        initial_state=starts,
        t_late=t_late,
        tol=tol,
        workers=workers,
    )
    motion, changed = judge(run, params, t_end, workers=workers)
    return {
        "motion": np.where(changed, MotionFlag.unsettled, motion),
        "late_max_x": run.late_max_x,
        "late_max_vx": run.late_max_vx,
        "separates": np.isfinite(run.first_separation_time),
        "first_separation_time": run.first_separation_time,
        "peak_contact_force": run.peak_contact_force,
        **predictability(run),
    }
