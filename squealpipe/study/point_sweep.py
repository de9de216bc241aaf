"""A sweep whose points are run one by one by several processes, and kept until all are done."""

import time
from abc import abstractmethod
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_all_start_methods, get_context

import xarray as xr

from squealpipe.study.chunks import Chunks, Run
from squealpipe.study.sweep_plan import SweepPlan
from squealpipe.systems.processes import available_cores, leave_interrupts_to_the_parent
from squealpipe.systems.progress import alone

MOST_HELD = 2000
"""Finished runs that are held in memory."""


class PointSweep(SweepPlan):
    """A sweep of independent runs."""

    @property
    @abstractmethod
    def points(self) -> Sequence[Sequence[float]]:
        """Points in order, each as :meth:`arrays` takes it."""

    @abstractmethod
    def arrays(self, point: Sequence[float], workers: int | None) -> Run:
        """Return the results at one point; ``workers`` is for a run that uses several processes."""

    @abstractmethod
    def merged(self, runs: Callable[[], Iterator[Run]]) -> xr.Dataset:
        """Return the dataset of all runs, which can be read more than once."""

    def finished(self, kept: Chunks) -> int:
        """Return the number of runs that are on disk."""
        return kept.finished()

    def dataset(
        self, workers: int | None = None, kept: Chunks | None = None
    ) -> xr.Dataset:
        """Return the results of all runs; those that are kept are not made again."""
        made: list[Run] = []
        done, written = (kept.finished(), time.monotonic()) if kept else (0, 0.0)
        total = len(self.points)
        number = done
        with alone() as show:
            show(done / total)
            try:
                for number, run in enumerate(_runs(self, workers, done), done + 1):
                    made.append(run)
                    show(number / total)
                    # after 5 s of new results they go to disk: a stopped sweep loses no more
                    if kept and (
                        time.monotonic() - written > 5.0 or len(made) >= MOST_HELD
                    ):
                        kept.save(number - len(made), made)
                        made, written = [], time.monotonic()
            finally:
                if kept and made:
                    kept.save(number - len(made), made)
        return self.merged(kept.runs if kept else lambda: iter(made))


def _runs(sweep: PointSweep, workers: int | None, first: int) -> Iterator[Run]:
    """Yield the results of the runs from one on, in order."""
    points = sweep.points[first:]
    number = min(workers or available_cores(), len(points))
    if number < 2 or "fork" not in get_all_start_methods():
        for point in points:
            yield sweep.arrays(point, workers)
        return
    others = set(active_children())
    # handing over a short run costs more than the run: up to 32 go together
    most = max(1, min(32, len(points) // (8 * number)))
    size, at = 1, 0
    with ProcessPoolExecutor(
        number, get_context("fork"), leave_interrupts_to_the_parent
    ) as pool:
        try:
            # not by its map, which cancels runs to come: the pool's thread trips over those;
            # a few ahead, so that what waits to be read is bounded
            ahead: deque[Future[tuple[list[Run], float]]] = deque()
            while ahead or at < len(points):
                while at < len(points) and len(ahead) <= 4 * number:
                    ahead.append(pool.submit(_batch, sweep, points[at : at + size]))
                    at += size
                runs, seconds = ahead.popleft().result()
                # so that handing them over costs little, and an interruption loses little
                # s: an interruption loses the runs under way
                size = min(max(1, int(len(runs) * 0.5 / max(seconds, 1e-9))), most)
                yield from runs
        except BrokenProcessPool as error:
            raise RuntimeError(
                "a worker process was killed, perhaps for want of memory; run the same command "
                "again, with fewer --workers"
            ) from error
        except BaseException:
            for process in set(active_children()) - others:
                process.terminate()  # the pool is broken then and waits for no other run
            raise


def _batch(
    sweep: PointSweep, points: Sequence[Sequence[float]]
) -> tuple[list[Run], float]:
    """Run several points; return their results and the time they took, s."""
    started = time.monotonic()
    runs = [sweep.arrays(point, 1) for point in points]
    return runs, time.monotonic() - started
