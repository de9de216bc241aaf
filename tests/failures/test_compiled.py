"""Compiled code that fails is heard: no run counts as converged that nothing finished."""

import ctypes

import numba
import numpy as np
import pytest
from numba import types

from squealpipe import Parameters, simulate
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.schema import Outcome
from squealpipe.systems import integrate


def kernel_that_divides_by_zero():
    def divide(table):
        return 1 // len("")

    compiled = numba.cfunc(types.intp(types.voidptr))(divide)
    function = ctypes.CFUNCTYPE(ctypes.c_ssize_t, ctypes.c_void_p)(compiled.address)
    function.code = compiled
    return function


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("workers", [1, 2])
def test_exception_in_compiled_code_reaches_the_caller(monkeypatch, workers):
    failing = kernel_that_divides_by_zero()
    monkeypatch.setattr(integrate.Batch, "loop", staticmethod(lambda: failing))
    with pytest.raises(RuntimeError, match="exception in compiled code"):
        run_ensemble(
            Parameters(), np.linspace(1.0, 2.0, 4), 2.6, t_end=1.0, workers=workers
        )


@pytest.mark.parametrize("model", ["A1", "A4", "A1-linear-springs"])
@pytest.mark.parametrize("length", ["length1", "length2"])
@pytest.mark.parametrize(
    "size", [1e-155, 1e-170]
)  # at the first, surfaces without a bound
def test_vanishing_length_earns_no_success_without_states(model, length, size):
    away, params = (0.0, 0.4, 0.0, 0.0), Parameters(**{length: size})
    found = simulate(params, 0.0, 1.0, t_end=2.0, model=model, initial_state=away)
    whole = all(np.isfinite(found[name]).all() for name in ("x", "y", "vx", "vy"))
    assert (found.outcome == Outcome.converged) == whole
