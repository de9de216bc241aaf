"""The spectrum of one run in Hz, as a dataset of its own."""

import math
from typing import Annotated

import numpy as np
import xarray as xr
from annotated_types import Gt

from squealpipe.brake.schema.dynamics.runs import spectrum_schema
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.vibration.spectrum import (
    FEWEST,
    amplitude_spectrum,
    step_of,
    strongest_lines,
)


@recorded()
def spectrum(
    run: xr.Dataset, *, last: Annotated[float, Gt(0)] | None = None
) -> xr.Dataset:
    """Amplitude spectra of velocities and contact force of a run, with a Hann window.

    A sinusoid of amplitude A is a line of height A; means are removed.

    Args:
        run: dataset ``simulation``, sampled uniformly.
        last: length of the end of the run that is taken, s; by default all of it.

    Returns:
        Dataset ``spectrum`` over ``frequency`` (Hz), and over ``peak`` the strongest lines of the
        contact force.

    Raises:
        ValueError: it is no run, its samples are not uniform, or there are too few of them.
    """
    if run.attrs.get("schema") != "simulation":
        raise ValueError(
            f"{run.attrs.get('schema', 'the file')} is no run; give what simulate makes (the "
            "answer of assess holds its spectrum: velocity_spectrum_along, line_frequency)"
        )
    time = run.time.values[np.isfinite(run.x.values)]
    chosen = time >= (time[-1] - last if last is not None and time.size else -math.inf)
    time = time[chosen]
    if time.size < FEWEST:
        raise ValueError(
            f"{time.size} samples are too few for a spectrum; ask for more or a longer run"
        )
    step = step_of(time)
    signals = np.stack(
        [
            run[name].values[: chosen.size][chosen]
            for name in ("vx", "vy", "normal_force")
        ]
    )
    # the grid is eight times finer than the resolution, so that peaks are smooth
    omega, amplitude = amplitude_spectrum(signals, step, padding=8)
    resolution = 1.0 / (time.size * step)
    # ten lines are named at most
    lines, heights = strongest_lines(
        omega, amplitude[2], 10, 2.0 * math.pi * resolution
    )
    return build(
        spectrum_schema,
        {
            "velocity_along": amplitude[0],
            "velocity_across": amplitude[1],
            "contact_force": amplitude[2],
            "peak_frequency": lines / (2.0 * math.pi),
            "peak_force": heights,
            "resolution": resolution,
            "outcome": int(run.outcome),
        },
        {"frequency": omega / (2.0 * math.pi), "peak": np.arange(1, lines.size + 1)},
    )
