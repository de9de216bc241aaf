"""A run as one tree; damaged, swapped and foreign files are refused."""

import shutil

import numpy as np
import pytest
import xarray as xr

from squealpipe import load, open_results
from squealpipe.store import StoreError, produce
from squealpipe.store.checkout import ROOT
from squealpipe.store.rerun.key import file_key
from squealpipe.store.runs import verify
from squealpipe.study.archive import archive


def test_nodes_are_the_datasets_by_their_names(run, keys_of):
    folder = run / "results/data"
    made = load(folder / "stability_map.nc")
    keys = keys_of(run)
    for name in ("second", "deep/third"):
        path = produce(
            lambda: made, config={}, output=folder / f"{name}.nc", key="0" * 16
        )
        keys[f"results/data/{name}.nc"] = file_key("0" * 16, path)
    archive("first", keys=keys, root=run)
    for tree in (open_results(run / "results"), open_results("first", root=run)):
        assert isinstance(tree, xr.DataTree)
        assert {node.path for node in tree.subtree if node.has_data} == {
            "/stability_map",
            "/second",
            "/deep/third",
        }
        whole = load(folder / "deep/third.nc")
        xr.testing.assert_identical(tree["deep/third"].to_dataset().load(), whole)
        np.testing.assert_array_equal(
            tree["second"].growth_rate[3:5, ::2].values,
            whole.growth_rate.values[3:5, ::2],
        )


def test_an_unknown_run_is_told_with_those_that_there_are(tmp_path):
    (tmp_path / "results/archive/first").mkdir(parents=True)
    with pytest.raises(
        FileNotFoundError,
        match=r"no archive, folder or file.*; archives: first, reference$",
    ):
        open_results("nothing", root=tmp_path)


DAMAGES = {
    "cut": lambda whole, share: whole[: int(len(whole) * share)],
    "cut at the front": lambda whole, share: whole[int(len(whole) * share) + 1 :],
    "flipped": lambda whole, share: flipped(whole, int(len(whole) * share)),
    "zeroed": lambda whole, share: (
        whole[: (k := int(len(whole) * share))] + bytes(len(whole) - k)
    ),
    "lengthened": lambda whole, share: whole + whole[: int(len(whole) * share) + 1],
}


def flipped(whole, place):
    content = bytearray(whole)
    content[place] ^= 1 << place % 8
    return bytes(content)


@pytest.mark.parametrize("kind", DAMAGES)
def test_sixty_damaged_files_of_each_kind_are_refused_at_open(run, kind):
    path = run / "results/data/stability_map.nc"
    whole = path.read_bytes()
    for share in np.linspace(0, 0.9999, 60):
        path.write_bytes(DAMAGES[kind](whole, share))
        with pytest.raises(StoreError, match="changed or damaged"):
            open_results(run / "results")


def test_files_that_were_swapped_are_refused(run, tmp_path):
    folder = run / "results/data"
    made = load(folder / "stability_map.nc")
    for name in ("first", "second"):
        produce(lambda: made, config={}, output=folder / f"{name}.nc", key="0" * 16)
    assert set(open_results(run / "results").children) == {
        "first",
        "second",
        "stability_map",
    }
    (folder / "first.nc").rename(tmp_path / "aside.nc")
    (folder / "second.nc").rename(folder / "first.nc")
    (tmp_path / "aside.nc").rename(folder / "second.nc")
    with pytest.raises(StoreError, match=r"first\.nc is a copy of data/second\.nc"):
        open_results(run / "results")


@pytest.mark.parametrize("other", [True, False])
def test_an_archive_with_a_dataset_of_another_or_without_one_is_refused(
    run, write_run, keys_of, other
):
    """Each file is whole by itself."""
    path = archive("first", keys=keys_of(run), root=run) / "data/stability_map.nc"
    path.unlink()
    if other:
        shutil.copy(write_run(run, mu=0.4) / "results/data/stability_map.nc", path)
    with pytest.raises(StoreError, match=r"(changed|missing): data/stability_map\.nc"):
        open_results("first", root=run)


@pytest.mark.release
def test_the_reference_opens_whatever_schemas_have_become_since():
    tree = open_results("reference", root=ROOT)
    assert tree["whirl"].attrs["schema"] == "whirl"
    assert float(tree["backbone/F10_mode1"].omega[0]) > 0


def test_an_archive_of_the_first_release_is_read():
    """Kept from 1.0.0 on: its bytes, and its datasets by the schemas of today.

    It is a study of one scene of a pad on coarse grids, whose configuration is in it.
    """
    folder = ROOT / "tests/store/archives/1.0.0"
    assert verify(folder).intact
    for path in sorted((folder / "data").rglob("*.nc")):
        assert load(path).attrs["package_version"] == "1.0.0"
    scene = open_results(folder)["own_scenes"].sel(
        scene="mine", variant="as configured"
    )
    assert float(scene.impact_speed) == pytest.approx(0.05989646446372935, rel=1e-12)
