"""Files that a command writes: checked before it computes, written as NetCDF or CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squealpipe.cli.console import say, working

if TYPE_CHECKING:
    import xarray as xr

    from squealpipe.parameters import Parameters

DATA = (".nc", ".csv")
TABLES = (".csv", ".mat", ".xlsx", ".parquet")
PICTURES = (".png", ".svg", ".pdf")


def check_output(
    path: Path, *, force: bool, kinds: tuple[str, ...] = DATA, option: str = "--output"
) -> None:
    """Refuse a name that cannot or must not be written, before anything is computed.

    Raises:
        ValueError: the standard output, a folder, a device, an ending that says no known kind, or
            a file that exists and is not to be overwritten.
    """
    endings = ", ".join(kinds[:-1]) + f" or {kinds[-1]}"
    if str(path) == "-":
        raise ValueError(f"{option} -: give a file that ends in {endings}; nothing is streamed")
    if path.is_dir():
        raise ValueError(
            f"{option} {path} is a folder; give a file in it, {path / f'NAME{kinds[0]}'}"
        )
    if path.exists() and not path.is_file():
        raise ValueError(f"{option} {path} is a device or pipe, not a file; it is left alone")
    if path.suffix not in kinds:
        raise ValueError(f"{option} {path}: end the name in {endings}")
    above = next(folder for folder in path.absolute().parents if folder.exists())
    if not above.is_dir():
        raise ValueError(f"{option} {path}: {above} is a file, not a folder")
    if path.exists() and not force:
        raise ValueError(f"{option} {path} exists; add --force to overwrite it, or change the name")
    if path.suffix in {".csv", ".parquet"} and not force:
        for other in sorted(path.parent.glob(f"{escape(path.stem)}.*{path.suffix}")):
            raise ValueError(
                f"{option} {path} writes further tables beside it, and {other} exists; add --force "
                "to overwrite it, or change the name"
            )


def check_outputs(output: Path, picture: Path | None, *, force: bool) -> Path:
    """Check both files of a command; the picture's name, by default beside the dataset.

    Raises:
        ValueError: as :func:`check_output`.
    """
    check_output(output, force=force)
    chosen = output.with_suffix(".png") if picture is None else picture
    check_output(chosen, force=force, kinds=PICTURES, option="--picture")
    return chosen


def write(make: Callable[[], xr.Dataset], output: Path, *, config: Mapping[str, Any]) -> xr.Dataset:
    """Make a dataset, write it in the form that the name asks for, and give it back.

    Args:
        make: makes it.
        output: file that ends in ``.nc`` or ``.csv``.
        config: what it was asked for, for its provenance.
    """
    from squealpipe.store import load, produce

    if output.suffix == ".nc":
        return load(produce(make, config=config, output=output))
    from squealpipe.store.provenance import stamped
    from squealpipe.store.tables import convert

    dataset = stamped(make, config=config)
    beside = convert(dataset, output)[1:]
    if beside:
        say(f"other dimensions are in {', '.join(map(str, beside))}")
    return dataset


def compute(
    function: str,
    params: Parameters,
    *angles: Any,
    output: Path,
    picture: Path | None,
    drawn: bool = True,
    **options: Any,
) -> xr.Dataset:
    """Run a function of the package; write its dataset and, if there is one, the picture of it.

    Args:
        function: its name in ``squealpipe``.
        params, angles: what it is called with.
        output, picture: files, checked before.
        drawn: whether there is a picture.
        options: its keywords; those that are None are left to their defaults.
    """
    import squealpipe
    from squealpipe.store.identity import dataset_id

    given = {name: value for name, value in options.items() if value is not None}
    place: dict[str, Any] = dict(zip(("alpha1", "alpha2"), angles, strict=False))
    place |= {k: dataset_id(v) if hasattr(v, "data_vars") else v for k, v in given.items()}
    with working(function.replace("_", " ")):
        dataset = write(
            lambda: getattr(squealpipe, function)(params, *angles, **given),
            output,
            config={"parameters": params.as_dict(), **place},
        )
    if drawn and picture is not None:
        from squealpipe.plotting import picture as draw
        from squealpipe.plotting.style import save_figure

        save_figure(draw(dataset), [picture])
    say(f"wrote {output}" + (f" and {picture}" if drawn else ""))
    return dataset
