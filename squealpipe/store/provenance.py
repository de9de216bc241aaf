"""Provenance of a dataset: configuration slice, code, libraries, inputs, and its own id."""

import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from squealpipe.store.checkout import commit
from squealpipe.store.identity import with_key
from squealpipe.store.netcdf import made_now, save
from squealpipe.store.rerun.key import canonical, digest, file_key, refuse_edited
from squealpipe.store.sealed import attributes
from squealpipe.systems.datasets.versions import versions


def produce(
    make: Callable[[], xr.Dataset],
    *,
    config: Mapping[str, Any],
    output: str | os.PathLike[str],
    inputs: Iterable[str | os.PathLike[str]] = (),
    key: str | None = None,
    started: float | None = None,
) -> Path:
    """Run a task, stamp the result with its provenance, and save it.

    Args:
        started: when work on it began, by ``time.perf_counter``; now by default.
        config: exactly the configuration that the task was given.
        inputs: NetCDF files that the task read.
        key: of the rule (see :mod:`squealpipe.store.rerun.key`).

    Raises:
        RuntimeError: the code was edited while the study ran, so the key may be another's; what is
            there stays.
    """
    dataset = stamped(make, config=config, inputs=inputs, started=started)
    if key is not None:
        refuse_edited(output)
        dataset = with_key(dataset, file_key(key, output))
    return save(dataset, output)


def stamped(
    make: Callable[[], xr.Dataset],
    *,
    config: Mapping[str, Any],
    inputs: Iterable[str | os.PathLike[str]] = (),
    started: float | None = None,
) -> xr.Dataset:
    """Return the dataset of a task with its provenance and wall time, not yet saved."""
    started = time.perf_counter() if started is None else started
    # before the task reads them: what is there afterwards may be others
    ids = {str(path): attributes(path)["dataset_id"] for path in inputs}
    dataset = make()
    text = canonical(config)
    return dataset.assign_attrs(
        config=text,
        config_hash=digest(text),
        **versions(),
        commit=commit(),
        platform=f"{platform.platform()}, Python {platform.python_version()}",
        inputs=canonical(ids),
        wall_time_s=time.perf_counter() - started,
        history=made_now(),
    )
