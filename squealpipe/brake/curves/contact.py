"""Trace the boundary of kept contact over two parameters, as curves.

Idea: the reserve, the lowest contact force of a run in which the contact spring pulls too, is
smooth across the boundary, where it is zero. So zero lines of one smooth function are followed
(:mod:`squealpipe.brake.curves.zero_lines`), and no cell of a map is judged by yes or no. While the
mass is slower than the belt the reserve does not depend on how A1 changes regime; where it is
faster, that part is computed anew. Invariant: regions that no other line leads to are guaranteed to
be found only above the size of a cell of the first grid. Cost: one run for each point that is
evaluated, all points of a round together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Annotated, Any, NamedTuple

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import Ensemble, run_ensemble
from squealpipe.brake.curves.chords import Vector
from squealpipe.brake.curves.regions import chains_of, gathered, holds, inside, loops_of
from squealpipe.brake.curves.zero_lines import FirstGrid, ZeroLines
from squealpipe.brake.models.refusals import refuse_unread
from squealpipe.brake.schema.curves import (
    PointKind,
    boundary_distance_schema,
    contact_boundary_schema,
    varied_parameters,
)
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, FALLING, LAWS
from squealpipe.laws.springs import springs_are_equal
from squealpipe.parameters import HORIZON, PHYSICAL, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import suggestion
from squealpipe.validation import Line, Number, Positive, Tolerance, Workers, one_of

LOST_SIDE = 1e-8
"""Distance from the boundary of the run that tells when contact is lost, over the ranges."""


class Square:
    """Two ranges as the unit square, and runs of A1 over it."""

    def __init__(
        self,
        params: Parameters,
        fixed: Mapping[str, float],
        axes: Mapping[str, Vector],
        options: Mapping[str, Any],
        model: str,
    ) -> None:
        self.params, self.fixed, self.names = params, fixed, list(axes)
        self.options, self.model, self.runs = options, model, 0
        self.faster: list[tuple[Vector, Vector]] = []
        """Places where the mass was once as fast as the belt, and the reserves there."""
        self.sticks = False
        """True if a mass was as fast as the belt before it lost contact."""
        self.low = np.array([axis[0] for axis in axes.values()])
        self.width = np.array([axis[-1] - axis[0] for axis in axes.values()])

    def is_its_mirror_image(self) -> bool:
        """Tell whether (u, v) and (1 − v, 1 − u) are the same motion.

        (α1, α2) and (π − α2, π − α1) swap the two springs, so if these are equal they have one
        motion, with the same friction, belt and sign of x.
        """
        angles = self.names == ["alpha1", "alpha2"] and springs_are_equal(
            {name: getattr(self.params, name) for name in PHYSICAL}
        )
        ends = [self.low, self.low + self.width]
        return bool(angles and np.abs(ends[0] + ends[1][::-1] - np.pi).max() < 1e-13)

    def values(self, places: Vector) -> Vector:
        """The two parameters at places of the square, (places, 2)."""
        return np.asarray(self.low + np.clip(places, 0.0, 1.0) * self.width)

    def fields(self, places: Vector) -> dict[str, Any]:
        """Parameters of A1 by name, and both angles."""
        fields: dict[str, Any] = {name: getattr(self.params, name) for name in PHYSICAL}
        fields |= {
            **self.fixed,
            **dict(zip(self.names, self.values(places).T, strict=True)),
        }
        if "kappa" in fields:
            fields["k3"] = fields.pop("kappa") * self.params.k1
        if "lambda_" in fields:
            fields["length1"] = fields.pop("lambda_") * self.params.preload
            fields["length2"] = (
                fields["length1"] * self.params.length2 / self.params.length1
            )
        return fields

    def _run(self, places: Vector, model: str, **options: Any) -> Ensemble:
        self.runs += len(places)
        fields, options = self.fields(places), {**options, **self.options}
        alpha1, alpha2 = fields.pop("alpha1"), fields.pop("alpha2")
        return run_ensemble(fields, alpha1, alpha2, model=model, **options)

    def motions(self) -> Any:
        """Return what decides the motions of masses slower than the belt; None if more does.

        While |ẋ| < |V| Coulomb's friction has one direction, so that A1 as printed moves as A1 does
        over a belt that runs the other way.
        """
        if self.params.friction_law != COULOMB or "belt_speed" in self.names:
            return None
        values: dict[str, Any] = {name: getattr(self.params, name) for name in PHYSICAL}
        drags_forwards = values["belt_speed"] > 0.0
        values["belt_speed"] = abs(values["belt_speed"])
        options = {name: self.options[name] for name in ("t_end", "tol")}
        ranges = [*self.low.tolist(), *self.width.tolist()]
        return (
            drags_forwards != (self.model == "A1-as-printed"),
            {**values, **self.fixed, **options},
            self.names,
            ranges,
        )

    def reserve(self, places: Vector) -> Vector:
        """The lowest contact force over the preload's, in runs in which k3 pulls too."""
        model, speed = f"{self.model}-no-separation", abs(self.params.belt_speed)
        # at twice the force at rest; of some designs the bound is too coarse
        bounded = bool(np.all(self._largest_speed(places, 2.0) < speed))
        tracked = ("contact_force",) if bounded else ("contact_force", "vx")
        run = self._run(places, model, tracked=tracked)
        lowest = np.nan_to_num(run.lowest_contact_force, nan=-1.0)
        reserve = np.asarray(np.clip(lowest, -1.0, 1.0))
        if bounded:
            force = np.maximum(run.peak_contact_force, -run.lowest_contact_force)
            slower = self._largest_speed(places, force) < speed
            again = places[~slower]
            if len(again):
                self.runs -= len(again)
                seen = self._run(again, model, tracked=("vx",))
                slower[~slower] = seen.early_max_vx < speed
        else:
            slower = run.early_max_vx < speed
        if not slower.all():
            self.faster.append((places[~slower], reserve[~slower]))
        return reserve

    def _largest_speed(self, places: Vector, force: Any) -> Any:
        """Return a bound of |ẋ| until t_end while |ẋ| < |V|, m/s; no extreme has to be tracked.

        From rest the energy is that of the contact spring, and friction alone adds to it.

        Args:
            force: largest |N| of each run over k3 l_pre.
        """
        if self.params.friction_law not in (COULOMB, *FALLING):
            return np.full(len(places), np.inf)
        p = SimpleNamespace(**self.fields(places))
        mu = p.mu if p.mu_static is None else np.maximum(p.mu, p.mu_static)
        by_friction = mu * p.k3 / p.mass * self.options["t_end"] * force
        return p.preload * (np.sqrt(p.k3 / p.mass) + by_friction)

    def touch_time(self, places: Vector, slope: Vector) -> Vector:
        """Return the time at which contact is lost next to the boundary, over √(m/k1)."""
        size = np.linalg.norm(slope, axis=1)
        # where the reserve jumps, as next to a pivot, it may have no slope on either side
        beside = places - LOST_SIDE * slope / np.where(size > 0.0, size, 1.0)[:, None]
        run = self._run(
            beside, self.model, stop_at_first_separation=True, tracked=("vx",)
        )
        slower = run.early_max_vx < abs(self.params.belt_speed)
        self.sticks |= not slower.all()
        time = np.where(
            run.outcome == Outcome.separated, run.first_separation_time, run.time
        )
        return np.asarray(time / self.params.time_unit)


def two_axes(
    params: Parameters,
    alpha1: Any,
    alpha2: Any,
    ranges: Mapping[str, Any],
    model: str = "A1",
) -> tuple[dict[str, Vector], dict[str, float]]:
    """The two arguments that are arrays, and the angles that are not; others are refused."""
    given = {"alpha1": np.asarray(alpha1), "alpha2": np.asarray(alpha2)}
    given |= {name: np.asarray(values) for name, values in ranges.items()}
    axes = {name: values for name, values in given.items() if values.ndim}
    if len(axes) != 2 or any(
        (np.diff(a) <= 0).any() or a.size < 3 for a in axes.values()
    ):
        raise ValueError(
            f"{', '.join(axes) or 'no argument'}: two arguments must be ascending arrays of three "
            "or more values, the others numbers"
        )
    for name in axes:
        if name not in varied_parameters:
            raise ValueError(
                f"{name!r} cannot vary; {suggestion(name, varied_parameters)}"
            )
    for ratio, same in (
        ("kappa", "k3"),
        ("lambda_", "length1"),
        ("lambda_", "length2"),
    ):
        if {ratio, same} <= axes.keys():
            raise ValueError(
                f"{ratio} sets {same}: let another parameter vary beside one of them"
            )
    fixed = {name: float(values) for name, values in given.items() if not values.ndim}
    if set(fixed) - {"alpha1", "alpha2"}:
        raise ValueError("what does not vary belongs into params")
    if params.contact_law != LINEAR:
        raise ValueError(
            f"contact_law = {brief(params.contact_law)}: contact is followed with the linear law; "
            f"use validity_map, or contact_law = {LINEAR!r}"
        )
    if model != "A1" and params.friction_law not in LAWS:
        raise ValueError(
            f"friction_law = {brief(params.friction_law)}: friction as printed is that of a "
            f"formula; use model A1, or one of {', '.join(LAWS)}"
        )
    refuse_unread(params, list(axes))
    return axes, fixed


class FollowedLines(NamedTuple):
    """Lines of kept contact, and what they hold for.

    Attributes:
        cells: per side of the coarse map, and of the finest at least.
        motions: what decides the runs, as :meth:`Square.motions` has it.
        square: whose runs they were followed by.
    """

    cells: tuple[int, int]
    motions: Any
    square: Square
    lines: ZeroLines


_latest: list[FollowedLines] = []
"""None or one. A study follows the boundary in two readings of the sign of friction, which differ
only where a mass is faster than the belt."""


def lines_of(square: Square, coarse: int, finest: int) -> ZeroLines:
    """Return the boundary of kept contact: the latest one if its reserves are the same.

    Where a mass was once as fast as the belt its reserve is computed anew.
    """
    cells, motions = (coarse, finest), square.motions()
    for latest in _latest:
        if motions is None or (cells, motions) != (latest.cells, latest.motions):
            continue
        if all(
            np.array_equal(square.reserve(places), reserve)
            for places, reserve in latest.square.faster
        ):
            square.runs = latest.square.runs
            return latest.lines
    square.runs = 0
    lines = contact_lines(square, coarse, finest)
    _latest.clear()
    if not square.sticks:
        _latest.append(FollowedLines(cells, motions, square, lines))
    return lines


def contact_lines(
    square: Square, coarse: int, finest: int, **accuracy: float
) -> ZeroLines:
    """The boundary of kept contact, begun on a grid of at least ``finest`` cells per side."""
    finer = 2 ** max(0, int(np.ceil(np.log2(finest / (coarse - 1)))))
    # over √(m/k1): where the time of touching changes by more, another maximum of y is the first
    # to touch
    return ZeroLines(
        square.reserve,
        square.touch_time,
        FirstGrid(coarse, finer),
        jump=0.1,
        touching=False,
        mirrored=square.is_its_mirror_image(),
        **accuracy,
    )


@recorded(method="zeros of the lowest contact force, joined from an adaptive grid")
def contact_boundary(
    params: Parameters,
    alpha1: Line,
    alpha2: Line,
    *,
    t_end: Positive | None = None,
    model: Annotated[str, one_of(("A1", "A1-as-printed"))] = "A1",
    tol: Tolerance = 1e-12,
    workers: Workers = None,
    **ranges: Line,
) -> xr.Dataset:
    """Trace where model A1, started at rest, just keeps contact until t_end, over two parameters.

    Two of the arguments are arrays: both angles, or others under their own names, as ``mu``,
    ``belt_speed`` or the ratios ``kappa`` = k3/k1 and ``lambda_`` = L1/l_pre (L2 keeps its
    proportion). An array's ends are the range; as many points per side as the longer one has
    make the coarse map, which is made finer where contact is nearly lost. Contact is kept
    where the largest y stays below l_pre, in runs in which the contact spring pulls, too, which
    are the same until then. So the boundary is made of arcs, on each of which one maximum of y is
    the first to touch, and corners, where two touch at once; where a maximum comes at t_end,
    y(t_end) goes on in its place. Over both angles to 200 √(m/k1) it ends ``unresolved``, in 10 s
    where a refined map takes 3 s; to 25 √(m/k1) both take about as long. Between angles that add
    up to π, equal springs have lines that are their own mirror image: half of them is followed.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles, rad.
        t_end: end of each run, s; 200 √(m/k1) by default.
        model: "A1" or "A1-as-printed".
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.
        ranges: parameters that vary.

    Returns:
        Dataset ``contact_boundary`` over ``point`` and ``region``.

    Raises:
        ValueError: not two arguments are ascending arrays, a parameter cannot vary or is read by no
            law, or the contact law is not linear.
    """
    axes, fixed = two_axes(params, alpha1, alpha2, ranges, model)
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    options = {"t_end": t_end, "tol": tol, "workers": workers}
    square = Square(params, fixed, axes, options, model)
    coarse = max(axis.size for axis in axes.values())
    # cells per side, at least, of the grid on whose edges the curves begin
    return _dataset(square, lines_of(square, coarse, 900), axes)


def nearest_on(
    loops: Sequence[Vector], place: Vector, limits: Vector
) -> tuple[Vector, float]:
    """The point of closed lines next to a place, and its distance; infinite where there is none."""
    nearest, distance = place, np.inf
    for line in loops:
        after = np.roll(line, -1, axis=0)
        chord = after - line
        share = ((place - line) * chord).sum(axis=1) / np.maximum(
            (chord**2).sum(axis=1), 1e-300
        )
        foot = line + np.clip(share, 0.0, 1.0)[:, None] * chord
        far = np.linalg.norm(foot - place, axis=1)
        # what runs along the end of a range is not an arc
        for limit in limits.T:
            far[((line == limit) & (after == limit)).any(axis=1)] = np.inf
        if far.min() < distance:
            nearest, distance = foot[far.argmin()], float(far.min())
    return nearest, distance


@recorded(method="nearest point of the outlines of a contact_boundary")
def boundary_distance(boundary: xr.Dataset, design: Mapping[str, Number]) -> xr.Dataset:
    """Find how far a design is from losing contact, or from keeping it.

    Args:
        boundary: dataset ``contact_boundary``.
        design: the two parameters that vary in it, by their names.

    Returns:
        Dataset ``boundary_distance``; where there is no boundary its distance is infinite.

    Raises:
        ValueError: the two parameters are others.
    """
    if "outline_loop" not in boundary:
        raise ValueError("boundary: a dataset of contact_boundary is needed")
    names = [str(name) for name in boundary.parameter.values]
    if set(design) != set(names):
        raise ValueError(
            f"design = {dict(design)!r}: {names[0]} and {names[1]} are needed"
        )
    place = np.array([design[name] for name in names])
    owner, vertices = boundary.outline_loop.values, boundary.outline.values
    loops = [vertices[owner == loop] for loop in np.unique(owner)]
    nearest, distance = nearest_on(loops, place, boundary.range.values)
    return build(
        boundary_distance_schema,
        {
            "design": place,
            "distance": distance,
            "nearest": nearest,
            "kept": inside(loops, place[:1], place[1:])[0, 0],
            "outcome": Outcome.converged
            if np.isfinite(distance)
            else Outcome.not_computed,
        },
        {"parameter": names},
    )


def _dataset(
    square: Square, lines: ZeroLines, axes: Mapping[str, Vector]
) -> xr.Dataset:
    chains, coarse = chains_of(lines.chords), max(axis.size for axis in axes.values())
    # on the border itself either side would do
    shares = [
        np.clip((a - a[0]) / (a[-1] - a[0]), LOST_SIDE, 1.0 - LOST_SIDE)
        for a in axes.values()
    ]
    at = np.array([point for chain in chains for point in chain], int)
    curve = np.repeat(np.arange(len(chains)), [len(chain) for chain in chains])
    corner = np.isnan(lines.slope[at, 0])
    border = ~corner & np.isin(lines.place[at], (0.0, 1.0)).any(axis=1)
    begins = np.ones(len(at), bool)
    begins[1:] = corner[1:] | (curve[1:] != curve[:-1])
    regions, outlines = [], []
    for kept in (True, False):
        loops = loops_of(lines, positive=kept)
        outlines += [square.values(loop.outline) for loop in loops] if kept else []
        for group in gathered(loops):
            area, error = (sum(loops[i][k] for i in group) for k in (1, 2))
            regions.append(
                (kept, area * np.prod(square.width), error * np.prod(square.width))
            )
    kept, areas, errors = np.array(regions).T
    inside = kept.astype(bool)
    return build(
        contact_boundary_schema,
        {
            **dict(zip(square.names, square.values(lines.place[at]).T, strict=True)),
            "kept": holds(lines, *shares),
            "curve": curve,
            "arc": np.cumsum(begins) - 1,
            "touch_time": lines.marks(at) * square.params.time_unit,
            "residual": lines.residual[at],
            "corner": corner,
            "kind": np.where(
                corner, PointKind.corner, np.where(border, PointKind.border, 0)
            ),
            "region_kept": kept,
            "region_area": areas,
            "region_area_error": errors,
            "kept_share": areas[inside].sum() / areas.sum(),
            "kept_share_error": errors[inside].sum() / areas.sum(),
            "outline": np.concatenate([*outlines, np.empty((0, 2))]),
            "outline_loop": np.repeat(
                np.arange(len(outlines)), [len(outline) for outline in outlines]
            ),
            "range": np.stack([square.low, square.low + square.width], axis=1),
            "t_end": square.options["t_end"],
            "runs": square.runs,
            "smallest_island": 0.5 * np.pi * np.prod(square.width) / (coarse - 1) ** 2,
            "outcome": Outcome.unresolved if lines.unresolved else Outcome.converged,
        },
        {
            "point": np.arange(len(at)),
            "parameter": square.names,
            **dict(zip(("row", "column"), axes.values(), strict=True)),
        },
    )
