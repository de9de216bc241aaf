"""Numbers of the shipped study that its narrative inserts, read off the datasets."""

import json
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.benchmark.schema import Role
from squealpipe.brake.schema.curves import ChartLine
from squealpipe.brake.schema.dynamics.extremes import largest_size
from squealpipe.paper.claims.maps import unstable_yet_sliding
from squealpipe.paper.figures.comparison.speed_and_accuracy import scenes_of_a1
from squealpipe.paper.figures.comparison.where_methods_fail import answers, substitutes
from squealpipe.paper.figures.linear.critical_friction import LARGEST_SHOWN
from squealpipe.paper.figures.linear.frequency_shift import NO_SHIFT
from squealpipe.paper.schema.claims import Basis, ClaimVerdict, Origin
from squealpipe.paper.schema.inference import of_study
from squealpipe.schema import meanings
from squealpipe.study.evidence import Evidence


def numbers(run: Evidence) -> dict[str, float | str]:
    """Name in ``templates/narrative.typ`` → number; percentages are between 0 and 100."""
    return {
        key: value.item() if isinstance(value, np.generic | xr.DataArray) else value
        for part in (
            _verdicts,
            _inferred,
            _growth,
            _linear,
            _valid,
            _bounded,
            _motions_and_shares,
            _contact_points,
            _methods,
        )
        for key, value in part(run).items()
    }


def _verdicts(run: Evidence) -> dict[str, Any]:
    claims = run["claims"]
    own = claims.isel(claim=(claims.origin != Origin.misprints).values)
    changed = (own.corrected_verdict != own.verdict).sum()
    fitted = own.basis == Basis.fitted
    parts = {"fitted": fitted, "tests": ~fitted}
    return {
        "statements": own.sizes["claim"],
        "one_sign_changes": changed,
        **{name: part.sum() for name, part in parts.items()},
        **{
            f"{name}_{verdict.name}": (part & (own.verdict == verdict)).sum()
            for name, part in parts.items()
            for verdict in ClaimVerdict
        },
    }


def _inferred(run: Evidence) -> dict[str, Any]:
    inference = run["parameter_inference"]
    shares = {
        f"share_{reading}{end}": 100 * inference[f"share{end}"].sel(reading=reading)
        for reading in inference.reading.values
        for end in ("", "_low", "_high")
    }
    counts = zip(inference.reading.values, inference.feasible_count.values, strict=True)
    return {
        "sets": inference.sizes["sample"],
        # growth's is much the same wherever it grows: |x| goes with the root of time
        "margin": of_study(inference).baseline_margin.drop_sel(statement="F3").min(),
        **{f"sets_{reading}": count for reading, count in counts},
        **shares,
    }


def _growth(run: Evidence) -> dict[str, Any]:
    unit, preload = run.parameters.time_unit, run.parameters.preload
    whirl = run["whirl"].sortby(
        abs(abs(run["whirl"].belt_speed) - abs(run.parameters.belt_speed))
    )
    short, long = run["simulate/F3"], run["simulate/F3_long"]
    return {
        "F3_size": largest_size(short, "x").max() / preload,
        "F3_time": short.time[-1] / unit,
        "whirl_size": whirl.amplitude[0] / preload,
        "whirl_slope": whirl.slope,
        "F3_long_size": largest_size(long, "x").max() / preload,
        "F3_long_time": long.time[-1] / unit,
        "one_sign_F3_long_size": largest_size(
            run["corrected/simulate/F3_long"], "x"
        ).max()
        / preload,
    }


def _linear(run: Evidence) -> dict[str, Any]:
    regime = run["stability_map"].regime_linear
    _, physical = unstable_yet_sliding(run)
    beside, sliding = run["corrected/stability_map"], run["corrected/quasi_static_map"]
    printed = (beside.regime_linear > 0) & (sliding.possible_as_printed == 1)
    omega = run["natural_frequencies"].omega
    falls = (
        omega.sel(contact_state="separated") - omega.sel(contact_state="contact")
        < -NO_SHIFT
    )
    return {
        "one_sign_sliding_printed": printed.sum(),
        **{f"omega{mode}_falls": 100 * falls.sel(mode=mode).mean() for mode in (1, 2)},
        "points": regime.sizes["alpha1"],
        "flutter": (regime == 1).sum(),
        "divergence": (regime == 2).sum(),
        "sliding_physical": physical.sum(),
    }


def _valid(run: Evidence) -> dict[str, Any]:
    validity, boundary = run["validity_map"], run["validity_boundary"]
    unstable = validity.regime_linear > 0
    return {
        "black": (unstable & (validity.separates == 0)).sum(),
        "black_by_curves": (unstable.values & boundary.kept.values).sum(),
        "unstable": unstable.sum(),
        "lost": 100 * (1.0 - float(boundary.kept_share)),
    }


def _bounded(run: Evidence) -> dict[str, Any]:
    transient, unit = run["transient"], run.parameters.time_unit
    lifetimes = transient.lifetime.values
    ended = np.isfinite(lifetimes)
    branches = {
        name: run[f"backbone/{name}_mode{i}"].omega
        for name, i in (("F10", 2), ("F13", 1))
    }
    return {
        "F4_size": largest_size(run["simulate/F4"], "x").max() / run.parameters.preload,
        "F4_growth": run["simulate/F4"].growth,
        "F4_time": run["simulate/F4"].time[-1] / unit,
        "F4_change": 100 * run["claims"].value.sel(claim="F4"),
        "transient_runs": lifetimes.size,
        "transient_ended": int(ended.sum()),
        "transient_time": transient.t_end / unit,
        **{f"{name}_low": omega.min() for name, omega in branches.items()},
        **{f"{name}_linear": omega[0] for name, omega in branches.items()},
    }


def _contact_points(run: Evidence) -> dict[str, Any]:
    pads = run["contact_points"]
    samples = json.loads(pads.attrs["arguments"])["samples"]
    loud: dict[str, Any] = {}
    for count in ("4", "8"):
        pad = pads.sel(design=count)
        loud |= {
            f"points{count}_onset": pad.critical_mu,
            f"points{count}_kilohertz": pad.dominant_frequency / 1e3,
            f"points{count}_starts": round(samples * float(pad.share)),
            f"points{count}_common": pad.common_frequency / 1e3,
            f"points{count}_lag": pad.lag[int(pad.contacts) - 1],
            f"points{count}_least": 100 * pad.separated_fraction.min(),
            f"points{count}_most": 100 * pad.separated_fraction.max(),
        }
    return {
        **loud,
        "points_samples": samples,
        "points_modes": pads.n_modes.max(),
        "points_growth_error": 100 * pads.growth_rate_error.max(),
    }


def _motions_and_shares(run: Evidence) -> dict[str, Any]:
    hammering, spread = run["hammering_map"], run["propensity"]
    kinds = {
        f"motion_{name}": 100 * (hammering.motion == code).mean()
        for code, name in meanings(hammering.motion).items()
    }
    shares = {
        f"propensity_{name}": 100 * spread.share.sel(quantity=name)
        for name in map(str, spread.quantity.values)
    }
    limited = hammering.predictability_horizon < hammering.t_end
    friction, beside = run["critical_friction_map"], run["a1_beside_a4"]
    charts = [run[f"friction_chart/{name}"] for name in ("F3", "F4")]
    shown = np.fmin(friction.critical_mu, friction.critical_mu_undamped) < LARGEST_SHOWN
    far = 100 * abs(beside.omega_a1 / beside.omega - 1.0).max("scene")
    return {
        **kinds,
        **shares,
        "unpredictable": 100 * limited.mean(),
        "shown_friction": LARGEST_SHOWN,
        "lowered": 100 * friction.destabilized.where(shown).mean(),
        "softest_kept": max(
            chart.kappa[chart.line == ChartLine.contact_lost].max() for chart in charts
        ),
        "far_short": far[0],
        "far_long": far[-1],
    }


def _methods(run: Evidence) -> dict[str, Any]:
    benchmark = run["benchmark"]
    scenes = scenes_of_a1(benchmark)
    tolerances = scenes.tol.values
    # speed and accuracy are quoted at 10⁻¹⁰, or at the nearest tolerance of the study
    asked = float(tolerances[np.abs(np.log(tolerances / 1e-10)).argmin()])
    scenes = scenes.sel(tol=asked)
    cpu = scenes.cpu_ratio
    times = cpu.sel(solver="squealpipe") / cpu.sel(solver="DOP853")
    scenes = scenes.median("problem")
    mine, theirs = (scenes.sel(solver=name) for name in ("squealpipe", "DOP853"))
    beside = {
        key: scenes.cpu_ratio.sel(solver=f"DOP853, {name}") / theirs.cpu_ratio
        for key, name in (("compiled", "compiled field"), ("bounded", "bounded step"))
        if f"DOP853, {name}" in benchmark.solver
    }
    table = answers(benchmark)
    public = (benchmark.role == Role.public).values
    silent = table.silent.sum("group")
    in_place_of_events = silent.solver.isin(substitutes(benchmark)).values
    return {
        "asked_error": asked,
        "ours_error": mine.error,
        "their_error": theirs.error,
        "ours_cpu": mine.cpu_ratio / theirs.cpu_ratio,
        "ours_cpu_least": times.min(),
        "ours_cpu_most": times.max(),
        **{f"{key}_cpu": ratio for key, ratio in beside.items()},
        "public_answers": table.asked.isel(solver=public).sum(),
        "public_silent": silent[public].sum(),
        "substitute_silent": silent[public & in_place_of_events].sum(),
        "integrator_silent": silent[public & ~in_place_of_events].sum(),
        "our_answers": table.asked.isel(solver=~public).sum(),
        "our_silent": silent[~public].sum(),
    }
