"""What archives have in common, kept once: objects named by the SHA-256 of their content.

The files of an archive are hard links to the objects, so each archive stays a plain folder that
is read without this package. Where links fail, its files stay copies.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from squealpipe.store.runs import ARCHIVES, MANIFEST, SEAL, listed_files

OBJECTS = ".objects"
DRAFT = ".tmp"
"""How the name of an archive that is being written ends."""


def checksum(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def object_path(archives: Path, digest: str) -> Path:
    """Where the content of that checksum is kept."""
    return archives / OBJECTS / digest[:2] / digest


@contextlib.contextmanager
def locked(archives: Path) -> Iterator[None]:
    """Keep other processes from writing or collecting at the same time."""
    archives.mkdir(parents=True, exist_ok=True)
    with (archives / ".lock").open("a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def share(path: Path, digest: str, archives: Path) -> bool:
    """Have a file of an archive and its object be one; False where links cannot be made.

    A damaged object is replaced, which leaves the archives that hold links to it as they are.
    """
    kept = object_path(archives, digest)
    link = path.with_name(f".{path.name}.link")
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        if kept.is_file() and checksum(kept) == digest:
            os.link(kept, link)
            link.replace(path)
        else:
            os.link(path, link)
            link.replace(kept)
    except OSError:
        link.unlink(missing_ok=True)
        return False
    return True


@dataclass(frozen=True)
class Garbage:
    """What nobody refers to.

    Attributes:
        objects: contents of no archive.
        drafts: archives that a killed process left half written.
        size: bytes that deleting them frees.
    """

    objects: list[Path]
    drafts: list[Path]
    size: int


def garbage(root: str | os.PathLike[str] = ".") -> Garbage:
    """Find what no archive refers to; call it :func:`locked`, or only to tell.

    An object that something outside the archives still links to is kept too.

    Raises:
        ValueError: an archive's manifest is damaged, so nobody knows what it refers to.
    """
    archives = Path(root) / ARCHIVES
    referred: set[str] = set()
    for folder in sorted(archives.iterdir()) if archives.is_dir() else []:
        if folder.name.startswith(".") or not (folder / MANIFEST).is_file():
            continue
        listed = listed_files(folder)
        if listed is None or not seal_fits(folder):
            raise ValueError(
                f"{folder}: its manifest is damaged, so what it refers to is not known; nothing is "
                "collected. Restore the manifest, or move the folder away"
            )
        referred.update(str(entry.get("sha256")) for entry in listed.values())
    objects = [
        path
        for path in sorted((archives / OBJECTS).glob("*/*"))
        if path.name not in referred and path.stat().st_nlink == 1
    ]
    drafts = sorted(path for path in archives.glob(f".*{DRAFT}") if path.is_dir())
    inside = [path for draft in drafts for path in draft.rglob("*") if path.is_file()]
    alone = [path for path in inside if path.stat().st_nlink == 1]
    return Garbage(objects, drafts, sum(path.stat().st_size for path in [*objects, *alone]))


def collect(root: str | os.PathLike[str] = ".") -> Garbage:
    """Delete what no archive refers to, and tell what it was.

    Raises:
        ValueError: as :func:`garbage`.
    """
    with locked(Path(root) / ARCHIVES):
        found = garbage(root)
        for path in found.objects:
            path.unlink()
        for draft in found.drafts:
            shutil.rmtree(draft)
    return found


def seal_fits(folder: Path) -> bool:
    """Whether the manifest of an archive is as it was sealed."""
    seal = folder / SEAL
    return seal.is_file() and seal.read_bytes() == seal_text(folder).encode()


def seal_text(folder: Path) -> str:
    """The line that seals the manifest of an archive."""
    return f"{checksum(folder / MANIFEST)}  {MANIFEST}\n"
