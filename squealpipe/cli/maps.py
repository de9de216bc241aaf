"""``squealpipe map``: one quantity over both spring angles, as a dataset and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

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
from squealpipe.cli.console import answer
from squealpipe.cli.exit_codes import DONE
from squealpipe.cli.output import check_outputs, compute
from squealpipe.parameters import HORIZON

Kind = Literal[
    "validity", "hammering", "quasi-static", "stability", "critical-friction", "frequencies"
]
TIMED = ("validity", "hammering")
"""Maps that take a horizon."""


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
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Compute a map over both spring angles; write a dataset and a picture.

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
        config: study whose parameters are used where none are typed; repeatable.
    """
    if min(len(alpha1), len(alpha2)) < 2:
        raise ValueError("a map needs 2 or more angles of each spring; write for instance 0:pi:31")
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    name = {"frequencies": "natural_frequencies"}.get(kind, f"{kind.replace('-', '_')}_map")
    options: dict[str, Any] = {"t_end": t_end, "tol": tol} if kind in TIMED else {}
    picture = check_outputs(output, picture, force=force)

    found = compute(name, params, alpha1, alpha2, output=output, picture=picture, **options)
    from squealpipe.plotting.quantities import counts

    answer(*counts(found))
    return DONE
