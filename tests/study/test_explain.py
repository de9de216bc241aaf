"""The plan in words: rules, keys and sources, figures, and the time that they took before."""

import base64
import json
import os
import subprocess
import sys
import textwrap
from dataclasses import replace
from pathlib import Path

import pytest

from squealpipe.store.rerun.key import PLAN_VARIABLE, file_key, state_key
from squealpipe.store.rerun.sources import PACKAGE
from squealpipe.study.durations import JobCost, job_costs, job_times, record_cost
from squealpipe.study.explain import (
    Explanation,
    PlannedJob,
    WorkflowError,
    _changed_content,
    _changing,
    explain,
    snakemake_command,
)


def job(rule, seconds, outputs=(), reasons=(), follows=()):
    lists = {
        "outputs": list(outputs),
        "reasons": list(reasons),
        "follows": list(follows),
    }
    return PlannedJob(rule=rule, seconds=seconds, **lists)


def test_plan_names_figures_and_time():
    jobs = [
        job(
            "map_validity",
            10.0,
            ["results/data/validity_map.nc"],
            ["parameters.mu: 0.3 → 0.4"],
        ),
        job(
            "draw_linear",
            2.0,
            [f"results/figures/fig07.{end}" for end in ("png", "svg")],
        ),
        job(
            "draw_model",
            None,
            ["results/figures/fig01.png"],
            ["missing"],
            ["map_validity"],
        ),
    ]
    plan = Explanation(jobs=jobs, cores=2)
    assert plan.figures == ["fig01", "fig07"]
    assert Explanation(jobs=[replace(jobs[1], changing=["fig08"])]).figures == ["fig08"]
    assert plan.seconds == 10.0, "no less than the longest job"
    assert plan.estimate() == (
        "about 10 s on 2 cores, from recorded times; not counted, never run: draw_model"
    )
    assert jobs[2].why() == "missing; follows map_validity"
    assert json.loads(json.dumps(plan.as_dict()))["jobs"][0]["rule"] == "map_validity"
    assert "no time estimate" in Explanation(jobs=[jobs[2]]).estimate()


@pytest.mark.release
def test_a_job_writes_down_its_cpu_time_and_that_of_its_children(tmp_path):
    """Half a second in the process and half a second in a child, beside a second of sleep."""
    (tmp_path / ".snakemake/metadata").mkdir(parents=True)
    (tmp_path / ".snakemake/metadata/one").write_text(
        json.dumps({"rule": "busy", "starttime": 10.0, "endtime": 13.5})
    )
    script = r"""
        import subprocess, sys, time
        from squealpipe.study.durations import record_cost
        from squealpipe.systems.compiled import timed_compilation
        busy = "import time\nwhile time.process_time() < 0.5: pass"
        subprocess.run([sys.executable, "-c", busy])
        time.sleep(1.0)
        before = time.process_time()
        with timed_compilation():
            with timed_compilation():
                while time.process_time() < before + 0.5: pass
        record_cost("busy", "1-of-1")
    """
    subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)], cwd=tmp_path, check=True
    )
    used = os.times()
    cost = job_costs(tmp_path)["busy"]
    assert cost.compiling == pytest.approx(0.5, abs=0.1)
    assert 1.0 < cost.cpu <= used.children_user + used.children_system + 0.05
    assert cost.clock == 3.5


def test_parts_of_a_scattered_rule_add_up_and_those_of_an_earlier_run_do_not(
    tmp_path, monkeypatch
):
    (tmp_path / ".snakemake").mkdir()
    monkeypatch.chdir(tmp_path)
    record_cost("map", "1-of-1")
    for item in ("1-of-2", "2-of-2"):
        record_cost("map", item)
    costs = tmp_path / ".snakemake/squealpipe/costs"
    for age, name in enumerate(("map.1-of-1", "map.1-of-2", "map.2-of-2")):
        record = json.loads((costs / f"{name}.json").read_text())
        record |= {"cpu": 2.0, "compiling": 0.5}
        (costs / f"{name}.json").write_text(json.dumps(record))
        os.utime(costs / f"{name}.json", (1000.0 + age, 1000.0 + age))
    assert job_costs(tmp_path) == {"map": JobCost(4.0, 1.0)}


def test_of_the_figures_that_a_rule_draws_those_change_that_an_edit_reaches(tmp_path):
    """A module of one of them is edited, or a dataset of one is pending; the rule draws both."""
    (tmp_path / "figures").mkdir()
    for name in ("one.py", "two.py", "figures/one.png", "figures/two.png"):
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (1000.0, 1000.0))
    outputs = {
        f"figures/{name}.png": {
            "reads": [f"data/{name}.nc"],
            "imports": [str(tmp_path / f"{name}.py")],
        }
        for name in ("one", "two")
    }
    assert _changing(tmp_path, outputs, {"data/one.nc"}) == ["one"]
    assert _changing(tmp_path, outputs, set()) is None, "what is drawn with all of them"
    os.utime(tmp_path / "two.py", (2000.0, 2000.0))
    assert _changing(tmp_path, outputs, set()) == ["two"]
    (tmp_path / "figures/one.png").unlink()
    assert _changing(tmp_path, outputs, set()) == ["one", "two"]


def test_times_come_from_snakemakes_records(tmp_path):
    folder = tmp_path / ".snakemake/metadata"
    folder.mkdir(parents=True)
    for name, start, end in (("a", 1.0, 3.0), ("b", 1.0, 3.001)):
        record = {"rule": "map_linear", "starttime": start, "endtime": end}
        (folder / name).write_text(json.dumps(record))
    (folder / "damaged").write_text("{")
    assert job_times(tmp_path) == {"map_linear": pytest.approx(2.0, abs=0.01)}


def test_times_are_those_of_one_study(tmp_path):
    """Its results stand beside those of a study whose folder begins with the same letters."""
    folder = tmp_path / ".snakemake/metadata"
    folder.mkdir(parents=True)
    for file, end in (("results/disc/data/a.nc", 3.0), ("results/disc2/a.nc", 9.0)):
        record = {"rule": "run", "starttime": 1.0, "endtime": end}
        name = base64.urlsafe_b64encode(file.encode()).decode()
        (folder / name).write_text(json.dumps(record))
    assert job_times(tmp_path, "results/disc") == {"run": 2.0}
    assert job_times(tmp_path) == {"run": 8.0}


@pytest.mark.parametrize(
    ("text", "results"),
    [("", "results/quick"), ("results: results/mine\n", "results/mine-quick")],
)
def test_a_quick_study_goes_beside_the_full_one(tmp_path, text, results):
    """Also where the overlay names a folder of its own."""
    mine = tmp_path / "mine.yaml"
    mine.write_text(text)
    command, study = snakemake_command([mine], quick=True)
    assert study.results == results
    assert f"results={results}" in command
    assert (str(mine) in command) == bool(text), "Snakemake takes no empty file"


@pytest.mark.release
def test_what_cannot_be_planned_is_one_message(tmp_path, monkeypatch):
    (tmp_path / "Snakefile").write_text("raise ValueError('broken')\n")
    monkeypatch.setattr("squealpipe.study.explain.WORKFLOW", tmp_path)
    with pytest.raises(WorkflowError, match="broken"):
        explain(directory=tmp_path)


def test_without_snakemake_a_study_says_what_to_install(tmp_path, monkeypatch):
    """After README's first line a run ended with: No module named snakemake."""
    monkeypatch.setitem(sys.modules, "snakemake", None)
    with pytest.raises(WorkflowError, match=r"pip install 'squealpipe\[study\]'"):
        snakemake_command(directory=tmp_path)


@pytest.mark.parametrize("ask", [snakemake_command, explain])
def test_a_checkout_with_a_package_of_its_own_says_which_was_imported(ask, tmp_path):
    (tmp_path / "Snakefile").touch()
    package = tmp_path / "squealpipe"
    package.mkdir()
    (package / "__init__.py").write_bytes((PACKAGE / "__init__.py").read_bytes())
    snakemake_command(directory=tmp_path)  # installed from this folder
    (package / "__init__.py").touch()
    (package / "reading.py").write_text("edited = True\n")
    with pytest.raises(WorkflowError) as caught:
        ask(directory=tmp_path)
    assert f"imported from {PACKAGE}, but" in str(caught.value)
    assert f"PYTHONPATH={tmp_path} before the command" in str(caught.value)


def test_an_edited_file_that_the_settings_name_is_the_reason(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    output, table = tmp_path / "answer.nc", tmp_path / "brake.yaml"
    module = tmp_path / "module.py"
    for age, path in enumerate((output, table, module)):
        path.write_text("mu: 0.5\n")
        os.utime(path, (1e9 + age, 1e9 + age))
    made = {"settings": {"structure": {"file": "brake.yaml"}}, "sources": [str(module)]}
    assert _changed_content(output, made) == "changed: brake.yaml"
    os.utime(table, (1e9 - 1.0, 1e9 - 1.0))
    assert _changed_content(output, made) == "code changed, of module.py"


def test_a_result_that_states_another_key_is_planned_though_snakemake_would_not(
    tmp_path, monkeypatch
):
    """Snakemake knows when a file was made, not what is in it: one may be copied from elsewhere."""
    paths = [f"results/data/{name}.json" for name in ("right", "copied")]
    made = {
        path: {
            "rule": f"make_{Path(path).stem}",
            "key": file_key(16 * "a", path),
            "inputs": [],
            "settings": {},
            "sources": [],
        }
        for path in paths
    }
    (tmp_path / "results/data").mkdir(parents=True)
    for path, key in zip(paths, (16 * "a", 16 * "b"), strict=True):
        (tmp_path / path).write_text('{"value": 1}', encoding="utf-8")
        state_key(tmp_path / path, key)

    def planned(command, env, **options):
        Path(env[PLAN_VARIABLE]).write_text(json.dumps(made), encoding="utf-8")
        rows = [f"{path}\tno update" for path in paths]
        return subprocess.CompletedProcess(command, 0, "\n".join(["head", *rows]), "")

    monkeypatch.setattr("squealpipe.study.explain.subprocess.run", planned)
    assert [each.rule for each in explain(directory=tmp_path).jobs] == ["make_copied"]
