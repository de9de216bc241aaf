"""``squealpipe sweep``: any task over ranges, to one dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import BASELINE, Angle, Output, Physical
from squealpipe.cli.exit_codes import DONE
from squealpipe.ranges import read_fixed, read_values, sweep_config


def sweep(
    task: str,
    /,
    *,
    vary: Annotated[list[str], Parameter(metavar="NAME=RANGE", negative="")],
    alpha1: Angle | None = None,
    alpha2: Angle | None = None,
    option: Annotated[list[str] | None, Parameter(metavar="NAME=VALUE", negative="")] = None,
    workers: int | None = None,
    output: Output = Path("sweep.nc"),
    params: Physical = BASELINE,
) -> int:
    """Run a task at every combination of values; write one dataset with the names as dimensions.

    A sweep that was stopped goes on where it was when the same command is run again.

    Example: `squealpipe sweep periodic_orbit --alpha1 0.3pi --alpha2 0.9pi --option mode=1
    --vary y_peak=1.1:4:30 --vary mu=0.1,0.2,0.3 -o orbits.nc`

    Args:
        task: simulate, validity_map, hammering_map, quasi_static_map, stability_map,
            natural_frequencies, periodic_orbit or backbone.
        vary: a parameter, angle or option with its values: mu=0:0.6:13, alpha1=0:pi:31,
            belt_speed=0.1:100:7:log or k3=0.5,0.75; repeat for further dimensions.
        alpha1: angle of spring 1 where it is not varied.
        alpha2: angle of spring 2 where it is not varied.
        option: a further keyword of the task, for instance t_end=100; repeat for more.
        workers: processes; all cores by default.
        output: NetCDF file to write.
    """
    from squealpipe.sources import closure
    from squealpipe.store import produce
    from squealpipe.store.chunks import Checkpoint
    from squealpipe.tasks import sweep as sweeping

    fixed = {name: read_fixed(name, value) for name, value in map(_pair, option or [])}
    fixed |= {
        name: value for name, value in (("alpha1", alpha1), ("alpha2", alpha2)) if value is not None
    }
    config = sweep_config(
        task=task,
        vary={name: read_values(name, text) for name, text in map(_pair, vary)},
        fixed=fixed,
        parameters=params.as_dict(),
    )
    plan = sweeping.planned(config)
    print(f"{len(plan.points)} runs of {task} over {', '.join(plan.names)}")
    kept = Checkpoint.beside(output, config=config, sources=closure(sweeping.__file__))
    with kept, sweeping.executor(workers) as pool:
        produce(
            lambda: sweeping.run_sweep(plan, executor=pool, checkpoint=kept),
            config=config,
            output=output,
        )
    print(f"wrote {output}")
    return DONE


def _pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise ValueError(f"{text!r} is no NAME=VALUE; write for instance mu=0:0.6:13")
    return name.strip().replace("-", "_"), value
