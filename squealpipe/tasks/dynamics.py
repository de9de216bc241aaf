"""Nonlinear runs in time, and the map of where model A1 keeps contact."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.laws.contact import contact_force
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.dynamics import SIMULATION, VALIDITY_MAP, RegimeFlag
from squealpipe.tasks.ensemble import run_ensemble, run_map
from squealpipe.tasks.ensemble_jobs import known_model, real_array
from squealpipe.tasks.linear import stability_map

SAMPLES_PER_TIME_UNIT = 20
MOST_SAMPLES = 20_001
FIRST_LOG = 1024
"""Events kept at first; a run that has more is made again with room for all."""


def simulate(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    *,
    t_end: float,
    model: str = "A1",
    tol: float = 1e-12,
    times: Any = None,
    initial_state: Any = (0.0, 0.0, 0.0, 0.0),
) -> xr.Dataset:
    """One run of a nonlinear model, with every regime change located.

    Args:
        params: physical parameters.
        alpha1, alpha2: spring angles, rad.
        t_end: end of the run, s.
        model: "A1", "A1-no-stick" (ends at the first stick, with outcome ``event_limit``),
            "A1-no-separation" (k3 also pulls), "A1-linear-springs" or "A4" (which goes on past
            ẋ = V, where it does not hold; compare ``vx`` with the belt speed).
        tol: tolerance of the Taylor integrator, relative to l_pre.
        times: the state is given at exactly these instants, s; by default 20 a time unit √(m/k1).
        initial_state: x, y, vx, vy at t = 0, m and m/s.

    Returns:
        Dataset over ``time`` and ``event``; see ``schema.dynamics.SIMULATION``. Instants that a
        run with another outcome than ``converged`` did not reach hold NaN.

    Raises:
        ValueError: an argument is not a finite number, is negative, or names no model.
    """
    known_model(model)
    scalars = {"alpha1": alpha1, "alpha2": alpha2, "t_end": t_end}
    for name, value in scalars.items():
        if real_array(name, value).ndim:
            raise ValueError(f"{name} = {value!r}: one number is needed")
    if t_end < 0:
        raise ValueError(f"t_end = {t_end!r}: must be 0 or greater")
    if times is None:
        count = math.ceil(SAMPLES_PER_TIME_UNIT * t_end / params.time_unit) + 1
        times = np.linspace(0.0, t_end, min(max(count, 2), MOST_SAMPLES))
    times = real_array("times", times)
    if times.ndim != 1:
        raise ValueError(f"times has {times.ndim} dimensions: a sequence of instants is needed")
    initial = real_array("initial_state", initial_state)
    if initial.shape != (4,):
        raise ValueError(f"initial_state = {initial_state!r}: x, y, vx and vy are needed")
    room, logged = 0, FIRST_LOG
    while room < logged:
        room = logged
        run = run_ensemble(
            params,
            alpha1,
            alpha2,
            t_end=t_end,
            model=model,
            tol=tol,
            times=times,
            initial_state=initial,
            log_events=room,
            workers=1,
        )
        logged = int(run.separations + run.contacts + run.sticks + run.slips + run.reversals)
    x, y, vx, vy = run.samples.T
    if times.size and times[0] == 0.0:
        x[0], y[0], vx[0], vy[0] = initial
    if VARIANT_RULES[model].separates:
        normal = np.where(run.sample_regimes == RegimeFlag.separated, 0.0, contact_force(y, params))
    else:
        normal = contact_force(y, params)
    return build(
        SIMULATION,
        {
            "x": x,
            "y": y,
            "vx": vx,
            "vy": vy,
            "normal_force": normal,
            "normalized_contact_force": normal / (params.k3 * params.preload),
            "regime": run.sample_regimes,
            "event_time": run.event_times[:logged],
            "event_kind": run.event_kinds[:logged],
            "alpha1": alpha1,
            "alpha2": alpha2,
            "preload": params.preload,
            "length1": params.length1,
            "length2": params.length2,
            "time_reached": run.time,
            "n_steps": run.steps,
            "outcome": run.outcome,
        },
        {"time": times},
        {"model": model},
    )


def validity_map(
    params: Parameters,
    alpha1: Any,
    alpha2: Any,
    *,
    t_end: float = 200.0,
    tol: float = 1e-12,
    workers: int | None = None,
) -> xr.Dataset:
    """Where model A1, started at rest, keeps contact until ``t_end``.

    A cell's run stops at its first separation, so a map of mostly separating cells is cheap.

    Args:
        params: physical parameters.
        alpha1, alpha2: 1-D arrays of angles, rad.
        t_end: end of each run, s.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset over (alpha1, alpha2): first_separation_time (s; NaN: none), separates,
        regime_linear (A3), response_growth (late over early |x|, for the stability that A1 itself
        shows), outcome (``separated`` or ``converged`` where the run was decided).

    Raises:
        ValueError: an argument is not a finite number or is negative.
    """
    first, second = angle_axis("alpha1", alpha1), angle_axis("alpha2", alpha2)
    run = run_map(
        params,
        first,
        second,
        ("outcome", "first_separation_time", "early_max_x", "late_max_x"),
        t_end=t_end,
        tol=tol,
        stop_at_first_separation=True,
        t_late=0.5 * t_end,
        workers=workers,
    )
    lost = run.outcome == Outcome.separated
    moves = run.early_max_x > 0
    growth = np.where(moves, run.late_max_x, 1.0) / np.where(moves, run.early_max_x, 1.0)
    return build(
        VALIDITY_MAP,
        {
            "first_separation_time": run.first_separation_time,
            "separates": lost,
            "response_growth": np.where(lost, np.nan, growth),
            "regime_linear": stability_map(params, first, second)["regime_linear"],
            "t_end": t_end,
            "outcome": run.outcome,
        },
        {"alpha1": first, "alpha2": second},
    )


def angle_axis(name: str, values: Any) -> np.ndarray:
    """A 1-D array of angles, rad.

    Raises:
        ValueError: it has another number of dimensions, is empty, or holds no finite numbers.
    """
    angles = real_array(name, values)
    if angles.ndim != 1 or not angles.size:
        raise ValueError(f"{name} has shape {angles.shape}: a 1-D array of angles is needed")
    return angles
