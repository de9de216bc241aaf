"""Map of what model A1 does after its first separation: impacts, forces, kind of motion."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.dynamics.runs import HAMMERING_MAP
from squealpipe.schema.origin import recorded
from squealpipe.solvers.a1.ensemble import PEAK, REACH, Ensemble, run_ensemble, run_map
from squealpipe.tasks.dynamics import motion
from squealpipe.tasks.normal_form import NormalForm
from squealpipe.validation import Angles, Positive, Tolerance, Workers

USED = (
    *motion.USED,
    "peak_contact_force",
    "return_peak_contact_force",
    "impact_speed",
    "predictability_horizon",
)
"""Results of the runs that the map is made from."""


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
    :class:`squealpipe.tasks.normal_form.NormalForm`.

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad.
        t_end: end of each run, s.

    Returns:
        Dataset over (alpha1, alpha2); see ``schema.dynamics.runs.HAMMERING_MAP``. ``outcome`` is
        ``beyond_horizon`` where an error of ``tol`` decides the state before t_end: there only
        statistics mean something.
    """
    form = NormalForm.of(params)
    rows, columns = form.angles(alpha1, alpha2)
    run = run_map(
        form.params,
        rows,
        columns,
        USED,
        **motion.as_judged(t_end),
        tol=tol,
        t_late="return",
        tracked=(PEAK, REACH),
        workers=workers,
    )
    shape = run.outcome.shape
    cells = [angles.ravel() for angles in np.broadcast_arrays(rows[:, None], columns)]
    flat = SimpleNamespace(
        **{
            name: values.reshape(-1, *values.shape[2:])
            for name, values in vars(run).items()
        }
    )

    def again(some: np.ndarray, room: int) -> Ensemble:
        return run_ensemble(
            form.params,
            *(angles[some] for angles in cells),
            t_end=t_end,
            tol=tol,
            tangent=True,
            tracked=(),
            log_events=room,
            workers=workers,
        )

    kinds, changed = motion.classify_motion(flat, form.params)
    kinds = motion.refine_labels(kinds, flat, again, t_end)
    # A run that ended early is averaged over the time that it lasted.
    time = np.maximum(run.time, np.finfo(float).tiny)
    maps = {
        "impact_rate": run.contacts / time,
        "separated_fraction": run.separated_time / time,
        "peak_contact_force": run.peak_contact_force,
        "return_peak_contact_force": run.return_peak_contact_force,
        "impact_speed": run.impact_speed,
        "stick_fraction": run.stick_time / time,
        "max_displacement": run.max_displacement,
        "turns": form.sign * run.turns,
        "motion": kinds.reshape(shape),
        "motion_changed": changed.reshape(shape),
        **motion.predictability(run),
    }
    return build(
        HAMMERING_MAP,
        {**{name: form.back(values) for name, values in maps.items()}, "t_end": t_end},
        {"alpha1": alpha1, "alpha2": alpha2},
        {
            "regular_growth": float(
                motion.regular_growth(t_end / motion.linear_time(params))
            )
        },
    )
