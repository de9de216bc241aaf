"""Worker processes: same results, clear ends, no hang."""

import multiprocessing
import os

import numpy as np
import pytest

from squealpipe.systems import processes
from squealpipe.systems.processes import available_cores, run_shared


def _squares(arrays, first, stride):
    index = np.arange(first, arrays["out"].size, stride)
    arrays["out"][index] = index**2


SHAPES = {"out": ((1000,), np.float64)}


@pytest.mark.parametrize(
    ("jobs", "workers"), [*((1000, n) for n in (1, 2, 3, 7, None)), (2, 5), (0, None)]
)
def test_every_job_is_done_once_for_any_number_of_workers(
    jobs, workers, one_process, monkeypatch
):
    monkeypatch.setattr(processes, "workers_for", one_process)
    out = run_shared(
        _squares, {"out": ((jobs,), np.float64)}, jobs=jobs, workers=workers
    )["out"]
    np.testing.assert_array_equal(out, np.arange(jobs) ** 2)
    assert 1 <= available_cores() <= (os.cpu_count() or 1)


def test_a_dead_worker_is_an_error():
    def die(arrays, first, stride):
        if first == 1:
            os._exit(9)

    with pytest.raises(RuntimeError, match="exit code 9"):
        run_shared(die, SHAPES, jobs=1000, workers=2)


def test_an_error_in_the_parent_ends_the_children():
    def fail(arrays, first, stride):
        if first == 0:
            raise ArithmeticError("on purpose")
        multiprocessing.Event().wait(60)

    with pytest.raises(ArithmeticError):
        run_shared(fail, SHAPES, jobs=1000, workers=2)


def test_inside_a_daemonic_worker_the_work_runs_there():
    def nested(queue):
        queue.put(run_shared(_squares, SHAPES, jobs=1000, workers=2)["out"].sum())

    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    process = context.Process(target=nested, args=(queue,), daemon=True)
    process.start()
    assert queue.get(timeout=60) == np.sum(np.arange(1000.0) ** 2)
    process.join()
