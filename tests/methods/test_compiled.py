"""The store of compiled kernels: current, shared, and done without where nothing can be written."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import squealpipe
from squealpipe.methods import compiled

PACKAGE = Path(squealpipe.__file__).parent
PROGRAM = """
import math
from squealpipe.parameters import Parameters
from squealpipe.tasks.backbones.orbit import periodic_orbit
found = periodic_orbit(Parameters(), math.pi / 2, math.pi, mode=2, y_peak=2.0)
print(repr(float(found.omega)))
"""
KNOWN = 1.23408516277258


@pytest.fixture
def copy(tmp_path):
    """A copy of the package without any compiled code."""
    shutil.copytree(PACKAGE, tmp_path / "squealpipe", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def _run(folder, **environment):
    return subprocess.Popen(
        [sys.executable, "-B", "-c", PROGRAM],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder), **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def _omega(process):
    out, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    return float(out)


def test_every_kernel_file_is_part_of_the_digest():
    """A kernel in a file that is not listed would be used stale after an edit."""
    methods = PACKAGE / "methods"
    using = {
        path.name for path in methods.rglob("*.py") if "\n@compiled\n" in path.read_text("utf-8")
    }
    assert len(using) > 4
    assert using <= {path.name for path in compiled.kernel_sources()}


def test_processes_that_start_together_share_one_store(copy):
    together = [_run(copy) for _ in range(2)]
    assert [_omega(process) for process in together] == pytest.approx([KNOWN] * 2, abs=1.2e-14)
    stores = list((copy / "squealpipe/methods/__pycache__").glob("kernels-*"))
    assert len(stores) == 1
    kept = {path.name for path in stores[0].rglob("*.nbc")}
    assert _omega(_run(copy)) == pytest.approx(KNOWN, abs=1.2e-14)
    assert {path.name for path in stores[0].rglob("*.nbc")} == kept


def test_an_edit_of_any_kernel_opens_a_new_store(copy, monkeypatch):
    """numba itself would go by the file of the calling kernel alone."""
    monkeypatch.setattr(compiled, "__file__", str(copy / "squealpipe/methods/compiled.py"))
    before = compiled._store.__wrapped__()
    edited = copy / "squealpipe/methods/orbits/modal_flow.py"
    edited.write_text(edited.read_text("utf-8") + "\n# edited\n", "utf-8")
    assert compiled._store.__wrapped__() != before


def test_without_any_place_to_write_kernels_are_compiled_in_memory(copy):
    """Every place that numba or we would choose is a file, which even root cannot write into."""
    blocked = copy / "blocked"
    blocked.write_text("", "utf-8")
    (copy / "squealpipe/methods/__pycache__").write_text("", "utf-8")
    found = _run(copy, HOME=str(blocked), XDG_CACHE_HOME=str(blocked), NUMBA_CACHE_DIR="")
    assert _omega(found) == pytest.approx(KNOWN, abs=1.2e-14)
