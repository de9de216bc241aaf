"""``squealpipe modes``, ``squeal``, ``ladder``: modes of a structure, and which of them squeal."""

from __future__ import annotations

import inspect
import math
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    BandOfRuns,
    Drawn,
    Files,
    Frequency,
    Frictions,
    ModesOfRuns,
    Output,
    Ranges,
    Share,
    SpeedTexts,
    StructureFile,
    Switch,
    Time,
    Tolerance,
    Whole,
    Workers,
    pairs_of,
    structure_files,
)
from squealpipe.cli.console import (
    ExitCodes,
    answer,
    current_session,
    keeping_on_interrupt,
    say,
    working,
)
from squealpipe.cli.output import (
    check_output,
    check_picture,
    finish,
    refuse_existing,
    write,
)
from squealpipe.cli.signatures import errors_in_options, in_options, options_of
from squealpipe.codes import Verdict
from squealpipe.inputs import parse_number
from squealpipe.parameters import Parameters
from squealpipe.ranges import parse_range

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr


def modes(
    file: StructureFile,
    /,
    *,
    mu: Frictions = None,
    belt_speed: SpeedTexts = None,
    frequency_max: Frequency = None,
    n_modes: Whole | None = None,
    critical: bool = True,
    vary: Ranges | None = None,
    output: Output = Path("modes.nc"),
    files: Files = structure_files,
) -> int:
    """Compute complex modes of a structure; write a dataset and a picture.

    Example: `squealpipe modes pad.yaml --mu 0:0.8:81 -o modes.nc`

    Args:
        mu: friction, a number or first:last:count; that of the file by default. It is that of the
            contacts that have none of their own; lining=0:0.6:13 is that of one contact or of a
            face, the contacts lining_1, lining_2, ….
        belt_speed: likewise, m/s, or rad/s (also 200 rpm) where the file has a rotation. Over
            several speeds, those at which a mode turns unstable or stable are located too.
        frequency_max: highest frequency of the modes, Hz. Where neither limit is given it is 20
            kHz up to 1000 degrees of freedom; beyond, one of the two is needed.
        n_modes: number of modes, those of lowest frequency.
        critical: locate where modes turn unstable, which is most of the work for a structure of
            many degrees of freedom; --no-critical leaves it out. Beyond 300 degrees of freedom
            critical frictions are sought in a reduced structure and confirmed in the whole.
        vary: a further factor with its value or values; repeat for more. preload=0.5:2:7 and
            contact_stiffness=0.5,1,2 multiply those of all contacts, p1_preload and p1_stiffness
            those of a contact p1, mass, damping and stiffness the matrices; modal_damping,
            mu_static and friction_speed replace those of the file.
    """
    asked: dict[str, Any] = {
        "mu": _friction(mu),
        "belt_speed": belt_speed,
        "frequency_max": frequency_max,
        "n_modes": n_modes,
        "critical": critical,
    }
    for name, text in pairs_of("--vary", vary or []).items():
        if name in asked:
            option = name.replace("_", "-")
            raise ValueError(f"--vary {name}: write --{option} {text} instead")
        asked[name] = _one_or_more(parse_range(text))

    refuse_existing(output, force=files.force)

    from squealpipe.structures import complex_modes as library
    from squealpipe.structures.modes import audible_band

    shown, contacts = "modes", ()

    def complex_modes(structure: Any, **options: Any) -> xr.Dataset:
        nonlocal shown, contacts
        contacts = structure.contacts
        if text := options.pop("belt_speed", None):
            read = partial(parse_number, units=structure.speed_unit)
            options["belt_speed"] = _one_or_more(parse_range(text, one=read))
        values = [*options.values()]
        if isinstance(options.get("mu"), dict):  # of a contact or face
            values += options["mu"].values()
        points = math.prod(len(value) for value in values if isinstance(value, list))
        told = library.cost_beforehand(structure, points, options.get("n_modes"))
        if told is not None:
            say(told)
        if not {"frequency_max", "n_modes"} & options.keys():
            audible = audible_band(structure)
            _say_band(audible)
            if audible is not None:
                options["frequency_max"] = audible
                shown = f"modes up to {audible / 1e3:g} kHz"
        return library.complex_modes(structure, **options)

    dataset = compute_of_structure(complex_modes, file, asked, output, files)
    _tell_modes(dataset, shown, contacts)
    return ExitCodes.done


def _tell_modes(dataset: xr.Dataset, shown: str, contacts: Sequence[Any]) -> None:
    """Print which modes are unstable, the gaps of faces, and contacts that are open.

    Args:
        shown: what was examined, in words.
    """
    from squealpipe.structures.meshes.gaps import gaps_of

    unstable = dataset.unstable
    varied = [dim for dim in unstable.dims if dim != "mode"]
    ever = unstable.any(varied)
    somewhere = " somewhere" if varied else ""
    beyond = "" if shown == "modes" else "; those above were not examined"
    answer(f"{int(ever.sum())} of {ever.size} {shown} are unstable{somewhere}{beyond}")
    # more unstable modes than twenty are a table for a file, not for a terminal
    for number in dataset.mode.values[ever.values][:20]:
        answer(_line(dataset.sel(mode=number)))
    for gaps in gaps_of(contacts):
        answer(str(gaps))
    if (opened := dataset.attrs["open_contacts"]) != "none":
        names = opened.split(", ")
        few = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
        answer(
            f"{len(names)} of {dataset.sizes['contact']} contacts are open in steady sliding and "
            f"left out there: {few}"
        )


def refuse_angles_and_parameters(
    file: Path, alpha2: Any, parameters: Parameters
) -> None:
    """Raise if a structure is asked about with what only a pad has."""
    if alpha2 is not None:
        raise ValueError(
            f"{file} is the file of a structure, which has no angles; leave {alpha2!r} out"
        )
    if parameters != Parameters():
        raise ValueError(
            "a structure has its numbers in its file; leave --config and parameters out"
        )


def compute_of_structure(
    task: Any, file: Path, options: dict[str, Any], output: Path, files: Files | Drawn
) -> xr.Dataset:
    """Run a task on the structure in a file; write its dataset and its picture.

    Args:
        options: of the task; those that are None are left to their defaults.
    """
    check_output(output, force=files.force)
    drawn = check_picture(files.picture, output, force=files.force)

    from squealpipe import Structure
    from squealpipe.systems.progress import stage

    given = {name: value for name, value in options.items() if value is not None}
    with working(task.__name__.replace("_", " ")), errors_in_options():
        with stage(f"reading {file}"):
            structure = Structure.read(file)
        say_doubts(structure)
        config = {"parameters": structure.as_dict(), **given}
        config.pop("workers", None)
        dataset = write(lambda: task(structure, **given), output, config=config)
    finish(dataset, output, drawn, files)
    return dataset


def say_doubts(structure: Any) -> None:
    """Say where faces are further apart than facets explain, and if there are two slidings."""
    from squealpipe.structures.meshes.gaps import gaps_of
    from squealpipe.structures.sliding import NoSlidingError, another_sliding

    for gaps in gaps_of(structure.contacts):
        if gaps.is_doubtful:
            say(f"warning: {gaps.doubt()}")
    with suppress(NoSlidingError):  # which the command tells
        forces = another_sliding(structure)
        if forces is not None:
            shown = ", ".join(
                f"{contact.name} {force:.3g}"
                for contact, force in zip(structure.contacts, forces, strict=True)
            )
            say(
                "warning: steady sliding is not unique; what follows is about the state nearest to "
                f"the preloads. In another one contact forces are {shown} N: a strike may end "
                "there, or carry the structure beyond it"
            )


def _say_band(limit: float | None) -> None:
    """Say that modes beyond the band that nobody asked for are left out."""
    if limit is not None:
        say(
            f"modes up to {limit / 1e3:g} kHz. Whether modes above grow is not examined: "
            "--frequency-max shows them"
        )


def _one_or_more(values: list[float] | None) -> Any:
    return values[0] if values is not None and len(values) == 1 else values


def _friction(given: Any) -> Any:
    if isinstance(given, dict):
        return {name: _one_or_more(values) for name, values in given.items()}
    return _one_or_more(given)


def _line(mode: Any) -> str:
    """Describe a mode where it grows fastest, with its critical friction and speed."""
    from squealpipe.plotting.origin import common_friction

    fastest = mode.growth_rate.where(mode.unstable).argmax(...)
    at = mode.isel(fastest)
    words = (
        f"mode {int(mode.mode)}: {at.frequency.item():.6g} Hz, growth rate "
        f"{at.growth_rate.item():.6g} 1/s"
    )
    name = f"mu of {mode.attrs['mu_of']}" if "mu_of" in mode.attrs else "mu"
    rubs = "contact" in mode.coords
    shown = [dim for dim in mode.growth_rate.dims if dim != "mu" or not rubs]
    if rubs and "mu" in at.coords:
        shown = ["mu", *shown]
    if shown:
        words += " at " + ", ".join(
            f"{name if dim == 'mu' else dim} = {at[dim].item():g}" for dim in shown
        )
    scale = at.get("critical_scale")  # every contact has its own friction
    of_scale = ", from {:.6g} times every mu on"
    if scale is not None and (own := common_friction(mode)) is not None:
        scale, of_scale = scale * own, ", from mu = {:.6g} on"
    onsets = [
        (at.critical_mu, f", from {name} = {{:.6g}} on"),
        (scale, of_scale),
        (at.get("critical_speed"), ", stability changes at belt_speed = {:.6g}"),
    ]
    located = [(each.item(), text) for each, text in onsets if each is not None]
    return words + "".join(text.format(x) for x, text in located if x == x)


def as_asked(structure: Any, options: dict[str, Any]) -> Any:
    """Return the structure that is run: reduced as ``n_modes`` and ``frequency_max`` ask.

    Args:
        options: of a command; both are taken out of it.
    """
    from squealpipe.structures.squeal.plant import band_of, in_modes

    number, limit = (options.pop(name, None) for name in ("n_modes", "frequency_max"))
    if limit is None:
        limit = band_of(structure, None)
        _say_band(limit)
    return in_modes(structure, number, limit)


@options_of("squealing_modes")
def squeal(
    file: StructureFile,
    /,
    *,
    samples: Whole,
    seed: Whole,
    t_end: Time | None,
    tol: Tolerance,
    n_modes: ModesOfRuns = None,
    frequency_max: BandOfRuns = None,
    onset: Switch,
    run: Annotated[Path | None, Parameter(negative="")] = None,
    output: Output = Path("squeal.nc"),
    files: Files = structure_files,
) -> int:
    """Say which unstable modes of a structure squeal, how loud, and with how much contact loss.

    The structure is run from small pushes along its unstable modes and from random starts until the
    motions have settled; every loss of contact is located. Exit code 0: quiet; 1: not quiet, or
    undetermined; 130: Ctrl-C, after which what had settled is kept.

    Example: `squealpipe squeal pad.yaml -o squeal.nc`

    Args:
        samples: random starts, each with at most the energy that the preload stores.
        seed: seed of the random starts.
        t_end: longest time of a run, s; by default 8000 periods of the slowest unstable mode,
            after the time in which it grows.
        onset: also lower the friction until the squeal dies, to see whether it lasts below the
            critical friction, and how far; costs about as much as the rest.
        run: also write, over time, the motion that a small push ends in (.nc), for `squealpipe
            listen` and `squealpipe animate`.
    """
    refuse_existing(output, force=files.force)
    if run is not None:
        check_output(run, force=files.force, kinds=(".nc",), option="--run")

    from squealpipe import squealing_modes
    from squealpipe.study.report.squealing import lines

    def squeal(structure: Any, **options: Any) -> xr.Dataset:
        reduced = as_asked(structure, options)
        reductions.append(reduced)
        return squealing_modes(reduced, **options)

    reductions: list[Any] = []
    asked = {"n_modes": n_modes, "frequency_max": frequency_max}
    asked |= {"samples": samples, "seed": seed, "tol": tol, "t_end": t_end}
    with keeping_on_interrupt() as interrupted:
        dataset = compute_of_structure(
            squeal, file, asked | {"onset": onset or None}, output, files
        )
        stopped = interrupted()
    answer(*map(in_options, lines(dataset)))
    if stopped:
        told = dataset.attrs.get("interrupted", "yes")
        say(
            "interrupted: starts that had not settled by then count as not settled"
            + ("" if told == "yes" else f"; {told}")
        )
        return ExitCodes.interrupted
    if run is not None:
        _write_run(reductions[0], dataset, run, tol)
    return ExitCodes.done if int(dataset.verdict) == 0 else ExitCodes.answer_is_no


def _write_run(structure: Any, told: xr.Dataset, path: Path, tol: float) -> None:
    """Write the motion that a structure settles to, if it moves."""
    from squealpipe.store.identity import dataset_id
    from squealpipe.structures.squeal.settled_run import (
        moving_attractors,
        squealing_run,
    )

    if not moving_attractors(told).size:
        answer(f"{path} is not written: no motion lasts")
        return
    config = {"parameters": structure.as_dict(), "answer": dataset_id(told)}
    with working("run"):
        write(lambda: squealing_run(structure, told, tol=tol), path, config=config)
    say(f"wrote {path}")


@options_of("squeal_ladder")
def ladder(
    file: StructureFile,
    /,
    *,
    pushes: Whole,
    t_end: Time | None,
    frequency_max: Frequency,
    tol: Tolerance,
    repeats: Whole,
    output: Output = Path("ladder.nc"),
    files: Files = structure_files,
) -> int:
    """Ask several methods which unstable modes of a structure squeal; chart accuracy and cost.

    Complex modes of the whole and the reduced structure, runs with every event located, and runs
    with smoothed friction and contact are compared with the finest run. Exit code 0: all agree with
    it; 1: some do not. It takes minutes.

    Example: `squealpipe ladder pad.yaml -o ladder.nc`

    Args:
        pushes: number of unstable modes to push along, the fastest-growing first.
        t_end: time of each run, s; by default until the last of these has grown, and 200 periods of
            the unstable mode of lowest frequency.
        frequency_max: highest frequency of the unstable modes, Hz; needed beyond 1000 degrees of
            freedom.
        repeats: repetitions of quick methods, for the median of their CPU time.
    """
    refuse_existing(output, force=files.force)

    from squealpipe import squeal_ladder
    from squealpipe.benchmark.schema import Reliability
    from squealpipe.study.report.squeal_ladder import lines

    asked = {"pushes": pushes, "t_end": t_end, "frequency_max": frequency_max}
    asked |= {"tol": tol, "repeats": repeats}
    dataset = compute_of_structure(squeal_ladder, file, asked, output, files)
    answer(*lines(dataset))
    return (
        ExitCodes.done
        if (dataset.verdict == Reliability.right).all()
        else ExitCodes.answer_is_no
    )


@options_of("operating_map")
def operating(
    file: StructureFile,
    /,
    *,
    pressure: SpeedTexts = None,
    speed: SpeedTexts = None,
    mu: SpeedTexts = None,
    temperature: SpeedTexts = None,
    mu_of: Annotated[
        list[str] | None, Parameter(metavar="NAME=TABLE", negative="")
    ] = None,
    measured: Path | None = None,
    frequency_band: Share,
    band_edges: SpeedTexts = None,
    n_modes: ModesOfRuns = None,
    frequency_max: BandOfRuns = None,
    tol: Tolerance,
    workers: Workers,
    output: Output = Path("operating.nc"),
    files: Files = structure_files,
) -> int:
    """Say at which pressures, speeds and frictions a structure is noisy, at which frequency.

    At each point steady sliding is pushed and run until its motion has settled. The same command
    resumes where it was interrupted. Exit code 0: all points are quiet; 1: some are not, or are
    undetermined.

    Example: `squealpipe operating pad.yaml --pressure 0.5:2:4 --speed 1:4:4 -o operating.nc`

    Args:
        pressure: factors of all preloads, a number, a list or first:last:count; with a unit, like
            "5 bar:20 bar:4", the mean pressure of the faces.
        speed: speeds likewise, m/s, or rad/s (also 200 rpm) where the file has a rotation; that of
            the file by default.
        mu: friction likewise, of the contacts that have none of their own; with --mu-of a factor
            of the tables.
        temperature: temperatures likewise, °C; needs --mu-of temperature=….
        mu_of: table of friction over temperature, pressure or speed: temperature=mu.csv, with the
            columns "temperature [°C]" and mu, or "temperature=20:0.45 300:0.35"; repeat for more,
            which are multiplied.
        measured: list of measured noises (text or Excel) with columns like pressure [bar],
            speed [km/h], temperature [°C], mu, frequency [Hz], level [dB]; an empty frequency is a
            quiet point. Each is compared with the nearest point of the map.
        frequency_band: largest difference between the frequency of a measured noise and the
            predicted one, over the measured one.
        band_edges: edges of the bands of occurrence, like 1kHz,2kHz,4kHz; third octaves by
            default.
    """
    refuse_existing(output, force=files.force)
    check_output(output, force=files.force)
    drawn = check_picture(files.picture, output, force=files.force)

    from squealpipe.store.rerun.key import rule_key, sources
    from squealpipe.study.chunks import beside
    from squealpipe.study.report.operating import lines
    from squealpipe.study.sweep import planned, run_sweep

    asked: dict[str, Any] = {"pressure": pressure, "speed": speed, "mu": mu}
    asked |= {"temperature": temperature, "band_edges": band_edges}
    asked |= {"n_modes": n_modes, "frequency_max": frequency_max}
    asked |= {"tol": tol, "frequency_band": frequency_band}
    asked["mu_of"] = pairs_of("--mu-of", mu_of) if mu_of else None
    asked["measured"] = None if measured is None else str(measured)
    settings = {
        "task": f"{file}:operating_map",
        "vary": {},
        "fixed": {name: each for name, each in asked.items() if each is not None},
    }
    with errors_in_options():
        plan: Any = planned(settings)
    kept = beside(output, rule_key(settings, sources(Path(inspect.getfile(planned)))))
    say_doubts(plan.operating.structure)
    if frequency_max is None:
        _say_band(plan.facts.get("frequency_max"))
    count, done = math.prod(map(len, plan.vary.values())), plan.finished(kept)
    say(
        f"{count} operating points" + (f"; {done} are already computed" if done else "")
    )
    # points that are finished are kept
    current_session.remedy = "run the same command again"
    with working("operating map"):
        dataset = write(
            lambda: run_sweep(plan, workers=workers, kept=kept), output, config=settings
        )
    kept.remove()
    finish(dataset, output, drawn, files)
    answer(*lines(dataset))
    quiet = bool((dataset.verdict == Verdict.quiet).all())
    return ExitCodes.done if quiet else ExitCodes.answer_is_no
