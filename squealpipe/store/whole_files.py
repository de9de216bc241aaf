"""Files that appear whole or not at all, and never where nothing may be written."""

import hashlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

MANIFEST = "manifest.json"
SEAL = "manifest.sha256"
"""Holds the checksum of the manifest, so that an edited manifest is noticed too."""
ARCHIVES = Path("results/archive")


class StoreError(ValueError):
    """A file cannot be read or written as a dataset; the message names it and the remedy."""


def archive_around(path: Path) -> Path | None:
    """The archive that a file is part of, or would be, if any."""
    return next((at for at in path.resolve().parents if _is_archive(at)), None)


def _is_archive(folder: Path) -> bool:
    """Return whether a folder is an archive, also one that was moved, or has lost its manifest."""
    if folder.name.startswith("."):  # the draft of one
        return False
    in_place = folder.parent.parts[-2:] == ARCHIVES.parts
    return (in_place and folder.is_dir()) or (folder / SEAL).is_file()


def refuse_place(path: Path) -> None:
    """Raise if a file must not be written there: the one gate of everything that writes."""
    if path.parts[:1] and path.parts[0].startswith("~"):
        raise StoreError(
            f"{path}: the shell did not replace {path.parts[0]}, as behind an equals sign; write "
            "the folder itself, or ./ before it if it is called so"
        )
    if path.exists() and not path.is_file():
        raise StoreError(
            f"{path} is not a regular file; choose another name to write to"
        )
    above = next((at for at in path.absolute().parents if at.exists()), path.parent)
    if not above.is_dir():
        raise StoreError(f"{path}: {above} is no folder; choose another name")
    if (frozen := archive_around(path)) is not None:
        raise StoreError(
            f"{path} is part of the archive {frozen}, which never changes; choose a name outside "
            "of it"
        )


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A new temporary file beside ``path`` that takes its place if the block ends without error.

    Raises:
        StoreError: nothing may be written there, or it cannot be: the disk is full, say. What was
            there stays.
    """
    refuse_place(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # opened with O_EXCL: no file or link that waits there is written to
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.stem[:100]}.", suffix=path.suffix
        )
        os.close(handle)
        temporary = Path(name)
        umask = os.umask(0)
        os.umask(umask)
        try:
            temporary.chmod(0o666 & ~umask)
            yield temporary
            sync(temporary)
            temporary.replace(path)
            sync(path.parent)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise not_written(path, error) from error


def not_written(path: Path, error: BaseException) -> StoreError:
    """That a file could not be written, why, and what to do."""
    reason = getattr(error, "strerror", None) or error
    return StoreError(
        f"cannot write {path}: {reason}; free space or fix permissions, "
        "then run the same command again"
    )


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
