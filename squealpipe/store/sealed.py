"""Dataset files that end with the digest of their bytes, and what they state about themselves.

Without Xarray, whose import takes longer than the attributes of a whole study.
"""

import hashlib
import os
from functools import lru_cache
from pathlib import Path
from typing import Any

import netCDF4

from squealpipe.store.whole_files import StoreError

SEAL_MARK = b"\n# squealpipe sha256 "


def attributes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Global attributes of a dataset file."""
    return dict(_attributes(*_with_digest(path)))


@lru_cache(maxsize=256)
def _attributes(path: Path, digest: bytes) -> dict[str, Any]:  # noqa: ARG001
    """Attributes of a file with these bytes: a report asks for those of all datasets twice."""
    with netCDF4.Dataset(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


def verified(path: str | os.PathLike[str]) -> Path:
    """The path of a dataset file whose bytes are those that were written, before HDF5 opens it."""
    return _with_digest(path)[0]


def _with_digest(path: str | os.PathLike[str]) -> tuple[Path, bytes]:
    """Return the path of such a file, and the digest of its bytes."""
    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(
            f"no dataset {source}; make it with snakemake, or check the path"
        )
    content, mark, stated = source.read_bytes().rpartition(SEAL_MARK)
    if not mark or stated != hashlib.sha256(content).hexdigest().encode() + b"\n":
        raise StoreError(
            f"{source} was changed or damaged since squealpipe wrote it, or another program wrote "
            "it; if a study made it, delete it and run snakemake again; a file of another program "
            "can be drawn (squealpipe plot) and converted (squealpipe convert)"
        )
    return source, stated
