"""A deposit can be used alone."""

import shutil
import zipfile

import pytest

from squealpipe.store.checkout import ROOT
from squealpipe.store.deposit import bundle
from squealpipe.store.runs import verify
from squealpipe.study.archive import archive


@pytest.fixture
def checkout(run, keys_of, monkeypatch):
    """A checkout with one archive and what else a deposit needs."""
    for name in (
        "CITATION.cff",
        "LICENSE",
        "Snakefile",
        "pyproject.toml",
        "requirements.lock",
    ):
        shutil.copy(ROOT / name, run / name)
    archive("first", keys=keys_of(run), root=run)
    monkeypatch.chdir(run)
    return run


def test_a_deposit_is_whole(checkout, tmp_path):
    with zipfile.ZipFile(bundle("first")) as file:
        file.extractall(tmp_path / "elsewhere")
    deposit = tmp_path / "elsewhere/first"
    assert verify(deposit / "run").intact
    for name in (
        "run/data/stability_map.nc",
        "run/figures/fig06.png",
        "run/config/resolved.yaml",
        "code/Snakefile",
        "code/requirements.lock",
        "CITATION.cff",
    ):
        assert (deposit / name).is_file()


def test_equal_archives_give_equal_bundles(checkout):
    first = bundle("first", output="a.zip").read_bytes()
    assert bundle("first", output="b.zip").read_bytes() == first


def test_a_damaged_archive_is_not_bundled(checkout):
    (checkout / "results/archive/first/figures/fig06.png").unlink()
    with pytest.raises(ValueError, match=r"missing: figures/fig06\.png"):
        bundle("first")
    assert not (checkout / "results/deposit").exists()
