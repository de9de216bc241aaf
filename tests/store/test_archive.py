"""An archive is whole, sealed, and every changed, missing or extra byte is found."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from rocrate.rocrate import ROCrate

from squealpipe import Structure
from squealpipe.cli import run as cli
from squealpipe.store import StoreError, load, produce, save
from squealpipe.store.comparison.compare import compare
from squealpipe.store.rerun.key import file_key
from squealpipe.store.runs import verify
from squealpipe.store.whole_files import checksum
from squealpipe.study.archive import archive
from squealpipe.study.configuration.settings import read_study


@pytest.fixture(scope="module")
def finished_archive(finished_run, keys_of, tmp_path_factory):
    """A checkout with an archive that no test changes."""
    root = shutil.copytree(
        finished_run, tmp_path_factory.mktemp("archive") / "checkout"
    )
    return archive("first", keys=keys_of(root), root=root)


@pytest.fixture
def frozen(finished_archive, run):
    """Its files are read-only: to damage one, replace it."""
    return shutil.copytree(finished_archive, run / "results/archive/first")


def replace(path, content):
    path.unlink()
    path.write_bytes(content)


def test_archive_holds_result_and_what_made_it(run, frozen, keys_of):
    assert frozen == run / "results/archive/first"
    names = {
        path.relative_to(frozen).as_posix()
        for path in frozen.rglob("*")
        if path.is_file()
    }
    assert names >= {
        "data/stability_map.nc",
        "figures/fig06.png",
        "config/paper.yaml",
        "config/resolved.yaml",
        "environment.json",
        "manifest.json",
        "manifest.sha256",
        "ro-crate-metadata.json",
    }
    both = (
        load(folder / "data/stability_map.nc") for folder in (frozen, run / "results")
    )
    xr.testing.assert_identical(*both)
    packages = json.loads((frozen / "environment.json").read_text())["packages"]
    assert packages["numpy"] == np.__version__
    assert verify("first", root=run).intact
    assert not list((run / "results/archive").glob(".*.tmp"))


def test_an_archive_holds_the_files_of_its_laws(run, keys_of):
    (run / "laws").mkdir()
    (run / "laws/friction.csv").write_text("speed,coefficient\n0,0.4\n1,0.3\n")
    (run / "mine.yaml").write_text(
        "parameters:\n  friction_law: {table: laws/friction.csv}\n"
    )
    configs = ("workflow/config/paper.yaml", "mine.yaml")
    frozen = archive("mine", keys=keys_of(run), root=run, configs=configs)
    shutil.rmtree(run / "laws")
    for names in (["resolved.yaml"], ["paper.yaml", "mine.yaml"]):
        study = read_study(*(frozen / "config" / name for name in names))
        assert study.parameters.friction_law == "linear 0.0:0.4 1.0:0.3"


def test_an_archive_holds_the_files_of_its_structure(run, keys_of, tmp_path):
    """Beside the configuration in their places; files from elsewhere in a folder of their own."""
    assert (
        cli(["init", str(run / "pads.yaml"), "--structure", "--results", "results"])
        == 0
    )
    text = (run / "pads.yaml").read_text()
    shutil.copytree(run / "pads", tmp_path / "elsewhere")
    (run / "far.yaml").write_text(
        text.replace("pads/structure.yaml", "../elsewhere/structure.yaml")
    )
    for name in ("pads", "far"):
        configs = ("workflow/config/paper.yaml", f"{name}.yaml")
        frozen = archive(name, keys=keys_of(run), root=run, configs=configs)
        study = read_study(frozen / "config/resolved.yaml")
        assert Path(study.structure.file).is_relative_to(frozen / "config")
        assert len(Structure.read(study.structure.file).contacts) == 2
    config = run / "results/archive/pads/config"
    again = read_study(config / "paper.yaml", config / "pads.yaml")
    assert Structure.read(again.structure.file).size == 4


def test_crate_is_read_by_its_own_library(frozen):
    crate = ROCrate(frozen)
    entity = crate.get("data/stability_map.nc")
    assert entity["sha256"] == checksum(frozen / "data/stability_map.nc")
    assert crate.get("#run")["instrument"].id == "#squealpipe"


@pytest.mark.parametrize("place", range(0, 100, 7))
def test_any_flipped_bit_is_found(frozen, place):
    files = sorted(path for path in frozen.rglob("*") if path.is_file())
    path = files[place % len(files)]
    content = bytearray(path.read_bytes())
    content[len(content) * place // 100] ^= 1
    replace(path, content)
    assert not verify(frozen).intact


def test_missing_extra_truncated_and_hidden_files_are_found(frozen):
    (frozen / "figures/fig06.png").unlink()
    (frozen / "figures/.note").write_text("hidden")
    path = frozen / "data/stability_map.nc"
    replace(path, path.read_bytes()[:-1])
    found = verify(frozen)
    assert found.findings == [
        "changed: data/stability_map.nc",
        "missing: figures/fig06.png",
        "extra: figures/.note",
    ]
    assert "NOT as it was frozen (3 findings)" in found.lines()[0]


def test_links_are_found_beside_files_and_in_their_place(frozen, tmp_path):
    (frozen / "data/link").symlink_to("config/paper.yaml")
    path = frozen / "figures/fig06.png"
    shutil.copy(path, tmp_path / "same.png")
    path.unlink()
    path.symlink_to(tmp_path / "same.png")
    found = verify(frozen)
    assert found.findings == ["changed: figures/fig06.png", "extra: data/link"]


def test_all_of_an_archive_is_on_disk_before_its_name_and_its_name_before_the_end(
    run, keys_of, monkeypatch
):
    synced, named_after = set(), []
    fsync, rename = os.fsync, Path.rename

    def seen_fsync(handle):
        synced.add(Path(f"/proc/self/fd/{handle}").readlink())
        fsync(handle)

    def seen_rename(self, target):
        named_after.extend({self, *self.rglob("*")} - synced)
        synced.clear()
        return rename(self, target)

    monkeypatch.setattr(os, "fsync", seen_fsync)
    monkeypatch.setattr(Path, "rename", seen_rename)
    target = archive("first", keys=keys_of(run), root=run)
    assert not named_after
    assert synced == {target.parent}


@pytest.mark.parametrize("name", ["", "..", "a/b", "/abs", ".hidden", "a" * 81, "a\nb"])
def test_names_that_could_escape_are_refused(run, name, keys_of):
    with pytest.raises(ValueError, match="archive name"):
        archive(name, keys=keys_of(run), root=run)


def test_archives_never_change(run, frozen, keys_of):
    before = checksum(frozen / "manifest.json")
    with pytest.raises(ValueError, match="choose another name"):
        archive("first", keys=keys_of(run), root=run)
    assert checksum(frozen / "manifest.json") == before


def test_a_damaged_manifest_is_found(frozen):
    replace(frozen / "manifest.json", b'{"files": [1, 2]}')
    assert verify(frozen).findings == ["changed: manifest.json (damaged)"]


def spoil_figure(path):
    path.write_bytes(path.read_bytes()[:3])


def copy_of_another(path):
    save(load(path).assign_attrs(key=file_key("0" * 16, "data/other.nc")), path)


def other_code(path):
    save(load(path).assign_attrs(key=file_key("f" * 16, path)), path)


@pytest.mark.parametrize(
    ("name", "spoil", "reason"),
    [
        ("data/stability_map.nc", Path.unlink, "missing"),
        ("data/stability_map.nc", spoil_figure, "changed or damaged"),
        ("data/stability_map.nc", copy_of_another, "is a copy of data/other.nc"),
        ("data/stability_map.nc", other_code, "another configuration or other code"),
        ("figures/fig06.png", Path.unlink, "missing"),
        ("figures/fig06.png", spoil_figure, "does not state what it was made from"),
    ],
)
def test_what_is_not_of_this_configuration_and_code_is_refused_by_name(
    run, keys_of, name, spoil, reason
):
    spoil(run / "results" / name)
    with pytest.raises(StoreError, match=rf"results/{name}.*{reason}"):
        archive("second", keys=keys_of(run), root=run)
    assert not (run / "results/archive/second").exists()
    assert verify(archive("rest", keys=keys_of(run), root=run, leave_out=[name])).intact


def test_a_dataset_that_was_edited_by_hand_is_not_frozen(run, keys_of):
    path = run / "results/data/stability_map.nc"
    edited = load(path)
    edited["growth_rate"] = edited.growth_rate * 3
    with pytest.warns(UserWarning, match="edited after its task made it"):
        save(edited, path)
    with pytest.raises(
        StoreError, match=r"stability_map.nc: changed, or does not state"
    ):
        archive("second", keys=keys_of(run), root=run)


@pytest.mark.parametrize("manifest", ["kept", "lost", "moved"])
@pytest.mark.parametrize(
    "command",
    [
        "init {0}/config/paper.yaml --force",
        "init {0}/new.yaml",
        "simulate 1 2 --t-end 1 -o {0}/x.csv",
        "simulate 1 2 --t-end 1 -o run.nc --picture {0}/x.png",
        "simulate 1 2 --t-end 1 -o {0}/new/x.nc",
        "plot map.nc -o {0}/figures/fig06.png --force",
        "convert map.nc -o {0}/map.csv",
        "convert map.nc -o {0}/map.mat",
        "deposit other -o {0}/x.zip",
    ],
)
def test_no_command_writes_into_an_archive(
    run, frozen, monkeypatch, capsys, command, manifest
):
    monkeypatch.chdir(run)
    at = frozen
    shutil.copytree(at, at.with_name("other"))
    Path("CITATION.cff").write_text("")
    shutil.copy(run / "results/data/stability_map.nc", "map.nc")
    if manifest == "lost":
        (at / "manifest.sha256").unlink()
    if manifest == "moved":
        at = at.rename(run / "elsewhere")
    before = sorted(at.rglob("*"))
    assert cli(command.format(at).split()) == 2
    assert f"is part of the archive {at}" in capsys.readouterr().err
    assert sorted(at.rglob("*")) == before


def test_left_out_datasets_are_no_difference(run, keys_of):
    path = run / "results/data/stability_map.nc"
    extra = produce(
        lambda: load(path), config={}, output=run / "results/data/simulate/F3.nc"
    )
    keys = {**keys_of(run), "results/data/simulate/F3.nc": "?"}
    frozen = archive("small", keys=keys, root=run, leave_out=["data/simulate/*"])
    assert extra.is_file()
    assert not (frozen / "data/simulate").exists()
    found = compare(frozen, run / "results")
    assert found.exit_code == 0
    assert found.skipped == ["simulate/F3"]
