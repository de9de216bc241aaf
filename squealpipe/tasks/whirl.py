"""What becomes of the paper's growing and bounded responses in the long run.

At (0.4π, 0.6π) and (0.2π, 0.8π) both springs share one fixed end. The mass goes round it, and
each pass over the belt adds energy until the mass is as fast as the belt.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import SCENES, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.dynamics import TRANSIENT, WHIRL, MotionFlag
from squealpipe.tasks.ensemble import run_ensemble
from squealpipe.tasks.hammering import classify_motion

LATE_SHARE = 0.8
"""Share of a run after which it counts as late."""
FAR = 4.0
"""Amplitude, in free lengths, from which the springs' free length is a small correction."""
LEAST_FITTED = 3
ESCAPE_TURNS = 10.0
"""Net turns that a pendulum swinging back and forth over the top never makes."""
LARGEST_PERTURBATION = 1e-9
"""Largest |x| at the start of a transient, in l_pre."""


def whirl_sizes(
    params: Parameters,
    belt_speeds: Any,
    *,
    t_end: float,
    tol: float = 1e-12,
    workers: int | None = None,
) -> xr.Dataset:
    """Size of the motion at (0.4π, 0.6π) after saturation, over belt speed, and its law.

    Far from the fixed end both springs pull as one of stiffness k1 + k2, so a mass that passes
    the belt at speed V swings out to x = c1 L1 + L1 + V √(m/(k1 + k2)). The fit takes this line's
    form, over all speeds with a whirl larger than four free lengths.

    Args:
        params: physical parameters; the belt speed is replaced.
        belt_speeds: 1-D array, m/s.
        t_end: end of each run, s; the last fifth gives the size.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset over belt_speed; see ``schema.dynamics.WHIRL``. Without three such speeds slope and
        offset are NaN and ``fit_outcome`` is ``unresolved``.

    Raises:
        ValueError: as :func:`run_ensemble`.
    """
    scene = SCENES["F3"]
    speeds = np.asarray(belt_speeds, float)
    run = run_ensemble(
        {**params.as_dict(), "belt_speed": speeds},
        scene.alpha1,
        scene.alpha2,
        t_end=t_end,
        tol=tol,
        t_late=LATE_SHARE * t_end,
        tangent=True,
        workers=workers,
    )
    motion = classify_motion(run, params.time_unit)
    length = max(params.length1, params.length2)
    fitted = (motion == MotionFlag.whirl) & (run.late_max_x > FAR * length)
    slope = offset = np.nan
    if np.count_nonzero(fitted) >= LEAST_FITTED:
        weights = 1.0 / run.late_max_x[fitted]
        slope, offset = np.polyfit(speeds[fitted], run.late_max_x[fitted], 1, w=weights)
    return build(
        WHIRL,
        {
            "amplitude": run.late_max_x,
            "amplitude_before": run.early_max_x,
            "max_vx": run.max_vx,
            "turn_rate": run.turns / run.time,
            "stick_fraction": run.stick_time / run.time,
            "motion": motion,
            "fitted": fitted,
            "slope": slope,
            "offset": offset,
            "energy_slope": np.sqrt(params.mass / (params.k1 + params.k2)),
            "energy_offset": params.length1 * (1.0 + np.cos(scene.alpha1)),
            "fit_outcome": Outcome.unresolved if np.isnan(slope) else Outcome.converged,
            "t_end": t_end,
            "outcome": run.outcome,
        },
        {"belt_speed": speeds},
    )


def transient_lifetimes(
    params: Parameters,
    belt_speeds: Any,
    *,
    samples: int,
    shown_samples: int,
    t_end: float,
    tol: float = 1e-12,
    workers: int | None = None,
) -> xr.Dataset:
    """Lifetimes of the bounded motion at (0.2π, 0.8π) over tiny perturbations of its start.

    The samples start at rest at y = 0 and evenly spaced x up to ±1e-9 l_pre. A run ends with its
    tenth net turn around the fixed ends: from there on it whirls.

    Args:
        params: physical parameters.
        belt_speeds: 1-D array, m/s, of the speeds to compare.
        samples: runs at each of these speeds.
        shown_samples: runs at the belt speed of ``params``.
        t_end: end of the runs, s.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Raises:
        ValueError: as :func:`run_ensemble`.
    """
    scene = SCENES["F4"]
    speeds = np.asarray(belt_speeds, float)
    runs = []
    starts = []
    for count, speed in ((samples, speeds[:, None]), (shown_samples, params.belt_speed)):
        start = LARGEST_PERTURBATION * params.preload * np.linspace(-1.0, 1.0, count)
        state = np.zeros((count, 4))
        state[:, 0] = start
        starts.append(start)
        runs.append(
            run_ensemble(
                {**params.as_dict(), "belt_speed": speed},
                scene.alpha1,
                scene.alpha2,
                t_end=t_end,
                tol=tol,
                initial_state=state,
                stop_at_turns=ESCAPE_TURNS,
                workers=workers,
            )
        )
    compared, shown = runs
    lifetimes = [
        np.where(run.outcome == Outcome.amplitude_reached, run.time, np.nan) for run in runs
    ]
    return build(
        TRANSIENT,
        {
            "start_x": starts[0],
            "lifetime": lifetimes[0],
            "max_displacement": compared.max_displacement,
            "shown_start_x": starts[1],
            "shown_lifetime": lifetimes[1],
            "shown_belt_speed": params.belt_speed,
            "t_end": t_end,
            "outcome": compared.outcome,
            "shown_outcome": shown.outcome,
        },
        {"belt_speed": speeds, "sample": np.arange(samples)},
    )
