"""Finished runs of a sweep on disk, so that the same command goes on where it was."""

from __future__ import annotations

import hashlib
import io
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.store.whole_files import checksum, whole_file

Run = dict[str, np.ndarray]
"""What one run gave: array by name."""


@dataclass(frozen=True)
class Chunks:
    """A folder with chunks of runs, ``<first>-<last>-<digest>.npz``: arrays, no code.

    Attributes:
        key: of what they are made from; a folder of another key is not gone on with.
    """

    folder: Path
    key: str

    @property
    def place(self) -> Path:
        """Folder of the runs with this key."""
        return self.folder / self.key

    def save(self, first: int, runs: list[Run]) -> None:
        """Write consecutive runs, whole or not at all."""
        arrays: dict[str, Any] = {
            f"{number} {name}": values
            for number, run in enumerate(runs)
            for name, values in run.items()
        }
        content = io.BytesIO()
        np.savez(content, **arrays)
        digest = hashlib.sha256(content.getvalue()).hexdigest()
        target = self.place / f"{first}-{first + len(runs)}-{digest}.npz"
        with whole_file(target) as temporary:
            temporary.write_bytes(content.getvalue())

    def finished(self) -> int:
        """Number of runs from the first on that are there without a gap."""
        end = 0
        for first, last, path in self._files():
            if first != end or not _is_whole(path):
                break
            end = last
        return end

    def runs(self) -> Iterator[Run]:
        """The runs that are there, in order, one chunk at a time in memory."""
        for first, last, path in self._files():
            with np.load(path, allow_pickle=False) as chunk:
                runs: list[Run] = [{} for _ in range(last - first)]
                for entry in chunk.files:
                    number, _, name = entry.partition(" ")
                    runs[int(number)][name] = chunk[entry]
            yield from runs

    def remove(self) -> None:
        """Remove the folder, whose runs are in the sweep's dataset now."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _files(self) -> list[tuple[int, int, Path]]:
        found = []
        for path in self.place.glob("[0-9]*-[0-9]*-*.npz"):
            first, last, _ = path.stem.split("-")
            found.append((int(first), int(last), path))
        return sorted(found)


def _is_whole(path: Path) -> bool:
    """Whether a chunk is as it was written; one that is damaged is removed and made again."""
    if path.stem.endswith(f"-{checksum(path)}"):
        return True
    path.unlink()
    return False
