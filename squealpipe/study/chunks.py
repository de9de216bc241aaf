"""Finished runs of a sweep on disk, so that the same command resumes where it stopped."""

import hashlib
import io
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.store.whole_files import checksum, whole_file

Run = dict[str, np.ndarray]
"""Results of one run: array by name."""
SHAPES = " shapes"
"""Ends the name of the array with the shapes of another one's parts."""


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
        content = io.BytesIO()
        np.savez(content, **_end_to_end(runs))
        digest = hashlib.sha256(content.getvalue()).hexdigest()
        target = self.place / f"{first}-{first + len(runs)}-{digest}.npz"
        with whole_file(target) as temporary:
            temporary.write_bytes(content.getvalue())

    def finished(self) -> int:
        """Number of runs from the first on that are there without a gap.

        Chunks that are damaged, or lie behind a gap, are removed: their runs are made again.
        """
        end, follows = 0, True
        for first, last, path in self._files():
            is_whole = path.stem.endswith(f"-{checksum(path)}")
            follows = follows and first == end and is_whole
            if follows:
                end = last
            else:
                path.unlink(missing_ok=True)
        return end

    def runs(self) -> Iterator[Run]:
        """The runs that are there, in order, one chunk at a time in memory."""
        for first, last, path in self._files():
            with np.load(path, allow_pickle=False) as chunk:
                runs = _one_by_one(chunk, last - first)
            yield from runs

    def remove(self) -> None:
        """Remove the folder, whose runs are in the sweep's dataset now."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _files(self) -> list[tuple[int, int, Path]]:
        files = []
        for path in self.place.glob("[0-9]*-[0-9]*-*.npz"):
            first, last, _ = path.stem.split("-")
            files.append((int(first), int(last), path))
        return sorted(files)


def beside(output: Path, key: str) -> Chunks:
    """Return the folder that keeps the runs of a sweep until its dataset is written."""
    return Chunks(output.with_name(f".{output.name}.runs"), key)


def _end_to_end(runs: list[Run]) -> dict[str, Any]:
    """Each name's values of all runs in one array, for an entry of a file costs a kilobyte."""
    arrays = {}
    for name in runs[0]:
        values = [run[name] for run in runs]
        arrays[name] = np.concatenate([value.ravel() for value in values])
        arrays[name + SHAPES] = np.array([value.shape for value in values])
    return arrays


def _one_by_one(chunk: Mapping[str, np.ndarray], count: int) -> list[Run]:
    """The runs that :func:`_end_to_end` put together."""
    runs: list[Run] = [{} for _ in range(count)]
    for name in chunk:
        if name.endswith(SHAPES):
            continue
        shapes = chunk[name + SHAPES].astype(int)
        ends = np.cumsum(shapes.prod(axis=1))
        parts = np.split(chunk[name], ends[:-1])
        for run, part, shape in zip(runs, parts, shapes.tolist(), strict=True):
            run[name] = part.reshape(shape)
    return runs
