"""Commands about one dataset file: its picture, and its tables for other programs."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import (
    Dpi,
    FigureSize,
    Force,
    Output,
    OutputElsewhere,
    Time,
    Units,
)
from squealpipe.cli.console import DONE, answer, say
from squealpipe.cli.output import PICTURES, TABLES, check_output, write
from squealpipe.units import engineering


def plot(
    file: Path,
    /,
    *,
    output: OutputElsewhere = None,
    variable: str | None = None,
    figure_size: FigureSize = None,
    dpi: Dpi = None,
    unit: Units = None,
    force: Force = False,
) -> int:
    """Draw a dataset: a run, a map, a branch, a cycle, an ensemble of a system.

    Example: `squealpipe plot run.nc -o run.png`

    Args:
        file: dataset that a command or `squealpipe.save` wrote, or another program's .nc or .csv.
        output: picture to write (png, svg or pdf); by default FILE.png, here.
        variable: draw this variable instead of the usual picture.
    """
    target = Path(file.with_suffix(".png").name) if output is None else output
    check_output(target, force=force, kinds=PICTURES)

    from squealpipe.plotting import picture
    from squealpipe.plotting.style import save_figure
    from squealpipe.store.foreign import load_any

    drawn = picture(load_any(file), variable, units=unit or ())
    save_figure(drawn, [target], size=figure_size, dpi=dpi)
    say(f"wrote {target}")
    return DONE


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
    figure_size: FigureSize = None,
    dpi: Dpi = None,
    unit: Units = None,
    force: Force = False,
) -> int:
    """Write the spectrum of a run in Hz: velocities, contact force and its strongest lines.

    Example: `squealpipe spectrum run.nc -o spectrum.csv`

    Args:
        file: run that `squealpipe simulate -o` wrote.
        last: take only so much of its end, like 0.2s; by default all of the run.
    """
    check_output(output, force=force)
    if picture is not None:
        check_output(picture, force=force, kinds=PICTURES, option="--picture")

    import squealpipe
    from squealpipe.plotting import picture as drawn
    from squealpipe.plotting.style import save_figure
    from squealpipe.store.identity import dataset_id

    run = squealpipe.load(file)
    made = write(
        lambda: squealpipe.spectrum(run, last=last),
        output,
        config={"run": dataset_id(run), "last": last},
    )
    if picture is not None:
        figure = drawn(made, units=unit or ())
        save_figure(figure, [picture], size=figure_size, dpi=dpi)
    say(f"wrote {output}{f' and {picture}' if picture else ''}")
    lines = made.peak_frequency.values
    told = ", ".join(engineering(float(line), "Hz", 4) for line in lines[:3])
    answer(f"strongest lines of the contact force: {told or 'none'}")
    return DONE


def convert(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    force: Force = False,
) -> int:
    """Write a dataset for another program: CSV, MATLAB, Excel or Parquet, units in the header.

    Example: `squealpipe convert run.nc -o run.mat`

    Args:
        file: dataset that a command or `squealpipe.save` wrote, or another program's .nc or .csv.
        output: file that ends in .csv, .mat, .xlsx or .parquet.
    """
    check_output(output, force=force, kinds=TABLES)

    from squealpipe.store.foreign import load_any
    from squealpipe.store.tables import convert as task

    say(f"wrote {' and '.join(map(str, task(load_any(file), output)))}")
    return DONE
