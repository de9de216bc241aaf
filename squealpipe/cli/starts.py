"""``squealpipe basin`` and ``squealpipe disturbance``: where motions lead from other starts."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from squealpipe.cli.arguments import (
    BASELINE,
    Angle,
    Configs,
    Numbers,
    Output,
    Physical,
    Picture,
    Switch,
    Whole,
)
from squealpipe.cli.console import answer
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE
from squealpipe.cli.output import check_outputs, compute
from squealpipe.cli.simulate import Model


def basin(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    x: Numbers = None,
    y: Numbers = None,
    vx: Numbers = None,
    vy: Numbers = None,
    t_end: float,
    t_late: float | None = None,
    tol: float = 1e-12,
    workers: Whole | None = None,
    output: Output = Path("basin.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Run A1 from a grid of starts; write the kind of motion of each and a picture.

    Example: `squealpipe basin 0.4pi 0.6pi --vx -5:5:21 --vy -5:5:21 --t-end 200 -o basin.nc`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        x: displacement along the belt at the start, a number or first:last:count, m.
        y: displacement away from the belt, m.
        vx: speed along the belt, m/s.
        vy: speed away from the belt, m/s.
        t_end: end of each run, s.
        t_late: from where the late extrema count, s; 0.8 of t_end by default.
        tol: tolerance of the integration.
        workers: processes; all cores by default.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    picture = check_outputs(output, picture, force=force)
    given = {"x": x, "y": y, "vx": vx, "vy": vy}
    starts: dict[str, Any] = {
        name: values[0] if len(values) == 1 else values for name, values in given.items() if values
    }
    if sum(isinstance(each, list) for each in starts.values()) not in {1, 2}:
        raise ValueError("give a range of one or two of x, y, vx, vy, like --vx -5:5:21")
    found = compute(
        "basin_map", params, alpha1, alpha2, output=output, picture=picture,
        **starts, t_end=t_end, t_late=t_late, tol=tol, workers=workers,
    )  # fmt: skip
    from squealpipe.plotting.quantities import counts

    answer(*counts(found))
    return DONE


def disturbance(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    leads_to: Literal["contact_lost", "whirl"] = "contact_lost",
    model: Model = "A1",
    t_end: float | None = None,
    bound: float | None = None,
    directions: Whole = 128,
    seed: Whole = 1,
    tol: float = 1e-9,
    workers: Whole | None = None,
    output: Output = Path("disturbance.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Find the smallest disturbance of steady sliding that leads to contact loss or to the whirl.

    Example: `squealpipe disturbance 0.75pi 0.75pi --leads-to contact_lost --t-end 50`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        leads_to: what it is to lead to.
        model: level of the model.
        t_end: time within which that happens, s; 200 √(2 mass/(k1 + k2)) by default.
        bound: largest disturbance tried, in preload lengths; 3 for contact loss, 15 for the whirl.
        directions: random directions.
        seed: of the directions.
        tol: tolerance of the integration.
        workers: processes; all cores by default.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    picture = check_outputs(output, picture, force=force)
    found = compute(
        "smallest_disturbance", params, alpha1, alpha2, output=output, picture=picture,
        leads_to=leads_to, model=model, t_end=t_end, bound=bound, directions=directions,
        seed=seed, tol=tol, workers=workers,
    )  # fmt: skip
    from squealpipe.schema import REMEDIES, Outcome

    outcome = Outcome(int(found.outcome))
    if outcome is not Outcome.converged:
        answer(f"no disturbance: {outcome.name} ({REMEDIES[outcome]})")
        return ANSWER_IS_NO
    answer(
        f"smallest disturbance found: {float(found.distance):.6g}, in l_pre and l_pre ω",
        f"by the linear motion: {float(found.linear_distance):.6g}; "
        f"the start at rest: {float(found.rest_distance):.6g}",
    )
    return DONE
