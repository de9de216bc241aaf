"""Files that appear whole or not at all."""

import hashlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

MANIFEST = "manifest.json"


class StoreError(ValueError):
    """A file cannot be read or written as a dataset; the message names it and the remedy."""


def archive_around(path: Path) -> Path | None:
    """The archive that a file is part of, if any."""
    return next(
        (at for at in path.resolve().parents if (at / MANIFEST).is_file()), None
    )


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A new temporary file beside ``path`` that takes its place if the block ends without error."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # opened with O_EXCL: no file or link that waits there is written to
    handle, name = tempfile.mkstemp(
        dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix
    )
    os.close(handle)
    temporary = Path(name)
    umask = os.umask(0)
    os.umask(umask)
    temporary.chmod(0o666 & ~umask)
    try:
        yield temporary
        sync(temporary)
        temporary.replace(path)
        sync(path.parent)
    finally:
        temporary.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Have a file or folder on disk before going on."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def checksum(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
