"""Nonlinear runs in time, and the map of where model A1 keeps contact."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.laws.contact import contact_force
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.dynamics.runs import GROWTH_THRESHOLD, SIMULATION, VALIDITY_MAP, RegimeFlag
from squealpipe.schema.origin import recorded
from squealpipe.solvers.a1.ensemble import integrate, run_map
from squealpipe.solvers.a1.jobs import Jobs, known_model
from squealpipe.tasks.linear.maps import stability_map
from squealpipe.validation import angle_axis, real_array, real_number

SAMPLES_PER_TIME_UNIT = 20
MOST_SAMPLES = 20_001
FIRST_LOG = 256
"""Events kept at first; a run that has more is made again with room for all."""
WANTED = (
    "samples",
    "sample_regimes",
    "event_times",
    "event_kinds",
    "events",
    "time",
    "steps",
    "outcome",
)
"""Results that ``simulate`` reports."""


@recorded(method="Taylor series with located events")
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
    growth: bool = False,
) -> xr.Dataset:
    """One run of a nonlinear model, with every regime change located.

    Args:
        params: physical parameters.
        alpha1, alpha2: spring angles, rad.
        t_end: end of the run, s.
        model: "A1", "A1-no-stick" (ends at the first stick, with outcome ``event_limit``),
            "A1-no-separation" (k3 also pulls), "A1-linear-springs", "A1-as-printed" (Eq. (4)
            literally: friction pushes against the belt) or "A4" (which goes on past ẋ = V, where it
            does not hold; compare ``vx`` with the belt speed).
        tol: tolerance of the Taylor integrator, relative to l_pre.
        times: the state is given at exactly these instants, s; by default 20 per time unit √(m/k1).
        initial_state: x, y, vx, vy at t = 0, m and m/s.
        growth: tell too by which factor a small perturbation of the start has grown at the end.

    Returns:
        Dataset over ``time`` and ``event``; see ``schema.dynamics.runs.SIMULATION``. Instants
        that a run with another outcome than ``converged`` did not reach hold NaN.

    Raises:
        ValueError: an argument is not a finite number, is negative, or names no model.
    """
    known_model(model)
    alpha1, alpha2 = real_number("alpha1", alpha1), real_number("alpha2", alpha2)
    t_end = real_number("t_end", t_end, least=0.0)
    times = _instants(times, t_end, params.time_unit)
    initial = real_array("initial_state", initial_state)
    if initial.shape != (4,):
        raise ValueError(f"initial_state = {initial_state!r}: x, y, vx and vy are needed")
    job = Jobs.build(
        params,
        alpha1,
        alpha2,
        t_end=t_end,
        model=model,
        tol=tol,
        times=times,
        initial_state=initial,
    )
    wanted = (*WANTED, *(("log_growth",) if growth else ()))
    room, logged = 0, FIRST_LOG
    while room < logged:
        room = logged
        found = integrate(job, wanted, tangent=growth, log_events=room, few=not growth, workers=1)
        run = SimpleNamespace(**found)
        logged = int(run.events)
    x, y, vx, vy = run.samples.T
    if times.size and times[0] == 0.0:
        x[0], y[0], vx[0], vy[0] = initial
    if VARIANT_RULES[model].separates:
        off = run.sample_regimes == RegimeFlag.separated.value
        normal = np.where(off, 0.0, contact_force(y, params))
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
            **({"growth": np.exp(run.log_growth)} if growth else {}),
            "outcome": run.outcome,
        },
        {"time": times},
        {
            "model": model,
            "title": f"Motion by model {model} at alpha1 = {alpha1 / math.pi:.6g} pi, alpha2 = "
            f"{alpha2 / math.pi:.6g} pi, t = 0 to {t_end:.6g} s, with every event located",
        },
    )


@recorded(method="Taylor series with located events")
def validity_map(
    params: Parameters,
    alpha1: Any,
    alpha2: Any,
    *,
    t_end: float = 200.0,
    model: str = "A1",
    tol: float = 1e-12,
    workers: int | None = None,
) -> xr.Dataset:
    """Where model A1, started at rest, keeps contact until ``t_end``.

    A cell's run stops at its first separation, so a map of mostly separating cells is cheap.

    Args:
        params: physical parameters.
        alpha1, alpha2: 1-D arrays of angles, rad.
        t_end: end of each run, s.
        model: "A1" or one of its variants.
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
    t_end = real_number("t_end", t_end, least=0.0)
    run = run_map(
        params,
        first,
        second,
        ("outcome", "first_separation_time", "early_max_x", "late_max_x"),
        t_end=t_end,
        model=model,
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
            "growth_threshold": GROWTH_THRESHOLD,
            "t_end": t_end,
            "outcome": run.outcome,
        },
        {"alpha1": first, "alpha2": second},
    )


def _instants(times: Any, t_end: float, time_unit: float) -> np.ndarray:
    """Checked instants, s; by default 20 per time unit.

    Raises:
        ValueError: they are no sequence, or empty.
    """
    if times is None:
        # a unit of time that underflows is refused with the run
        wanted = SAMPLES_PER_TIME_UNIT * t_end / time_unit if time_unit else math.inf
        count = math.ceil(min(MOST_SAMPLES, wanted)) + 1
        return np.linspace(0.0, t_end, min(max(count, 2), MOST_SAMPLES))
    instants = real_array("times", times)
    if instants.ndim != 1 or not instants.size:
        raise ValueError(f"times has shape {instants.shape}: a sequence of instants is needed")
    return instants
