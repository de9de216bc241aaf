"""A run as one tree, read when it is used; several runs stacked along what was changed."""

import shutil
import time

import numpy as np
import pytest
import xarray as xr

from squealpipe import Parameters, backbone, load, open_results, save, stability_map
from squealpipe.store import StoreError
from squealpipe.store.archive import archive
from squealpipe.store.checkout import ROOT
from squealpipe.store.memory import results
from squealpipe.store.seal import HEADER


def test_nodes_are_the_datasets_by_their_names(run):
    folder = run / "results/data"
    shutil.copy(folder / "stability_map.nc", folder / "second.nc")
    (folder / "deep").mkdir()
    shutil.copy(folder / "stability_map.nc", folder / "deep/third.nc")
    archive("first", root=run)
    for tree in (open_results(run / "results"), open_results("first", root=run)):
        assert isinstance(tree, xr.DataTree)
        assert {node.path for node in tree.subtree if node.has_data} == {
            "/stability_map",
            "/second",
            "/deep/third",
        }
        whole = load(folder / "stability_map.nc")
        xr.testing.assert_identical(tree["deep/third"].to_dataset().load(), whole)
        np.testing.assert_array_equal(
            tree["second"].growth_rate[3:5, ::2].values, whole.growth_rate.values[3:5, ::2]
        )


def test_every_kind_of_dataset_of_the_reference_is_the_one_that_load_reads():
    tree = open_results("reference", root=ROOT)
    for name in ("claims", "whirl", "backbone/F10_mode1", "failure_atlas", "model_ladder"):
        whole = load(ROOT / f"results/archive/reference/data/{name}.nc")
        xr.testing.assert_identical(tree[name].to_dataset().load(), whole)


def test_values_are_read_when_they_are_used(run, monkeypatch):
    read = []
    original = results._StoredArray._read

    def counted(self, key):
        read.append(self.name)
        return original(self, key)

    monkeypatch.setattr(results._StoredArray, "_read", counted)
    tree = open_results(run / "results")
    assert read == []
    assert float(tree["stability_map"].growth_rate.max()) > 0
    assert set(read) == {"growth_rate"}


@pytest.mark.parametrize("points", [5, 5000])
def test_the_header_gives_what_the_file_gives(tmp_path, points):
    """Attributes, types and grids; a grid that is too long for it is read from the file."""
    made = stability_map(Parameters(), [0.3, 1.2], np.linspace(0, 3, points))
    made = made.assign_attrs(note="é", number=3, factor=0.1, vector=np.array([1.5, np.nan]))
    path = save(made, tmp_path / "map.nc")
    assert results.open_lazily(path).load().identical(load(path))
    without = tmp_path / "without.nc"
    without.write_bytes(path.read_bytes().rpartition(HEADER)[0])
    assert results.open_lazily(without).load().identical(load(path))


def test_damaged_files_are_refused(run):
    path = run / "results/data/stability_map.nc"
    content = bytearray(path.read_bytes())
    content[2000] ^= 1
    path.write_bytes(content)
    with pytest.raises(StoreError, match="changed or damaged"):
        open_results(run / "results")


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
    (tmp_path / "results/archive/.index.json").touch()
    with pytest.raises(FileNotFoundError, match=r"no archive, folder or file.*; archives: first$"):
        open_results("nothing", root=tmp_path)


def test_a_thousand_nodes_open_within_three_seconds(tmp_path):
    """Of processor time; no file stays open."""
    angles = np.linspace(0, np.pi, 31)
    made = stability_map(Parameters(), angles, angles)
    first = save(made, tmp_path / "0.nc")
    for i in range(1, 1000):
        shutil.copy(first, tmp_path / f"{i}.nc")
    began = time.process_time()
    tree = open_results(tmp_path)
    assert time.process_time() - began < 3.0
    assert len(tree.children) == 1000
    assert tree["999"].to_dataset().load().identical(load(first))
