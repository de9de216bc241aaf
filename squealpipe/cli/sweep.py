"""``squealpipe sweep``: any task over ranges, to one dataset."""

import inspect
from math import prod
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    Angle1,
    Angle2,
    Output,
    Ranges,
    Workers,
    Written,
    pairs_of,
    written_output,
)
from squealpipe.cli.console import ExitCodes, answer, current_session, say, working
from squealpipe.cli.output import check_output, refuse_existing, write
from squealpipe.ranges import read_fixed, read_values, sweep_config


def sweep(
    task: str,
    /,
    *,
    vary: Ranges,
    alpha1: Angle1 | None = None,
    alpha2: Angle2 | None = None,
    option: Annotated[
        list[str] | None, Parameter(metavar="NAME=VALUE", negative="")
    ] = None,
    workers: Workers = None,
    output: Output = Path("sweep.nc"),
    brake: Written = written_output,
) -> int:
    """Run a task at every combination of values; write one dataset with the names as dimensions.

    Example: `squealpipe sweep periodic_orbit --alpha1 0.3pi --alpha2 0.9pi --option mode=1
    --vary y_peak=1.1:4:30 --vary mu=0.1,0.2,0.3 -o orbits.nc`

    Args:
        task: simulate, validity_map, hammering_map, quasi_static_map, stability_map,
            critical_friction_map, natural_frequencies, periodic_orbit, backbone,
            smallest_disturbance or assess; a system of your own as FILE.py:NAME; or the modes of
            a structure as FILE.yaml:complex_modes, or its noise over pressure, speed, mu or
            temperature as FILE.yaml:operating_map.
        vary: a parameter, angle or option, or a start of a system (x0), with its values:
            mu=0:0.6:13, alpha1=0:pi:31, belt_speed=0.1:100:7:log or k3=0.5,0.75; repeat for
            further dimensions.
        option: a further keyword of the task, for instance t_end=100; repeat for more.
    """
    refuse_existing(output, force=brake.force)

    from squealpipe.store.rerun.key import rule_key, sources
    from squealpipe.study.chunks import beside
    from squealpipe.study.sweep import outcome_lines, planned, run_sweep

    varied = pairs_of("--vary", vary)
    options = pairs_of("--option", option or [])
    angles = {
        name: v for name, v in (("alpha1", alpha1), ("alpha2", alpha2)) if v is not None
    }
    for name in sorted(
        set(varied) & (set(options) | set(angles) | current_session.typed)
    ):
        raise ValueError(f"{name} is both fixed and varied; keep one")
    settings = sweep_config(
        task=task,
        vary={name: read_values(name, text, task) for name, text in varied.items()},
        fixed={
            **{name: read_fixed(name, value, task) for name, value in options.items()},
            **angles,
        },
        parameters=brake.params.as_dict(),
    )
    plan = planned(settings)
    check_output(output, force=brake.force)
    runs = prod(len(plan.vary[name]) for name in plan.names)
    say(f"{runs} runs of {task} over {', '.join(plan.names)}")
    kept = beside(output, rule_key(settings, sources(Path(inspect.getfile(planned)))))
    if done := plan.finished(kept):
        say(f"{done} of them are already computed")
    again = "run the same command again"
    current_session.remedy = again  # runs that are finished are kept
    with working(f"sweep of {task}"):
        dataset = write(
            lambda: run_sweep(plan, workers=workers, kept=kept), output, config=settings
        )
    kept.remove()
    answer(*outcome_lines(dataset, plan.names))
    say(f"wrote {output}")
    return ExitCodes.done
