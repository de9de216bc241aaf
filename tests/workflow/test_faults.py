"""Full disks, damaged files, missing permissions: nothing is lost.

After each fault the next plain `snakemake`, or the one command that its message names, completes;
the results equal an undisturbed run, and no half-written file was ever read as whole.
"""

import shutil
import subprocess

import pytest

from squealpipe.store import StoreError, load
from tests.conftest import run_snakemake

SMALL = """
dynamics: {validity_points: 31, validity_horizon: 100.0}
"""
DATASET = "results/data/validity_map.nc"


def run(checkout, target=DATASET):
    return run_snakemake(checkout, target, "--configfile", "small.yaml")


def completed(checkout):
    """The id of the dataset after a plain `snakemake`."""
    again = run(checkout)
    assert again.returncode == 0, again.stderr[-4000:]
    return load(checkout / DATASET).attrs["dataset_id"]


@pytest.fixture(scope="module")
def undisturbed(one_checkout):
    """The id of the dataset of a run without faults."""
    (one_checkout / "small.yaml").write_text(SMALL)
    return completed(one_checkout)


@pytest.fixture
def small(one_checkout, undisturbed):
    for folder in ("results", ".snakemake"):
        shutil.rmtree(one_checkout / folder, ignore_errors=True)
    (one_checkout / "results").mkdir()
    return one_checkout


def test_damaged_dataset_is_named_with_its_remedy(one_checkout, undisturbed):
    small = one_checkout
    path = small / DATASET
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 255
    for content in (bytes(damaged), whole[: len(whole) // 2]):
        path.write_bytes(content)
        with pytest.raises(StoreError, match="delete it and run snakemake again"):
            load(path)
    failed = run(small, "results/figures/fig07.png")  # the map is read
    assert failed.returncode != 0
    assert "delete it and run snakemake again" in failed.stdout + failed.stderr
    path.unlink()
    assert completed(small) == undisturbed


def test_missing_permission_and_full_disk_are_told_and_the_next_run_completes(
    small, undisturbed, read_only
):
    results = small / "results"
    with read_only(results):
        refused = run(small)
    assert refused.returncode != 0
    told = refused.stdout + refused.stderr
    assert "Read-only file system" in told or "Permission denied" in told
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", results]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        assert completed(small) == undisturbed
        pytest.skip("a small file system cannot be mounted here (needs root)")
    try:
        full = run(small)
        assert full.returncode != 0
        assert "free space or fix permissions" in full.stdout + full.stderr
        assert not list(small.rglob("results/data/*.nc")), (
            "of a file only the whole has its name"
        )
        subprocess.run(["mount", "-o", "remount,size=64m", results], check=True)
        assert completed(small) == undisturbed
    finally:
        subprocess.run(["umount", "-l", results], check=True)
