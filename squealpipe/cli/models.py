"""``choose``, ``infer`` and ``propensity``: which model, which parameters, and their scatter."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    BRAKE,
    DRAWN,
    WRITTEN_OUTPUT,
    Angle1,
    Angle2,
    Brake,
    Drawn,
    Numbers,
    Output,
    Share,
    Time,
    Tolerance,
    Whole,
    Workers,
    Written,
)
from squealpipe.cli.console import EXIT, SESSION, answer, working
from squealpipe.cli.output import compute
from squealpipe.cli.signatures import options_of
from squealpipe.inputs import parse_number, reader
from squealpipe.parameters import HORIZON

Question = Literal[
    "contact_lost", "frequency", "peak_contact_force", "max_displacement"
]


@options_of("choose_model")
def choose(
    alpha1: Angle1,
    alpha2: Angle2,
    question: Question,
    /,
    *,
    t_end: Time | None,
    brake: Brake = BRAKE,
) -> int:
    """Print the cheapest model that answers a question as A1 does, its answer and the reason.

    Example: `squealpipe choose 0.75pi 0.75pi contact_lost`

    Args:
        question: what is asked.
        t_end: horizon, s; 200 √(mass/k1) by default.
    """
    from squealpipe import choose_model
    from squealpipe.brake.schema.ladder import Level

    with working("choose"):
        choice = choose_model(brake.params, alpha1, alpha2, question, t_end=t_end)
    value = (
        f"{choice.value:.6g}"
        if question != "contact_lost"
        else ("no", "yes")[int(choice.value)]
    )
    answer(
        f"{question.replace('_', ' ')}: {value}",
        f"by {Level[choice.model].label}: {choice.reason}",
    )
    return EXIT.done


@options_of("infer_parameters")
def infer(
    *,
    samples: Whole = 1024,
    reading: Literal["as_printed", "along_plus_x", "along_minus_x"],
    kappa: Numbers = None,
    mu_range: Numbers = None,
    length_ratio: Numbers = None,
    speed_ratio: Numbers = None,
    seed: Whole,
    tol: Tolerance,
    workers: Workers,
    output: Output = Path("inference.nc"),
    brake: Written = WRITTEN_OUTPUT,
) -> int:
    """Judge parameter sets by the paper's statements, in each reading of the sign of friction.

    Example: `squealpipe infer --samples 256 --kappa 0.5,0.8 -o inference.nc`

    Args:
        samples: number of parameter sets.
        reading: the study's reading of the sign of friction.
        kappa: range of k3/k, LOW,HIGH.
        mu_range: range of the friction coefficient, LOW,HIGH.
        length_ratio: range of L/l_pre, LOW,HIGH.
        speed_ratio: range of the belt speed over l_pre √(k/m), LOW,HIGH.
        seed: seed of the random sample.
    """
    inference = compute(
        "infer_parameters",
        brake,
        output=output,
        samples=samples,
        reading=reading,
        kappa=kappa,
        mu=mu_range,
        length_ratio=length_ratio,
        speed_ratio=speed_ratio,
        seed=seed,
        tol=tol,
        workers=workers,
    )
    for name, count in zip(
        inference.reading.values, inference.feasible_count.values, strict=True
    ):
        answer(f"{name}: {count} of {samples} sets meet every statement")
    return EXIT.done


@options_of("propensity")
def propensity(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    distribution: Annotated[
        list[str], Parameter(metavar="NAME=KIND:LOW:HIGH", negative="")
    ],
    samples: Whole = 1024,
    t_end: Time | None = None,
    spring_correlation: Share,
    seed: Whole,
    output: Output = Path("propensity.nc"),
    brake: Drawn = DRAWN,
) -> int:
    """Shares of flutter, contact loss, irregular hammering and whirl over uncertain parameters.

    Example: `squealpipe propensity 0.07pi 0.305pi --distribution mu=uniform:0.1:0.9
    --distribution k1=normal:1:0.05 -o propensity.nc`

    Args:
        distribution: distribution of a parameter or angle: uniform:low:high, normal:mean:std or
            lognormal:median:log_std; repeat for more.
        samples: size of the sample, a power of 2.
        t_end: end of each run, s; 200 √(mass/k1) by default.
        spring_correlation: correlation of k1 and k2; with it there are no Sobol indices.
        seed: seed of the random sample.
    """
    distributions = dict(map(_distribution, distribution))
    if len(distributions) < len(distribution):
        raise ValueError("--distribution: a duplicate name; keep one")
    for name in sorted(set(distributions) & SESSION.typed):
        raise ValueError(f"{name} is both fixed and distributed; keep one")
    t_end = HORIZON * brake.params.time_unit if t_end is None else t_end
    shares = compute(
        "propensity",
        brake,
        alpha1,
        alpha2,
        output=output,
        distributions=distributions,
        samples=samples,
        t_end=t_end,
        spring_correlation=spring_correlation,
        seed=seed,
    )
    for name in shares.quantity.values:
        one = shares.sel(quantity=name)
        share, low, high = (float(one[f"share{end}"]) for end in ("", "_low", "_high"))
        answer(
            f"{name.replace('_', ' '):<20} {share:8.2%}  (95 %: {low:.2%} to {high:.2%})"
        )
    return EXIT.done


def _distribution(text: str) -> tuple[str, dict[str, str | float]]:
    """Name and distribution of NAME=KIND:A:B."""
    from squealpipe.brake.propensity.distributions import DISTRIBUTIONS

    name, _, words = text.partition("=")
    name, parts = name.strip().replace("-", "_"), words.split(":")
    if len(parts) != 3 or parts[0] not in DISTRIBUTIONS:
        raise ValueError(
            f"--distribution {text!r} is not a distribution; write for instance "
            "mu=uniform:0.1:0.9, k1=normal:1:0.05 or k3=lognormal:0.65:0.1"
        )
    numbers = {
        key: (parse_number if key == "log_std" else reader(name))(text)
        for key, text in zip(DISTRIBUTIONS[parts[0]], parts[1:], strict=True)
    }
    return name, {"distribution": parts[0], **numbers}
