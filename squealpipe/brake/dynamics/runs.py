"""Nonlinear runs in time, and the map of where model A1 keeps contact."""

from __future__ import annotations

import math
import warnings

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import LARGEST_REACH, Ensemble, integrate, run_map
from squealpipe.brake.a1.jobs import Model, jobs_of
from squealpipe.brake.linear.maps import stability_map
from squealpipe.brake.models.variants import VARIANT_RULES
from squealpipe.brake.sampling import default_times, unresolved
from squealpipe.brake.schema.dynamics.runs import simulation_schema, validity_map_schema
from squealpipe.codes import Regime
from squealpipe.laws.contact import normal_force
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.validation import (
    Angle,
    Angles,
    NotNegative,
    State,
    Tolerance,
    Vector,
    Workers,
)


@recorded(method="Taylor series with located events")
def simulate(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    t_end: NotNegative,
    model: Model = "A1",
    tol: Tolerance = 1e-12,
    times: Vector | None = None,
    initial_state: State = (0.0, 0.0, 0.0, 0.0),
    growth: bool = False,
) -> xr.Dataset:
    """One run of a nonlinear model, with every regime change located.

    Args:
        alpha1, alpha2: spring angles, rad.
        t_end: end of the run, s.
        model: "A1", "A1-no-stick" (ends at the first stick, with outcome ``accumulation``),
            "A1-no-separation" (k3 also pulls), "A1-linear-springs", "A1-as-printed" (Eq. (4)
            literally: friction pushes against the belt) or "A4" (which goes on past ẋ = V, where it
            does not hold; compare ``vx`` with the belt speed).
        tol: tolerance of the Taylor integrator, relative to l_pre.
        times: the state is given at exactly these instants, s; by default at equal steps that
            resolve √((k1 + k2 + k3)/m).
        initial_state: x, y, vx, vy at t = 0, m and m/s.
        growth: also give the factor by which a small perturbation of the start has grown.

    Returns:
        Dataset over ``time`` and ``event``; see ``simulation_schema``. Instants
        that a run with another outcome than ``converged`` did not reach hold NaN.
    """
    if times is None:
        times = default_times(params, t_end)
    elif missed := unresolved(params, times):
        warnings.warn(missed, stacklevel=6)
    job = jobs_of(
        params,
        alpha1,
        alpha2,
        t_end=t_end,
        model=model,
        tol=tol,
        times=times,
        initial_state=initial_state,
        t_late="return",
    )
    # events kept at first; a run that has more is made again with room for all
    room, logged = 0, 256
    while room < logged:
        room = logged
        run = integrate(
            job,
            ("x", "y", "vx", "contact_force", LARGEST_REACH),
            tangent=growth,
            log_events=room,
            extremes_between=True,
            workers=1,
        )
        logged = int(run.events)
    if int(run.outcome) == Outcome.accumulation:
        # reversals at one instant, where the variant has no stick to go over to, are one
        last = run.event_times[logged - 1]
        # events this close, over their time, are told apart by round-off alone
        at_once = run.event_times[:logged] >= last - 1e-13 * max(last, 1e-300)
        logged -= int(np.count_nonzero(at_once)) - 1
    x, y, vx, vy = run.samples.T
    if times.size and times[0] == 0.0:
        x[0], y[0], vx[0], vy[0] = initial_state
    if VARIANT_RULES[model].separates:
        off = run.sample_regimes == Regime.separated.value
        normal = np.where(off, 0.0, normal_force(y, vy, params))
    else:
        normal = normal_force(y, vy, params)
    force = normal / (params.k3 * params.preload)
    low, high = run.between_samples("contact_force")
    if VARIANT_RULES[model].separates:
        # a step that ends where contact is lost ends a round-off below zero
        low, high = np.maximum(low, 0.0), np.maximum(high, 0.0)
    extremes = {name: run.between_samples(name) for name in ("x", "y", "vx")}
    extremes["normalized_contact_force"] = low, high
    states = {"x": x, "y": y, "vx": vx, "normalized_contact_force": force}
    return build(
        simulation_schema,
        {
            "x": x,
            "y": y,
            "vx": vx,
            "vy": vy,
            "normal_force": normal,
            "normalized_contact_force": force,
            # a run of no length has no series
            **{
                f"{name}_{end}": least_or_most(states[name], value)
                for name, values in extremes.items()
                for end, least_or_most, value in zip(
                    ("min", "max"), (np.fmin, np.fmax), values, strict=True
                )
            },
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
            "return_peak_contact_force": run.return_peak_contact_force,
            "impact_speed": run.impact_speed,
            "max_displacement": run.max_displacement,
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
    alpha1: Angles,
    alpha2: Angles,
    *,
    t_end: NotNegative | None = None,
    model: Model = "A1",
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Map where model A1, started at rest, keeps contact until ``t_end``.

    A cell's run stops at its first separation, so a map of mostly separating cells is cheap.

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad.
        t_end: end of each run, s; 200 √(m/k1) by default.
        model: "A1" or one of its variants.

    Returns:
        Dataset over (alpha1, alpha2); ``response_growth`` is late over early |x|, for the stability
        that A1 itself shows.
    """
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    maps = run_map(
        params,
        alpha1,
        alpha2,
        _validity,
        t_end=t_end,
        model=model,
        tol=tol,
        stop_at_first_separation=True,
        t_late=0.5 * t_end,
        tracked=("x",),
        workers=workers,
    )
    regimes = stability_map(params, alpha1, alpha2)["regime_linear"]
    return build(
        validity_map_schema,
        {**maps, "regime_linear": regimes, "t_end": t_end},
        {"alpha1": alpha1, "alpha2": alpha2},
    )


def _validity(run: Ensemble) -> dict[str, np.ndarray]:
    """Variables of some runs that end at their first separation."""
    lost = run.outcome == Outcome.separated
    moves = run.early_max_x > 0
    late, early = (np.where(moves, x, 1.0) for x in (run.late_max_x, run.early_max_x))
    return {
        "first_separation_time": run.first_separation_time,
        "separates": lost,
        "response_growth": np.where(lost, np.nan, late / early),
        "outcome": run.outcome,
    }
