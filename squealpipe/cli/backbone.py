"""``squealpipe backbone``: a family of free periodic motions, as NetCDF and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from squealpipe.cli.arguments import BASELINE, Angle, Output, Physical, Picture, picture_beside
from squealpipe.cli.exit_codes import DONE


def backbone(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    mode: Literal[1, 2] = 1,
    method: Literal["exact", "hbm"] = "exact",
    y_peak_max: float | None = None,
    x_amplitude_max: float | None = None,
    n_harmonics: int = 16,
    output: Output = Path("backbone.nc"),
    picture: Picture = None,
    params: Physical = BASELINE,
) -> int:
    """Follow a family of free periodic motions of model A4; write NetCDF and a picture.

    Example: `squealpipe backbone 0.3pi 0.9pi --mode 1 --method hbm --n-harmonics 32`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        mode: mode, by ascending frequency in contact.
        method: exact orbits, or harmonic balance judged by them.
        y_peak_max: largest y at the symmetric instant; 3 preload lengths by default.
        x_amplitude_max: largest x amplitude of an isolated x mode; 3 preload lengths by default.
        n_harmonics: harmonics kept by harmonic balance.
        output: NetCDF file to write.
        picture: picture to write; by default beside the output.
    """
    from squealpipe.figures.branch import draw
    from squealpipe.figures.style import save_figure
    from squealpipe.schema import REMEDIES, Outcome
    from squealpipe.store import load, produce
    from squealpipe.tasks.backbones import backbone as task

    options: dict[str, Any] = {
        "mode": mode,
        "method": method,
        "y_peak_max": 3 * params.preload if y_peak_max is None else y_peak_max,
        "x_amplitude_max": 3 * params.preload if x_amplitude_max is None else x_amplitude_max,
        **({"n_harmonics": n_harmonics} if method == "hbm" else {}),
    }
    picture = picture_beside(output, picture)
    config = {"parameters": params.as_dict(), "alpha1": alpha1, "alpha2": alpha2, **options}
    produce(lambda: task(params, alpha1, alpha2, **options), config=config, output=output)
    branch = load(output)
    save_figure(draw(branch, preload=params.preload), [picture])
    end = Outcome(int(branch.end))
    print(
        f"mode {mode}: {branch.sizes['point']} points, ω from {float(branch.omega[0]):.6g} "
        f"to {float(branch.omega[-1]):.6g} rad/s"
    )
    print(f"the branch ends: {end.name} ({REMEDIES[end]})")
    print(f"wrote {output} and {picture}")
    return DONE
