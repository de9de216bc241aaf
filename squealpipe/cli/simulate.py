"""``squealpipe simulate``: one configuration, as text, NetCDF and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from squealpipe.cli.arguments import BASELINE, Angle, Output, Physical, Picture, picture_beside
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE

Model = Literal["A1", "A1-no-stick", "A1-no-separation", "A1-linear-springs", "A4"]


def simulate(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    t_end: float = 50.0,
    model: Model = "A1",
    tol: float = 1e-12,
    points: int = 2001,
    output: Output = Path("run.nc"),
    picture: Picture = None,
    params: Physical = BASELINE,
) -> int:
    """Integrate one configuration from rest; print a summary, write NetCDF and a picture.

    Example: `squealpipe simulate 5pi/6 5pi/6 --t-end 100 --mu 0.2 -o hammering.nc`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        t_end: horizon; the unit of time is √(mass/k1) at the baseline.
        model: level of the model.
        tol: tolerance of the integration.
        points: instants at which the state is kept.
        output: NetCDF file to write.
        picture: picture to write (png, svg or pdf); by default beside the output.
    """
    import numpy as np

    from squealpipe.figures.run import draw
    from squealpipe.figures.style import save_figure
    from squealpipe.schema import REMEDIES, Outcome
    from squealpipe.store import produce
    from squealpipe.store.netcdf import load
    from squealpipe.tasks.dynamics import simulate as task
    from squealpipe.tasks.summary import summarize, summary_lines

    if points < 16:
        raise ValueError(f"--points {points} is too few to show a motion; give 16 or more")
    if not t_end > 0:
        raise ValueError(f"--t-end {t_end!r} must be greater than 0")
    times = np.linspace(0.0, t_end, points)
    picture = picture_beside(output, picture)
    config = {"parameters": params.as_dict(), "alpha1": alpha1, "alpha2": alpha2}
    options: dict[str, Any] = {"t_end": t_end, "model": model, "tol": tol}
    produce(
        lambda: task(params, alpha1, alpha2, times=times, **options),
        config={**config, **options, "points": points},
        output=output,
    )
    run = load(output)
    summary = summarize(run)
    for line in summary_lines(run, summary):
        print(line)
    save_figure(draw(run, summary), [picture])
    print(f"wrote {output} and {picture}")
    outcome = Outcome(int(run.outcome))
    if outcome is Outcome.converged:
        return DONE
    print(f"the run ended early: {outcome.name} ({REMEDIES[outcome]})")
    return ANSWER_IS_NO
