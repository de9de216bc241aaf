"""Commands about one dataset file: its picture, and its tables for other programs."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    Force,
    Look,
    Output,
    OutputElsewhere,
    Time,
    Whole,
    default_look,
)
from squealpipe.cli.console import ExitCodes, answer, say
from squealpipe.cli.output import PICTURES, check_output, draw, finish, write
from squealpipe.systems.inputs.units import engineering


def plot(
    file: Path,
    /,
    *,
    output: OutputElsewhere = None,
    variable: str | None = None,
    mode: Whole | None = None,
    look: Look = default_look,
    force: Force = False,
) -> int:
    """Draw a dataset: a run, a map, a branch, a cycle, an ensemble of a system.

    Example: `squealpipe plot run.nc -o run.png`

    Args:
        file: dataset that a command or `squealpipe.save` wrote, or another program's .nc or .csv.
        output: picture to write (png, svg or pdf); by default FILE.png, here.
        variable: draw this variable instead of the usual picture.
        mode: number of the complex mode whose shape is drawn: on the mesh, undeformed grey and
            deformed coloured, or without a mesh as arrows at its degrees of freedom.
    """
    target = Path(file.with_suffix(".png").name) if output is None else output
    check_output(target, force=force, kinds=PICTURES)

    from squealpipe.store.foreign import load_any

    draw(load_any(file), target, look, variable=variable, mode=mode)
    say(f"wrote {target}")
    return ExitCodes.done


def spectrum(
    file: Path,
    /,
    *,
    last: Time | None = None,
    output: Output = Path("spectrum.nc"),
    picture: Annotated[
        Path | None,
        Parameter(name=["--picture", "-p"], help="also draw it (png, svg or pdf)."),
    ] = None,
    look: Look = default_look,
    force: Force = False,
) -> int:
    """Write the spectrum of a run in Hz: velocities, contact force and its strongest lines.

    Example: `squealpipe spectrum run.nc -o spectrum.csv`

    Args:
        file: run that `squealpipe simulate -o` wrote.
        last: length of the last part of the run to use, like 0.2s; by default the whole run.
    """
    check_output(output, force=force)
    if picture is not None:
        check_output(picture, force=force, kinds=PICTURES, option="--picture")

    import squealpipe
    from squealpipe.store.identity import dataset_id

    run = squealpipe.load(file)
    made = write(
        lambda: squealpipe.spectrum(run, last=last),
        output,
        config={"run": dataset_id(run), "last": last},
    )
    finish(made, output, picture, look)
    lines = made.peak_frequency.values
    told = ", ".join(engineering(float(line), "Hz", 4) for line in lines[:3])
    answer(f"strongest lines of the contact force: {told or 'none'}")
    return ExitCodes.done


def convert(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    force: Force = False,
) -> int:
    """Write a dataset for another program: CSV, MATLAB, Excel, Parquet, or ParaView for modes.

    Units are in the header. Modes of a structure with a mesh can be a .vtu file, with the arrays
    mode_N_real, mode_N_imaginary and mode_N_amplitude at the nodes.

    Example: `squealpipe convert run.nc -o run.mat`

    Args:
        file: dataset that a command or `squealpipe.save` wrote, or another program's .nc or .csv.
        output: file that ends in .csv, .mat, .xlsx, .parquet or .vtu.
    """
    table_endings = (".csv", ".mat", ".xlsx", ".parquet")
    check_output(output, force=force, kinds=(*table_endings, ".vtu"))

    from squealpipe.store.foreign import load_any
    from squealpipe.store.tables import convert as task

    say(f"wrote {' and '.join(map(str, task(load_any(file), output)))}")
    return ExitCodes.done
