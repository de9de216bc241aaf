"""Map of what model A1 does after its first separation: impacts, forces, kind of motion."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.dynamics import HAMMERING_MAP, MotionFlag
from squealpipe.tasks.dynamics import angle_axis
from squealpipe.tasks.ensemble import Ensemble, run_map

LEAST_TURNS = 3
"""Net turns from which a motion can be a whirl."""
TURNS_PER_RETURN = 0.5
"""Net turns for each return to the belt from which it is one: a pendulum that goes over the top
and back makes none, however long it lasts."""
REGULAR_GROWTH_POWER = 2.0
"""A perturbation of a regular motion grows like a power of time, of a chaotic one exponentially."""

USED = (
    "outcome",
    "time",
    "contacts",
    "separations",
    "separated_time",
    "stick_time",
    "peak_contact_force",
    "max_displacement",
    "turns",
    "log_growth",
    "predictability_horizon",
)
"""Results of the runs that the map is made from."""


def hammering_map(
    params: Parameters,
    alpha1: Any,
    alpha2: Any,
    *,
    t_end: float,
    tol: float = 1e-12,
    workers: int | None = None,
) -> xr.Dataset:
    """Impacts, forces, extremes, kind of motion and predictability of A1 started at rest.

    ``motion`` is perpetual contact; stick–slip in contact; whirl (at least three net turns around
    both fixed ends, and one for two returns to the belt); otherwise hammering,
    irregular where a perturbation has grown faster than (1 + t)², t in units of √(m/k1), and
    else periodic or quasi-periodic.

    Args:
        params: physical parameters.
        alpha1, alpha2: 1-D arrays of angles, rad.
        t_end: end of each run, s.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset over (alpha1, alpha2); see ``schema.dynamics.HAMMERING_MAP``. ``outcome`` is
        ``beyond_horizon`` where an error of ``tol`` decides the state before t_end: there only
        statistics mean something.

    Raises:
        ValueError: an argument is not a finite number, or t_end is not positive.
    """
    first, second = angle_axis("alpha1", alpha1), angle_axis("alpha2", alpha2)
    if not t_end > 0:
        raise ValueError(f"t_end = {t_end!r}: must be greater than 0")
    run = run_map(
        params,
        first,
        second,
        USED,
        t_end=t_end,
        tol=tol,
        tangent=True,
        workers=workers,
    )
    # A run that ended early is averaged over the time that it lasted.
    time = np.maximum(run.time, np.finfo(float).tiny)
    chaotic = (run.outcome == Outcome.converged) & np.isfinite(run.predictability_horizon)
    return build(
        HAMMERING_MAP,
        {
            "impact_rate": run.contacts / time,
            "separated_fraction": run.separated_time / time,
            "peak_contact_force": run.peak_contact_force,
            "stick_fraction": run.stick_time / time,
            "max_displacement": run.max_displacement,
            "turns": run.turns,
            "lyapunov_exponent": run.log_growth / time,
            "predictability_horizon": np.where(
                np.isnan(run.predictability_horizon), run.time, run.predictability_horizon
            ),
            "motion": classify_motion(run, params.time_unit),
            "t_end": t_end,
            "outcome": np.where(chaotic, Outcome.beyond_horizon, run.outcome),
        },
        {"alpha1": first, "alpha2": second},
        {"regular_growth": float(regular_growth(t_end / params.time_unit))},
    )


def regular_growth(time: Any) -> Any:
    """Most that ln of a perturbation grows in a regular motion; time in √(m/k1)."""
    return REGULAR_GROWTH_POWER * np.log1p(time)


def classify_motion(run: Ensemble | SimpleNamespace, time_unit: float) -> np.ndarray:
    """``MotionFlag`` of each run of an ensemble with ``tangent=True``."""
    turns = np.abs(run.turns)
    whirls = (turns >= LEAST_TURNS) & (turns > TURNS_PER_RETURN * run.contacts)
    return np.select(
        [
            (run.separations == 0) & (run.separated_time == 0) & (run.stick_time == 0),
            (run.separations == 0) & (run.separated_time == 0),
            whirls,
            run.log_growth > regular_growth(run.time / time_unit),
        ],
        [
            MotionFlag.perpetual_contact,
            MotionFlag.stick_slip,
            MotionFlag.whirl,
            MotionFlag.irregular_hammering,
        ],
        MotionFlag.periodic_hammering,
    )
