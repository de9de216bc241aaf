"""Commands about one dataset file: its picture, and its tables for other programs."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import Dpi, FigureSize, Force, OutputElsewhere, Units
from squealpipe.cli.console import DONE, say
from squealpipe.cli.output import PICTURES, TABLES, check_output


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
