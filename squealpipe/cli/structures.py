"""``squealpipe modes``, ``squeal``, ``ladder``: modes of a structure, and which of them squeal."""

from pathlib import Path
from typing import Any

from squealpipe.cli.arguments import (
    LOOK,
    Force,
    Frequency,
    Look,
    Numbers,
    Output,
    Picture,
    Ranges,
    Speeds,
    Switch,
    Time,
    Tolerance,
    Whole,
    pairs_of,
)
from squealpipe.cli.console import ANSWER_IS_NO, DONE, answer, say, working
from squealpipe.cli.output import check_output, check_picture, draw_beside, write
from squealpipe.cli.signatures import options_of
from squealpipe.config.ranges import parse_range

LISTED = 20
"""Unstable modes that are printed."""


def modes(
    file: Path,
    /,
    *,
    mu: Numbers = None,
    belt_speed: Speeds = None,
    frequency_max: Frequency = None,
    n_modes: Whole | None = None,
    vary: Ranges | None = None,
    output: Output = Path("modes.nc"),
    picture: Picture = None,
    look: Look = LOOK,
    force: Force = False,
) -> int:
    """Compute complex modes of a structure; write a dataset and a picture.

    Example: `squealpipe modes pad.yaml --mu 0:0.8:81 -o modes.nc`

    Args:
        file: structure, a YAML file that names its matrices and contacts (see the gallery).
        mu: friction, a number or first:last:count; that of the file by default.
        belt_speed: likewise, m/s.
        frequency_max: modes up to there, Hz.
        n_modes: so many modes; this or the other limit is needed beyond 1000 degrees of freedom.
        vary: a further factor with its value or values; repeat for more. preload=0.5:2:7 and
            contact_stiffness=0.5,1,2 multiply those of all contacts, p1_preload and p1_stiffness
            those of a contact p1, mass, damping and stiffness the matrices; modal_damping,
            mu_static and friction_speed replace those of the file.
    """
    check_output(output, force=force)
    drawn = check_picture(picture, output, force=force)

    from squealpipe import Structure

    structure = Structure.read(file)
    asked: dict[str, Any] = {
        "mu": _one_or_more(mu),
        "belt_speed": _one_or_more(belt_speed),
        "frequency_max": frequency_max,
        "n_modes": n_modes,
    }
    for name, text in pairs_of("--vary", vary or []).items():
        if name in asked:
            option = name.replace("_", "-")
            raise ValueError(f"--vary {name}: write --{option} {text} instead")
        asked[name] = _one_or_more(parse_range(text))
    options = {name: value for name, value in asked.items() if value is not None}
    with working("complex modes"):
        dataset = write(
            lambda: structure.complex_modes(**options),
            output,
            config={"parameters": structure.as_dict(), **options},
        )
    draw_beside(dataset, output, drawn, look)
    unstable = dataset.unstable
    ever = unstable.any([dim for dim in unstable.dims if dim != "mode"])
    answer(f"{int(ever.sum())} of {ever.size} modes are unstable somewhere")
    for number in dataset.mode.values[ever.values][:LISTED]:
        answer(_line(dataset.sel(mode=number)))
    say(f"wrote {output} and {drawn}")
    return DONE


def _one_or_more(values: list[float] | None) -> Any:
    return values[0] if values is not None and len(values) == 1 else values


def _line(mode: Any) -> str:
    """A mode where it grows fastest, and its critical friction."""
    fastest = mode.growth_rate.where(mode.unstable).argmax(...)
    at = mode.isel(fastest)
    critical = at.critical_mu.item()
    onset = f", from mu = {critical:.6g} on" if critical == critical else ""
    return (
        f"mode {int(mode.mode)}: {at.frequency.item():.6g} Hz, growth rate "
        f"{at.growth_rate.item():.6g} 1/s at mu = {at.mu.item():g}{onset}"
    )


@options_of("squealing_modes")
def squeal(
    file: Path,
    /,
    *,
    samples: Whole,
    seed: Whole,
    t_end: Time | None,
    tol: Tolerance,
    n_modes: Whole | None = None,
    frequency_max: Frequency = None,
    onset: Switch,
    output: Output = Path("squeal.nc"),
    picture: Picture = None,
    look: Look = LOOK,
    force: Force = False,
) -> int:
    """Say which unstable modes of a structure squeal, how loud, and with how much contact loss.

    It is run from small pushes along its unstable modes and from random starts, with every loss of
    contact located, until the motions have settled. Exit code 0: quiet; 1: not quiet, or
    undetermined.

    Example: `squealpipe squeal pad.yaml -o squeal.nc`

    Args:
        file: structure, a YAML file that names its matrices and contacts (see the gallery).
        samples: random starts, of at most the energy that the preload stores.
        seed: number that the random starts follow from.
        t_end: longest time of a run, s; by default 8000 periods of the slowest unstable mode,
            after the time in which it grows.
        n_modes: modes to reduce the structure to; by default as many as errors below 1 % need,
            and no reduction up to 32 degrees of freedom.
        frequency_max: reduce to the modes that the unstable ones up to this frequency need, Hz;
            needed beyond 1000 degrees of freedom.
        onset: also follow what squeals down in friction until it dies: whether squeal lasts below
            the critical friction, and how far; costs about as much as the rest.
    """
    check_output(output, force=force)
    drawn = check_picture(picture, output, force=force)

    from squealpipe import Structure, squealing_modes
    from squealpipe.study.report.squealing import lines

    structure = Structure.read(file)
    chosen = {"n_modes": n_modes, "frequency_max": frequency_max}
    limits: dict[str, Any] = {
        name: value for name, value in chosen.items() if value is not None
    }
    options: dict[str, Any] = {"samples": samples, "seed": seed, "tol": tol}
    if t_end is not None:
        options["t_end"] = t_end
    if onset:
        options["onset"] = True
    with working("squeal"):
        reduced = structure.reduce(**limits) if limits else structure
        dataset = write(
            lambda: squealing_modes(reduced, **options),
            output,
            config={"parameters": structure.as_dict(), **limits, **options},
        )
    draw_beside(dataset, output, drawn, look)
    answer(*lines(dataset))
    say(f"wrote {output} and {drawn}")
    return DONE if int(dataset.verdict) == 0 else ANSWER_IS_NO


@options_of("squeal_ladder")
def ladder(
    file: Path,
    /,
    *,
    pushes: Whole,
    t_end: Time | None,
    frequency_max: Frequency,
    tol: Tolerance,
    repeats: Whole,
    output: Output = Path("ladder.nc"),
    picture: Picture = None,
    look: Look = LOOK,
    force: Force = False,
) -> int:
    """Ask several methods which unstable modes of a structure squeal; chart accuracy and cost.

    Complex modes of the whole and the reduced structure, runs with every event located and runs
    with friction and contact smoothed are held against the finest run. Exit code 0: all agree with
    it; 1: some do not. It takes minutes.

    Example: `squealpipe ladder pad.yaml -o ladder.nc`

    Args:
        file: structure, a YAML file that names its matrices and contacts (see the gallery).
        pushes: unstable modes along which is pushed, the fastest first.
        t_end: time of each run, s; by default until the last of these has grown, and 200 periods of
            the unstable mode of lowest frequency.
        frequency_max: unstable modes up to there count, Hz; needed beyond 1000 degrees of freedom.
        repeats: of what is quick, for the median of its CPU time.
    """
    check_output(output, force=force)
    drawn = check_picture(picture, output, force=force)

    from squealpipe import Structure, squeal_ladder
    from squealpipe.schema.comparison import Reliability
    from squealpipe.study.report.squeal_ladder import lines

    structure = Structure.read(file)
    asked = {"t_end": t_end, "frequency_max": frequency_max}
    options: dict[str, Any] = {"pushes": pushes, "tol": tol, "repeats": repeats}
    options |= {name: value for name, value in asked.items() if value is not None}
    with working("ladder"):
        dataset = write(
            lambda: squeal_ladder(structure, **options),
            output,
            config={"parameters": structure.as_dict(), **options},
        )
    draw_beside(dataset, output, drawn, look)
    answer(*lines(dataset))
    say(f"wrote {output} and {drawn}")
    return DONE if (dataset.verdict == Reliability.right).all() else ANSWER_IS_NO
