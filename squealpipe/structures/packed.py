"""Files that gzip has packed, read as if they were not."""

import gzip
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def is_packed(path: Path) -> bool:
    """Tell whether gzip has packed a file."""
    with path.open("rb") as file:
        gzip_mark = b"\x1f\x8b"
        return file.read(len(gzip_mark)) == gzip_mark


def plain_name(path: Path) -> Path:
    """Return the name without ``.gz``."""
    return path.with_suffix("") if path.suffix.lower() == ".gz" else path


def bytes_of(path: Path) -> bytes:
    """Return what a file holds, unpacked.

    Raises:
        ValueError: it is packed but cut off or damaged.
    """
    if not is_packed(path):
        return path.read_bytes()
    try:
        return gzip.decompress(path.read_bytes())
    except (OSError, EOFError, zlib.error) as error:
        raise ValueError(f"{path} is packed by gzip but damaged: {error}") from error


def text_of(path: Path) -> str:
    """Return the text of a file, unpacked; signs that are not UTF-8 are replaced."""
    return bytes_of(path).decode("utf-8-sig", errors="replace")


@contextmanager
def unpacked(path: Path) -> Iterator[Path]:
    """Yield a path to the plain file, in a temporary folder where the file is packed.

    Libraries read files by their name alone.
    """
    if not is_packed(path):
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / plain_name(path).name
        plain.write_bytes(bytes_of(path))
        yield plain
