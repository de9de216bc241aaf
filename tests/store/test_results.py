"""A run as one tree, read when it is used; several runs stacked along what was changed."""

import numpy as np
import pytest
import xarray as xr

from squealpipe import Parameters, backbone, load, open_results, save
from squealpipe.rerun.key import file_key
from squealpipe.store import StoreError, produce
from squealpipe.store.archive import archive
from squealpipe.store.checkout import ROOT


def test_nodes_are_the_datasets_by_their_names(run, keys_of):
    folder = run / "results/data"
    made = load(folder / "stability_map.nc")
    keys = keys_of(run)
    for name in ("second", "deep/third"):
        path = produce(lambda: made, config={}, output=folder / f"{name}.nc", key="0" * 16)
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
            tree["second"].growth_rate[3:5, ::2].values, whole.growth_rate.values[3:5, ::2]
        )


def test_runs_are_stacked_along_the_parameters_that_changed(tmp_path, write_run):
    places = []
    for name, mu, points in (("a", 0.3, 13), ("b", 0.4, 25), ("c", 0.5, 13)):
        places.append(write_run(tmp_path / name, mu=mu, points=points) / "results")
    tree = open_results(places, along="run")
    found = tree["stability_map"]
    assert found.growth_rate.dims == ("run", "alpha1", "alpha2")
    assert found.growth_rate.shape == (3, 13, 13)
    assert found.run.values.tolist() == list(map(str, places))
    assert found.mu.values.tolist() == [0.3, 0.4, 0.5]
    assert found["linear.points"].values.tolist() == [13, 25, 13]
    whole = load(places[1] / "data/stability_map.nc")
    np.testing.assert_array_equal(found.growth_rate[1], whole.growth_rate[::2, ::2])
    np.testing.assert_array_equal(found.alpha1, load(places[0] / "data/stability_map.nc").alpha1)


def test_lists_of_other_length_are_filled_up(tmp_path):
    made = {}
    for name, k3, top in (("a", 0.75, 1.5), ("b", 0.6, 1.2)):
        params = Parameters(k3=k3)
        made[name] = backbone(params, 0.9, 2.8, mode=1, y_peak_max=top)
        save(made[name], tmp_path / name / "data/branch.nc")
    found = open_results([tmp_path / "a", tmp_path / "b"], along="run")["branch"]
    assert found.k3.values.tolist() == [0.75, 0.6]
    sizes = [each.sizes["point"] for each in made.values()]
    assert found.sizes["point"] == max(sizes)
    for row, each in zip(found.omega.values, made.values(), strict=True):
        np.testing.assert_array_equal(row[: each.sizes["point"]], each.omega)
        assert np.isnan(row[each.sizes["point"] :]).all()


def test_wrong_questions_are_told(run, tmp_path):
    with pytest.raises(ValueError, match="give a list"):
        open_results(run / "results", along="run")
    for wrong in ([run / "results"], []):
        with pytest.raises(ValueError, match="along = None"):
            open_results(wrong)
    with pytest.raises(ValueError, match="named twice"):
        open_results([run / "results"] * 2, along="run")
    (tmp_path / "results/archive/first").mkdir(parents=True)
    with pytest.raises(FileNotFoundError, match=r"no archive, folder or file.*; archives: first$"):
        open_results("nothing", root=tmp_path)


DAMAGES = {
    "cut": lambda whole, share: whole[: int(len(whole) * share)],
    "cut at the front": lambda whole, share: whole[int(len(whole) * share) + 1 :],
    "flipped": lambda whole, share: flipped(whole, int(len(whole) * share)),
    "zeroed": lambda whole, share: whole[: (k := int(len(whole) * share))] + bytes(len(whole) - k),
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


def test_values_doubled_by_another_program_are_refused(run):
    path = run / "results/data/stability_map.nc"
    dataset = load(path)
    dataset["growth_rate"] = dataset.growth_rate * 2
    dataset.to_netcdf(path)
    with pytest.raises(StoreError, match="another program wrote it"):
        open_results(run / "results")


def test_files_that_were_swapped_are_refused(run, tmp_path):
    folder = run / "results/data"
    made = load(folder / "stability_map.nc")
    for name in ("first", "second"):
        produce(lambda: made, config={}, output=folder / f"{name}.nc", key="0" * 16)
    assert set(open_results(run / "results").children) == {"first", "second", "stability_map"}
    (folder / "first.nc").rename(tmp_path / "aside.nc")
    (folder / "second.nc").rename(folder / "first.nc")
    (tmp_path / "aside.nc").rename(folder / "second.nc")
    with pytest.raises(StoreError, match=r"first\.nc is a copy of data/second\.nc"):
        open_results(run / "results")


def test_the_reference_opens_whatever_schemas_have_become_since():
    tree = open_results("reference", root=ROOT)
    assert tree["whirl"].attrs["schema"] == "whirl"
    assert float(tree["backbone/F10_mode1"].omega[0]) > 0
