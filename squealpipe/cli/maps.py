"""``squealpipe map``: one quantity over both spring angles, as NetCDF and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from squealpipe.cli.arguments import (
    BASELINE,
    FULL_RANGE,
    AngleRange,
    Output,
    Physical,
    Picture,
    picture_beside,
)
from squealpipe.cli.exit_codes import DONE

Kind = Literal["validity", "hammering", "quasi-static", "stability", "frequencies"]


def map_angles(
    kind: Kind,
    /,
    *,
    alpha1: AngleRange = FULL_RANGE,
    alpha2: AngleRange = FULL_RANGE,
    t_end: float = 200.0,
    tol: float = 1e-12,
    output: Output = Path("map.nc"),
    picture: Picture = None,
    params: Physical = BASELINE,
) -> int:
    """Compute a map over both spring angles; write NetCDF and a picture.

    Example: `squealpipe map validity --alpha1 0:pi:91 --alpha2 0:pi:91 --mu 0.2 -o validity.nc`

    Args:
        kind: what to map.
        alpha1: angles of spring 1, first:last:count or a list.
        alpha2: angles of spring 2.
        t_end: horizon of validity and hammering maps.
        tol: tolerance of their integration.
        output: NetCDF file to write.
        picture: picture to write; by default beside the output.
    """
    from squealpipe.figures.angle_map import SHOWN, draw
    from squealpipe.figures.style import save_figure
    from squealpipe.store import load, produce
    from squealpipe.tasks.catalogue import run_task

    if min(len(alpha1), len(alpha2)) < 2:
        raise ValueError("a map needs 2 or more angles of each spring; write for instance 0:pi:61")
    name = {"frequencies": "natural_frequencies"}.get(kind, f"{kind.replace('-', '_')}_map")
    options = {"t_end": t_end, "tol": tol} if kind in {"validity", "hammering"} else {}
    picture = picture_beside(output, picture)
    config = {"parameters": params.as_dict(), "alpha1": alpha1, "alpha2": alpha2, **options}
    produce(lambda: run_task(name, params, alpha1, alpha2, **options), config=config, output=output)
    dataset = load(output)
    save_figure(draw(dataset), [picture])
    for line in SHOWN[str(dataset.attrs["schema"])].counts(dataset):
        print(line)
    print(f"wrote {output} and {picture}")
    return DONE
