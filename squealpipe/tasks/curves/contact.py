"""The boundary of kept contact over two parameters, as curves."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.methods.regions import Curve, gathered, inside, link, loops_around
from squealpipe.methods.union_boundary import (
    Front,
    Heights,
    Kind,
    Reached,
    Settings,
    Vector,
    follow_all,
    passed,
    start_on,
)
from squealpipe.parameters import HORIZON, TABLE, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.curves import BOUNDARY_DISTANCE, CONTACT_BOUNDARY
from squealpipe.schema.origin import recorded
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.solvers.a1.jobs import Model
from squealpipe.tasks.curves.heights import HeightsOfRuns
from squealpipe.validation import Line, Positive, Tolerance, Workers

EVERY = 3
"""Every so many crossings of the coarse map a front starts; others where one is missed."""
ROUNDS = 4


class _Square:
    """Two ranges as the unit square, and the functions over it."""

    def __init__(self, names: list[str], ranges: list[Vector], heights: HeightsOfRuns) -> None:
        self.names, self.heights = names, heights
        self.low = np.array([each[0] for each in ranges])
        self.width = np.array([each[-1] - each[0] for each in ranges])
        self.grid = [(each - each[0]) / (each[-1] - each[0]) for each in ranges]

    def values(self, places: Vector) -> Vector:
        """The two parameters at places of the square, (places, 2)."""
        return np.asarray(self.low + places * self.width)

    def __call__(self, places: Vector) -> list[Heights]:
        return [
            h._replace(
                slope=h.slope * self.width,
                drift=h.drift * self.width,
                rate_slope=h.rate_slope * self.width,
            )
            for h in self.heights(self.values(places))
        ]


@recorded(method="curves of exact maxima by Newton's method from a coarse map")
def contact_boundary(
    params: Parameters,
    alpha1: Line,
    alpha2: Line,
    *,
    t_end: Positive | None = None,
    model: Model = "A1",
    tol: Tolerance = 1e-12,
    workers: Workers = None,
    **ranges: Line,
) -> xr.Dataset:
    """Where model A1, started at rest, just keeps contact until t_end, over two parameters.

    Two of the arguments are arrays: both angles, or others under their own names, as ``mu``,
    ``belt_speed`` or the ratios ``kappa`` = k3/k1 and ``lambda_`` = L1/l_pre (L2 keeps its
    proportion). An array's ends are the range, its points the coarse map that the curves start
    from. Contact is kept where the largest y stays below l_pre. So the boundary is made of arcs, on
    each of which one maximum of y is the first to touch, and corners, where two touch at once;
    where a maximum comes at t_end, y(t_end) goes on in its place. The curves are checked against
    the coarse map, and fronts are added where that differs.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles, rad.
        t_end: end of each run, s; 200 √(m/k1) by default.
        model: "A1" or a variant of it that loses contact.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.
        ranges: parameters that vary.

    Returns:
        Dataset ``contact_boundary`` over ``point`` and ``region``.

    Raises:
        ValueError: not two arguments are ascending arrays, or a parameter cannot vary.
    """
    given = {"alpha1": np.asarray(alpha1), "alpha2": np.asarray(alpha2)}
    given |= {name: np.asarray(values) for name, values in ranges.items()}
    names = [name for name, values in given.items() if values.ndim]
    if len(names) != 2 or any((np.diff(given[n]) <= 0).any() or given[n].size < 3 for n in names):
        raise ValueError(
            f"{', '.join(names) or 'no argument'}: two arguments must be ascending arrays of three "
            "or more values, the others numbers"
        )
    fixed = {name: float(values) for name, values in given.items() if not values.ndim}
    if set(fixed) - {"alpha1", "alpha2"}:
        raise ValueError("what does not vary belongs into params")
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    axes = [given[name] for name in names]
    heights = HeightsOfRuns(
        params, fixed, names, t_end=t_end, model=model, tol=tol, workers=workers
    )
    square = _Square(names, axes, heights)
    coarse = _coarse(params, fixed, dict(zip(names, axes, strict=True)), t_end, model, tol, workers)
    curves, all_kept = _trace(square, coarse)
    return _dataset(params, square, curves, all_kept, t_end, coarse.size)


@recorded(method="nearest point of the outlines of a contact_boundary")
def boundary_distance(boundary: xr.Dataset, design: Mapping[str, float]) -> xr.Dataset:
    """How far a design is from losing contact, or from keeping it.

    Args:
        boundary: dataset ``contact_boundary``.
        design: the two parameters that vary in it, by their names.

    Returns:
        Dataset ``boundary_distance``; where there is no boundary its distance is infinite.

    Raises:
        ValueError: the two parameters are others.
    """
    names = [str(name) for name in boundary.parameter.values]
    if set(design) != set(names):
        raise ValueError(f"design = {dict(design)!r}: {names[0]} and {names[1]} are needed")
    place = np.array([design[name] for name in names])
    owner, vertices = boundary.outline_loop.values, boundary.outline.values
    loops = [vertices[owner == loop] for loop in np.unique(owner)]
    nearest, distance = place, np.inf
    for line in loops:
        after = np.roll(line, -1, axis=0)
        chord = after - line
        share = ((place - line) * chord).sum(axis=1) / np.maximum((chord**2).sum(axis=1), 1e-300)
        foot = line + np.clip(share, 0.0, 1.0)[:, None] * chord
        far = np.linalg.norm(foot - place, axis=1)
        # what runs along the end of a range is no arc
        for limit in boundary.range.values.T:
            far[((line == limit) & (after == limit)).any(axis=1)] = np.inf
        if far.min() < distance:
            nearest, distance = foot[far.argmin()], float(far.min())
    return build(
        BOUNDARY_DISTANCE,
        {
            "design": place,
            "distance": distance,
            "nearest": nearest,
            "kept": inside(loops, place[:1], place[1:])[0, 0],
            "outcome": Outcome.converged if np.isfinite(distance) else Outcome.not_computed,
        },
        {"parameter": names},
    )


def _coarse(
    params: Parameters,
    fixed: Mapping[str, float],
    axes: Mapping[str, Vector],
    t_end: float,
    model: str,
    tol: float,
    workers: int | None,
) -> np.ndarray:
    """Where contact is kept on the coarse map, over both arrays."""
    fields: dict[str, Any] = {
        name: getattr(params, name) for name in TABLE if TABLE[name].enters_a1
    }
    angles: dict[str, Any] = dict(fixed)
    for (name, values), shape in zip(axes.items(), ((-1, 1), (1, -1)), strict=True):
        column = values.reshape(shape)
        if name in {"alpha1", "alpha2"}:
            angles[name] = column
        elif name == "kappa":
            fields["k3"] = column * params.k1
        elif name == "lambda_":
            fields["length1"] = column * params.preload
            fields["length2"] = fields["length1"] * params.length2 / params.length1
        else:
            fields[name] = column
    run = run_ensemble(
        fields, angles["alpha1"], angles["alpha2"], t_end=t_end, model=model, tol=tol,
        stop_at_first_separation=True, workers=workers,
    )  # fmt: skip
    size = tuple(values.size for values in axes.values())
    return np.asarray(np.broadcast_to(run.outcome != Outcome.separated, size))


def _trace(square: _Square, coarse: np.ndarray) -> tuple[list[Curve], bool]:
    """All curves that separate the coarse map's points, and whether it is kept without them."""
    settings = Settings()
    within = [np.clip(each, 1e-9, 1.0 - 1e-9) for each in square.grid]
    starts: list[Reached] = []
    fronts: list[Front] = []
    wrong = np.full(coarse.shape, coarse.min() != coarse.max())
    curves: list[Curve] = []
    for number in range(ROUNDS):
        if not wrong.any():
            break
        kept, lost, border = _crossings(square.grid, coarse, wrong)
        some = border | (np.arange(len(kept)) % (EVERY if number == 0 else 1) == 0)
        new = [each for each in start_on(square, kept[some], lost[some], settings) if each]
        new = [
            each for each in new if all(np.abs(each.place - s.place).max() > 1e-9 for s in starts)
        ]
        entering = [each for each in new if _enters(each)]
        added = [Front(each) for each in entering]
        starts += entering
        fronts += added
        follow_all(square, added, starts, settings)
        led_to = {front.joins for front in fronts}
        alone = [
            f for i, f in enumerate(fronts) if i not in led_to and not _on_border(f.start.place)
        ]
        back = [Front(front.start, direction=-1.0) for front in alone]
        follow_all(square, back, [], settings)
        curves = link(fronts, back)
        loops = loops_around(curves, below=True, all_below=bool(coarse.flat[0]))
        wrong = inside([loop.outline for loop in loops], *within) != coarse
    return curves, bool(coarse.flat[0])


def _crossings(
    grid: list[Vector], coarse: np.ndarray, wrong: np.ndarray
) -> tuple[Vector, Vector, np.ndarray]:
    """Neighbours that differ, and of which one is wrong by the curves.

    Returns:
        (kept, lost, on the border): both places of each pair, (pairs, 2).
    """
    found = []
    for axis in (0, 1):
        labels, doubt = np.moveaxis(coarse, axis, 0), np.moveaxis(wrong, axis, 0)
        i, j = np.nonzero((labels[1:] != labels[:-1]) & (doubt[1:] | doubt[:-1]))
        border = (j == 0) | (j == labels.shape[1] - 1)
        up = labels[i, j]
        for row, side in ((i + ~up, j), (i + up, j)):
            pair = (row, side) if axis == 0 else (side, row)
            found.append(np.stack([grid[0][pair[0]], grid[1][pair[1]]], axis=1))
        found.append(border)
    return tuple(np.concatenate([found[k], found[k + 3]]) for k in range(3))  # type: ignore[return-value]


def _is_followed(start: Reached, fronts: list[Front]) -> bool:
    """Whether a point lies on what fronts have followed."""
    return any(
        passed(here, there, [start]) >= 0
        for front in fronts
        for here, there in pairwise(front.points)
    )


def _on_border(place: Vector) -> bool:
    return bool((np.abs(place - 0.5) >= 0.5 - 1e-12).any())


def _enters(start: Reached) -> bool:
    """Whether a front from there goes into the square."""
    way = Front(start).tangent(start)
    low, high = start.place <= 1e-12, start.place >= 1.0 - 1e-12
    return not ((low & (way <= 0.0)) | (high & (way >= 0.0))).any()


def _dataset(
    params: Parameters,
    square: _Square,
    curves: list[Curve],
    all_kept: bool,
    t_end: float,
    coarse_runs: int,
) -> xr.Dataset:
    points = [(c, p) for c, curve in enumerate(curves) for p in _closed(curve)]
    places = np.array([p.place for _, p in points]).reshape(-1, 2)
    curve = np.array([c for c, _ in points], int)
    corner = np.array([p.kind == Kind.corner for _, p in points], bool)
    begins = np.ones(len(points), bool)
    begins[1:] = corner[1:] | (curve[1:] != curve[:-1])
    areas, errors, kept, outlines = [], [], [], []
    scale = float(np.prod(square.width))
    for below in (True, False):
        loops = loops_around(curves, below=below, all_below=all_kept)
        outlines += [square.values(loop.outline) for loop in loops] if below else []
        for group in gathered(loops):
            areas.append(scale * sum(loops[i].area for i in group))
            errors.append(scale * sum(loops[i].error for i in group))
            kept.append(below)
    gap = max((each.gap for each in curves), default=0.0)
    lost = gap > 0.0 or any(not c.closed and c.points[-1].kind != Kind.border for c in curves)
    steps = [
        np.diff(each).max() * width for each, width in zip(square.grid, square.width, strict=True)
    ]
    values = square.values(places)
    return build(
        CONTACT_BOUNDARY,
        {
            **{name: values[:, i] for i, name in enumerate(square.names)},
            "curve": curve,
            "arc": np.cumsum(begins) - 1,
            "touch_time": [p.heights.time[p.on] * params.time_unit for _, p in points],
            "residual": [abs(p.heights.value[p.on]) for _, p in points],
            "corner": corner,
            "kind": [int(p.kind) for _, p in points],
            "region_kept": kept,
            "region_area": areas,
            "region_area_error": errors,
            "outline": np.concatenate([*outlines, np.empty((0, 2))]),
            "outline_loop": np.repeat(np.arange(len(outlines)), [len(each) for each in outlines]),
            "range": np.stack([square.low, square.low + square.width], axis=1),
            "t_end": t_end,
            "runs": square.heights.runs,
            "coarse_runs": coarse_runs,
            "smallest_island": 0.25 * np.pi * (steps[0] ** 2 + steps[1] ** 2),
            "largest_gap": gap,
            "outcome": Outcome.branch_lost if lost else Outcome.converged,
        },
        {"point": np.arange(len(points)), "parameter": square.names},
    )


def _closed(curve: Curve) -> list[Reached]:
    return [*curve.points, curve.points[0]] if curve.closed else curve.points
