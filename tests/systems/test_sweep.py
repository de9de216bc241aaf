"""Systems as tasks of sweeps: from a file, in parts, with a key that follows the file."""

import shutil
from pathlib import Path

import pytest
import xarray as xr

from squealpipe.config.ranges import sweep_config
from squealpipe.execution.chunks import Chunks
from squealpipe.execution.scatter import join
from squealpipe.execution.sweep import planned, run_sweep
from squealpipe.execution.system_sweep import SystemSweep
from squealpipe.rerun.key import rule_key
from squealpipe.systems.shipped import impact_oscillator


@pytest.fixture
def task(tmp_path, monkeypatch):
    """A system in the working folder, as the user names it."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(impact_oscillator.__file__, "impact.py")
    return "impact.py:impact_oscillator"


def config(task, **fixed):
    vary = {"omega": [0.8, 1.2, 1.6], "x0": [0.0, 0.5]}
    return sweep_config(
        task=task, vary=vary, fixed={"t_end": 20.0, **fixed}, parameters={"mu": 0.3}
    )


@pytest.mark.parametrize("run", ["ensemble", "basin"])
def test_a_sweep_of_a_system_is_its_ensemble_whole_or_in_parts(task, run):
    plan = planned(config(task, run=run, amplitude=0.6))
    whole = run_sweep(plan)
    method = getattr(impact_oscillator.impact_oscillator, run)
    direct = method(20.0, start={"x": [0.0, 0.5]}, omega=[0.8, 1.2, 1.6], amplitude=0.6)
    xr.testing.assert_identical(whole, direct)
    if run == "ensemble":  # which cannot number attractors of another part
        parts = [run_sweep(plan.scattered(f"{i}-of-2")) for i in (1, 2)]
        xr.testing.assert_equal(join(parts, "omega"), whole)


@pytest.mark.parametrize("run", ["ensemble", "basin"])
@pytest.mark.parametrize("blocks", [0, 1, 2, 99])
def test_a_sweep_of_a_system_that_was_stopped_goes_on_where_it_was(
    task, run, blocks, tmp_path, monkeypatch
):
    monkeypatch.setattr("squealpipe.execution.system_sweep.FIRST", 3)
    monkeypatch.setattr("squealpipe.execution.system_sweep.MOST", 6)
    given = config(task, run=run, amplitude=0.6)
    given["vary"] |= {"x0": [0.0, 0.5, 0.6, 0.7, 0.9]}
    plan, kept = planned(given), Chunks(tmp_path / ".runs", "0" * 16)
    whole, made, block = run_sweep(plan), [], SystemSweep._block

    def stopped(self, some, workers):
        if len(made) == blocks:
            raise KeyboardInterrupt
        made.append(some["x0"])
        return block(self, some, workers)

    with monkeypatch.context() as patch:
        patch.setattr(SystemSweep, "_block", stopped)
        if blocks == 99:
            run_sweep(plan, kept=kept)
        else:
            with pytest.raises(KeyboardInterrupt):
                run_sweep(plan, kept=kept)
    assert plan.finished(kept) == 3 * sum(map(len, made))
    assert (plan.finished(kept) == 15) is (blocks == 99)
    monkeypatch.setattr(
        SystemSweep,
        "_block",
        lambda self, some, workers: (
            made.append(some["x0"]) or block(self, some, workers)
        ),
    )
    xr.testing.assert_identical(run_sweep(plan, kept=kept), whole)
    if blocks != 99:  # no run was made twice
        assert [x0 for part in made for x0 in part] == given["vary"]["x0"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"task": "impact.py:oscillator"}, "no system 'oscillator'"),
        ({"task": "none.py:oscillator"}, "no file 'none.py'"),
        ({"amplitud": 1.0}, "did you mean 'amplitude'"),
        ({"run": "basins"}, "did you mean 'basin'"),
        ({"t_end": None}, "needs t_end"),
    ],
)
def test_what_cannot_be_run_is_refused_when_it_is_planned(task, change, message):
    given = config(change.pop("task", task), **change)
    given["fixed"] = {
        name: value for name, value in given["fixed"].items() if value is not None
    }
    with pytest.raises(ValueError, match=message):
        planned(given)


def test_the_key_of_a_sweep_follows_the_file(task):
    keys = [rule_key(config(task), [])]
    file = Path("impact.py")
    file.write_text(
        file.read_text(encoding="utf-8").replace("0.1", "0.2"), encoding="utf-8"
    )
    keys.append(rule_key(config(task), []))
    assert keys[0] != keys[1]
