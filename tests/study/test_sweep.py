"""Sweeps against the task run point by point; ragged runs; sweeps and maps joined from parts."""

import contextlib
import os
import re
import runpy
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr
import yaml

from squealpipe.brake.dynamics.runs import simulate, validity_map
from squealpipe.brake.linear.maps import stability_map
from squealpipe.cli import run as command
from squealpipe.ranges import longest, parse_range
from squealpipe.schema import Outcome, Variable, find
from squealpipe.store import load, save
from squealpipe.store.identity import dataset_id
from squealpipe.study.chunks import Chunks
from squealpipe.study.configuration.settings import parse_study
from squealpipe.study.job import Job
from squealpipe.study.scatter import join, scattered_rows
from squealpipe.study.sweep import Sweep, _in_order, outcome_lines, planned, run_sweep
from tests.former import FORMER

SCRIPTS = Path(__file__).parents[2] / "workflow/scripts"

ANGLES = [0.0, 1.0, 2.0]


def linear_sweep(**changes):
    vary = {"mu": [0.0, 0.4], "k3": [0.5, 0.75, 1.0], "alpha1": ANGLES}
    plan = {
        "task": "stability_map",
        "params": FORMER,
        "vary": vary,
        "fixed": {"alpha2": 0.6},
    }
    return Sweep(**{**plan, **changes})


def test_map_task_gets_swept_names_as_leading_dimensions():
    found = run_sweep(linear_sweep())
    assert found.growth_rate.dims == ("mu", "k3", "alpha1", "alpha2")
    for mu in (0.0, 0.4):
        for k3 in (0.5, 0.75, 1.0):
            alone = stability_map(FORMER.with_(mu=mu, k3=k3), ANGLES, [0.6])
            np.testing.assert_array_equal(
                found.frequency.sel(mu=mu, k3=k3), alone.frequency
            )
    assert found.mu.attrs["units"] == "1"
    assert found.k3.attrs["units"] == "N m-1"


def test_processes_and_fixed_parameters_give_the_same_bits():
    assert run_sweep(linear_sweep(), workers=2).identical(
        run_sweep(linear_sweep(), workers=1)
    )
    found = run_sweep(linear_sweep(fixed={"alpha2": 0.6, "mass": 2.0}))
    assert found.identical(run_sweep(linear_sweep(params=FORMER.with_(mass=2.0))))


def test_angles_and_options_can_be_swept_and_ragged_runs_are_filled_up(tmp_path):
    vary = {"alpha1": [0.5 * np.pi, 5 * np.pi / 6], "t_end": [20.0]}
    fixed = {"alpha2": 5 * np.pi / 6, "times": np.linspace(0, 20, 50)}
    plan = Sweep(task="simulate", params=FORMER, vary=vary, fixed=fixed)
    found = load(save(run_sweep(plan), tmp_path / "sweep.nc"))
    assert found.x.dims == ("alpha1", "t_end", "time")
    for k, alpha1 in enumerate(plan.vary["alpha1"]):
        alone = simulate(
            FORMER, alpha1, 5 * np.pi / 6, t_end=20.0, times=np.linspace(0, 20, 50)
        )
        count = int(found.event_count[k, 0])
        assert count == alone.sizes["event"]
        np.testing.assert_array_equal(found.event_time[k, 0, :count], alone.event_time)
        assert np.isnan(found.event_time[k, 0, count:]).all()
        assert (found.event_kind[k, 0, count:] == -1).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"task": "sing"}, "no task 'sing'; choose from simulate"),
        ({"task": "natural_frequency"}, "did you mean 'natural_frequencies'?"),
        ({"vary": {"nu": [1]}}, "'nu' cannot be varied"),
        ({"vary": {"my": [1]}}, "did you mean 'mu'?"),
        ({"vary": {"mu": []}}, "a 1-D array"),
        ({"vary": {"mu": [1, 1], "alpha1": [0]}}, "each once"),
        ({"vary": {"mu": [1]}}, "needs alpha1 once"),
        (
            {"vary": {"mu": [1], "alpha1": [1]}, "fixed": {"alpha1": 0, "alpha2": 0}},
            "alpha1 once",
        ),
        ({"fixed": {"alpha2": 0, "depth": 3}}, "no option 'depth'"),
        ({"vary": {"alpha1": ANGLES}}, "vary a parameter too"),
        ({"task": "simulate"}, "simulate needs t_end once"),
        ({"fixed": {"alpha2": 0, "mu": 0.1}}, "needs mu once"),
        ({"fixed": {"alpha2": 0, "mass": -1.0}}, "mass = -1.0: must be greater than 0"),
        (
            {"vary": {"friction_speed": [1, 2], "alpha1": [0]}},
            "friction_speed cannot vary: friction_law = 'coulomb' does not read it",
        ),
        (
            {
                "task": "simulate",
                "vary": {"sigma": [10.0, 100.0], "alpha1": [0]},
                "fixed": {"alpha2": 0, "t_end": 5.0},
            },
            "sigma cannot vary: A1 does not read it",
        ),
    ],
)
def test_plans_that_cannot_work_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        linear_sweep(**changes)


def test_an_option_with_a_parameters_name_is_the_option():
    fixed = {
        "alpha1": 0.94,
        "alpha2": 2.83,
        "mode": 1,
        "method": "hbm",
        "n_harmonics": 4,
    }
    plan = {"fixed": {**fixed, "y_peak_max": 1.2}, "vary": {"sigma": [3.0, 1000.0]}}
    found = run_sweep(Sweep(task="backbone", params=FORMER, **plan))
    assert not np.array_equal(found.omega[0], found.omega[1])


def test_schema_of_a_sweep_follows_from_its_name():
    schema = find("sweep of natural_frequencies over mu, belt_speed")
    assert schema.variables["omega"].dims[:2] == ("mu", "belt_speed")
    assert schema.coordinates["belt_speed"].units == "m s-1"
    with pytest.raises(ValueError, match="'colour' cannot be swept"):
        find("sweep of stability_map over colour")


@pytest.mark.release
def test_a_script_without_a_main_guard_can_sweep(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from squealpipe import Parameters, Sweep, run_sweep\n"
        "plan = Sweep(task='stability_map', params=Parameters(),\n"
        "             vary={'mu': [0.1, 0.2, 0.3]}, fixed={'alpha1': 1.0, 'alpha2': 2.0})\n"
        "print(run_sweep(plan, workers=2).sizes['mu'])\n"
    )
    command = [sys.executable, str(script)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout == "3\n", done.stderr


SCATTERED = {
    "ragged events": {
        "task": "simulate",
        "vary": {"mu": [0.1, 0.6], "alpha1": [1.6, 2.0, 5 * np.pi / 6, 2.7]},
        "fixed": {"alpha2": 5 * np.pi / 6, "t_end": 20.0},
    },
    "ragged branches": {
        "task": "backbone",
        "vary": {"k3": [0.5, 0.75, 1.0]},
        "fixed": {
            "alpha1": 0.3 * np.pi,
            "alpha2": 0.9 * np.pi,
            "mode": 1,
            "y_peak_max": 1.5,
        },
    },
    "log range": {
        "task": "periodic_orbit",
        "vary": {"mode": [1, 2], "y_peak": parse_range("1.1:4:7:log")},
        "fixed": {"alpha1": 0.3 * np.pi, "alpha2": 0.9 * np.pi},
    },
    "maps over a parameter": {
        "task": "validity_map",
        "vary": {
            "mu": [0.2, 0.4],
            "alpha1": np.linspace(0, np.pi, 5).tolist(),
            "alpha2": [0.5, 2],
        },
        "fixed": {"t_end": 20.0},
    },
    "one number a run": {
        "task": "stability_map",
        "vary": {"mu": parse_range("0:0.6:5")},
        "fixed": {"alpha1": 1.0, "alpha2": 2.0},
    },
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(
            name,
            marks=[pytest.mark.release] * (name in ("log range", "one number a run")),
        )
        for name in SCATTERED
    ],
)
def test_parts_joined_are_the_whole_bit_for_bit(name, tmp_path):
    plan = Sweep(params=FORMER, **SCATTERED[name])
    whole = run_sweep(plan)
    cut = longest(plan.vary)
    parts = []
    for k in range(3):
        path = save(run_sweep(plan.scattered(f"{k + 1}-of-3")), tmp_path / f"{k}.nc")
        parts.append(load(path))
    assert sum(part.sizes[cut] for part in parts) == whole.sizes[cut]
    joined = join(parts, cut)
    for written in ("dataset_id", "commit", "history"):
        assert joined.attrs.pop(written) == parts[0].attrs[written]
    assert joined.identical(whole)
    assert dataset_id(joined) == dataset_id(whole)
    if "ragged" in name:
        dim = "event" if plan.task == "simulate" else "point"
        assert len({part.sizes[dim] for part in parts}) > 1


def test_parts_are_the_values_once_each_and_no_more_than_there_are():
    plan = linear_sweep()
    parts = [plan.scattered(f"{k}-of-2").vary for k in (1, 2)]
    assert [value for part in parts for value in part["k3"]] == [0.5, 0.75, 1.0]
    assert all(part["mu"] == plan.vary["mu"] for part in parts)
    with pytest.raises(ValueError, match="at most 3 parts"):
        plan.scattered("1-of-4")


def test_runs_at_other_instants_are_not_put_on_one_axis():
    plan = {"vary": {"t_end": [5.0, 10.0]}, "fixed": {"alpha1": 1.6, "alpha2": 2.6}}
    with pytest.raises(  # before any run is made
        ValueError, match="time differs from run to run; fix the option 'times'"
    ):
        Sweep(task="simulate", params=FORMER, **plan)
    Sweep(
        task="simulate",
        params=FORMER,
        vary={"mu": [0.1, 0.2]},
        fixed={**plan["fixed"], "t_end": 5.0},
    )


RAGGED = {
    "task": "periodic_orbit",
    "params": FORMER,
    "vary": {"y_peak": [1.1, 1.5, 2.0, 3.0], "mu": [0.1, 0.3]},
    "fixed": {"mode": 1, "alpha1": 0.3 * np.pi, "alpha2": 0.9 * np.pi},
}


@pytest.mark.parametrize(
    "finished",
    [0, 3, 8, *(pytest.param(count, marks=pytest.mark.release) for count in (1, 7))],
)
def test_a_sweep_that_was_stopped_goes_on_where_it_was(tmp_path, monkeypatch, finished):
    kept, plan = Chunks(tmp_path / ".runs", "0" * 16), Sweep(**RAGGED)
    made, run = [], Sweep.run

    def stopped(self, point, workers=None):
        if len(made) == finished:
            raise KeyboardInterrupt
        made.append(point)
        return run(self, point, workers)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Sweep, "run", stopped)
        patch.setattr("squealpipe.study.point_sweep.MOST_HELD", 2)
        if finished < 8:
            with pytest.raises(KeyboardInterrupt):
                run_sweep(plan, workers=1, kept=kept)
        else:
            run_sweep(plan, workers=1, kept=kept)
    assert kept.finished() == finished
    monkeypatch.setattr(
        Sweep, "run", lambda *given: made.append(given[1]) or run(*given)
    )
    resumed = run_sweep(plan, workers=1, kept=kept)
    assert sorted(made) == sorted(plan.points)  # none was made twice
    assert resumed.identical(run_sweep(plan, workers=1))
    assert Chunks(tmp_path / ".runs", "1" * 16).finished() == 0  # of something else


def test_an_interrupted_sweep_keeps_what_its_processes_finished(tmp_path, monkeypatch):
    """The first runs are handed out one by one: a batch of 32 would be lost as a whole."""
    run, singles = Sweep.run, 9  # four for each of two processes, and one

    def stuck_at_last(self, point, workers=None):
        if self.points.index(point) >= singles:
            time.sleep(600.0)
        return run(self, point, workers)

    def interrupt_at_last(share):
        if share >= singles / 600:  # soon: while it waits for the next run
            signal.setitimer(signal.ITIMER_REAL, 0.1)

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Sweep, "run", stuck_at_last)
    monkeypatch.setattr(
        "squealpipe.study.point_sweep.alone",
        lambda: contextlib.nullcontext(interrupt_at_last),
    )
    plan = linear_sweep(
        vary={"mu": np.linspace(0.0, 1.0, 600).tolist(), "alpha1": [1.0]}
    )
    kept = Chunks(tmp_path / ".runs", "0" * 16)
    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 120.0)  # of a sweep that waits for all
    try:
        with pytest.raises(KeyboardInterrupt):
            run_sweep(plan, workers=2, kept=kept)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert kept.finished() == singles


def test_a_damaged_chunk_is_made_again(tmp_path):
    kept, plan = Chunks(tmp_path / ".runs", "0" * 16), Sweep(**RAGGED)
    whole = run_sweep(plan, workers=1, kept=kept)
    (chunk,) = kept.place.iterdir()
    content = bytearray(chunk.read_bytes())
    content[len(content) // 2] ^= 255
    chunk.write_bytes(content)
    assert kept.finished() == 0
    assert run_sweep(plan, workers=2, kept=kept).identical(whole)


@pytest.mark.parametrize(
    "lost", [0, 1, *(pytest.param(k, marks=pytest.mark.release) for k in (2, 3))]
)
def test_runs_behind_a_lost_chunk_are_made_again(tmp_path, monkeypatch, lost):
    kept, plan = Chunks(tmp_path / ".runs", "0" * 16), Sweep(**RAGGED)
    with monkeypatch.context() as patch:
        patch.setattr("squealpipe.study.point_sweep.MOST_HELD", 2)
        whole = run_sweep(plan, workers=1, kept=kept)
    chunks = sorted(kept.place.iterdir())
    chunks[lost].unlink()
    # in chunks of other lengths, so that those behind the gap would overlap
    assert run_sweep(plan, workers=1, kept=kept).identical(whole)
    assert len(list(kept.runs())) == 8


@pytest.mark.parametrize("changed", ["settings", "code", "nothing"])
def test_runs_of_other_settings_or_other_code_are_not_gone_on_with(
    tmp_path, monkeypatch, capsys, changed
):
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "quasi_static_map", "--vary", "mu=0.1:0.6:6", "--workers", "1"]
    words += ["--alpha1", "1", "--alpha2", "2", "-o", "a.nc"]
    with monkeypatch.context() as patch:
        run, made = Sweep.run, []

        def stopped(self, point, workers=None):
            made.append(point)
            if len(made) > 3:
                raise KeyboardInterrupt
            return run(self, point, workers)

        patch.setattr(Sweep, "run", stopped)
        assert command(words) == 130
    if changed == "settings":
        words += ["--k3", "3"]
    if changed == "code":
        others = [Path(__file__)]
        monkeypatch.setattr("squealpipe.store.rerun.key.sources", lambda *_: others)
    capsys.readouterr()
    assert command(words) == 0
    resumed = "3 of them are already computed" in capsys.readouterr().out
    assert resumed is (changed == "nothing")
    assert command([*words, "--force"]) == 0  # the whole of it
    assert not list(tmp_path.glob(".*"))


def test_a_job_of_the_study_goes_on_where_it_was(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    script = SCRIPTS / "execution/run_sweep.py"
    vary, fixed = {"mu": "0.1:0.6:6"}, {"alpha1": 1.0, "alpha2": 2.0}
    given = {"task": "quasi_static_map", "vary": vary, "fixed": fixed}
    study = parse_study({"sweeps": {"one": given}})
    job = SimpleNamespace(
        params=Mock(get=lambda *_: study.sweep("one"), key="0" * 16),
        output=["data/sweeps/one.nc"],
        wildcards={},
        rule="some",
        threads=1,
    )
    run, made = Sweep.run, []

    def stopped(self, point, workers=None):
        if len(made) == 3:
            made.append(None)
            raise KeyboardInterrupt
        made.append(point)
        return run(self, point, workers)

    monkeypatch.setattr(Sweep, "run", stopped)
    with pytest.raises(KeyboardInterrupt):
        runpy.run_path(str(script), {"snakemake": job})
    runpy.run_path(str(script), {"snakemake": job})
    assert len(made) == 7  # the one that was stopped among them
    assert load("data/sweeps/one.nc").sizes["mu"] == 6
    assert [path.name for path in Path("data/sweeps").iterdir()] == ["one.nc"]


def test_a_killed_worker_is_told_with_its_remedy(monkeypatch):
    monkeypatch.setattr(
        Sweep, "run", lambda *_, **__: os.kill(os.getpid(), signal.SIGKILL)
    )
    with pytest.raises(
        RuntimeError, match="run the same command again, with fewer --workers"
    ):
        run_sweep(Sweep(**RAGGED), workers=2)


@pytest.mark.release
def test_a_killed_command_goes_on_where_it_was(tmp_path):
    """Its dataset is that of a command that nobody disturbed."""
    words = [
        *(
            sys.executable,
            "-m",
            "squealpipe",
            "sweep",
            "hammering_map",
            "--workers",
            "2",
        ),
        *("--vary", "mu=0.1:0.6:60", "--alpha1", "5pi/6", "--alpha2", "5pi/6"),
        *("--option", "t_end=2000", "-o"),
    ]
    with subprocess.Popen([*words, "a.nc"], cwd=tmp_path) as sweep:
        until = time.monotonic() + 100
        whole = ".a.nc.runs/*/[0-9]*.npz"  # one that is being written starts with a dot
        while not list(tmp_path.glob(whole)) and sweep.poll() is None:
            assert time.monotonic() < until
            time.sleep(0.05)
        sweep.kill()
    killed = not (tmp_path / "a.nc").exists()
    again = subprocess.run(
        [*words, "a.nc"], cwd=tmp_path, check=True, capture_output=True
    )
    assert killed is (b"of them are already computed" in again.stdout)
    subprocess.run([*words, "b.nc"], cwd=tmp_path, check=True, capture_output=True)
    assert load(tmp_path / "a.nc").dataset_id == load(tmp_path / "b.nc").dataset_id
    assert not list(tmp_path.glob(".*"))


def test_the_sweeps_in_the_page_on_clusters_can_be_planned():
    page = Path(__file__).parents[2] / "docs/cluster.md"
    (block,) = re.findall(
        r"```yaml\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL
    )
    study = parse_study(yaml.safe_load(block))
    plans = {name: planned(study.sweep(name)) for name in study.sweeps}
    assert len(plans["orbits_over_friction"].points) == 52
    assert plans["contact_over_stiffness"].names == ["k3"]
    assert longest(plans["contact_over_stiffness"].vary) == "alpha1"


GRID = np.linspace(0, np.pi, 21)


def test_maps_joined_from_rows_are_the_map_bit_for_bit():
    for task, options in ((stability_map, {}), (validity_map, {"t_end": 30.0})):
        rows = [scattered_rows(21, f"{i}-of-3") for i in (1, 2, 3)]
        parts = [task(FORMER, GRID[chosen], GRID, **options) for chosen in rows]
        assert join(parts).identical(task(FORMER, GRID, GRID, **options))


@pytest.mark.parametrize("count", [1, 2, 3, 7, 21])
def test_scattered_parts_cover_every_row_once(count):
    slices = [scattered_rows(21, f"{i}-of-{count}") for i in range(1, count + 1)]
    assert [row for part in slices for row in range(21)[part]] == list(range(21))
    sizes = [part.stop - part.start for part in slices]
    assert max(sizes) - min(sizes) <= 1


def test_foreign_parts_are_not_joined():
    a = stability_map(FORMER, GRID[:3], GRID)
    with pytest.raises(ValueError, match="not blocks of rows of one map"):
        join([a, stability_map(FORMER, GRID[3:], GRID[:4])])
    with pytest.raises(ValueError, match="no parts"):
        join([])


def test_wall_times_of_a_job_cover_all_of_it(tmp_path, monkeypatch):
    """A boundary that was made before its file was had a wall time of 0.04 s."""
    monkeypatch.chdir(tmp_path)  # where it notes what it cost
    paths = [str(tmp_path / f"{name}.nc") for name in ("first", "second")]
    given = SimpleNamespace(
        params=SimpleNamespace(key="0" * 16, get=lambda *_: {}),
        wildcards={},
        rule="some",
        output=paths,
    )
    started = time.perf_counter()
    job = Job(given)
    time.sleep(0.05)
    made = stability_map(FORMER, ANGLES, ANGLES)
    job.make(lambda: made, paths[0])
    time.sleep(0.1)
    job.make(lambda: made, paths[1])
    took = [load(path).wall_time_s for path in paths]
    assert took[0] >= 0.05
    assert took[1] >= 0.1
    assert sum(took) <= time.perf_counter() - started


def test_values_go_with_their_words_where_runs_name_them_in_another_order():
    """Of two words an order is its own inverse: three tell it from that."""
    first = {"cure": np.array(["mu", "preload", "speed"])}
    run = {"cure": np.array(["speed", "mu", "preload"]), "change": np.array([3, 1, 2])}
    entries = {"change": Variable("change", dims=("cure",))}
    assert _in_order(run, first, entries)["change"].tolist() == [1, 2, 3]


def test_outcomes_of_a_sweep_are_told_by_their_number():
    codes = [
        Outcome.step_limit,
        *[Outcome.event_limit] * 3,
        *[Outcome.singular_geometry] * 2,
    ]
    flags = {
        "flag_values": np.array([3, 4, 5]),
        "flag_meanings": "step_limit event_limit singular_geometry",
    }
    told = outcome_lines(
        xr.Dataset({"outcome": ("mass", np.array(codes, "i4"), flags)}), ["mass"]
    )
    assert told[0] == (
        "outcome of 6 runs: event_limit 3, singular_geometry 2, step_limit 1"
    )
    assert [line.split(":")[0] for line in told[1:]] == (
        ["event_limit", "singular_geometry", "step_limit"]
    )
