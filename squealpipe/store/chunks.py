"""Long jobs in chunks: progress while they run, and after a kill only what is missing runs."""

from __future__ import annotations

import concurrent.futures
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self, TypeVar

import numpy as np

from squealpipe.progress import Progress
from squealpipe.store.netcdf import StoreError

Chunk = TypeVar("Chunk")
Arrays = dict[str, np.ndarray]


MARK = "part of"
"""Entry of a kept chunk that says which one it is."""


@dataclass(frozen=True, kw_only=True)
class Checkpoint:
    """Where the chunks of an unfinished job wait, and the log of its progress.

    The folder's name is the job's key, so chunks made with
    other numbers or other code are never taken for one's own. As a context it removes the
    folder once the block, which saves the dataset, ends without an error.

    Attributes:
        directory: folder of the part files of exactly this job.
        log: file for progress lines, or None.
    """

    directory: Path
    log: Path | None = None

    @classmethod
    def beside(
        cls,
        output: str | os.PathLike[str],
        *,
        key: str,
        log: str | os.PathLike[str] | None = None,
    ) -> Checkpoint:
        """The checkpoint of a job that will write ``output``.

        Args:
            output: the dataset to be written; the folder lies beside it, hidden.
            key: digest of the configuration and code of the job.
            log: file for progress lines.
        """
        target = Path(output)
        shelf = target.parent / f".{target.name}.parts"
        return cls(directory=shelf / key, log=None if log is None else Path(log))

    def __enter__(self) -> Self:
        if self.directory.parent.is_dir():
            for other in self.directory.parent.iterdir():
                if other != self.directory:
                    shutil.rmtree(other, ignore_errors=True)
        self.directory.mkdir(parents=True, exist_ok=True)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None or not self.kept():
            shutil.rmtree(self.directory.parent, ignore_errors=True)

    def kept(self) -> int:
        """Finished chunks that wait here."""
        return sum(1 for _ in self.directory.rglob("*.npz"))

    def advice(self) -> str:
        """How to go on after an interrupt."""
        count = self.kept()
        if not count:
            return "nothing was finished; run the same command again"
        return f"{count} finished parts are kept; run the same command again to go on from them"

    def part(self, name: str) -> Checkpoint:
        """A checkpoint of its own for one of several chunked computations of a job."""
        directory = self.directory / name
        directory.mkdir(parents=True, exist_ok=True)
        return Checkpoint(directory=directory, log=self.log)

    def path(self, index: int) -> Path:
        """File of one chunk."""
        return self.directory / f"{index:06d}.npz"

    def write(self, index: int, arrays: Mapping[str, np.ndarray]) -> None:
        """Keep one chunk; it is whole or absent.

        The folder is made again if it went missing: a process that outlived its killed parent may
        have finished the same job and cleaned up.
        """
        temporary = self.path(index).with_suffix(f".{os.getpid()}.tmp")
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            with temporary.open("wb") as file:
                np.savez(file, **arrays, **{MARK: np.array(self._mark(index))})  # type: ignore[arg-type]
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(self.path(index))
        except FileNotFoundError:
            return  # cleaned up just now: the chunk is in memory, and only a restart would miss it
        except OSError as error:
            raise StoreError(
                f"cannot write {self.path(index)}: {error.strerror}; free space or fix "
                "permissions, then run the same command again"
            ) from error
        finally:
            temporary.unlink(missing_ok=True)

    def read(self, index: int) -> Arrays | None:
        """One chunk, or None if it is absent or damaged (it is then computed again).

        Raises:
            StoreError: the file is whole, but another computation's, or another part of this one.
        """
        try:
            with np.load(self.path(index), allow_pickle=False) as file:
                found = {name: file[name] for name in file.files}
        except (FileNotFoundError, zipfile.BadZipFile, ValueError, EOFError, OSError, KeyError):
            return None
        if str(found.pop(MARK, "")) != self._mark(index):
            raise StoreError(
                f"{self.path(index)} is a part of something else; delete it and run the same "
                "command again"
            )
        return found

    def _mark(self, index: int) -> str:
        return "/".join([*self.directory.parts[-2:], str(index)])


def run_chunks(
    compute: Callable[[Chunk], Mapping[str, np.ndarray]],
    chunks: Sequence[Chunk],
    *,
    checkpoint: Checkpoint | None = None,
    executor: concurrent.futures.Executor | None = None,
    sizes: Sequence[int] | None = None,
    label: str = "chunks",
    unit: str = "cells",
) -> list[Arrays]:
    """Results of ``compute`` for every chunk, in order.

    Args:
        compute: chunk → arrays by name; with an executor of processes it must be picklable.
        chunks: what to compute. Their number and order must follow from the configuration
            alone (never from the number of workers), or chunks kept earlier would not fit.
        checkpoint: keeps finished chunks; None computes all in memory.
        executor: runs the chunks; None runs them here, one after the other.
        sizes: work in each chunk, for rate and remaining time; 1 each by default.
        label, unit: words for the progress line.

    Raises:
        ValueError: ``sizes`` has another length than ``chunks``.
    """
    amounts = [1] * len(chunks) if sizes is None else list(sizes)
    if len(amounts) != len(chunks):
        raise ValueError(
            f"sizes has {len(amounts)} entries for {len(chunks)} chunks; give one each"
        )
    results: dict[int, Arrays] = {}
    if checkpoint is not None:
        for index in range(len(chunks)):
            kept = checkpoint.read(index)
            if kept is not None:
                results[index] = kept
    kept_amount = sum(amounts[index] for index in results)
    missing = [index for index in range(len(chunks)) if index not in results]
    log = None if checkpoint is None else checkpoint.log
    with Progress(sum(amounts), label, unit=unit, log=log, done=kept_amount) as progress:
        for index, arrays in _computed(compute, chunks, missing, executor):
            results[index] = dict(arrays)
            if checkpoint is not None:
                checkpoint.write(index, results[index])
            progress.advance(amounts[index])
    return [results[index] for index in range(len(chunks))]


def _computed(
    compute: Callable[[Chunk], Mapping[str, np.ndarray]],
    chunks: Sequence[Chunk],
    missing: Sequence[int],
    executor: concurrent.futures.Executor | None,
) -> Iterator[tuple[int, Mapping[str, np.ndarray]]]:
    if executor is None:
        for index in missing:
            yield index, compute(chunks[index])
        return
    waiting = {executor.submit(compute, chunks[index]): index for index in missing}
    for future in concurrent.futures.as_completed(waiting):
        yield waiting[future], future.result()
