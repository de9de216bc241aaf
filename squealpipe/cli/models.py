"""``choose``, ``infer`` and ``propensity``: which model, which parameters, and their scatter."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    Angle1,
    Angle1OrFile,
    Angle2,
    BandOfRuns,
    Brake,
    Drawn,
    ModesOfRuns,
    Numbers,
    OptionalAngle2,
    Output,
    Share,
    Time,
    Tolerance,
    Whole,
    Workers,
    Written,
    default_brake,
    drawn_output,
    pairs_of,
    parse_share,
    written_output,
)
from squealpipe.cli.console import ExitCodes, answer, current_session, working
from squealpipe.cli.output import compute
from squealpipe.cli.signatures import options_of
from squealpipe.cli.structures import (
    as_asked,
    compute_of_structure,
    refuse_angles_and_parameters,
)
from squealpipe.codes import flag_words
from squealpipe.inputs import parse_number, reader
from squealpipe.parameters import HORIZON

if TYPE_CHECKING:
    import xarray as xr

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
    brake: Brake = default_brake,
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
    return ExitCodes.done


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
    brake: Written = written_output,
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
    return ExitCodes.done


@options_of("propensity")
def propensity(
    alpha1_or_file: Angle1OrFile,
    alpha2: OptionalAngle2 = None,
    /,
    *,
    distribution: Annotated[
        list[str] | None, Parameter(metavar="NAME=KIND:LOW:HIGH", negative="")
    ] = None,
    relative_std: Annotated[
        list[str] | None, Parameter(metavar="NAME=SHARE", negative="")
    ] = None,
    samples: Whole | None = None,
    t_end: Time | None = None,
    spring_correlation: Share,
    seed: Whole | None,
    tol: Tolerance,
    n_modes: ModesOfRuns = None,
    frequency_max: BandOfRuns = None,
    workers: Workers = None,
    output: Output = Path("propensity.nc"),
    brake: Drawn = drawn_output,
) -> int:
    """Compute shares of verdicts over scattered parameters, and which parameter decides most.

    Of a pad, given by both angles, it tells how often flutter, contact loss, irregular hammering
    and whirl occur; of a structure, given by its file, how often it is quiet, squeals or hammers.

    Example: `squealpipe propensity 0.07pi 0.305pi --distribution mu=uniform:0.1:0.9
    --distribution k1=normal:1:0.05 -o propensity.nc`

    Args:
        distribution: distribution of a parameter or angle of a pad: uniform:low:high,
            normal:mean:std or lognormal:median:log_std; repeat for more.
        relative_std: of a structure, standard deviation of a parameter over its value: mu=0.1,
            contact_stiffness_lining=20%; repeat for more. Parameters are mu, contact_stiffness and
            preload, each also of a face or contact, modal_damping and belt_speed.
        samples: size of the sample, a power of 2; 1024 for a pad, 256 for a structure.
        t_end: end of each run of a pad, s; 200 √(mass/k1) by default.
        spring_correlation: correlation of k1 and k2 of a pad; with it there are no Sobol indices.
        seed: seed of the random sample; 1 for a pad, 0 for a structure by default.
    """
    of_structure = {
        "--relative-std": relative_std,
        "--n-modes": n_modes,
        "--frequency-max": frequency_max,
    }
    of_pad = {
        "--distribution": distribution,
        "--t-end": t_end,
        "--spring-correlation": spring_correlation or None,
    }
    is_file = isinstance(alpha1_or_file, Path)
    for name, value in (of_pad if is_file else of_structure).items():
        if value is not None:
            whose = "pads" if is_file else "structures"
            raise ValueError(f"{name}: only {whose} take this; leave it out")
    common = {"seed": seed, "tol": tol, "workers": workers}
    if isinstance(alpha1_or_file, Path):
        refuse_angles_and_parameters(alpha1_or_file, alpha2, brake.params)
        if relative_std is None:
            raise ValueError("--relative-std is missing; write for instance mu=0.1")
        spread = {
            name: parse_share(value)
            for name, value in pairs_of("--relative-std", relative_std).items()
        }
        modes = {"n_modes": n_modes, "frequency_max": frequency_max}
        options = {**modes, "relative_std": spread, "samples": samples, **common}

        def propensity(structure: Any, **options: Any) -> xr.Dataset:
            import squealpipe

            return squealpipe.propensity(as_asked(structure, options), **options)

        shares = compute_of_structure(
            propensity, alpha1_or_file, options, output, brake
        )
        _say_shares(shares, "verdict")
        return ExitCodes.done
    if alpha2 is None or distribution is None:
        raise ValueError(
            "a pad needs both angles and --distribution, like `squealpipe propensity 0.07pi "
            "0.305pi --distribution mu=uniform:0.1:0.9`; a structure is one file"
        )
    distributions = dict(map(_distribution, distribution))
    if len(distributions) < len(distribution):
        raise ValueError("--distribution: a duplicate name; keep one")
    for name in sorted(set(distributions) & current_session.typed):
        raise ValueError(f"{name} is both fixed and distributed; keep one")
    t_end = HORIZON * brake.params.time_unit if t_end is None else t_end
    shares = compute(
        "propensity",
        brake,
        alpha1_or_file,
        alpha2,
        output=output,
        distributions=distributions,
        samples=1024 if samples is None else samples,
        t_end=t_end,
        spring_correlation=spring_correlation,
        **common,
    )
    _say_shares(shares, "quantity")
    return ExitCodes.done


def _say_shares(shares: xr.Dataset, dim: str) -> None:
    """Print each share with its interval, and which parameter has the largest index."""
    for name in shares[dim].values:
        one = shares.sel({dim: name})
        share, low, high = (float(one[f"share{end}"]) for end in ("", "_low", "_high"))
        total = one.total_order
        decides = ""
        if dim == "verdict" and total.notnull().any():
            place = int(total.fillna(-1.0).argmax())
            decides = f"; most influential: {total.input.values[place]}"
        answer(
            f"{flag_words(str(name)):<20} {share:8.2%}  (95 %: {low:.2%} to {high:.2%})"
            f"{decides}"
        )


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
