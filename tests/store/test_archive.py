"""An archive is whole, sealed, and every changed, missing or extra byte is found."""

import json
import os
import shutil
from pathlib import Path

import pytest
import yaml
from rocrate.rocrate import ROCrate

from squealpipe.config.settings import read_study
from squealpipe.execution.sweep import planned, run_sweep
from squealpipe.store import StoreError, load, produce, save
from squealpipe.store.archive import archive, verify
from squealpipe.store.comparison.compare import compare
from squealpipe.store.memory.objects import checksum

FIXED = {"alpha1": "1.1", "alpha2": "1.2"}


@pytest.fixture
def frozen(run):
    """Its files are links to shared objects and read-only: to damage one, replace it."""
    return archive("first", root=run)


def replace(path, content):
    path.unlink()
    path.write_bytes(content)


def test_archive_holds_result_and_what_made_it(run, frozen):
    assert frozen == run / "results/archive/first"
    names = {path.relative_to(frozen).as_posix() for path in frozen.rglob("*") if path.is_file()}
    assert {
        "data/stability_map.nc",
        "figures/fig06.png",
        "config/paper.yaml",
        "config/resolved.yaml",
        "environment.json",
        "manifest.json",
        "manifest.sha256",
        "ro-crate-metadata.json",
    } <= names
    assert load(frozen / "data/stability_map.nc").identical(
        load(run / "results/data/stability_map.nc")
    )
    assert verify("first", root=run).intact
    assert not list((run / "results/archive").glob(".*.tmp"))


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
    assert found.missing == ["figures/fig06.png"]
    assert found.extra == ["figures/.note"]
    assert found.changed == ["data/stability_map.nc"]
    assert "NOT as it was frozen (3 findings)" in found.lines()[0]


@pytest.mark.parametrize("name", ["../outside", "/etc/passwd", "data/../../outside", "..\\x", ""])
def test_manifest_cannot_lead_out_of_the_folder(frozen, name, monkeypatch):
    manifest = json.loads((frozen / "manifest.json").read_text())
    manifest["files"][name] = {"bytes": 1, "sha256": "0" * 64}
    replace(frozen / "manifest.json", json.dumps(manifest).encode())
    read = []
    original = Path.open
    monkeypatch.setattr(
        Path, "open", lambda self, *a, **k: (read.append(self), original(self, *a, **k))[1]
    )
    found = verify(frozen)
    assert found.unsafe == [name]
    assert all(frozen.resolve() in path.resolve().parents for path in read)


@pytest.mark.parametrize("target", ["/etc/passwd", "config/paper.yaml", "."])
def test_links_are_unsafe(frozen, target):
    (frozen / "data/link").symlink_to(target)
    assert verify(frozen).unsafe == ["data/link (link)"]


def test_link_in_place_of_a_file_is_found(frozen, tmp_path):
    path = frozen / "figures/fig06.png"
    shutil.copy(path, tmp_path / "same.png")
    path.unlink()
    path.symlink_to(tmp_path / "same.png")
    found = verify(frozen)
    assert found.missing == ["figures/fig06.png"]
    assert found.unsafe


@pytest.mark.parametrize("name", ["", "..", "a/b", "/abs", ".hidden", "a" * 81, "a\nb"])
def test_names_that_could_escape_are_refused(run, name):
    with pytest.raises(ValueError, match="archive name"):
        archive(name, root=run)


def test_archives_never_change(run, frozen):
    before = checksum(frozen / "manifest.json")
    with pytest.raises(ValueError, match="choose another name"):
        archive("first", root=run)
    assert checksum(frozen / "manifest.json") == before


def test_run_of_another_configuration_is_refused(run):
    config = run / "workflow/config/paper.yaml"
    config.write_text(config.read_text().replace("mu: 0.3", "mu: 0.4"))
    with pytest.raises(ValueError, match=r"another configuration: stability_map; run snakemake"):
        archive("second", root=run)
    assert not (run / "results/archive/second").exists()


def test_damaged_dataset_is_refused(run):
    path = run / "results/data/stability_map.nc"
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(StoreError, match="truncated"):
        archive("second", root=run)


def test_no_run_is_told(tmp_path, run):
    shutil.rmtree(run / "results")
    with pytest.raises(FileNotFoundError, match="run snakemake first"):
        archive("first", root=run)
    with pytest.raises(FileNotFoundError, match="no archives yet"):
        verify("first", root=run)


def test_oversized_or_damaged_manifest_is_refused(frozen, monkeypatch):
    replace(frozen / "manifest.json", b'{"files": [1, 2]}')
    assert verify(frozen).changed == ["manifest.json (damaged)"]
    monkeypatch.setattr("squealpipe.store.runs.LARGEST_MANIFEST", 3)
    with pytest.raises(ValueError, match="not one of ours"):
        verify(frozen)


def test_left_out_datasets_are_no_difference(run):
    path = run / "results/data/stability_map.nc"
    (run / "results/data/simulate").mkdir()
    shutil.copy(path, run / "results/data/simulate/F3.nc")
    frozen = archive("small", root=run, leave_out=["data/simulate/*"])
    assert not (frozen / "data/simulate").exists()
    assert verify(frozen).intact
    found = compare(frozen, run / "results")
    assert found.exit_code == 0
    assert found.skipped == ["simulate/F3"]
    path.rename(path.with_name("another.nc"))
    assert compare(frozen, run / "results").exit_code == 1


def test_suffixes_can_be_left_out(run):
    frozen = archive("small", root=run, leave_out=[".png"])
    assert not (frozen / "figures/fig06.png").exists()
    assert verify(frozen).intact


def test_files_that_say_which_of_a_rules_outputs_they_are_can_be_frozen(run):
    path = run / "results/data/stability_map.nc"
    dataset = load(path)
    config = json.loads(dataset.attrs["config"])
    save(dataset.assign_attrs(config=json.dumps({**config, "scene": "F3", "mode": 1})), path)
    assert verify(archive("second", root=run)).intact


def test_a_study_with_sweeps_can_be_frozen(run):
    """A sweep's dataset holds its own configuration, not a slice of the study's."""
    config = run / "workflow/config/paper.yaml"
    sweeps = {"k3": {"task": "stability_map", "vary": {"k3": "0.5,0.75"}, "fixed": FIXED}}
    content = {**yaml.safe_load(config.read_text()), "sweeps": sweeps}
    config.write_text(yaml.safe_dump(content))
    plan = read_study(config).sweep("k3")
    path = run / "results/data/sweeps/k3.nc"
    produce(lambda: run_sweep(planned(plan)), config=plan, output=path)
    assert verify(archive("swept", root=run)).intact
    content["parameters"]["mu"] = 0.7
    config.write_text(yaml.safe_dump(content))
    (run / "results/data/stability_map.nc").unlink()
    with pytest.raises(ValueError, match="another configuration: sweeps/k3"):
        archive("stale", root=run)


@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
def test_archives_obey_the_umask(run, mask):
    before = os.umask(mask)
    try:
        frozen = archive("first", root=run)
    finally:
        os.umask(before)
    for path in [frozen, *frozen.rglob("*")]:
        allowed = 0o777 if path.is_dir() else 0o444
        assert path.stat().st_mode & 0o777 == allowed & ~mask, path
