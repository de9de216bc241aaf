"""Data of the explorer page for each pair of angles: a motion, its spectrum, two backbones."""

import json
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.a4.exact_branches import places_on_exact_branch
from squealpipe.brake.a4.system import ScaledSystem, scaled_system
from squealpipe.brake.backbones.backbone import exact_variables
from squealpipe.brake.models.refusals import extensions
from squealpipe.brake.orbits.tracing import found_at
from squealpipe.brake.schema.dynamics.explorer import HISTORIES, ORBITS, explorer_schema
from squealpipe.codes import Regime
from squealpipe.laws.contact import normal_force
from squealpipe.laws.springs import springs_are_equal
from squealpipe.parameters import PHYSICAL, Parameters
from squealpipe.schema import build
from squealpipe.systems.processes import run_shared
from squealpipe.vibration.spectrum import amplitude_spectrum


def explorer_data(
    params: Parameters,
    angles: NDArray[np.float64],
    *,
    history_time: float,
    spectrum_time: float,
    samples: int,
    branch_points: int,
    workers: int | None = None,
) -> xr.Dataset:
    """Motions from rest, spectra of the contact force and backbones on a grid of angles.

    Args:
        history_time: time for which the motion is kept, in units of √(m/k1).
        branch_points: points kept of each backbone; shorter ones repeat their last point.

    Returns:
        Dataset ``explorer``; it has branches where model A4 carries the parameters.
    """
    if spectrum_time < history_time:
        raise ValueError(
            f"spectrum_time = {spectrum_time!r}: must be at least history_time = {history_time!r}"
        )
    step = history_time * params.time_unit / (samples - 1)
    times: NDArray[np.float64] = step * np.arange(
        round(spectrum_time * params.time_unit / step) + 1, dtype=float
    )
    frequency, _ = amplitude_spectrum(np.zeros(times.size), step)
    # in units of √(k1/m): four times the highest natural frequency
    lines = int(np.searchsorted(frequency * params.time_unit, 6.0, side="right"))
    count, modes = angles.size, () if extensions(params) else (1, 2)
    mirrored = springs_are_equal(
        {name: getattr(params, name) for name in PHYSICAL}
    ) and np.allclose(angles + angles[::-1], np.pi, rtol=0.0, atol=1e-13)

    def fill(arrays: dict[str, NDArray[Any]], first: int, stride: int) -> None:
        for row in range(first, count, stride):
            # (α1, α2) and (π − α2, π − α1) swap two equal springs: one motion
            others = angles[: count - row] if mirrored else angles
            cells = slice(row * count, row * count + others.size)
            motions = _motions(
                params, float(angles[row]), others, times, samples, lines
            )
            for name, values in motions.items():
                arrays[name][cells] = values
            for cell, alpha2 in enumerate(
                others.tolist() if modes else (), row * count
            ):
                scene = scaled_system(params, float(angles[row]), alpha2)
                for index, mode in enumerate(modes):
                    _branch(arrays, (cell, index), params, scene, mode)

    history = (count * count, samples)
    branch = (count * count, len(modes), branch_points)
    filled = run_shared(
        fill,
        {
            **dict.fromkeys(HISTORIES, (history, np.float32)),
            "force_spectrum": ((count * count, lines), np.float32),
            "outcome": ((count * count,), np.int8),
            **(dict.fromkeys(ORBITS, (branch, np.float32)) if modes else {}),
            **({"end": ((count * count, len(modes)), np.int8)} if modes else {}),
        },
        jobs=count * count,
        workers=workers,
    )
    if mirrored:
        row, column = np.divmod(np.arange(count * count), count)
        image = (count - 1 - column) * count + count - 1 - row
        known = np.where(row + column < count, np.arange(count * count), image)
        filled = {name: each[known] for name, each in filled.items()}
    maps = {
        name: each.reshape(count, count, *each.shape[1:])
        for name, each in filled.items()
    }
    fixed = ("preload", "length1", "length2", "belt_speed")
    return build(
        explorer_schema,
        {**maps, **{name: getattr(params, name) for name in fixed}},
        {
            "alpha1": angles,
            "alpha2": angles,
            "time": times[:samples],
            "frequency": frequency[:lines],
            **({"mode": modes, "point": np.arange(branch_points)} if modes else {}),
        },
        {
            "parameters": json.dumps(params.as_dict()),
            "run_t_end": float(times[-1]),
            "run_points": times.size,
        },
    )


def _motions(
    params: Parameters,
    alpha1: float,
    alpha2: NDArray[np.float64],
    times: NDArray[np.float64],
    samples: int,
    lines: int,
) -> dict[str, NDArray[Any]]:
    """Motions in one row of the grid, and spectra of their contact forces."""
    run = run_ensemble(
        params,
        alpha1,
        alpha2,
        t_end=times[-1],
        times=times,
        tracked=(),
        tol=1e-12,
        workers=1,
    )
    x, y, _, vy = np.moveaxis(run.samples, -1, 0)
    normal = np.where(
        run.sample_regimes == Regime.separated, 0.0, normal_force(y, vy, params)
    )
    force = normal / (params.k3 * params.preload)
    _, amplitude = amplitude_spectrum(force, float(times[1]))
    return {
        **dict(
            zip(HISTORIES, (each[:, :samples] for each in (x, y, force)), strict=True)
        ),
        "force_spectrum": amplitude[:, :lines],
        "outcome": run.outcome,
    }


def _branch(
    arrays: dict[str, NDArray[Any]],
    place: tuple[int, int],
    params: Parameters,
    scene: ScaledSystem,
    mode: int,
) -> None:
    # peaks and amplitudes over l_pre up to which branches go
    largest = 3.0
    places, end = places_on_exact_branch(scene, mode, largest, largest)
    wanted = arrays["omega"].shape[-1]
    even = np.linspace(0, len(places) - 1, min(len(places), wanted))
    orbits = found_at(places[i] for i in np.round(even).astype(int))
    if orbits:
        orbits += orbits[-1:] * (wanted - len(orbits))
        variables = exact_variables(scene, params, orbits, [], end)
    for name in ORBITS:
        arrays[name][place] = variables[name] if orbits else np.nan
    arrays["end"][place] = int(end)
