"""The room of systems stands alone: it takes nothing from the rest of the package."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import squealpipe.systems

ROOM = Path(squealpipe.systems.__file__).parent
PROGRAM = """
import sys
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
run = impact_oscillator.simulate("20 s", start={"x": 0.3}, omega=2.8)
cycle = impact_oscillator.limit_cycle(start={"x": 0.3}, t_settle=200.0, omega=2.8)
branch = impact_oscillator.cycle_branch("omega", 2.9, start=cycle)
assert float(run.time[-1]) == 20.0 and branch.sizes["point"] > 1
package = {name for name in sys.modules if name.startswith("squealpipe.")}
print(*sorted(n for n in package if not n.startswith("squealpipe.systems")))
"""


@pytest.mark.release
def test_a_copy_without_the_rest_of_the_package_runs(tmp_path):
    copy = tmp_path / "squealpipe"
    shutil.copytree(ROOM, copy / "systems")
    (copy / "__init__.py").touch()
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path), "HOME": str(Path.home())},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == []
