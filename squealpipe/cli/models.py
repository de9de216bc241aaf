"""``squealpipe choose``, ``infer`` and ``refine``: which model, which parameters, where to look."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from squealpipe.cli.arguments import (
    BASELINE,
    Angle,
    Configs,
    Numbers,
    Output,
    Physical,
    Picture,
    Switch,
    Whole,
)
from squealpipe.cli.console import answer, working
from squealpipe.cli.exit_codes import DONE
from squealpipe.cli.output import check_output, check_outputs, compute
from squealpipe.cli.simulate import Model

Question = Literal["contact_lost", "frequency", "peak_contact_force", "max_displacement"]


def choose(
    alpha1: Angle,
    alpha2: Angle,
    question: Question,
    /,
    *,
    t_end: float | None = None,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Print the cheapest model that answers a question as A1 does, its answer and the reason.

    Example: `squealpipe choose 0.75pi 0.75pi contact_lost`

    Args:
        alpha1: angle of spring 1: 0.4pi, 2pi/5, 72deg or radians.
        alpha2: angle of spring 2.
        question: what is asked.
        t_end: horizon, s; 200 √(mass/k1) by default.
        config: study whose parameters are used where none are typed; repeatable.
    """
    from squealpipe import choose_model
    from squealpipe.schema.ladder import Level

    with working("choose"):
        found = choose_model(params, alpha1, alpha2, question, t_end=t_end)
    answer(
        f"{question.replace('_', ' ')}: {found.value:.6g}",
        f"by {Level[found.model].label}: {found.reason}",
    )
    return DONE


def infer(
    *,
    samples: Whole = 1024,
    reading: Literal["as_printed", "along_plus_x", "along_minus_x"] = "as_printed",
    kappa: Numbers = None,
    mu_range: Numbers = None,
    length_ratio: Numbers = None,
    speed_ratio: Numbers = None,
    seed: Whole = 2021,
    tol: float = 1e-9,
    workers: Whole | None = None,
    output: Output = Path("inference.nc"),
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Judge parameter sets by the paper's statements, in each reading of the sign of friction.

    Example: `squealpipe infer --samples 256 --kappa 0.5,0.8 -o inference.nc`

    Args:
        samples: number of parameter sets.
        reading: the study's reading.
        kappa: range of k3/k, LOW,HIGH.
        mu_range: range of the friction coefficient, LOW,HIGH.
        length_ratio: range of L/l_pre, LOW,HIGH.
        speed_ratio: range of the belt speed over l_pre √(k/m), LOW,HIGH.
        seed: of the sample.
        tol: tolerance of the integration.
        workers: processes; all cores by default.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        force: overwrite a file that exists.
        config: study whose parameters are used where none are typed; repeatable.
    """
    check_output(output, force=force)
    found = compute(
        "infer_parameters", params, output=output, picture=None, drawn=False,
        samples=samples, reading=reading, kappa=kappa, mu=mu_range, length_ratio=length_ratio,
        speed_ratio=speed_ratio, seed=seed, tol=tol, workers=workers,
    )  # fmt: skip
    for name, count in zip(found.reading.values, found.feasible_count.values, strict=True):
        answer(f"{name}: {count} of {samples} sets meet every statement")
    return DONE


def refine(
    *,
    resolution: Whole = 361,
    coarse: Whole = 46,
    t_end: float | None = None,
    model: Model = "A1",
    tol: float = 1e-12,
    workers: Whole | None = None,
    output: Output = Path("refined.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Map where contact is kept at high resolution, running the boundaries alone.

    Example: `squealpipe refine --resolution 181 --coarse 46 --t-end 50 -o refined.nc`

    Args:
        resolution: points per side of the finest grid; one less is 2^n (coarse - 1).
        coarse: points per side of the first grid.
        t_end: end of each run, s; 200 √(mass/k1) by default.
        model: level of the model.
        tol: tolerance of the integration.
        workers: processes; all cores by default.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    picture = check_outputs(output, picture, force=force)
    found = compute(
        "refine_validity_map", params, output=output, picture=picture,
        resolution=resolution, coarse=coarse, t_end=t_end, model=model, tol=tol, workers=workers,
    )  # fmt: skip
    low, high = found.inherited_error_interval.values
    answer(
        f"contact is lost in {int(found.separates.sum())} of {found.separates.size} cells",
        f"{int(found.computed.sum())} cells were run; of the others {float(low):.2%} to "
        f"{float(high):.2%} are wrong (95 %)",
    )
    return DONE
