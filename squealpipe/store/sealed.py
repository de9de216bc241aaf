"""Dataset files that end with the digest of their bytes, and what they state about themselves.

Without Xarray, whose import takes longer than the attributes of a whole study.
"""

import hashlib
import os
from pathlib import Path
from typing import Any

import netCDF4

from squealpipe.store.whole_files import StoreError

SEAL_MARK = b"\n# squealpipe sha256 "


def attributes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Global attributes of a dataset file."""
    with netCDF4.Dataset(verified(path)) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


def verified(path: str | os.PathLike[str]) -> Path:
    """The path of a dataset file whose bytes are those that were written, before HDF5 opens it."""
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
    return source
