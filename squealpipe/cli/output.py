"""Files that a command writes: checked before it computes, written as NetCDF or CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squealpipe.cli.arguments import Drawn, Look, Written
from squealpipe.cli.console import current_session, say, working
from squealpipe.cli.long_work import say_what_it_takes
from squealpipe.cli.reservation import reserve

if TYPE_CHECKING:
    import xarray as xr

PICTURES = (".png", ".svg", ".pdf")


def check_output(
    path: Path,
    *,
    force: bool,
    kinds: tuple[str, ...] = (".nc", ".csv"),
    option: str = "--output",
) -> None:
    """Refuse a name that cannot or must not be written, before anything is computed.

    It is kept until the command ends: another command that is to write there is refused.
    """
    if path.suffix not in kinds:
        endings = ", ".join(kinds[:-1]) + f" or {kinds[-1]}"
        raise ValueError(f"{option} {path}: end the name in {endings}")
    refuse_existing(path, force=force, option=option)
    reserve(path, current_session.held, option)
    # another command may just have finished
    refuse_existing(path, force=force, option=option)
    if path.suffix in {".csv", ".parquet"} and not force:
        for other in sorted(path.parent.glob(f"{escape(path.stem)}.*{path.suffix}")):
            raise ValueError(
                f"{option} {path} writes further tables beside it, and {other} exists; add --force "
                "to overwrite it, or change the name"
            )


def refuse_existing(path: Path, *, force: bool, option: str = "--output") -> None:
    """Refuse a file that exists, as :func:`check_output` does, before anything slow is imported."""
    if path.is_file() and not force:
        raise ValueError(
            f"{option} {path} exists; add --force to overwrite it, or change the name"
        )


def write(
    make: Callable[[], xr.Dataset], output: Path, *, config: Mapping[str, Any]
) -> xr.Dataset:
    """Make a dataset, write it as ``.nc`` or ``.csv`` with its provenance, and give it back."""
    from squealpipe.store import load, produce

    if output.suffix == ".nc":
        return load(produce(make, config=config, output=output))
    from squealpipe.store.provenance import stamped
    from squealpipe.store.tables import convert

    dataset = stamped(make, config=config)
    if beside := convert(dataset, output)[1:]:
        say(f"other dimensions are in {', '.join(map(str, beside))}")
    return dataset


def compute(
    function: str, brake: Written, *angles: Any, output: Path, **options: Any
) -> xr.Dataset:
    """Run a function of the package; write its dataset and, where a command has one, its picture.

    Args:
        function: its name in ``squealpipe``.
        angles: what it is called with beside the parameters.
        options: its keywords; those that are None are left to their defaults.
    """
    check_output(output, force=brake.force)
    drawn = (
        check_picture(brake.picture, output, force=brake.force)
        if isinstance(brake, Drawn)
        else None
    )

    import squealpipe
    from squealpipe.schema.origin import plain
    from squealpipe.store.identity import dataset_id

    given = {name: value for name, value in options.items() if value is not None}
    stated = dict(zip(("alpha1", "alpha2"), angles, strict=False)) | {
        name: dataset_id(value) if hasattr(value, "data_vars") else plain(value)
        for name, value in given.items()
    }
    say_what_it_takes(function, brake.params, angles, given)
    with working(function.replace("_", " ")):
        dataset = write(
            lambda: getattr(squealpipe, function)(brake.params, *angles, **given),
            output,
            config={"parameters": brake.params.as_dict(), **stated},
        )
    finish(dataset, output, drawn, brake)
    return dataset


def check_picture(picture: Path | None, output: Path, *, force: bool) -> Path:
    """The picture's name, by default beside the dataset, checked as :func:`check_output` does."""
    drawn = picture or output.with_suffix(".png")
    check_output(drawn, force=force, kinds=PICTURES, option="--picture")
    return drawn


def draw(
    dataset: xr.Dataset,
    path: Path,
    look: Look,
    *,
    variable: str | None = None,
    mode: int | None = None,
) -> None:
    """Write the picture of a dataset."""
    from squealpipe.plotting import picture
    from squealpipe.plotting.style import save_figure

    figure = picture(dataset, variable, mode=mode, units=look.unit or ())
    save_figure(figure, [path], size=look.figure_size, dpi=look.dpi)


def finish(
    dataset: xr.Dataset, output: Path, drawn: Path | None, look: Look | Written
) -> None:
    """Have the picture of a written dataset drawn after the command's answer, and say so then.

    Matplotlib takes a second, for which nobody has to wait who asked for a number. An interrupted
    command says how to draw it later.
    """

    def finishing() -> None:
        if drawn is not None and isinstance(look, Look):
            from squealpipe.store.whole_files import StoreError

            try:
                draw(dataset, drawn, look)
            except StoreError as error:
                # the same command alone would refuse to overwrite its dataset
                again = f"{error}, with --force; or, as {current_session.remedy}"
                raise StoreError(again) from error
        say(f"wrote {output}{f' and {drawn}' if drawn else ''}")

    if drawn is not None:
        current_session.remedy = (
            f"{output} is written; squealpipe plot {output} -o {drawn} draws it"
        )
    current_session.closing.append(finishing)


def ending(outcome: xr.DataArray) -> tuple[str, str]:
    """The name of an outcome, and the words for it with its remedy."""
    from squealpipe.schema import Outcome

    reached = Outcome(int(outcome))
    return reached.name, f"{reached.name} ({reached.remedy})"
