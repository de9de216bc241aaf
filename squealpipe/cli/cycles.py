"""``squealpipe cycle`` and ``squealpipe branch``: periodic motions of A1."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
from squealpipe.config.ranges import parse_range

if TYPE_CHECKING:
    import xarray as xr


def cycle(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    guess: Numbers = None,
    t_settle: float | None = None,
    output: Output = Path("cycle.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Find a periodic motion of A1, its events and its stability; write a dataset and a picture.

    Example: `squealpipe cycle 0.1pi 0.5pi --friction-law exponential --mu-static 0.6
    --belt-speed 0.5 --damping1 0.02 --damping2 0.02`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        guess: state x,y,vx,vy near the cycle, which may be unstable; by default what a run from
            rest settles to.
        t_settle: after which that run counts as settled, s; 2000 √(mass/min(k1, k2)) by default.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    picture = check_outputs(output, picture, force=force)
    found = compute(
        "limit_cycle", params, alpha1, alpha2,
        output=output, picture=picture, guess=guess, t_settle=t_settle,
    )  # fmt: skip
    from squealpipe.schema import REMEDIES, Outcome

    outcome = Outcome(int(found.outcome))
    if outcome not in {Outcome.converged, Outcome.family_member}:
        answer(f"no periodic motion was found: {outcome.name} ({REMEDIES[outcome]})")
        return ANSWER_IS_NO
    answer(
        f"period {float(found.period):.9g} s, {'stable' if found.stable == 1 else 'not stable'}, "
        f"{found.sizes['event']} events",
        f"x from {float(found.x_min):.6g} to {float(found.x_max):.6g} m, "
        f"y from {float(found.y_min):.6g} to {float(found.y_max):.6g} m",
        f"in contact for {float(found.contact_fraction):.1%} of it, in stick for "
        f"{float(found.stick_fraction):.1%}",
    )
    if outcome is Outcome.family_member:
        answer(f"note: {outcome.name} ({REMEDIES[outcome]})")
    return DONE


def branch(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    parameter: str,
    to: float,
    start: str | None = None,
    n_points: Whole = 200,
    doubled: Switch = False,
    output: Output = Path("branch.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Follow periodic motions of A1 in a parameter, stable or not; write a dataset and a picture.

    Example: `squealpipe branch 0.1pi 0.5pi --parameter belt_speed --to 1.5 --friction-law
    exponential --mu-static 0.6 --belt-speed 0.5 --damping1 0.02 --damping2 0.02`

    Args:
        alpha1: angle of spring 1 at the start.
        alpha2: angle of spring 2 at the start.
        parameter: a physical parameter, alpha1 or alpha2.
        to: value at which the branch ends; angles in rad.
        start: a file written by `squealpipe cycle`, a state x,y,vx,vy near the first cycle, or
            onset (the loss of stability of steady sliding); by default what a run from rest
            settles to.
        n_points: largest number of points.
        doubled: follow the branch that leaves at the first period doubling instead.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    picture = check_outputs(output, picture, force=force)
    found = compute(
        "cycle_branch", params, alpha1, alpha2, output=output, picture=picture,
        parameter=parameter.replace("-", "_"), to=to, start=_start(start),
        n_points=n_points, doubled=doubled,
    )  # fmt: skip
    from squealpipe.schema import REMEDIES, Outcome

    end = Outcome(int(found.end))
    why = f"{end.name} ({REMEDIES[end]})"
    if not found.sizes["point"]:
        answer(f"no point of a branch was found: {why}")
        return ANSWER_IS_NO
    values = found[parameter.replace("-", "_")]
    answer(
        f"{found.sizes['point']} points, {parameter} from {float(values[0]):.6g} to "
        f"{float(values[-1]):.6g}",
        *_special(found, values),
        f"the branch ends: {why}",
    )
    return DONE


def _start(text: str | None) -> Any:
    """A dataset, a state, or the word."""
    if text is None or text == "onset":
        return text
    if Path(text).is_file():
        from squealpipe.store import load

        return load(text)
    return parse_range(text)


def _special(found: xr.Dataset, values: xr.DataArray) -> Iterator[str]:
    from squealpipe.schema import labels

    for word, value in zip(labels(found.label).values, values.values, strict=True):
        if word not in {"regular", "end"}:
            yield f"{word} at {values.name} = {value:.9g}"
