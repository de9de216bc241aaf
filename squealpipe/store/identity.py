"""What makes two datasets the same: one hash of schema, configuration and values."""

import hashlib

import numpy as np
import xarray as xr

from squealpipe.rerun.key import canonical
from squealpipe.schema import schema_of


def dataset_id(dataset: xr.Dataset) -> str:
    """Hash of what was computed: schema, configuration and all values that are not volatile."""
    schema = schema_of(dataset)
    total = hashlib.sha256()
    total.update(canonical([schema.name, schema.version, dataset.attrs.get("config", "")]).encode())
    for name in sorted(map(str, dataset.variables)):
        entry = schema.lookup(name)
        if entry is not None and entry.volatile:
            continue
        values = np.ascontiguousarray(dataset[name].values)
        total.update(f"{name}{values.shape}{values.dtype.kind}".encode())
        total.update(
            repr(values.tolist()).encode() if values.dtype.kind in "UO" else values.tobytes()
        )
    return total.hexdigest()[:16]
