"""``squealpipe map``: one quantity over both spring angles, as a dataset and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from squealpipe.cli.arguments import (
    BASELINE,
    FULL_RANGE,
    AngleRange,
    Configs,
    Output,
    Physical,
    Picture,
    Switch,
)
from squealpipe.cli.console import answer, say
from squealpipe.cli.cost import SECONDS, TIMED, estimate
from squealpipe.cli.exit_codes import DONE
from squealpipe.cli.output import check_outputs, write
from squealpipe.parameters import HORIZON

Kind = Literal[
    "validity", "hammering", "quasi-static", "stability", "critical-friction", "frequencies"
]
SECONDS_PER_PART = 3.0
"""Work of one core between two words of progress, and what an interrupt loses."""


def map_angles(
    kind: Kind,
    /,
    *,
    alpha1: AngleRange = FULL_RANGE,
    alpha2: AngleRange = FULL_RANGE,
    t_end: float | None = None,
    tol: float = 1e-12,
    output: Output = Path("map.nc"),
    picture: Picture = None,
    force: Switch = False,
    yes: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Compute a map over both spring angles; write a dataset and a picture.

    A map that was stopped goes on where it was when the same command is run again.

    Example: `squealpipe map validity --alpha1 0:pi:91 --alpha2 0:pi:91 --mu 0.2 -o validity.nc`

    Args:
        kind: what to map.
        alpha1: angles of spring 1, first:last:count or a list.
        alpha2: angles of spring 2.
        t_end: horizon of validity and hammering maps, s; 200 √(mass/k1) by default.
        tol: tolerance of their integration.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        yes: go on though it takes long or much memory.
        config: study whose parameters are used where none are typed; repeatable.
    """
    if min(len(alpha1), len(alpha2)) < 2:
        raise ValueError("a map needs 2 or more angles of each spring; write for instance 0:pi:31")
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    name = {"frequencies": "natural_frequencies"}.get(kind, f"{kind.replace('-', '_')}_map")
    options = {"t_end": t_end, "tol": tol} if name in TIMED else {}
    picture = check_outputs(output, picture, force=force)
    estimate(name, params, options, runs=len(alpha1) * len(alpha2)).check(yes=yes)

    import numpy as np

    from squealpipe.execution import catalogue
    from squealpipe.execution.row_blocks import BLOCK, map_in_blocks
    from squealpipe.rerun.key import rule_key, sources
    from squealpipe.store.chunks import Checkpoint
    from squealpipe.study.figures.parts.angle_map import SHOWN, draw
    from squealpipe.study.figures.parts.style import save_figure

    settings = {"parameters": params.as_dict(), "alpha1": alpha1, "alpha2": alpha2, **options}
    each = SECONDS[name] * (t_end / params.time_unit if name in TIMED else 1.0)
    key = rule_key({"task": name, **settings}, sources(Path(catalogue.__file__)))
    kept = Checkpoint.beside(output, key=key)
    dataset = write(
        lambda: map_in_blocks(
            lambda rows: catalogue.run_task(name, params, rows, alpha2, **options),
            np.array(alpha1),
            len(alpha2),
            label=f"{kind} map",
            checkpoint=kept,
            block=int(min(BLOCK, max(SECONDS_PER_PART / each, 1.0))),
        ),
        output,
        config=settings,
        checkpoint=kept,
    )
    save_figure(draw(dataset), [picture])
    answer(*SHOWN[str(dataset.attrs["schema"])].counts(dataset))
    say(f"wrote {output} and {picture}")
    return DONE
