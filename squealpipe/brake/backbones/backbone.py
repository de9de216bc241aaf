"""Backbones of model A4: exact, or by harmonic balance and judged by the exact orbits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
import xarray as xr
from annotated_types import Interval

from squealpipe.brake.a4.exact_branches import exact_branch
from squealpipe.brake.a4.harmonic_branches import HarmonicPoint, harmonic_branch
from squealpipe.brake.a4.orbits import SHAPE, find_orbit, orbit_values
from squealpipe.brake.a4.system import ScaledSystem, scaled_system
from squealpipe.brake.backbones.orbit import check_length
from squealpipe.brake.balance.harmonic_balance import (
    CosineBalance,
    series_extremes,
    series_speed,
)
from squealpipe.brake.orbits.orbits import Orbit
from squealpipe.brake.orbits.special_points import special_points
from squealpipe.brake.schema.backbones import backbone_schema
from squealpipe.codes import SpecialPoint
from squealpipe.laws.friction import slides
from squealpipe.parameters import SCENES, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.inputs.values import brief
from squealpipe.validation import Angle, Mode, Positive, Whole


@recorded(model="A4")
def backbone(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    mode: Mode,
    y_peak_max: Positive | None = None,
    x_amplitude_max: Positive | None = None,
    method: Literal["exact", "hbm"] = "exact",
    n_harmonics: Annotated[Whole, Interval(ge=1, le=512)] = 16,
    n_time: Whole | None = None,
    sigma: Positive | None = None,
    cross_poles: bool = False,
) -> xr.Dataset:
    """The family of periodic motions that grows out of a linear mode of model A4.

    Args:
        alpha1, alpha2: angles, rad.
        mode: 1 or 2, by ascending ω of the contact state.
        y_peak_max: peak at which the branch ends, m; 3 l_pre by default.
        x_amplitude_max: amplitude at which the vertical branch of an isolated x mode
            (K12 = 0) ends, m; 3 l_pre by default.
        method: ``"exact"`` or ``"hbm"`` (symmetric cosine series).
        n_time: samples per period of the contact force; None: contact integrals in closed form.
        sigma: regularizing factor of the contact law, 1/m; None: the sharp law.
        cross_poles: go on beyond internal resonances ω = ω_x/n where K12 = 0.

    Returns:
        Dataset ``backbone`` over ``point``; ``end`` says why the branch ends. An exact branch also
        has its period doublings and folds, located; a harmonic one the distance of each point from
        the exact orbit of equal y_peak and from a time integration over one period.
    """
    y_max = 3.0 * params.preload if y_peak_max is None else y_peak_max
    x_max = 3.0 * params.preload if x_amplitude_max is None else x_amplitude_max
    check_length("y_peak_max", y_max, params.preload)
    check_length("x_amplitude_max", x_max, params.preload)
    _check_sampling(n_harmonics, n_time)
    scene = scaled_system(params, alpha1, alpha2)
    attrs = {"alpha1": alpha1, "alpha2": alpha2, "mode": mode, "method": method}
    if method == "exact":
        orbits, outcomes, end = exact_branch(
            scene,
            mode,
            y_max / scene.length,
            x_max / scene.length,
            cross_poles=cross_poles,
        )
        beyond = special_beyond_contact(scene, orbits, outcomes)
        variables = exact_variables(scene, params, orbits, outcomes, end)
        return build(
            backbone_schema,
            variables | special_variables(scene, beyond),
            {"point": np.arange(len(orbits)), "special": np.arange(len(beyond))},
            attrs,
        )
    balance, points, end = harmonic_branch(
        scene,
        mode,
        y_max / scene.length,
        x_max / scene.length,
        n_harmonics=n_harmonics,
        n_time=n_time,
        sigma=None if sigma is None else sigma * scene.length,
        cross_poles=cross_poles,
    )
    return _harmonic_dataset(scene, params, balance, points, end, attrs)


def named_scenes(
    coupled: Mapping[str, Sequence[float]],
) -> dict[str, tuple[float, float]]:
    """Angles, rad, of the paper's Figs. 10–13 and of further scenes given over π."""
    paper = {
        name: (scene.alpha1, scene.alpha2)
        for name, scene in SCENES.items()
        if scene.figure >= 10
    }
    return {
        **paper,
        **{name: (a * math.pi, b * math.pi) for name, (a, b) in coupled.items()},
    }


def contact_losing_branches(
    coupled: Mapping[str, Sequence[float]],
) -> dict[str, tuple[float, float, int]]:
    """Branches that lose contact, one of each kind: name → (alpha1, alpha2, mode)."""
    scenes = named_scenes(coupled)
    modes = {"F10": (2,), "F13": (1,), **dict.fromkeys(coupled, (1, 2))}
    return {
        f"{name} mode {mode}": (*scenes[name], mode)
        for name, among in modes.items()
        for mode in among
    }


def with_orbits(
    params: Parameters,
    branches: Mapping[str, tuple[float, float, int]],
    peaks: Sequence[float],
) -> tuple[dict[str, tuple[float, float, int]], str]:
    """Those branches that have an exact orbit at every peak, and why the others have none.

    Which mode loses contact depends on the parameters, so a study with other ones may keep fewer
    branches; the reasons go into the dataset's attribute ``left_out``.

    Args:
        peaks: y_peak over l_pre.
    """
    kept, reasons = {}, []
    for name, (alpha1, alpha2, mode) in branches.items():
        scene = scaled_system(params, alpha1, alpha2)
        if scene.rest[1] >= min(peaks):
            reasons.append(f"{name}: equilibrium above the peak")
            continue
        orbits = [find_orbit(scene, mode, peak) for peak in peaks]
        missing = [outcome.name for orbit, outcome in orbits if orbit is None]
        if missing:
            reasons.append(f"{name}: {missing[0]}")
        else:
            kept[name] = (alpha1, alpha2, mode)
    if not kept:
        raise ValueError(
            f"no branch has orbits at y_peak = {list(peaks)} l_pre ({'; '.join(reasons)}); "
            "change the parameters or backbones.coupled"
        )
    return kept, "; ".join(reasons)


def _check_sampling(n_harmonics: int, n_time: int | None) -> None:
    """Raise a ValueError unless the samples of a period are enough, and fit into memory."""
    # the table of cosines at the samples takes 64 MiB at most
    least, most = 2 * n_harmonics + 1, (2**23) // (n_harmonics + 1)
    if n_time is not None and not least <= n_time <= most:
        raise ValueError(
            f"n_time = {brief(n_time)}: a whole number is needed, at least 2 n_harmonics + 1 = "
            f"{least} and, with {n_harmonics} harmonics, at most {most} samples; leave it out for "
            "contact integrals without sampling error"
        )


def exact_variables(
    scene: ScaledSystem,
    params: Parameters,
    orbits: Sequence[Orbit],
    outcomes: Sequence[Outcome],
    end: Outcome,
) -> dict[str, Any]:
    """Return the variables that a dataset holds of the exact orbits of a branch."""
    shapes = [orbit_values(scene, params, orbit.point) for orbit in orbits]
    return {
        **{name: np.array([shape[name] for shape in shapes]) for name in SHAPE},
        "y_peak": np.array([orbit.point[1] for orbit in orbits]) * scene.length,
        "stability_index": np.array([orbit.stability_index for orbit in orbits]),
        "switches": [len(orbit.switches) for orbit in orbits],
        "residual": np.array([orbit.residual for orbit in orbits]),
        "outcome": list(outcomes),
        "end": end,
    }


def _harmonic_dataset(
    scene: ScaledSystem,
    params: Parameters,
    balance: CosineBalance,
    points: list[HarmonicPoint],
    end: Outcome,
    attrs: dict[str, Any],
) -> xr.Dataset:
    series = [balance.split(point.z) for point in points]
    order = np.arange(balance.contact.n_harmonics + 1)
    x = np.array([entry[0] for entry in series]).reshape(-1, len(order)) * scene.length
    y = np.array([entry[1] for entry in series]).reshape(-1, len(order)) * scene.length
    omega = np.array([entry[2] for entry in series]) * scene.frequency
    x_wave = series_extremes(x)
    y_wave = series_extremes(y)
    x_speed = series_speed(x) * omega
    return build(
        backbone_schema,
        {
            "omega": omega,
            "x_at_peak": x.sum(axis=1),
            "x_amplitude": x_wave,
            "y_amplitude": y_wave,
            "largest_speed": x_speed,
            "sliding_assumption": slides(x_speed, params).astype(int),
            "y_peak": y.sum(axis=1),
            "stability_index": np.array([point.stability_index for point in points]),
            "switches": [len(point.switches) for point in points],
            "residual": np.array([point.residual for point in points]),
            "outcome": [point.outcome for point in points],
            "x_cosine": x,
            "y_cosine": y,
            "omega_exact": np.array([point.omega_exact for point in points])
            * scene.frequency,
            "waveform_error": np.array([point.waveform_error for point in points])
            * scene.length,
            "integration_error": np.array([point.integration_error for point in points])
            * scene.length,
            "end": end,
            **special_variables(scene, []),
        },
        {"point": np.arange(len(points)), "harmonic": order, "special": []},
        {
            **attrs,
            "n_harmonics": balance.contact.n_harmonics,
            "contact": type(balance.contact).__name__,
        },
    )


def special_beyond_contact(
    scene: ScaledSystem, orbits: Sequence[Orbit], outcomes: Sequence[Outcome]
) -> list[tuple[SpecialPoint, Orbit]]:
    """Special points of an exact branch from grazing on."""
    pairs = zip(orbits, outcomes, strict=True)
    beyond = (Outcome.grazing, Outcome.converged)
    return special_points(
        scene.system, [orbit for orbit, outcome in pairs if outcome in beyond]
    )


def special_variables(
    scene: ScaledSystem, found: Sequence[tuple[SpecialPoint, Orbit]]
) -> dict[str, Any]:
    """Return the variables that a dataset holds of the special points of a branch."""
    return {
        "special_kind": [int(kind) for kind, _ in found],
        "special_y_peak": np.array([orbit.point[1] for _, orbit in found])
        * scene.length,
        "special_omega": np.array([orbit.omega for _, orbit in found])
        * scene.frequency,
    }
