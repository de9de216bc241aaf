"""Verdict, frequency and level of a structure at many operating points."""

from __future__ import annotations  # help shows the types, not their checks

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.inputs import UNITS
from squealpipe.schema.origin import recorded
from squealpipe.structures.assess.operating_points import FLAGS, VALUES, OperatingPoints
from squealpipe.systems.processes import available_cores, run_shared
from squealpipe.systems.progress import with_progress
from squealpipe.validation import Positive, Tolerance, Workers


@recorded(
    model="structure with exact contact and friction",
    method="Taylor series with located events",
    # plain numbers of a pressure are factors, and so texts are read where their meaning is known
    units={name: unit for name, unit in UNITS.items() if name != "pressure"},
)
def operating_map(
    structure: Any,
    *,
    pressure: Any = (1.0,),
    speed: Any = None,
    mu: Any = None,
    temperature: Any = None,
    mu_of: Mapping[str, Any] | None = None,
    measured: Any = None,
    frequency_band: Positive = 0.05,
    band_edges: Any = None,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Find which operating points of a structure are noisy, at which frequency, and how loud.

    At each point steady sliding is pushed by 1 % of the static deformation along the mode that
    grows fastest and run until its motion has settled, as :func:`squealpipe.assess` does with the
    same tolerance, so that both give the same answer. Other motions that may exist at a point are
    not sought here; ``assess`` reports them. The level is the velocity of the contacts, not a sound
    pressure.

    Args:
        structure: a :class:`squealpipe.Structure`; one of more than 32 degrees of freedom is
            reduced to the modes that its largest friction needs.
        pressure: factors of all preloads, and of a load that is given; or texts like ``"10 bar"``,
            the mean pressure of all faces.
        speed: belt speeds, m/s, or of a structure that turns, rad/s, or texts like ``"30 km/h"``;
            that of the structure by default.
        mu: coefficients of friction of the contacts without one of their own; that of the
            structure by default. With ``mu_of`` a factor of the tables, 1 by default.
        temperature: temperatures, °C; needs a table of friction over temperature.
        mu_of: tables of friction, like ``{"temperature": {20: 0.45, 300: 0.35}}``, over
            temperature, pressure (factors, or knots like ``"10 bar"``) or speed; also a text
            ``"20:0.45 300:0.35"`` or a file with the columns ``temperature [°C]`` and ``mu``.
            Interpolated linearly, refused outside; several are multiplied, also by ``mu``.
        measured: name of a list of measured noises (text or Excel) with columns like ``pressure``
            (or ``pressure [bar]``), ``speed [km/h]``, ``temperature [°C]``, ``mu``, ``frequency
            [Hz]``, ``level [dB]``; an empty frequency is a quiet point. Each is compared with the
            nearest point of the map; nothing is fitted.
        frequency_band: largest difference between the frequency of a measured noise and the
            predicted one, over the measured one.
        band_edges: edges of the bands of occurrence, Hz; third octaves by default.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset ``operating_map``: over ``pressure``, ``speed`` and ``mu`` (or ``temperature``, then
        ``operating_map over temperature``) the verdict, frequency, level and their statistical
        errors, friction and share of contact loss; over ``band`` the share of points that are noisy
        there, as in reports of dynamometer tests. With ``measured``, over ``noise``, the measured
        and the predicted frequency and ``match``, with counts of hits, misses and false alarms.
        Outcomes: converged, unresolved (undetermined), no_sliding_state.

    Raises:
        FileNotFoundError: a list or table is missing.
        ValueError: an argument; no contacts; a structure that is too large.
    """
    points = OperatingPoints.of(
        structure,
        pressure=pressure,
        speed=speed,
        mu=mu,
        temperature=temperature,
        mu_of=mu_of,
        measured=measured,
        frequency_band=frequency_band,
        band_edges=band_edges,
        tol=tol,
    ).reduced()

    def fill(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        for place in with_progress(range(first, points.count, stride)):
            for name, value in points.run(place).items():
                arrays[name][place] = value

    filled = run_shared(
        fill,
        {
            **dict.fromkeys(VALUES, ((points.count,), np.float64)),
            **dict.fromkeys(FLAGS, ((points.count,), np.int64)),
        },
        jobs=points.count,
        # a point takes up to seconds, so that a process pays from the second on
        workers=available_cores() if workers is None else workers,
    )
    return points.dataset(filled)
