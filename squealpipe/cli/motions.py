"""``simulate``, ``backbone``, ``cycle`` and ``branch``: single motions and families of them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    Angle1,
    Angle2,
    Drawn,
    Length,
    Output,
    Speed,
    State,
    Switch,
    Time,
    Tolerance,
    Whole,
    drawn_output,
    parse_state,
)
from squealpipe.cli.console import ExitCodes, answer
from squealpipe.cli.output import compute, ending, refuse_existing
from squealpipe.cli.signatures import options_of
from squealpipe.inputs import reader

if TYPE_CHECKING:
    import xarray as xr

Model = Annotated[
    Literal[
        "A1",
        "A1-no-stick",
        "A1-no-separation",
        "A1-linear-springs",
        "A1-as-printed",
        "A4",
    ],
    Parameter(help="level of the model."),
]


@options_of("simulate")
def simulate(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    t_end: Time | None = None,
    model: Model,
    tol: Tolerance,
    points: Whole | None = None,
    x0: Length = 0.0,
    y0: Length = 0.0,
    vx0: Speed = 0.0,
    vy0: Speed = 0.0,
    output: Output = Path("run.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Integrate one configuration, from rest unless given otherwise; write a dataset and a picture.

    Example: `squealpipe simulate 5pi/6 5pi/6 --t-end 100 --mu 0.2 -o hammering.nc`

    Args:
        t_end: horizon, s; 50 √(mass/k1) by default.
        points: instants at which the state is kept; by default enough for the fastest oscillation.
        x0: displacement along the belt at the start.
        y0: displacement away from the belt at the start.
        vx0: speed along the belt at the start.
        vy0: speed away from the belt at the start.
    """
    if points is not None and points < 16:
        raise ValueError(
            f"--points {points} is too few to show a motion; give 16 or more"
        )
    t_end = 50.0 * brake.params.time_unit if t_end is None else t_end
    if not 0 < t_end < float("inf"):
        raise ValueError(f"--t-end {t_end!r} must be greater than 0 and finite")

    refuse_existing(output, force=brake.force)

    import numpy as np

    from squealpipe.brake.dynamics.summary import summarize, summary_lines
    from squealpipe.brake.sampling import default_times, unresolved
    from squealpipe.vibration.spectrum import FEWEST

    times = (
        np.linspace(0.0, t_end, points)
        if points
        else default_times(brake.params, t_end)
    )
    run = compute(
        "simulate",
        brake,
        alpha1,
        alpha2,
        output=output,
        t_end=t_end,
        model=model,
        tol=tol,
        times=times,
        initial_state=[x0, y0, vx0, vy0],
    )
    if np.isfinite(run.x).sum() >= FEWEST:
        answer(*summary_lines(run, summarize(run)))
        if missed := unresolved(brake.params, times):
            answer(f"note: {missed}")
    outcome, why = ending(run.outcome)
    if outcome == "converged":
        return ExitCodes.done
    answer(f"the run ended early: {why}")
    return ExitCodes.answer_is_no


@options_of("backbone")
def backbone(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    mode: Literal[1, 2] = 1,
    method: Literal["exact", "hbm"],
    y_peak_max: Length | None,
    x_amplitude_max: Length | None,
    n_harmonics: Whole,
    output: Output = Path("backbone.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Follow a family of free periodic motions of model A4; write a dataset and a picture.

    Example: `squealpipe backbone 0.3pi 0.9pi --mode 1 --method hbm --n-harmonics 32`

    Args:
        mode: mode, by ascending frequency in contact.
        method: exact orbits, or harmonic balance judged by them.
        y_peak_max: largest y at the symmetric instant; 3 preload lengths by default.
        x_amplitude_max: largest x amplitude of an isolated x mode; 3 preload lengths by default.
        n_harmonics: harmonics kept by harmonic balance.
    """
    branch = compute(
        "backbone",
        brake,
        alpha1,
        alpha2,
        output=output,
        mode=mode,
        method=method,
        y_peak_max=y_peak_max,
        x_amplitude_max=x_amplitude_max,
        n_harmonics=n_harmonics if method == "hbm" else None,
    )
    _, why = ending(branch.end)
    if not branch.sizes["point"]:
        answer(
            f"mode {mode} has no periodic motions here: {why}; try other angles or parameters"
        )
        return ExitCodes.answer_is_no
    answer(
        f"mode {mode}: {branch.sizes['point']} points, ω from {float(branch.omega[0]):.6g} "
        f"to {float(branch.omega[-1]):.6g} rad/s",
        f"the branch ends: {why}",
    )
    return ExitCodes.done


@options_of("limit_cycle")
def cycle(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    guess: State,
    t_settle: Time | None,
    output: Output = Path("cycle.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Find a periodic motion of A1, its events and its stability; write a dataset and a picture.

    Example: `squealpipe cycle 0.1pi 0.5pi --friction-law exponential --mu-static 0.6
    --belt-speed 0.5 --damping1 0.02 --damping2 0.02`

    Args:
        guess: state x,y,vx,vy near the cycle, which may be unstable; by default what a run from
            rest settles to.
        t_settle: after which that run counts as settled, s; 2000 √(mass/min(k1, k2)) by default.
    """
    orbit = compute(
        "limit_cycle",
        brake,
        alpha1,
        alpha2,
        output=output,
        guess=guess,
        t_settle=t_settle,
    )
    outcome, why = ending(orbit.outcome)
    if outcome not in {"converged", "family_member"}:
        answer(f"no periodic motion was found: {why}")
        return ExitCodes.answer_is_no
    answer(
        f"period {float(orbit.period):.9g} s, {'stable' if orbit.stable == 1 else 'not stable'}, "
        f"{orbit.sizes['event']} events",
        f"x from {float(orbit.x_min):.6g} to {float(orbit.x_max):.6g} m, "
        f"y from {float(orbit.y_min):.6g} to {float(orbit.y_max):.6g} m",
        f"in contact for {float(orbit.contact_fraction):.1%} of it, in stick for "
        f"{float(orbit.stick_fraction):.1%}",
    )
    if outcome == "family_member":
        answer(f"note: {why}")
    return ExitCodes.done


@options_of("cycle_branch")
def branch(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    parameter: str,
    to: str,
    start: str | None,
    n_points: Whole,
    doubled: Switch,
    output: Output = Path("branch.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Follow periodic motions of A1 in a parameter, stable or not; write a dataset and a picture.

    Example: `squealpipe branch 0.1pi 0.5pi --parameter belt_speed --to 1.5 --friction-law
    exponential --mu-static 0.6 --belt-speed 0.5 --damping1 0.02 --damping2 0.02`

    Args:
        parameter: a physical parameter, alpha1 or alpha2.
        to: value at which the branch ends, written like the parameter's option.
        start: a file written by `squealpipe cycle`, a state x,y,vx,vy near the first cycle, or
            onset (the loss of stability of steady sliding); by default what a run from rest
            settles to.
        n_points: largest number of points.
        doubled: follow the branch that leaves at the first period doubling instead.
    """
    name = parameter.replace("-", "_")
    cycles = compute(
        "cycle_branch",
        brake,
        alpha1,
        alpha2,
        output=output,
        parameter=name,
        to=reader(name)(to),
        start=_start(start),
        n_points=n_points,
        doubled=doubled,
    )
    _, why = ending(cycles.end)
    if not cycles.sizes["point"]:
        answer(f"no point of a branch was found: {why}")
        return ExitCodes.answer_is_no
    values = cycles[name]
    answer(
        f"{cycles.sizes['point']} points, {parameter} from {float(values[0]):.6g} to "
        f"{float(values[-1]):.6g}",
        *_special(cycles, values),
        f"the branch ends: {why}",
    )
    return ExitCodes.done


def _start(text: str | None) -> Any:
    """A dataset, a state, or the word."""
    if text is None or text == "onset":
        return text
    if Path(text).is_file():
        from squealpipe.store import load

        return load(text)
    return parse_state(text)


def _special(found: xr.Dataset, values: xr.DataArray) -> Iterator[str]:
    from squealpipe.schema import labels

    for word, value in zip(labels(found.label).values, values.values, strict=True):
        if word not in {"regular", "end"}:
            yield f"{word} at {values.name} = {value:.9g}"
