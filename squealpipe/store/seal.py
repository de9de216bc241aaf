"""Whether a dataset file is byte for byte as it was written, known before HDF5 opens it.

Two lines behind the NetCDF content, which HDF5 ignores, hold a header (names, dimensions and
attributes, to open many files quickly) and the SHA-256 of all before. Files that an archive
lists are held against its manifest; others without such a line (older ones, or another
program's) are first opened in a process of their own, with a time limit, because some damaged
files hang or crash HDF5.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
from enum import Enum
from pathlib import Path

from squealpipe.rerun.stale import HEADER
from squealpipe.store.runs import MANIFEST, read_manifest

MARK = b"\n# squealpipe sha256 "
LENGTH = len(MARK) + 64 + 1
SEALED = {"file_checksum": "SHA-256 of all other bytes, in the last line of the file"}
"""Attribute that tells that there must be such a line."""
TIME_LIMIT_S = 30.0
PROBE = """
import sys, netCDF4
def read(group):
    for variable in group.variables.values():
        variable[...]
        [variable.getncattr(name) for name in variable.ncattrs()]
    [read(inner) for inner in group.groups.values()]
try:
    with netCDF4.Dataset(sys.argv[1]) as file:
        read(file)
except Exception as error:  # told by the reader, which meets the same
    print(error)
"""


class Seal(Enum):
    """What the bytes of a file tell."""

    fits = 0
    absent = 1
    broken = 2
    unreadable = 3


def write_seal(path: Path, header: str = "{}") -> None:
    """Add two lines to a finished file: what it holds, as JSON, and the checksum of it all."""
    with path.open("ab") as file:
        file.write(HEADER + header.encode())
    with path.open("rb") as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
    with path.open("ab") as file:
        file.write(MARK + found.encode() + b"\n")


def judge(path: Path) -> Seal:
    """Hold a file against its own last line or the manifest of its archive.

    A file with neither is opened in another process; it is ``unreadable`` if that hangs or dies.
    """
    return read_seal(path)[0]


def read_seal(path: Path) -> tuple[Seal, bytes]:
    """What the bytes of a file tell, and its header where the seal fits."""
    content = path.read_bytes()
    footer = content[-LENGTH:]
    if footer.startswith(MARK) and footer.endswith(b"\n"):
        told = footer[len(MARK) : -1].decode(errors="replace")
        fits = hashlib.sha256(content[:-LENGTH]).hexdigest() == told
        header = content[:-LENGTH].rpartition(HEADER)[2] if fits else b""
        return (Seal.fits if fits else Seal.broken), header
    listed = listed_checksum(path)
    if listed is not None:
        fits = hashlib.sha256(content).hexdigest() == listed
        return (Seal.absent if fits else Seal.broken), b""
    return (Seal.absent if opens_in_time(path) else Seal.unreadable), b""


def listed_checksum(path: Path) -> str | None:
    """Checksum that the manifest of an archive around the file states; None if there is none."""
    archive = archive_around(path)
    if archive is None:
        return None
    try:
        name = path.resolve().relative_to(archive).as_posix()
        return str(read_manifest(archive)["files"][name]["sha256"])
    except (KeyError, TypeError, ValueError):
        return None


def archive_around(path: Path) -> Path | None:
    """The archive that a file is part of, if any."""
    return next((at for at in path.resolve().parents if (at / MANIFEST).is_file()), None)


def opens_in_time(path: Path) -> bool:
    """Whether the netCDF library gets through a file in time without dying."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", PROBE, str(path)],
            capture_output=True,
            timeout=TIME_LIMIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0
