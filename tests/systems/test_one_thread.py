"""Linear algebra by one thread: NumPy's and SciPy's, and as many as before afterwards."""

import ctypes
import threading

import numpy.linalg._umath_linalg as in_numpy
import pytest
import scipy.linalg._fblas as in_scipy

from squealpipe.systems.inputs.gate import checked
from squealpipe.systems.one_thread import one_thread


@pytest.fixture(
    params=[(in_numpy, "64_"), (in_scipy, "")], ids=["NumPy's BLAS", "SciPy's BLAS"]
)
def threads(request):
    """Number of threads of one library, which is two for the test."""
    module, end = request.param
    library = ctypes.CDLL(module.__file__)
    if not hasattr(library, f"scipy_openblas_set_num_threads{end}"):
        pytest.skip("another BLAS here")
    change = getattr(library, f"scipy_openblas_set_num_threads{end}")
    change(2)
    yield getattr(library, f"scipy_openblas_get_num_threads{end}")
    change(1)


def test_what_is_public_runs_with_one_thread_and_restores_the_number(threads):
    @checked
    def public(again: bool) -> int:
        return public(False) if again else threads()

    assert threads() == 2
    assert public(True) == 1
    assert threads() == 2


def test_calls_from_two_threads_restore_the_number_when_the_last_one_ends(threads):
    """The first one in is the first one out."""
    inside, leave = threading.Event(), threading.Event()

    def first():
        with one_thread():
            inside.set()
            leave.wait(10.0)

    other = threading.Thread(target=first)
    other.start()
    inside.wait(10.0)
    with one_thread():
        leave.set()
        other.join()
        assert threads() == 1
    assert threads() == 2
