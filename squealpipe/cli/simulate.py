"""``squealpipe simulate``: one configuration, as text, a dataset and a picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Literal

from squealpipe.cli.arguments import (
    BASELINE,
    Angle,
    Configs,
    Output,
    Physical,
    Picture,
    Switch,
    Whole,
)
from squealpipe.cli.console import answer, say, working
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE
from squealpipe.cli.output import check_outputs, write

Model = Literal["A1", "A1-no-stick", "A1-no-separation", "A1-linear-springs", "A1-as-printed", "A4"]


def simulate(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    t_end: float | None = None,
    model: Model = "A1",
    tol: float = 1e-12,
    points: Whole | None = None,
    x0: float = 0.0,
    y0: float = 0.0,
    vx0: float = 0.0,
    vy0: float = 0.0,
    output: Output = Path("run.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Integrate one configuration, from rest unless given otherwise; write a dataset and a picture.

    Example: `squealpipe simulate 5pi/6 5pi/6 --t-end 100 --mu 0.2 -o hammering.nc`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        t_end: horizon, s; 50 √(mass/k1) by default.
        model: level of the model.
        tol: tolerance of the integration.
        points: instants at which the state is kept; by default enough for the fastest oscillation.
        x0: displacement along the belt at the start.
        y0: displacement away from the belt at the start.
        vx0: speed along the belt at the start.
        vy0: speed away from the belt at the start.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write (png, svg or pdf); by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    if points is not None and points < 16:
        raise ValueError(f"--points {points} is too few to show a motion; give 16 or more")
    t_end = 50.0 * params.time_unit if t_end is None else t_end
    if not (t_end > 0 and math.isfinite(t_end)):
        raise ValueError(f"--t-end {t_end!r} must be greater than 0 and finite")
    picture = check_outputs(output, picture, force=force)

    import numpy as np

    from squealpipe.methods.spectrum import FEWEST
    from squealpipe.plotting import picture as draw
    from squealpipe.plotting.style import save_figure
    from squealpipe.schema import REMEDIES, Outcome
    from squealpipe.tasks.dynamics.runs import simulate as task
    from squealpipe.tasks.dynamics.summary import summarize, summary_lines
    from squealpipe.tasks.sampling import default_times, unresolved

    options: dict[str, Any] = {"t_end": t_end, "model": model, "tol": tol}
    if any((x0, y0, vx0, vy0)):
        options["initial_state"] = [x0, y0, vx0, vy0]
    settings = {"parameters": params.as_dict(), "alpha1": alpha1, "alpha2": alpha2, **options}
    times = default_times(params, t_end) if points is None else np.linspace(0.0, t_end, points)
    with working("simulation"):
        run = write(
            lambda: task(params, alpha1, alpha2, times=times, **options),
            output,
            config={**settings, "points": times.size},
        )
    outcome = Outcome(int(run.outcome))
    early = f"the run ended early: {outcome.name} ({REMEDIES[outcome]})"
    if outcome is not Outcome.converged and np.isfinite(run.x).sum() < FEWEST:
        answer(early)
        say(f"wrote {output}, too short for a picture")
        return ANSWER_IS_NO
    summary = summarize(run)
    answer(*summary_lines(run, summary))
    if missed := unresolved(params, times):
        answer(f"note: {missed}")
    save_figure(draw(run), [picture])
    say(f"wrote {output} and {picture}")
    if outcome is Outcome.converged:
        return DONE
    answer(early)
    return ANSWER_IS_NO
