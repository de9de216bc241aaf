"""Identity of a dataset: the id of its values, and the digest that ties a key to its content."""

import hashlib
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import schema_of
from squealpipe.store.rerun.key import canonical, digest

VOLATILE_ATTRIBUTES = frozenset(
    {
        "history",
        "wall_time_s",
        "platform",
        "libraries",
        "package_version",
        "commit",
        "inputs",
        "key",
        "key_content",
    }
)
"""Global attributes that describe the run, not the result."""


def dataset_id(dataset: xr.Dataset) -> str:
    """Hash of what was computed: schema, configuration and all values that are not volatile."""
    schema = schema_of(dataset)
    total = hashlib.sha256()
    total.update(
        canonical(
            [schema.name, schema.version, dataset.attrs.get("config", "")]
        ).encode()
    )
    for name in sorted(map(str, dataset.variables)):
        entry = schema.lookup(name)
        if entry is not None and entry.volatile:
            continue
        values = np.ascontiguousarray(dataset[name].values)
        total.update(f"{name}{values.shape}{values.dtype.kind}".encode())
        total.update(_bytes(values))
    return total.hexdigest()[:16]


def with_key(dataset: xr.Dataset, key: str) -> xr.Dataset:
    """A dataset as a task made it, with the key of its rule, which holds for this content only."""
    return dataset.assign_attrs(key=key, key_content=content_digest(dataset))


def without_foreign_key(dataset: xr.Dataset, edited_at: str) -> xr.Dataset:
    """The dataset; if it is no longer what its task made, without the key, and a warning says so.

    Args:
        edited_at: the line of its history that dates the edit.
    """
    attrs = dict(dataset.attrs)
    if "key" not in attrs or _is_what_was_made(dataset):
        return dataset
    place = str(attrs.pop("key")).partition(" ")[2]
    attrs.pop("key_content", None)
    warnings.warn(
        f"this dataset was edited after its task made it, so it is saved without the key of "
        f"{place}: no report or archive takes it for a result of the study",
        stacklevel=4,
    )
    edit = f"{edited_at}: edited; what was {place} is no result of a rule any more"
    attrs["history"] = "\n".join(filter(None, (edit, str(attrs.get("history", "")))))
    edited = dataset.copy(deep=False)
    edited.attrs = attrs
    return edited


def _is_what_was_made(dataset: xr.Dataset) -> bool:
    stated = dataset.attrs.get("key_content")
    if stated is None:  # as up to 1.0.0, when only the id tied the key to its content
        return bool(dataset.attrs.get("dataset_id") == dataset_id(dataset))
    return bool(stated == content_digest(dataset))


def content_digest(dataset: xr.Dataset) -> str:
    """Digest of all that a reader of the result sees: values, names, dimensions and attributes."""
    total = hashlib.sha256()
    left_out = VOLATILE_ATTRIBUTES | {"dataset_id"}
    shown = {key: dataset.attrs[key] for key in dataset.attrs if key not in left_out}
    total.update(canonical(_plain(shown)).encode())
    for name in sorted(map(str, dataset.variables)):
        variable = dataset[name]
        values = np.ascontiguousarray(variable.values)
        about = [name, list(map(str, variable.dims)), _plain(variable.attrs)]
        size = [list(values.shape), values.dtype.kind.replace("O", "U")]
        total.update(canonical([*about, *size]).encode())
        total.update(_bytes(values))
    return digest(total.digest())


def _bytes(values: np.ndarray) -> bytes:
    if values.dtype.kind in "UO":
        return repr(values.tolist()).encode()
    return values.tobytes()


def _plain(attrs: Mapping[Any, Any]) -> dict[str, list[str]]:
    """Attributes as they are before and after a file, which turns lists of one into numbers."""
    return {
        str(key): [str(item) for item in np.ravel(np.asarray(value)).tolist()]
        for key, value in attrs.items()
    }
