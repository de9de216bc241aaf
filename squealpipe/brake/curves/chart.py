"""Regime charts: lines over two parameters that separate the regimes of a design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import scipy
import xarray as xr

from squealpipe.brake.curves.chords import Vector
from squealpipe.brake.curves.contact import Square, contact_lines, nearest_on, two_axes
from squealpipe.brake.curves.regions import chains_of, holds, loops_of
from squealpipe.brake.curves.stability import REGIME_GRID, Regimes, centres
from squealpipe.brake.schema.curves import ChartLine, regime_chart_schema
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.validation import Line, Positive, Tolerance, Workers


@recorded(model="A1", method="zeros of closed forms and of the lowest contact force")
def regime_chart(
    params: Parameters,
    alpha1: Line,
    alpha2: Line,
    *,
    design: Mapping[str, Line] | None = None,
    whirl: xr.Dataset | Sequence[xr.Dataset] | None = None,
    stick: xr.Dataset | Sequence[xr.Dataset] | None = None,
    t_end: Positive | None = None,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
    **ranges: Line,
) -> xr.Dataset:
    """The lines over two parameters across which A3 becomes unstable or A1 loses contact.

    Flutter and divergence are the regimes of :func:`stability_map`, with dashpots and the slope of
    friction where there are any; contact is that of A1 from rest until t_end, as in
    :func:`contact_boundary`, whose two arrays are given likewise.

    Args:
        alpha1, alpha2: angles, rad.
        design: the two parameters by their names, numbers or arrays of several designs; by default
            their values in ``params``, where both are there. Distances to each line are given.
        whirl, stick: one or several datasets of :func:`cycle_curve` over the two parameters (k3 for
            kappa), which become lines too: where a cycle is born, as in a fold, and where it begins
            to stick. An empty list says that there is none: its distance is infinite.
        t_end: end of each run, s; 200 √(m/k1) by default.
        ranges: parameters that vary.

    Returns:
        Dataset ``regime_chart`` over ``point`` and ``region``. A line that is right to about a cell
        only has the outcome ``unresolved``.

    Raises:
        ValueError: as :func:`contact_boundary`, or design or curves have other parameters.
    """
    axes, fixed = two_axes(params, alpha1, alpha2, ranges)
    if design is not None and set(design) != set(axes):
        raise ValueError(f"design = {dict(design)!r}: {' and '.join(axes)} are needed")
    if design is None and not {"alpha1", "alpha2"} & set(axes):
        own = {"lambda_": params.length_ratio, "mu_static": params.static_mu}
        design = {name: own.get(name, getattr(params, name, None)) for name in axes}
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    square = Square(
        params, fixed, axes, {"t_end": t_end, "tol": tol, "workers": workers}, "A1"
    )

    regimes = Regimes(square)
    coarse = max(axis.size for axis in axes.values())
    # the second, finer grid is taken where the first one cuts a tongue
    for finest in (60, 120):
        # lines are right to 1e-6 of the ranges from few runs: in the middle of a chord a line is
        # off by about twice as much as on average
        contact = contact_lines(square, coarse, finest, off=6e-7, residual=4e-8)
        if not contact.unresolved:
            break
    lines = {**regimes.lines(), ChartLine.contact_lost: contact}
    cells = centres(REGIME_GRID)
    regime, beside = (
        each(cells).reshape(REGIME_GRID, REGIME_GRID)
        for each in (regimes.at, regimes.beside)
    )
    middles = (np.arange(REGIME_GRID) + 0.5) / REGIME_GRID
    kept = holds(contact, middles, middles)
    regions = [
        (code, state, places[k - 1], size)
        for code in np.unique(beside)
        for state in (True, False)
        for places, sizes in [_parts((beside == code) & (kept == state))]
        for k, size in enumerate(sizes, start=1)
    ]
    onsets = {ChartLine.whirl: whirl, ChartLine.stick: stick}
    asked = {
        which: [curves] if isinstance(curves, xr.Dataset) else curves
        for which, curves in onsets.items()
        if curves is not None
    }
    cycles = [
        (which, _over(square, which.name, x), x)
        for which in asked
        for x in asked[which]
    ]
    data: dict[str, Any] = {}
    if design is not None:
        given = np.broadcast_arrays(*(design[name] for name in axes))
        places = np.atleast_2d(np.stack(given, axis=-1))
        limits = np.stack([square.low, square.low + square.width], axis=1)
        loops = {
            which: [
                square.values(loop.outline)
                for loop in loops_of(line, positive=True, flat=3e-7)
            ]
            for which, line in lines.items()
        } | {which: [] for which in asked}
        for which, line, curve in cycles:
            loops[which].append(_smooth(line, square.width, curve.label.values))
        far = [
            [nearest_on(loop, at, limits)[1] for loop in loops.values()]
            for at in places
        ]
        data = {"design": places, "distance": far}
    chains = [
        (which, square.values(line.place[chain]), line.residual[chain])
        for which, line in lines.items()
        for chain in chains_of(line.chords)
    ] + [(which, line, curve.residual.values) for which, line, curve in cycles]
    places = np.concatenate([np.empty((0, 2)), *(line for _, line, _ in chains)])
    lengths = [len(line) for _, line, _ in chains]
    return build(
        regime_chart_schema,
        data
        | {
            **dict(zip(square.names, places.T, strict=True)),
            "line": np.repeat([int(which) for which, _, _ in chains], lengths),
            "curve": np.repeat(np.arange(len(chains)), lengths),
            "residual": np.concatenate(
                [np.empty(0), *(residual for *_, residual in chains)]
            ),
            "cell_regime": regime,
            "cell_kept": kept,
            "region_regime": [code for code, *_ in regions],
            "region_kept": [state for _, state, _, _ in regions],
            "region_place": square.values(np.array([at for _, _, at, _ in regions])),
            "region_share": [size / REGIME_GRID**2 for *_, size in regions],
            "range": np.stack([square.low, square.low + square.width], axis=1),
            "t_end": t_end,
            "runs": square.runs,
            "outcome": [
                Outcome.unresolved if line.unresolved else Outcome.converged
                for line in lines.values()
            ]
            + [Outcome.converged] * len(asked),
        },
        {
            "point": np.arange(len(places)),
            "parameter": square.names,
            "boundary": [which.name for which in (*lines, *asked)],
        },
    )


def _over(square: Square, name: str, curve: xr.Dataset) -> Vector:
    """A curve of cycles in the chart's parameters, (points, 2)."""
    names = ["k3" if name == "kappa" else name for name in square.names]
    if set(names) != set(curve.get("parameter", xr.DataArray([])).values):
        raise ValueError(
            f"{name}: a dataset of cycle_curve in {' and '.join(names)} is needed"
        )
    units = np.where(np.array(square.names) == "kappa", square.params.k1, 1.0)
    return np.stack([curve[name].values for name in names], axis=1) / units


def _smooth(line: Vector, width: Vector, label: Vector) -> Vector:
    """There and back along a curve by splines, which end where something else happens."""
    steps = np.linalg.norm(np.diff(line, axis=0) / width, axis=1)
    way = np.append(0.0, np.cumsum(np.maximum(steps, 1e-12)))
    points = [line[:1]]
    for i, j in pairwise(np.unique([0, *np.flatnonzero(label), len(line) - 1])):
        at = np.interp(
            np.arange(0.0, j - i + 1e-9, 0.01), np.arange(j - i + 1), way[i : j + 1]
        )
        points.append(
            scipy.interpolate.CubicSpline(way[i : j + 1], line[i : j + 1])(at)
        )
    there = np.concatenate(points)
    return np.concatenate([there, there[::-1]])


def _parts(where: np.ndarray) -> tuple[Vector, np.ndarray]:
    """Connected parts of a grid's points: the place farthest from its edge, and points, of each."""
    numbers, count = scipy.ndimage.label(where)
    inner = scipy.ndimage.distance_transform_edt(np.pad(where, 1))[1:-1, 1:-1]
    at = [
        np.unravel_index(np.argmax(inner * (numbers == k)), where.shape)
        for k in range(1, count + 1)
    ]
    return (np.array(at).reshape(-1, 2) + 0.5) / REGIME_GRID, np.bincount(
        numbers.ravel()
    )[1:]
