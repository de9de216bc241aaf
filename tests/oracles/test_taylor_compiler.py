"""heyoka's compiler leaves nothing behind."""

import os
import subprocess
import sys

RUN = """
from tests.oracles.a1_long_double import simulate_reference
from tests.former import FORMER
simulate_reference(FORMER, 1.0, 2.0, t_end=1.0)
"""


def test_no_compiled_code_is_stored_outside_the_project(tmp_path):
    environment = {**os.environ, "HOME": str(tmp_path), "HEYOKA_CACHE_DIR": str(tmp_path / "store")}
    subprocess.run([sys.executable, "-c", RUN], env=environment, check=True)
    assert {path.name for path in tmp_path.iterdir()} <= {".cache"}  # of numba, see compiled
