"""What the explorer page shows of each pair of angles: a motion, its spectrum, two backbones."""

import json
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.methods.processes import run_shared
from squealpipe.methods.spectrum import amplitude_spectrum
from squealpipe.models.refusals import extensions
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.dynamics.explorer import EXPLORER
from squealpipe.tasks.backbones.backbone import backbone
from squealpipe.tasks.dynamics.runs import simulate

BRANCH = ("omega", "x_amplitude", "y_amplitude", "y_peak", "stability_index")
MODES = (1, 2)
HIGHEST_FREQUENCY = 6.0
"""Spectra are kept up to here, in units of √(k1/m): four times the highest natural frequency."""


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
    lines = int(np.searchsorted(frequency * params.time_unit, HIGHEST_FREQUENCY, side="right"))
    count, modes = angles.size, () if extensions(params) else MODES

    def fill(arrays: dict[str, NDArray[Any]], first: int, stride: int) -> None:
        for cell in range(first, count * count, stride):
            alpha1, alpha2 = float(angles[cell // count]), float(angles[cell % count])
            _motion(arrays, cell, params, alpha1, alpha2, times)
            for place, mode in enumerate(modes):
                _branch(arrays, (cell, place), backbone(params, alpha1, alpha2, mode=mode))

    history, branch = (count * count, samples), (count * count, len(modes), branch_points)
    arrays = run_shared(
        fill,
        {
            **dict.fromkeys(("x", "y", "normalized_contact_force"), (history, np.float32)),
            "force_spectrum": ((count * count, lines), np.float32),
            "outcome": ((count * count,), np.int8),
            **(dict.fromkeys(BRANCH, (branch, np.float32)) if modes else {}),
            **({"end": ((count * count, len(modes)), np.int8)} if modes else {}),
        },
        jobs=count * count,
        workers=workers,
    )
    return build(
        EXPLORER,
        {
            **{
                name: array.reshape((count, count, *array.shape[1:]))
                for name, array in arrays.items()
            },
            **{
                name: getattr(params, name)
                for name in ("preload", "length1", "length2", "belt_speed")
            },
        },
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


def _motion(
    arrays: dict[str, NDArray[Any]],
    cell: int,
    params: Parameters,
    alpha1: float,
    alpha2: float,
    times: NDArray[np.float64],
) -> None:
    run = simulate(params, alpha1, alpha2, t_end=float(times[-1]), times=times)
    for name in ("x", "y", "normalized_contact_force"):
        kept = run[name].values[: arrays[name].shape[1]]
        arrays[name][cell, : kept.size] = kept
        arrays[name][cell, kept.size :] = kept[-1]
    force = run.normalized_contact_force.values
    _, amplitude = amplitude_spectrum(force, float(times[1]))
    arrays["force_spectrum"][cell] = amplitude[: arrays["force_spectrum"].shape[1]]
    arrays["outcome"][cell] = int(run.outcome)


def _branch(arrays: dict[str, NDArray[Any]], place: tuple[int, int], branch: xr.Dataset) -> None:
    points = branch.sizes["point"]
    wanted = arrays["omega"].shape[-1]
    arrays["end"][place] = int(branch.end)
    if points == 0:
        for name in BRANCH:
            arrays[name][place] = np.nan
        return
    chosen = np.round(np.linspace(0, points - 1, min(points, wanted))).astype(int)
    chosen = np.concatenate([chosen, np.full(wanted - chosen.size, points - 1)])
    for name in BRANCH:
        arrays[name][place] = branch[name].values[chosen]
