"""Runs are found again by their parameters; the index saves time and is never believed."""

import json
import shutil
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

from squealpipe.cli import run as command
from squealpipe.config.settings import Study
from squealpipe.config.yaml_files import flat
from squealpipe.store.archive import archive
from squealpipe.store.memory.catalogue import INDEX, runs
from squealpipe.store.memory.expressions import Condition
from squealpipe.store.memory.objects import seal_text

OLD_ARCHIVE = Path(__file__).with_name("old_archive")
"""A part of an archive made before manifests told the configuration and files were sealed."""

KNOWN = flat(Study().model_dump(mode="json"))


@pytest.fixture
def memory(tmp_path, write_run, monkeypatch):
    """A checkout with two archives of μ = 0.3 and 0.25 and a folder of results."""
    root = write_run(tmp_path / "checkout")
    archive("first", root=root)
    write_run(root, mu=0.25)
    archive("second", root=root)
    monkeypatch.chdir(root)
    return root


def told(capsys, *arguments):
    code = command(list(arguments))
    return code, capsys.readouterr().out.splitlines()


def test_list_tells_what_differs_and_whether_it_was_verified(memory, capsys):
    _, lines = told(capsys, "list")
    assert [line.split()[0] for line in lines] == ["name", "first", "second", "results"]
    assert command(["verify", "second"]) == 0
    found = json.loads("\n".join(told(capsys, "list", "--json")[1][1:]))
    states = {run["name"]: run["verified"] for run in found}
    assert states["first"] == ""
    assert states["second"].startswith("intact 20")
    assert found[0]["changed"] == {"parameters.mu": 0.3}, "here the paper's is 0.25"
    assert found[2]["config"] == {**found[2]["config"], "parameters.mu": 0.25, "linear.points": 13}


@pytest.mark.parametrize(
    ("expression", "names"),
    [
        ("mu == 0.25", ["second", "results"]),
        ("mu == 0.25 and L1 > 4", ["second", "results"]),
        ("mu > 0.25 or not k3 == 0.75", ["first"]),
        ("0.2 < mu <= 0.25 and linear.points in [13, 31]", ["second", "results"]),
        ("length1 / l_pre == 5 and mu * 4 == 1", ["second", "results"]),
        ("damping1 == 0 and mu_static < 0.3 and friction_law == 'coulomb'", ["second", "results"]),
    ],
)
def test_find_prints_the_runs_that_match(memory, capsys, expression, names):
    assert told(capsys, "find", expression) == (0, names)


def test_find_tells_by_its_exit_code_that_there_is_none(memory, capsys):
    assert told(capsys, "find", "mu == 0.9") == (1, ["no run fulfils it"])
    assert told(capsys, "find", "mu == 0.9", "--json") == (1, ["[]"])


@pytest.mark.parametrize(
    "expression",
    [
        "mu = 0.25",
        "mu",
        "1",
        "muu == 1",
        "__import__('os').system('touch ran') == 0",
        "(lambda: 1)() == 1",
        "[x for x in [1]] == [1]",
        "mu.__class__ == 1",
        "mu ** 9 ** 9 ** 9 > 0",
        "mu / 0 > 1",
        "mu < 'a'",
        "mu and k3",
        "(" * 300 + "mu" + ")" * 300 + " == 1",
        "not " * 400 + "mu == 1",
        "mu == 1 " + " " * 2000,
        "",
        "f'{mu}' == '0.3'",
    ],
)
def test_what_is_no_condition_is_one_message_and_runs_nothing(memory, capsys, expression):
    assert command(["find", expression]) == 2
    error = capsys.readouterr().err
    assert "Traceback" not in error
    assert not (memory / "ran").exists()


def test_unknown_names_get_the_nearest_one():
    with pytest.raises(ValueError, match="did you mean 'belt_speed'"):
        Condition("belt_sped == 1", KNOWN)


def test_a_run_that_does_not_tell_a_key_has_its_default():
    assert Condition("mu == 0.3 and V == 100", KNOWN).holds({"parameters.mu": 0.3})


@pytest.mark.parametrize(
    "spoil",
    [
        lambda index: index.unlink(),
        lambda index: index.write_text("{"),
        lambda index: index.write_text('{"format": 1, "runs": [{"name": "first"}]}'),
    ],
)
def test_a_missing_or_damaged_index_is_made_again(memory, capsys, spoil):
    runs(memory)
    index = memory / "results/archive" / INDEX
    spoil(index)
    assert told(capsys, "find", "mu == 0.25") == (0, ["second", "results"])
    assert json.loads(index.read_text())["runs"][0]["name"] == "first"


def test_a_changed_archive_is_read_again_whatever_the_index_says(memory, capsys):
    assert told(capsys, "find", "mu == 0.3") == (0, ["first"])
    manifest = memory / "results/archive/first/manifest.json"
    content = json.loads(manifest.read_text())
    content["config"]["parameters"]["mu"] = 0.77
    manifest.unlink()
    manifest.write_text(json.dumps(content))
    assert told(capsys, "find", "mu == 0.77") == (0, ["first"])
    assert next(run for run in runs(memory) if run.name == "first").verified == "damaged manifest"


def test_archives_made_before_the_manifest_told_the_configuration_are_found(memory, capsys):
    shutil.copytree(OLD_ARCHIVE, memory / "results/archive/reference")
    assert told(capsys, "find", "mu == 0.3 and linear.points == 181") == (0, ["reference"])
    reference = next(run for run in runs(memory) if run.name == "reference")
    manifest = json.loads((OLD_ARCHIVE / "environment.json").read_text())
    assert reference.commit == manifest["commit"]
    assert reference.date.startswith("20")


def test_an_unwritable_folder_has_no_index_and_still_an_answer(memory, capsys, read_only):
    with read_only(memory / "results/archive"):
        assert told(capsys, "find", "mu == 0.3") == (0, ["first"])


def test_a_thousand_archives_are_searched_within_a_second(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    config = Study().model_dump(mode="json")
    files = {f"data/{i}.nc": {"bytes": 1, "sha256": "0" * 64} for i in range(60)}
    for i, mu in enumerate(np.linspace(0, 1, 1000)):
        config["parameters"]["mu"] = float(mu)
        folder = tmp_path / f"results/archive/run-{i:04}"
        folder.mkdir(parents=True)
        manifest = {"name": folder.name, "commit": "c", "config": config, "files": files}
        (folder / "manifest.json").write_text(json.dumps(manifest))
        (folder / "manifest.sha256").write_text(seal_text(folder))
    expected = [f"run-{i:04}" for i, mu in enumerate(np.linspace(0, 1, 1000)) if mu > 0.99]
    assert told(capsys, "find", "mu > 0.99") == (0, expected)
    began = time.process_time()
    assert told(capsys, "find", "mu > 0.99") == (0, expected)
    assert time.process_time() - began < 1.0


def test_configuration_is_that_of_the_manifest(memory):
    manifest = json.loads((memory / "results/archive/first/manifest.json").read_text())
    resolved = yaml.safe_load((memory / "results/archive/first/config/resolved.yaml").read_text())
    assert flat(manifest["config"]) == flat(resolved)
