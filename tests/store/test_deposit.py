"""A deposit can be used alone and is valid."""

import json
import shutil
import zipfile

import pytest
from rocrate.rocrate import ROCrate

from squealpipe.cli import run as command
from squealpipe.store.archive import archive, verify
from squealpipe.store.checkout import ROOT
from squealpipe.store.memory.deposit import bundle, check


@pytest.fixture
def checkout(run, keys_of, monkeypatch):
    """A checkout with one archive and what else a deposit needs."""
    for name in ("CITATION.cff", "LICENSE", "Snakefile", "pyproject.toml", "requirements.lock"):
        shutil.copy(ROOT / name, run / name)
    archive("first", keys=keys_of(run), root=run)
    monkeypatch.chdir(run)
    return run


def unpacked(path, folder):
    with zipfile.ZipFile(path) as file:
        file.extractall(folder)
    return folder / "first"


@pytest.fixture
def deposit(checkout, tmp_path):
    return unpacked(bundle("first")[0], tmp_path / "elsewhere")


def test_a_deposit_is_whole_and_valid(deposit):
    assert check(deposit) == []
    assert verify(deposit / "run").intact
    for name in ("run/data/stability_map.nc", "run/figures/fig06.png", "run/config/resolved.yaml",
                 "code/Snakefile", "code/requirements.lock", "CITATION.cff"):  # fmt: skip
        assert (deposit / name).is_file()
    zenodo = json.loads((deposit / ".zenodo.json").read_text())
    datacite = json.loads((deposit / "datacite.json").read_text())
    assert zenodo["title"] == datacite["titles"][0]["title"]
    assert zenodo["license"] == datacite["rightsList"][0]["rightsIdentifier"] == "MIT"


def test_the_crate_tells_the_run_of_each_dataset(deposit):
    crate = ROCrate(deposit)
    assert crate.mainEntity.id == "code/Snakefile"
    assert "ComputationalWorkflow" in crate.mainEntity.type
    run = crate.get("#run-stability_map")
    assert run.type == "CreateAction"
    assert [item.id for item in run["result"]] == ["run/data/stability_map.nc"]
    assert json.loads(run["object"][0]["value"])["parameters"]["mu"] == 0.3
    assert run["instrument"]["name"] == "squealpipe"
    profiles = [item.id for item in crate.root_dataset["conformsTo"]]
    assert "https://w3id.org/ro/wfrun/workflow/0.5" in profiles


def test_equal_archives_give_equal_bundles(checkout):
    first = bundle("first", output="a.zip")[0].read_bytes()
    assert bundle("first", output="b.zip")[0].read_bytes() == first


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("datacite.json", "{}"),
        (".zenodo.json", '{"title": ""}'),
        ("CITATION.cff", "title: x"),
        ("run/figures/fig06.png", "another"),
        ("code/Snakefile", "another"),
        ("code/new.py", "not described"),
    ],
)
def test_the_check_finds_faults(deposit, name, content):
    (deposit / name).write_text(content)
    assert any(name.removeprefix("run/") in fault for fault in check(deposit))


def test_a_damaged_archive_or_one_without_authors_is_not_bundled(checkout):
    (checkout / "CITATION.cff").write_text("title: t\nlicense: MIT\nauthors: []\nversion: '1'\n")
    with pytest.raises(ValueError, match="not valid"):
        bundle("first")
    shutil.copy(ROOT / "CITATION.cff", checkout / "CITATION.cff")
    path = checkout / "results/archive/first/figures/fig06.png"
    path.unlink()
    with pytest.raises(ValueError, match=r"missing: figures/fig06\.png"):
        bundle("first")
    assert not (checkout / "results/deposit/first.zip").exists()
    assert not list((checkout / "results/deposit").glob(".deposit.*"))


def test_the_command_needs_no_network(checkout, monkeypatch, capsys):
    def refuse(*_, **__):
        raise AssertionError("the network was used")

    monkeypatch.setattr("socket.socket.connect", refuse)
    assert command(["deposit", "first"]) == 0
    assert "results/deposit/first.zip" in capsys.readouterr().out
