"""``squealpipe backbone``: a family of free periodic motions, as a dataset and a picture."""

from __future__ import annotations

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
from squealpipe.cli.console import answer
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE
from squealpipe.cli.output import check_outputs, compute


def backbone(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    mode: Literal[1, 2] = 1,
    method: Literal["exact", "hbm"] = "exact",
    y_peak_max: float | None = None,
    x_amplitude_max: float | None = None,
    n_harmonics: Whole = 16,
    output: Output = Path("backbone.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Follow a family of free periodic motions of model A4; write a dataset and a picture.

    Example: `squealpipe backbone 0.3pi 0.9pi --mode 1 --method hbm --n-harmonics 32`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        mode: mode, by ascending frequency in contact.
        method: exact orbits, or harmonic balance judged by them.
        y_peak_max: largest y at the symmetric instant; 3 preload lengths by default.
        x_amplitude_max: largest x amplitude of an isolated x mode; 3 preload lengths by default.
        n_harmonics: harmonics kept by harmonic balance.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    options: dict[str, Any] = {
        "mode": mode,
        "method": method,
        "y_peak_max": 3 * params.preload if y_peak_max is None else y_peak_max,
        "x_amplitude_max": 3 * params.preload if x_amplitude_max is None else x_amplitude_max,
        **({"n_harmonics": n_harmonics} if method == "hbm" else {}),
    }
    picture = check_outputs(output, picture, force=force)

    branch = compute("backbone", params, alpha1, alpha2, output=output, picture=picture, **options)
    from squealpipe.schema import REMEDIES, Outcome

    end = Outcome(int(branch.end))
    if not branch.sizes["point"]:
        answer(
            f"mode {mode} has no periodic motions here: {end.name} ({REMEDIES[end]}); "
            "try other angles or parameters"
        )
        return ANSWER_IS_NO
    answer(
        f"mode {mode}: {branch.sizes['point']} points, ω from {float(branch.omega[0]):.6g} "
        f"to {float(branch.omega[-1]):.6g} rad/s",
        f"the branch ends: {end.name} ({REMEDIES[end]})",
    )
    return DONE
