"""Work spread over processes that write into shared arrays.

Processes are forked, so nothing is pickled, compiled code is shared and a script needs no main
guard. Where forking is not possible (other systems, or inside a daemonic worker) the work runs in
this process.
"""

import ctypes
import mmap
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Mapping
from math import prod
from typing import Any

import numpy as np

from squealpipe.systems.progress import shown

Work = Callable[[dict[str, np.ndarray], int, int], None]


def cpu_time() -> float:
    """CPU time of this process and of those that it started and that have ended, s."""
    children = os.times()
    return time.process_time() + children.children_user + children.children_system


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def workers_for(jobs: int) -> int:
    """Processes for so many jobs, where none are asked for."""
    # with fewer jobs a process a fork costs more than it saves
    minimum_jobs = 64
    return max(1, min(available_cores(), jobs // minimum_jobs))


def run_shared(
    work: Work,
    shapes: Mapping[str, tuple[tuple[int, ...], Any]],
    *,
    jobs: int,
    workers: int | None,
) -> dict[str, np.ndarray]:
    """Call ``work(arrays, first, stride)`` in several processes for interleaved jobs.

    Args:
        work: handles the jobs first, first + stride, … and writes their rows of the arrays.
        workers: processes; None takes all cores, at most one for every 64 jobs.
    """
    if workers is None:
        workers = workers_for(jobs)
    workers = min(workers, max(1, jobs))
    daemon = multiprocessing.current_process().daemon
    if workers == 1 or daemon or "fork" not in multiprocessing.get_all_start_methods():
        arrays = {
            name: np.zeros(shape, dtype) for name, (shape, dtype) in shapes.items()
        }
        work(arrays, 0, 1)
        return arrays
    arrays = {
        name: _shared_array(shape, dtype) for name, (shape, dtype) in shapes.items()
    }
    context = multiprocessing.get_context("fork")
    processes = [
        context.Process(
            target=_in_child, args=(work, arrays, first, workers), daemon=True
        )
        for first in range(1, workers)
    ]
    for process in processes:
        process.start()
    try:
        work(arrays, 0, workers)
        for process in processes:
            process.join()
    except BaseException:
        for process in processes:
            process.terminate()
        raise
    failed = next((process.exitcode for process in processes if process.exitcode), 0)
    if failed:
        raise RuntimeError(
            f"a worker process ended with exit code {failed}; run again with workers=1 to see why"
        )
    return arrays


def leave_interrupts_to_the_parent() -> None:
    """Let a worker ignore Ctrl-C, which reaches the whole group; the parent ends its workers.

    If the parent is killed, the worker ends with it, where the system (Linux) can tell it.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
    if sys.platform == "linux":
        parent = os.getppid()
        # 1: PR_SET_PDEATHSIG of Linux's <sys/prctl.h>
        ctypes.CDLL(None).prctl(1, signal.SIGTERM)
        if os.getppid() != parent:  # it died meanwhile
            os._exit(1)


def _in_child(
    work: Work, arrays: dict[str, np.ndarray], first: int, stride: int
) -> None:
    leave_interrupts_to_the_parent()
    with shown(None):
        work(arrays, first, stride)


def _shared_array(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    size = prod(shape) * np.dtype(dtype).itemsize
    return np.frombuffer(mmap.mmap(-1, max(1, size)), dtype, count=prod(shape)).reshape(
        shape
    )
