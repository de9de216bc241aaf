"""``squealpipe propensity``: how often instability occurs over uncertain parameters, and why."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

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
from squealpipe.cli.console import SESSION, answer
from squealpipe.cli.exit_codes import DONE
from squealpipe.cli.output import check_outputs, compute
from squealpipe.config.ranges import ANGLES, parse_angle, parse_number
from squealpipe.parameters import HORIZON

FORM = "write for instance mu=uniform:0.1:0.9, k1=normal:1:0.05 or k3=lognormal:0.65:0.1"


def propensity(
    alpha1: Angle,
    alpha2: Angle,
    /,
    *,
    spread: Annotated[list[str], Parameter(metavar="NAME=KIND:LOW:HIGH", negative="")],
    samples: Whole = 1024,
    t_end: float | None = None,
    spring_correlation: float = 0.0,
    seed: Whole = 1,
    output: Output = Path("propensity.nc"),
    picture: Picture = None,
    force: Switch = False,
    config: Configs = None,  # noqa: ARG001 (read by `parameters_from_study`)
    params: Physical = BASELINE,
) -> int:
    """Shares of flutter, contact loss, irregular hammering and whirl over uncertain parameters.

    Example: `squealpipe propensity 0.07pi 0.305pi --spread mu=uniform:0.1:0.9
    --spread k1=normal:1:0.05 -o propensity.nc`

    Args:
        alpha1: angle of spring 1 where it has no distribution.
        alpha2: angle of spring 2 where it has none.
        spread: a parameter or angle with its distribution: uniform:low:high, normal:mean:std or
            lognormal:median:log_std; repeat for more.
        samples: size of the sample, a power of 2.
        t_end: end of each run, s; 200 √(mass/k1) by default.
        spring_correlation: of k1 and k2; no Sobol indices are given with it.
        seed: of the sample.
        output: dataset to write: NetCDF (.nc) or CSV (.csv).
        picture: picture to write; by default beside the output.
        force: overwrite files that exist.
        config: study whose parameters are used where none are typed; repeatable.
    """
    distributions = dict(map(_distribution, spread))
    if len(distributions) < len(spread):
        raise ValueError("--spread: a duplicate name; keep one")
    for name in sorted(set(distributions) & SESSION.typed):
        raise ValueError(f"{name} is both fixed and spread; keep one")
    t_end = HORIZON * params.time_unit if t_end is None else t_end
    picture = check_outputs(output, picture, force=force)

    dataset = compute(
        "propensity", params, alpha1, alpha2, output=output, picture=picture,
        distributions=distributions, samples=samples, t_end=t_end,
        spring_correlation=spring_correlation, seed=seed,
    )  # fmt: skip
    answer(
        *(
            f"{str(name).replace('_', ' '):<20} {100 * share:6.2f} %  "
            f"(95 %: {100 * low:.2f} to {100 * high:.2f})"
            for name, share, low, high in zip(
                dataset.quantity.values, dataset.share.values, dataset.share_low.values,
                dataset.share_high.values, strict=True,
            )
        ),
    )  # fmt: skip
    return DONE


def _distribution(text: str) -> tuple[str, dict[str, str | float]]:
    """Name and distribution of NAME=KIND:A:B.

    Raises:
        ValueError: the text is none.
    """
    from squealpipe.tasks.propensity.distributions import KINDS

    name, _, words = text.partition("=")
    name, parts = name.strip().replace("-", "_"), words.split(":")
    if len(parts) != 3 or parts[0] not in KINDS:
        raise ValueError(f"--spread {text!r} is not a distribution; {FORM}")
    one = parse_angle if name in ANGLES else parse_number
    numbers = dict(zip(KINDS[parts[0]], map(one, parts[1:]), strict=True))
    return name, {"distribution": parts[0], **numbers}
