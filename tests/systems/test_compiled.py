"""The store of compiled kernels: current, shared, and done without where nothing can be written."""

import gc
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

import squealpipe
from squealpipe.brake.orbits.modal_flow import advance
from squealpipe.brake.orbits.piecewise_linear import LinearState
from squealpipe.systems import compiled
from squealpipe.systems.taylor import kernels, lanes, machine

PACKAGE = Path(squealpipe.__file__).parent
PROGRAM = """
import math
from squealpipe.parameters import Parameters
from squealpipe.brake.backbones.orbit import periodic_orbit
params = Parameters(k3=0.75, mu=0.3, belt_speed=100.0, length1=5.0, length2=5.0)
found = periodic_orbit(params, math.pi / 2, math.pi, mode=2, y_peak=2.0)
print(repr(float(found.omega)))
"""
KNOWN = 1.23408516277258


@pytest.fixture
def copy(tmp_path):
    """A copy of the package without any compiled code."""
    shutil.copytree(
        PACKAGE, tmp_path / "squealpipe", ignore=shutil.ignore_patterns("__pycache__")
    )
    return tmp_path


def _run(folder, **environment):
    return subprocess.Popen(
        [sys.executable, "-B", "-c", PROGRAM],
        cwd=folder,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(folder), **environment},
        stderr=subprocess.PIPE,
        text=True,
    )


def _omega(process):
    out, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    return float(out)


@pytest.mark.parametrize(
    "decorator", ["part", "views", "inline", "inline_views", "polynomial"]
)
def test_python_that_calls_a_part_of_compiled_code_is_told_how(decorator):
    """It ended the process: there is no wrapper at the address that numba jumped to."""

    def double(number):
        return 2.0 * number

    kernel = getattr(compiled, decorator)(double)
    with pytest.raises(TypeError, match=r"double has no wrapper for Python: call it "):
        kernel(1.0)
    assert kernel.py_func(1.0) == 2.0


def test_a_part_is_compiled_once_for_constants_and_other_numbers():
    """A constant had a type of its own, so functions were compiled up to five times."""
    double = compiled.part(lambda number: 2 * number)
    both = numba.njit(lambda number: double(3) + double(number=number))
    assert both(4) == 14
    assert len(double.signatures) == 1


def test_an_edit_of_how_parts_are_compiled_compiles_the_loops_anew():
    assert Path(compiled.__file__).read_bytes() in lanes.sources_of(None)


def test_collection_of_garbage_waits_for_the_compiler_and_stays_off_where_it_was():
    assert gc.isenabled()
    with compiled.timed_compilation():
        with compiled.timed_compilation():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()
    gc.disable()
    try:
        with compiled.timed_compilation():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


@pytest.mark.release
def test_processes_and_checkouts_share_one_store(copy, tmp_path):
    place = {"XDG_CACHE_HOME": str(tmp_path / "cache"), "NUMBA_CACHE_DIR": ""}
    together = [_run(copy, **place) for _ in range(2)]
    assert [_omega(process) for process in together] == pytest.approx(
        [KNOWN] * 2, abs=1.2e-14
    )
    stores = list((tmp_path / "cache/squealpipe").glob("written-*"))
    assert len(stores) == 1
    kept = {path.name for path in stores[0].rglob("*.o")}
    assert kept
    (copy / "squealpipe").rename(tmp_path / "moved")
    (tmp_path / "other").mkdir()
    other = (tmp_path / "moved").rename(tmp_path / "other/squealpipe").parent
    assert _omega(_run(other, **place)) == pytest.approx(KNOWN, abs=1.2e-14)
    assert {path.name for path in stores[0].rglob("*.o")} == kept


def test_an_edit_of_any_kernel_compiles_all_of_its_folder_anew(monkeypatch):
    """numba itself would go by the file of the calling kernel alone."""
    folder = PACKAGE / "brake/orbits"
    taken = []
    monkeypatch.setattr(
        kernels, "addresses_of_entries", lambda *given: taken.append(given) or []
    )
    kernels.Kernels(folder).compile()
    ((_, content),) = taken
    for name in ("modal_flow", "shooting", "orbit_shape"):
        source = (folder / f"{name}.py").read_bytes()
        assert b"\n@kernel\n" in source
        assert source in content


@pytest.mark.parametrize("variable", ["XDG_CACHE_HOME", "NUMBA_CACHE_DIR"])
def test_who_waits_for_what_cannot_be_kept_is_told_why(monkeypatch, tmp_path, variable):
    """At every run it said: once on this machine."""
    (tmp_path / "file").write_text("", "utf-8")
    folder = str(tmp_path / "file" / "cache")
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    if variable == "NUMBA_CACHE_DIR":
        monkeypatch.setattr(numba.config, "CACHE_DIR", folder)
    monkeypatch.setenv("XDG_CACHE_HOME", folder)
    told = compiled._how_often.__wrapped__()
    assert told.startswith(f"compiling at every run (Not a directory: {folder}")
    assert told.endswith(f"; set {variable})")


def test_a_kernel_runs_where_the_store_is_full(monkeypatch, tmp_path):
    """The command ended with: No space left on device."""
    monkeypatch.setattr(machine, "store_folder", lambda *_: str(tmp_path))

    @kernels.Kernels(tmp_path)
    def double(number: float) -> float:
        return 2.0 * number

    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, usual[1]))
    try:
        assert double(2.0) == 4.0
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    assert not [*tmp_path.rglob("*")]


@pytest.mark.parametrize(
    "array", [np.arange(3), np.arange(6.0)[::2]], ids=["integers", "every other number"]
)
def test_python_that_hands_a_kernel_another_array_is_told_which(array):
    """It would read beside it."""
    point, out = np.array([0.4, 1.3, 0.0, 0.0]), np.zeros(8)
    row = LinearState(((1.0, 0.0), (0.0, 1.0)), (0.0, 0.0)).row(0.4)
    with pytest.raises(TypeError, match="coefficients: a contiguous array of float64"):
        advance(row, array, point)
    with pytest.raises(TypeError, match="row: a contiguous array of "):
        advance(array, out, point)


@pytest.mark.release
def test_without_any_place_to_write_kernels_are_compiled_in_memory(copy):
    """The place of the store is a file, which even root cannot write into."""
    blocked = copy / "blocked"
    blocked.write_text("", "utf-8")
    found = _run(
        copy, HOME=str(blocked), XDG_CACHE_HOME=str(blocked), NUMBA_CACHE_DIR=""
    )
    assert _omega(found) == pytest.approx(KNOWN, abs=1.2e-14)
