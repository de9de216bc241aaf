"""Measure a pad's settled motion: it is run on from its end, recorded, and described by numbers."""

from functools import partial
from typing import Any

import numpy as np

from squealpipe.brake.a1.ensemble import LARGEST_CONTACT_FORCE, run_ensemble
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.codes import Regime
from squealpipe.laws.contact import normal_force
from squealpipe.schema import Outcome
from squealpipe.vibration import levels as measured
from squealpipe.vibration.levels import Measurement, Record
from squealpipe.vibration.settled_runs import SettledRun


def levels(
    design: Design, sliding: Sliding | None, settled: SettledRun, *, tol: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the scalars of a settled motion; and its spectrum and path.

    Both are variables of the dataset of :func:`squealpipe.assess` by name, as
    :func:`squealpipe.vibration.levels.levels` defines them. A pad has one contact, so the values by
    contact are left out.
    """
    params = design.params
    scalars, pictured = measured.levels(
        partial(_record, design, tol=tol),
        settled,
        begin=settled.last.final,
        period=design.period,
        loads=np.array([params.k3 * params.preload]),
        sliding_forces=None if sliding is None else np.array([sliding.force]),
    )
    of_one = {key: v for key, v in pictured.items() if not key.startswith("contact_")}
    return scalars, of_one


def _record(design: Design, state: np.ndarray, *, tol: float) -> Record:
    """Return samples of a run from a state (4,), over the length of one record."""
    params = design.params
    length = Measurement.periods * design.period
    count = int(Measurement.periods * Measurement.fine)
    times = np.linspace(0.0, length, count + 1)[1:]
    run = run_ensemble(
        params,
        design.alpha1,
        design.alpha2,
        t_end=length,
        times=times,
        initial_state=state,
        tol=tol,
        tracked=(LARGEST_CONTACT_FORCE,),
        sums=True,
        log_events=Measurement.most_events,
        workers=1,
    )
    load = params.k3 * params.preload
    x, y, vx, vy = run.samples.T
    off = run.sample_regimes == Regime.separated.value
    force = np.where(off, 0.0, normal_force(y, vy, params) / load)
    logged = min(int(run.events), Measurement.most_events)
    return Record(
        times=times,
        states=run.samples,
        displacements=np.stack([x, y], axis=-1)[:, None],
        velocities=np.stack([vx, vy], axis=-1)[:, None],
        forces=force[:, None],
        regimes=run.sample_regimes[:, None],
        open_time=run.sample_separated_time[:, None],
        stick_time=run.sample_stick_time[:, None],
        landings=run.sample_contacts[:, None],
        peak_forces=np.atleast_1d(float(run.peak_contact_force) * load),
        impact_speed=float(run.impact_speed),
        event_times=run.event_times[:logged],
        event_kinds=run.event_kinds[:logged],
        end=run.final_state,
        duration=float(run.time),
        finished=run.outcome == Outcome.converged,
    )
