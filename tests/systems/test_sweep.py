"""Systems as tasks of sweeps: from a file, in parts, with a key that follows the file."""

import shutil
from pathlib import Path

import pytest
import xarray as xr

from squealpipe.ranges import sweep_config
from squealpipe.store.rerun.key import rule_key
from squealpipe.study.chunks import Chunks
from squealpipe.study.scatter import join
from squealpipe.study.sweep import planned, run_sweep
from squealpipe.study.system_sweep import SystemSweep
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


@pytest.mark.parametrize(
    ("run", "along", "blocks"),
    [
        ("ensemble", "omega", 1),
        ("ensemble", "omega", 99),
        ("basin", "x0", 0),
        ("basin", "x0", 2),
        *(
            pytest.param(*each, marks=pytest.mark.release)
            for each in (
                ("ensemble", "omega", 0),
                ("ensemble", "omega", 2),
                ("basin", "x0", 1),
                ("basin", "x0", 99),
            )
        ),
    ],
)
def test_a_sweep_of_a_system_that_was_stopped_goes_on_where_it_was(
    task, run, along, blocks, tmp_path, monkeypatch
):
    monkeypatch.setattr("squealpipe.study.system_sweep.FIRST_BLOCK", 6)
    monkeypatch.setattr("squealpipe.study.system_sweep.LARGEST_BLOCK", 12)
    given = config(task, run=run, amplitude=0.6)
    omega, x0 = [0.8, 1.0, 1.2, 1.4, 1.6, 1.9], [0.0, 0.5, 0.6, 0.7, 0.9]
    given["vary"] = {"omega": omega, "x0": x0}
    plan, kept = planned(given), Chunks(tmp_path / ".runs", "0" * 16)
    whole, made, block = run_sweep(plan), [], SystemSweep._block

    def seen(self, some, workers):
        if len(made) == blocks:
            raise KeyboardInterrupt
        made.append(some[along])
        return block(self, some, workers)

    with monkeypatch.context() as patch:
        patch.setattr(SystemSweep, "_block", seen)
        if blocks == 99:
            run_sweep(plan, kept=kept)
        else:
            with pytest.raises(KeyboardInterrupt):
                run_sweep(plan, kept=kept)
    done = sum(map(len, made))
    assert plan.finished(kept) == done * 30 // len(given["vary"][along])
    assert (plan.finished(kept) == 30) is (blocks == 99)
    blocks = -1
    monkeypatch.setattr(SystemSweep, "_block", seen)
    xr.testing.assert_identical(run_sweep(plan, kept=kept), whole)
    if done < len(given["vary"][along]):  # no run was made twice
        assert [value for part in made for value in part] == given["vary"][along]


WELLS = """
from squealpipe import System
wells = System(
    "two wells", states={"x": "m", "v": "m/s"}, parameters={"c": 1.0}, regimes={"free": {}},
    field=lambda t, s, p, r: {"x": s.v, "v": s.x - s.x**3 - p.c * s.v},
    switches=[], start={"x": 0.5, "v": 0.0},
)
"""


def test_attractors_are_numbered_over_all_parts(tmp_path, monkeypatch):
    monkeypatch.setattr("squealpipe.study.system_sweep.FIRST_BLOCK", 1)
    monkeypatch.chdir(tmp_path)
    Path("wells.py").write_text(WELLS)
    fixed = {"run": "basin", "t_end": 60.0}
    vary = {"x0": [1.0, -1.0], "c": [1.0, 2.0]}  # the first is in a block of its own
    plan = planned(
        sweep_config(task="wells.py:wells", vary=vary, fixed=fixed, parameters={})
    )
    found = run_sweep(plan, kept=Chunks(tmp_path / ".runs", "0" * 16))
    assert found.attractor.values.tolist() == [[0, 0], [1, 1]]


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
