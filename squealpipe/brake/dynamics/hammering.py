"""Map of what model A1 does after its first separation: impacts, forces, kind of motion."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import (
    LARGEST_CONTACT_FORCE,
    LARGEST_REACH,
    Ensemble,
    run_map,
)
from squealpipe.brake.dynamics import motion
from squealpipe.brake.normal_form import NormalForm
from squealpipe.brake.schema.dynamics.runs import hammering_map_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.systems.recurrence import Recurrence
from squealpipe.validation import Angles, Positive, Tolerance, Workers


@recorded(model="A1", method="Taylor series with located events")
def hammering_map(
    params: Parameters,
    alpha1: Angles,
    alpha2: Angles,
    *,
    t_end: Positive,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Impacts, forces, extremes, kind of motion and predictability of A1 started at rest.

    ``motion`` is the kind of motion, judged from the second half of the run:

    - contact kept in it, or stick–slip in contact; came to rest in contact (within a
      thousandth of its largest displacement); or hammered earlier, then kept contact;
    - whirl: net turns around both fixed ends, counted by half turns, at a rate of at least three a
      run, and one for two returns to the belt;
    - irregular hammering: a perturbation has grown by more than 1 + t, t in √(2m/(k1 + k2));
    - periodic hammering: it has not, and the kinds and intervals of the events repeat within 1e-6
      of the mean interval;
    - quasi-periodic hammering: they do not repeat, but the intervals after each kind are
      distributed alike in both halves, with at least 30 in each;
    - undetermined: there are fewer events, or they still change.

    ``motion_changed``: the two quarters have different labels. Systems that are mirror images of
    one another get the same labels: the runs are made in the form of
    :class:`squealpipe.brake.normal_form.NormalForm`.

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad.
        t_end: end of each run, s.

    Returns:
        Dataset over (alpha1, alpha2); see ``hammering_map_schema``. ``outcome`` is
        ``beyond_horizon`` where an error of ``tol`` decides the state before t_end: there only
        statistics mean something.
    """
    form = NormalForm.of(params)
    rows, columns = form.angles(alpha1, alpha2)
    maps = run_map(
        form.params,
        rows,
        columns,
        partial(_hammering, params=form.params, t_end=t_end, workers=workers),
        at_once=Recurrence.events_at_once // motion.room_for_events(t_end, params),
        **motion.with_log(t_end, params),
        tol=tol,
        t_late="return",
        tracked=(LARGEST_CONTACT_FORCE, LARGEST_REACH),
        workers=workers,
    )
    maps["turns"] = form.sign * maps["turns"]
    return build(
        hammering_map_schema,
        {**{name: form.back(values) for name, values in maps.items()}, "t_end": t_end},
        {"alpha1": alpha1, "alpha2": alpha2},
        {
            "regular_growth": float(
                motion.regular_growth(t_end / motion.linear_time(params))
            )
        },
    )


def _hammering(
    run: Ensemble, *, params: Parameters, t_end: float, workers: int | None
) -> dict[str, np.ndarray]:
    """Variables of some runs."""
    kinds, changed = motion.judge(run, params, t_end, workers=workers)
    # A run that ended early is averaged over the time that it lasted.
    time = np.maximum(run.time, np.finfo(float).tiny)
    return {
        "impact_rate": run.contacts / time,
        "separated_fraction": run.separated_time / time,
        "peak_contact_force": run.peak_contact_force,
        "return_peak_contact_force": run.return_peak_contact_force,
        "impact_speed": run.impact_speed,
        "stick_fraction": run.stick_time / time,
        "max_displacement": run.max_displacement,
        "turns": run.turns,
        "motion": kinds,
        "motion_changed": changed,
        **motion.predictability(run),
    }
