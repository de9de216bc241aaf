"""Verdict, frequency and level of a structure at many operating points."""

from __future__ import annotations  # help shows Line, not its checks

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.structures.assess.cures import with_preload
from squealpipe.structures.assess.designs import Design, Structures, pushed
from squealpipe.structures.assess.measured import matched, read_noises
from squealpipe.structures.assess.records import levels
from squealpipe.structures.schema.operating_map import OPERATING_MAP
from squealpipe.structures.squeal.windows import Running
from squealpipe.systems.processes import run_shared
from squealpipe.validation import Line, Positive, Tolerance, Workers

VALUES = ("frequency", "velocity_rms", "separated_fraction", "growth_rate")


@recorded(
    model="structure with exact contact and friction",
    method="Taylor series with located events",
)
def operating_map(
    structure: Any,
    *,
    pressure: Line = (1.0,),
    speed: Line | None = None,
    mu: Line | None = None,
    measured: Any = None,
    frequency_band: Positive = 0.05,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Find which operating points of a structure are noisy, at which frequency, and how loud.

    At each point steady sliding is pushed by 1 % of the static deformation along the mode that
    grows fastest and run until its motion has settled, as :func:`squealpipe.assess` does. The level
    is the velocity of the contacts, not a sound pressure.

    Args:
        structure: a :class:`squealpipe.Structure`.
        pressure: factors of all preloads, and of a load that is given.
        speed: belt speeds, m/s, or of a structure that turns, rad/s; that of the structure by
            default.
        mu: coefficients of friction of the contacts without one of their own; that of the
            structure by default.
        measured: name of a list of measured noises (text or Excel) with columns like ``pressure``,
            ``speed [km/h]``, ``mu``, ``frequency [Hz]``, ``level [dB]``; an empty frequency is a
            quiet point. Each is compared with the nearest point of the map; nothing is fitted.
        frequency_band: largest difference between the frequency of a measured noise and the
            predicted one, over the measured one.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset ``operating_map``: over ``pressure``, ``speed`` and ``mu`` the verdict, frequency,
        level and share of contact loss; over ``band``, third octaves, the share of points that are
        noisy there, as in reports of dynamometer tests. With ``measured``, over ``noise``, the
        measured and the predicted frequency and ``match``, with counts of hits, misses and false
        alarms. Outcomes: converged, unresolved (undetermined), no_sliding_state.

    Raises:
        ValueError: an argument; no contacts; a structure that is too large.
    """
    # a list that cannot be read is told before anything is computed
    noises = None if measured is None else read_noises(measured, structure.speed_unit)
    design = Design.of(structure)
    whole = design.whole
    speeds = np.array([whole.belt_speed]) if speed is None else np.asarray(speed)
    frictions = np.array([whole.mu]) if mu is None else np.asarray(mu)
    pressures = np.asarray(pressure)
    for name, values in (("pressure", pressures), ("mu", frictions)):
        if not (values >= 0.0).all() or (name == "pressure" and not values.all()):
            raise ValueError(f"{name} = {values.min():g}: it must be greater than 0")
    pressed = [
        design if factor == 1.0 else design.changed(with_preload(whole, float(factor)))
        for factor in pressures
    ]
    shape = pressures.size, speeds.size, frictions.size
    count = int(np.prod(shape))
    family = Structures(tol, 0, 0, 1)

    def fill(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        for place in range(first, count, stride):
            i, j, k = np.unravel_index(place, shape)
            point = pressed[int(i)].slid(
                belt_speed=float(speeds[j]), mu=float(frictions[k])
            )
            for name, value in _of_point(point, family).items():
                arrays[name][place] = value

    filled = run_shared(
        fill,
        {
            **dict.fromkeys(VALUES, ((count,), np.float64)),
            **dict.fromkeys(
                ("verdict", "unstable_modes", "outcome"), ((count,), np.int64)
            ),
        },
        jobs=count,
        workers=workers,
    )
    noisy = np.isin(filled["verdict"], (Verdict.squeals, Verdict.hammers))
    band, occurrence = _third_octaves(filled["frequency"][noisy], count)
    points = build(
        OPERATING_MAP,
        {
            **{name: values.reshape(shape) for name, values in filled.items()},
            "occurrence": occurrence,
            "share_noisy": float(noisy.mean()),
            "share_undetermined": float(
                (filled["verdict"] == Verdict.undetermined).mean()
            ),
            "n_modes": design.n_modes or whole.size,
        },
        {
            "pressure": pressures,
            "speed": speeds,
            "mu": frictions,
            "band": band,
            "contact": [each.name for each in whole.contacts],
        },
    )
    if noises is None:
        return points
    beside = matched(points, noises, frequency_band)
    return build(
        OPERATING_MAP,
        {
            **{str(name): each.values for name, each in points.data_vars.items()},
            **beside,
        },
        {str(name): each.values for name, each in points.coords.items()},
    )


def _of_point(design: Design, family: Structures) -> dict[str, Any]:
    """Return what is known of one operating point."""
    nothing = dict.fromkeys(VALUES, np.nan)
    start = pushed(design)
    plant = design.plant
    if start is None or plant is None:
        undetermined = {"verdict": Verdict.undetermined, "unstable_modes": 0}
        return nothing | undetermined | {"outcome": Outcome.no_sliding_state}
    (run,) = family.settled([start])
    known: dict[str, Any] = {
        "verdict": run.verdict,
        "growth_rate": float(plant.spectrum.values.real.max()),
        "unstable_modes": plant.unstable.size,
        "outcome": Outcome.converged if run.agrees else Outcome.unresolved,
    }
    if run.quiet:
        return nothing | known | {"velocity_rms": 0.0, "separated_fraction": 0.0}
    if not run.agrees:
        return nothing | known
    scalars, _ = levels(design, run, how=Running(family.tol, family.seed, 1))
    return known | {
        "frequency": scalars["frequency"],
        "velocity_rms": float(
            np.hypot(scalars["velocity_rms_along"], scalars["velocity_rms_across"])
        ),
        "separated_fraction": scalars["separated_fraction"],
    }


def _third_octaves(
    frequencies: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return middles of the bands that hold all frequencies, Hz, and the share of points in each.

    Bands are those of IEC 61260 with base 10: middles 1000 · 10^(k/10) Hz, edges half a band away.
    """
    known = frequencies[np.isfinite(frequencies)]
    if not known.size:
        return np.empty(0), np.empty(0)
    numbers = np.rint(10.0 * np.log10(known / 1000.0)).astype(int)
    bands = np.arange(numbers.min(), numbers.max() + 1)
    shares = np.array([(numbers == band).sum() / count for band in bands])
    return 1000.0 * 10.0 ** (bands / 10.0), shares
