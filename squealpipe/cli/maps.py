"""``map``, ``refine``, ``basin``, ``disturbance``: many runs in one picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from squealpipe.cli.arguments import (
    Angle1,
    Angle2,
    AngleRange,
    Drawn,
    Lengths,
    Output,
    Share,
    Speeds,
    Time,
    Tolerance,
    Whole,
    Workers,
    drawn_output,
    full_range,
)
from squealpipe.cli.console import ExitCodes, answer
from squealpipe.cli.motions import Model
from squealpipe.cli.output import compute, ending
from squealpipe.cli.signatures import options_of
from squealpipe.parameters import HORIZON

if TYPE_CHECKING:
    import xarray as xr

Kind = Literal[
    "validity",
    "hammering",
    "quasi-static",
    "stability",
    "critical-friction",
    "frequencies",
]


@options_of("validity_map")
def map_angles(
    kind: Kind,
    /,
    *,
    alpha1: AngleRange = full_range,
    alpha2: AngleRange = full_range,
    t_end: Time | None,
    tol: Tolerance,
    output: Output = Path("map.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Compute a map over both spring angles; write a dataset and a picture.

    Example: `squealpipe map validity --alpha1 0:pi:91 --alpha2 0:pi:91 --mu 0.2 -o validity.nc`

    Args:
        kind: what to map.
        t_end: horizon of validity and hammering maps, s; 200 √(mass/k1) by default.
    """
    if min(len(alpha1), len(alpha2)) < 2:
        raise ValueError(
            "a map needs 2 or more angles of each spring; write for instance 0:pi:31"
        )
    t_end = HORIZON * brake.params.time_unit if t_end is None else t_end
    name = {"frequencies": "natural_frequencies"}.get(
        kind, f"{kind.replace('-', '_')}_map"
    )
    # linear models have no horizon
    options: dict[str, Any] = (
        {"t_end": t_end, "tol": tol} if kind in ("validity", "hammering") else {}
    )
    return _counted(compute(name, brake, alpha1, alpha2, output=output, **options))


@options_of("refine_validity_map")
def refine(
    *,
    resolution: Whole = 361,
    coarse: Whole = 46,
    t_end: Time | None,
    model: Model,
    tol: Tolerance,
    workers: Workers,
    output: Output = Path("refined.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Map at high resolution where contact is kept, with runs only along the boundaries.

    Example: `squealpipe refine --resolution 181 --coarse 46 --t-end 50 -o refined.nc`

    Args:
        resolution: points per side of the finest grid; one less is 2^n (coarse - 1).
        coarse: points per side of the first grid.
        t_end: end of each run, s; 200 √(mass/k1) by default.
    """
    validity = compute(
        "refine_validity_map",
        brake,
        output=output,
        resolution=resolution,
        coarse=coarse,
        t_end=t_end,
        model=model,
        tol=tol,
        workers=workers,
    )
    low, high = validity.inherited_error_interval.values
    run = int(validity.computed.sum())
    wrong = f"; of the others {low:.2%} to {high:.2%} are wrong (95 %)"
    answer(
        f"contact is lost in {int(validity.separates.sum())} of {validity.separates.size} cells",
        f"{run} cells were run{wrong if run < validity.computed.size else ''}",
    )
    return ExitCodes.done


@options_of("basin_map")
def basin(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    x: Lengths = None,
    y: Lengths = None,
    vx: Speeds = None,
    vy: Speeds = None,
    t_end: Time,
    t_late: Time | None,
    tol: Tolerance,
    workers: Workers,
    output: Output = Path("basin.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Run A1 from a grid of starts; write the kind of motion of each and a picture.

    Example: `squealpipe basin 0.4pi 0.6pi --vx -5:5:21 --vy -5:5:21 --t-end 200 -o basin.nc`

    Args:
        x: displacement along the belt at the start, a number or first:last:count, m.
        y: displacement away from the belt, m.
        vx: speed along the belt, m/s.
        vy: speed away from the belt, m/s.
        t_end: end of each run, s.
        t_late: time from which the late extrema are taken, s; 0.8 of t_end by default.
    """
    given = {"x": x, "y": y, "vx": vx, "vy": vy}
    starts: dict[str, Any] = {
        name: values[0] if len(values) == 1 else values
        for name, values in given.items()
        if values
    }
    if sum(isinstance(start, list) for start in starts.values()) not in {1, 2}:
        raise ValueError(
            "give a range of one or two of x, y, vx, vy, like --vx -5:5:21"
        )
    options: dict[str, Any] = {
        "t_end": t_end,
        "t_late": t_late,
        "tol": tol,
        "workers": workers,
    }
    return _counted(
        compute("basin_map", brake, alpha1, alpha2, output=output, **starts, **options)
    )


def _counted(found: xr.Dataset) -> int:
    """State how many cells have which answer."""
    from squealpipe.plotting.quantities import counts

    answer(*counts(found))
    return ExitCodes.done


@options_of("smallest_disturbance")
def disturbance(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    leads_to: Literal["contact_lost", "whirl"],
    model: Model,
    t_end: Time | None,
    bound: Share | None,
    directions: Whole,
    seed: Whole,
    tol: Tolerance,
    workers: Workers,
    output: Output = Path("disturbance.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Find the smallest disturbance of steady sliding that leads to contact loss or to the whirl.

    Example: `squealpipe disturbance 0.75pi 0.75pi --leads-to contact_lost --t-end 50`

    Args:
        leads_to: what the disturbance must lead to.
        t_end: time within which that happens, s; 200 √(2 mass/(k1 + k2)) by default.
        bound: largest disturbance tried, in preload lengths; 3 for contact loss, 15 for the whirl.
        directions: random directions.
        seed: seed of the random directions.
    """
    dataset = compute(
        "smallest_disturbance",
        brake,
        alpha1,
        alpha2,
        output=output,
        leads_to=leads_to,
        model=model,
        t_end=t_end,
        bound=bound,
        directions=directions,
        seed=seed,
        tol=tol,
        workers=workers,
    )
    outcome, why = ending(dataset.outcome)
    if outcome != "converged":
        answer(f"no disturbance: {why}")
        return ExitCodes.answer_is_no
    answer(
        f"smallest disturbance found: {float(dataset.distance):.6g}, in l_pre and l_pre ω",
        f"by the linear motion: {float(dataset.linear_distance):.6g}; "
        f"the start at rest: {float(dataset.rest_distance):.6g}",
    )
    return ExitCodes.done
