"""``squealpipe choose`` and ``squealpipe infer``: which model, and which parameters."""

from pathlib import Path
from typing import Literal

from squealpipe.cli.arguments import (
    BRAKE,
    WRITTEN,
    Angle1,
    Angle2,
    Brake,
    Numbers,
    Output,
    Time,
    Tolerance,
    Whole,
    Workers,
    Written,
)
from squealpipe.cli.console import DONE, answer, working
from squealpipe.cli.output import compute
from squealpipe.cli.signatures import options_of

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
    from squealpipe.schema.ladder import Level

    with working("choose"):
        found = choose_model(brake.params, alpha1, alpha2, question, t_end=t_end)
    value = (
        f"{found.value:.6g}"
        if question != "contact_lost"
        else ("no", "yes")[int(found.value)]
    )
    answer(
        f"{question.replace('_', ' ')}: {value}",
        f"by {Level[found.model].label}: {found.reason}",
    )
    return DONE


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
    brake: Written = WRITTEN,
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
    """
    found = compute(
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
        found.reading.values, found.feasible_count.values, strict=True
    ):
        answer(f"{name}: {count} of {samples} sets meet every statement")
    return DONE
