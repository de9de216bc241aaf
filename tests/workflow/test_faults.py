"""Full disks, damaged files, missing permissions: nothing is lost.

After each fault the next plain `snakemake`, or the one command that its message names, completes;
the results equal an undisturbed run, and no half-written file was ever read as whole.
"""

import os
import shutil
import subprocess
import sys

import pytest

from squealpipe.store import StoreError, load

pytestmark = pytest.mark.release


SMALL = """
dynamics: {validity_points: 31, validity_horizon: 100.0}
"""
DATASET = "results/data/validity_map.nc"
RUN = [
    *(sys.executable, "-m", "snakemake", DATASET),
    *("--configfile", "small.yaml"),
]


def environment(checkout):
    return {**os.environ, "PYTHONPATH": str(checkout)}


def run(checkout, *words, **options):
    return subprocess.run(
        [*RUN[:3], *words, *RUN[3:]], cwd=checkout, env=environment(checkout), capture_output=True,
        text=True, timeout=300, check=False, **options,
    )  # fmt: skip


def complete(checkout):
    """Plain `snakemake`, or first the command that its message names."""
    again = run(checkout)
    if again.returncode and "--unlock" in again.stderr:
        assert run(checkout, "--unlock").returncode == 0
        again = run(checkout)
    assert again.returncode == 0, again.stderr[-4000:]


def dataset_id(checkout):
    return load(checkout / DATASET).attrs["dataset_id"]


def check_files(checkout):
    """Every dataset that has its final name is whole."""
    for path in (checkout / "results/data").glob("*.nc"):
        load(path)


def discard_results(checkout):
    for folder in ("results", ".snakemake"):
        shutil.rmtree(checkout / folder, ignore_errors=True)


@pytest.fixture(scope="module")
def undisturbed(one_checkout):
    """The id of the dataset of a run without faults."""
    (one_checkout / "small.yaml").write_text(SMALL)
    done = run(one_checkout)
    assert done.returncode == 0, done.stderr[-4000:]
    return dataset_id(one_checkout)


@pytest.fixture
def small(one_checkout, undisturbed):
    discard_results(one_checkout)
    (one_checkout / "results").mkdir()
    return one_checkout


def test_damaged_dataset_is_named_with_its_remedy(small, undisturbed):
    assert run(small).returncode == 0
    path = small / DATASET
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 255
    for content in (whole[: len(whole) // 2], bytes(damaged)):
        path.write_bytes(content)
        with pytest.raises(StoreError, match="delete it and run snakemake again"):
            load(path)
        failed = run(small, "results/figures/fig07.png")  # the map is read
        assert failed.returncode != 0
        assert "delete it and run snakemake again" in failed.stdout + failed.stderr
        path.unlink()
        complete(small)
        assert dataset_id(small) == undisturbed


def test_full_disk_is_told_and_the_next_run_completes(small, undisturbed):
    results = small / "results"
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", results]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("a small file system cannot be mounted here (needs root)")
    try:
        full = run(small)
        assert full.returncode != 0
        assert "free space or fix permissions" in full.stdout + full.stderr
        check_files(small)
        subprocess.run(["mount", "-o", "remount,size=64m", results], check=True)
        complete(small)
        assert dataset_id(small) == undisturbed
    finally:
        subprocess.run(["umount", "-l", results], check=True)


def test_missing_permission_is_told_and_the_next_run_completes(small, undisturbed, read_only):
    with read_only(small / "results"):
        refused = run(small)
    assert refused.returncode != 0
    told = refused.stdout + refused.stderr
    assert "Read-only file system" in told or "Permission denied" in told
    complete(small)
    assert dataset_id(small) == undisturbed
