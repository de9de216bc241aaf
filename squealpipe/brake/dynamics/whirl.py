"""The paper's growing and bounded responses in the long run.

At (0.4π, 0.6π) and (0.2π, 0.8π) both springs share one fixed end. The mass goes round it, and
each pass over the belt adds energy until the mass is as fast as the belt.
"""

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import LARGEST_REACH, run_ensemble
from squealpipe.brake.dynamics.motion import judge, with_log
from squealpipe.brake.normal_form import NormalForm
from squealpipe.brake.schema.dynamics.long_runs import transient_schema, whirl_schema
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.parameters import SCENES, Parameters
from squealpipe.schema import Outcome, build


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
    the belt at speed V swings out to x = (1 + c1) L + V √(m/(k1 + k2)), L the mean of both free
    lengths weighted by stiffness. The fit takes this line's form, over all speeds with a whirl
    larger than four free lengths; ``fit_range`` says how far it holds.

    Args:
        params: physical parameters; of the belt speed only the direction is kept.
        t_end: end of each run, s; the last fifth gives the size.

    Returns:
        Dataset over belt_speed; see ``whirl_schema``. Without three such speeds
        slope and offset are NaN.
    """
    form, scene = NormalForm.of(params), SCENES["F3"]
    alpha1, alpha2 = form.angles(scene.alpha1, scene.alpha2)
    speeds = np.asarray(belt_speeds, float)

    # the last fifth of a run counts as late
    run = run_ensemble(
        {**form.params.as_dict(), "belt_speed": speeds},
        alpha1,
        alpha2,
        **with_log(t_end, params),
        tol=tol,
        t_late=0.8 * t_end,
        tracked=("x", LARGEST_REACH),
        workers=workers,
    )
    motion, changed = judge(run, form.params, t_end, workers=workers)
    p = params
    # in free lengths: from here the springs' free length is a small correction
    fitted = (motion == MotionFlag.whirl) & (
        run.late_max_x > 4.0 * max(p.length1, p.length2)
    )
    # of the one spring that both are together from afar
    length = (p.k1 * p.length1 + p.k2 * p.length2) / (p.k1 + p.k2)
    slope, offset, fit_range = np.nan, np.nan, [np.nan, np.nan]
    # two amplitudes would fit any power law
    if np.count_nonzero(fitted) >= 3:
        fit_range = [speeds[fitted].min(), speeds[fitted].max()]
        weights = 1.0 / run.late_max_x[fitted]
        slope, offset = np.polyfit(speeds[fitted], run.late_max_x[fitted], 1, w=weights)
    return build(
        whirl_schema,
        {
            "amplitude": run.late_max_x,
            "stick_fraction": run.stick_time / run.time,
            "motion": motion,
            "motion_changed": changed,
            "fitted": fitted,
            "fit_range": fit_range,
            "slope": slope,
            "offset": offset,
            "energy_slope": np.sqrt(p.mass / (p.k1 + p.k2)),
            "energy_offset": length * (1.0 + np.cos(scene.alpha1)),
            "t_end": t_end,
            "outcome": run.outcome,
        },
        {"belt_speed": form.sign * speeds},
    )


def transient_lifetimes(
    params: Parameters,
    *,
    samples: int,
    t_end: float,
    tol: float = 1e-12,
    workers: int | None = None,
) -> xr.Dataset:
    """Lifetimes of the bounded motion at (0.2π, 0.8π) over tiny perturbations of its start.

    The samples start at rest at y = 0 and evenly spaced x up to ±1e-9 l_pre. A run ends with its
    tenth net turn around the fixed ends: from there on it whirls.
    """
    form, scene = NormalForm.of(params), SCENES["F4"]
    alpha1, alpha2 = form.angles(scene.alpha1, scene.alpha2)
    state = np.zeros((samples, 4))
    # in l_pre: the starts differ by less than anything that could be measured
    start = 1e-9 * params.preload * np.linspace(-1.0, 1.0, samples)
    state[:, 0] = form.sign * start
    # a pendulum swinging back and forth over the top never makes ten net turns
    run = run_ensemble(
        form.params,
        alpha1,
        alpha2,
        t_end=t_end,
        tol=tol,
        initial_state=state,
        stop_at_turns=10.0,
        tracked=(),
        workers=workers,
    )
    ended = run.outcome == Outcome.amplitude_reached
    return build(
        transient_schema,
        {
            "lifetime": np.where(ended, run.time, np.nan),
            "belt_speed": params.belt_speed,
            "t_end": t_end,
            "outcome": run.outcome,
        },
        {"sample": np.arange(samples)},
    )
