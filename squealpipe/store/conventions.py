"""What the CF conventions ask of a file and a dataset in memory does not need."""

from __future__ import annotations

import xarray as xr

EPOCH = "seconds since 1970-01-01T00:00:00"
NOTE = "time since the start of the run; the date is arbitrary (open with decode_times=False)"


def as_file(dataset: xr.Dataset) -> xr.Dataset:
    """A coordinate ``time`` in s as CF has it: with a standard name and a date to count from."""
    if "time" not in dataset.coords or dataset.time.attrs.get("units") != "s":
        return dataset
    told = {**dataset.time.attrs, "units": EPOCH, "calendar": "standard"}
    told |= {"standard_name": "time", "axis": "T", "comment": NOTE}
    told |= {"units_metadata": "leap_seconds: none"}
    variable = xr.Variable(dataset.time.dims, dataset.time.values, told, dataset.time.encoding)
    return dataset.assign_coords(time=variable)


def as_dataset(dataset: xr.Dataset) -> xr.Dataset:
    """The inverse of :func:`as_file`; other datasets stay as they are."""
    if "time" in dataset.coords and dataset.time.attrs.get("units") == EPOCH:
        dataset.time.attrs["units"] = "s"
        for key in ("calendar", "standard_name", "axis", "comment", "units_metadata"):
            dataset.time.attrs.pop(key, None)
    return dataset
