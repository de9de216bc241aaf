"""The map of kept contact at high resolution."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.a1.jobs import Model
from squealpipe.brake.adaptive_grid import (
    Evaluate,
    RefinedGrid,
    follow_boundaries,
    refine_grid,
)
from squealpipe.brake.schema.dynamics.runs import refined_validity_map_schema
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.validation import Natural, Positive, Tolerance, Workers
from squealpipe.vibration.shares import wilson_interval

CHECKED_CELLS = 4000
"""Inherited cells that are run to measure how often they are wrong."""


@recorded(method="Taylor series with located events on an adaptive grid")
def refine_validity_map(
    params: Parameters,
    *,
    resolution: Natural,
    coarse: Natural,
    t_end: Positive | None = None,
    model: Model = "A1",
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Map where model A1 keeps contact, over both angles from 0 to π, at full resolution.

    Cells are run on a coarse grid, along every boundary, and around cells where a region too thin
    for the grid may hide: those that separate late, and those whose lowest contact force is small
    against its change between neighbours. The others inherit the answer of a neighbour. How often
    that is wrong is measured by running a random sample of them; if it finds wrong ones, the
    boundaries around these are followed too, and a new sample shows what is left.

    Args:
        resolution, coarse: points per side of the finest and the first grid; (resolution − 1) must
            be (coarse − 1) times a power of two.
        t_end: end of each run, s; 200 √(m/k1) by default.
        model: "A1" or one of its variants.

    Returns:
        Dataset over (alpha1, alpha2); cells that were not run have the outcome ``inherited``, and
        the error rate of these is given with its 95 % interval. Cells of a sample that were wrong
        are put right.
    """
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    angles = np.linspace(0.0, np.pi, resolution)
    time = np.full((resolution, resolution), np.nan)
    outcome = np.full((resolution, resolution), int(Outcome.inherited), np.int8)

    def evaluate(
        rows: np.ndarray, columns: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        run = run_ensemble(
            params,
            angles[rows],
            angles[columns],
            t_end=t_end,
            model=model,
            tol=tol,
            stop_at_first_separation=True,
            tracked=("contact_force",),
            workers=workers,
        )
        time[rows, columns] = run.first_separation_time
        outcome[rows, columns] = run.outcome
        lost = run.outcome == Outcome.separated
        # cells that separate only after a tenth of t_end lie next to those that never do
        late = lost & (run.first_separation_time > 0.1 * t_end)
        return lost, late, np.where(lost, np.nan, run.lowest_contact_force)

    grid = refine_grid(evaluate, resolution, coarse)
    seed = 2021
    checked, wrong = _check_inherited(evaluate, grid, seed)
    if wrong:
        follow_boundaries(evaluate, grid)
        checked, wrong = _check_inherited(evaluate, grid, seed + 1)
    time[~grid.computed], outcome[~grid.computed] = np.nan, Outcome.inherited
    return build(
        refined_validity_map_schema,
        {
            "separates": grid.labels,
            "first_separation_time": time,
            "computed": grid.computed,
            "inherited_checked": checked,
            "inherited_wrong": wrong,
            "inherited_error_interval": wilson_interval(wrong, checked),
            "t_end": t_end,
            "outcome": outcome,
        },
        {"alpha1": angles, "alpha2": angles},
        {"runs": int(grid.computed.sum()), "coarse": coarse},
    )


def _check_inherited(
    evaluate: Evaluate, grid: RefinedGrid, seed: int
) -> tuple[int, int]:
    """Run a sample of the inherited cells: (how many, how many were wrong); put those right."""
    inherited = np.flatnonzero(~grid.computed)
    if not inherited.size:
        return 0, 0
    size = min(CHECKED_CELLS, inherited.size)
    chosen = inherited[
        np.random.default_rng(seed).choice(inherited.size, size, replace=False)
    ]
    rows, columns = np.unravel_index(np.sort(chosen), grid.labels.shape)
    lost, _, _ = evaluate(rows, columns)
    wrong = lost != grid.labels[rows, columns]
    here = rows[wrong], columns[wrong]
    grid.labels[here], grid.computed[here] = lost[wrong], True
    return int(chosen.size), int(wrong.sum())
