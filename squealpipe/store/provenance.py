"""Where a dataset comes from: configuration slice, code, libraries, inputs, and its own id."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import xarray as xr

from squealpipe.rerun.sources import code_digests, edited
from squealpipe.rerun.stale import attributes, some
from squealpipe.schema.origin import versions
from squealpipe.store.checkout import commit
from squealpipe.store.identity import canonical, digest
from squealpipe.store.netcdf import StoreError, load, made_now, save

VOLATILE_ATTRIBUTES = frozenset(
    {
        "history",
        "wall_time_s",
        "platform",
        "libraries",
        "package_version",
        "commit",
        "inputs",
        "code",
    }
)
"""Global attributes that tell of the run, not of the result."""


STARTED = time.time()
"""When this process began, s since 1970: no later than any of its jobs."""


def produce(
    make: Callable[[], xr.Dataset],
    *,
    config: Mapping[str, Any],
    output: str | os.PathLike[str],
    inputs: Iterable[str | os.PathLike[str]] = (),
    sources: Iterable[str | os.PathLike[str]] = (),
) -> Path:
    """Run a task, stamp the result with its provenance, and save it.

    Args:
        make: the task, ready to call.
        config: exactly the configuration that the task was given.
        output: where the dataset goes.
        inputs: NetCDF files that the task read.
        sources: files whose code decides the result; where given, the dataset tells their digests
            and a result that is out of date when the task ends is not published.

    Raises:
        StoreError: the code changed while the task ran, or another configuration or other code
            wrote ``output`` meanwhile; what is there stays.
    """
    files = [Path(path) for path in sources]
    code = code_digests(files)
    dataset = stamped(make, config=config, inputs=inputs)
    if code:
        refuse_outdated(Path(output), files, dataset.attrs["config"], code)
        dataset = dataset.assign_attrs(code=canonical(code))
    return save(dataset, output)


def refuse_outdated(
    output: Path, sources: Iterable[Path], config: str, code: Mapping[str, str]
) -> None:
    """Raise if a result made from this configuration and code is out of date by now."""
    changed = edited(sources)
    if changed:
        raise StoreError(
            f"{output} is not written: {some(changed)} changed while it was computed; "
            "run snakemake again"
        )
    if output.is_file() and output.stat().st_mtime > STARTED:
        newer = attributes(output)
        if newer is not None and (newer.get("config"), newer.get("code")) != (
            config,
            canonical(code),
        ):
            raise StoreError(
                f"{output} is not written: a job that began later has written it, from another "
                "configuration or other code"
            )


def stamped(
    make: Callable[[], xr.Dataset],
    *,
    config: Mapping[str, Any],
    inputs: Iterable[str | os.PathLike[str]] = (),
) -> xr.Dataset:
    """What a task makes, with its provenance and wall time, not yet saved."""
    # before the task reads them: what is there afterwards may be others
    ids = {str(path): load(path).attrs["dataset_id"] for path in inputs}
    started = time.perf_counter()
    dataset = make()
    wall_time = time.perf_counter() - started
    return stamp(dataset, config=config, inputs=ids, wall_time=wall_time)


def stamp(
    dataset: xr.Dataset,
    *,
    config: Mapping[str, Any],
    inputs: Mapping[str, str] = MappingProxyType({}),
    wall_time: float,
) -> xr.Dataset:
    """The dataset with provenance attributes; ``inputs`` are the ids of files that were read."""
    text = canonical(config)
    return dataset.assign_attrs(
        config=text,
        config_hash=digest(text),
        **versions(),
        commit=commit(),
        platform=f"{platform.platform()}, Python {platform.python_version()}",
        inputs=canonical(dict(inputs)),
        wall_time_s=wall_time,
        history=made_now(),
    )
