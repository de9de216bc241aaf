"""Comparison: equal, within tolerance, different or refused; where, how much, and which flags."""

import json
import shutil

import numpy as np
import pytest
import xarray as xr

from squealpipe.schema import DatasetSchema, Variable, build
from squealpipe.store import load, save
from squealpipe.store.archive import archive
from squealpipe.store.compare import compare, compare_datasets
from squealpipe.store.differences import Verdict, align, difference


def edited(path, change):
    """A copy of a dataset file, changed by a function and written beside it."""
    dataset = load(path)
    change(dataset)
    return save(dataset, path.with_name("edited.nc"))


@pytest.fixture
def dataset_file(run):
    return run / "results/data/stability_map.nc"


def test_two_runs_of_one_configuration_are_equal(tmp_path, write_run):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    found = compare(a / "results", b / "results")
    assert found.verdict == Verdict.equal
    assert found.exit_code == 0
    assert found.parameters == {}
    assert json.loads(json.dumps(found.as_dict(), allow_nan=False))["verdict"] == "equal"


def test_archives_by_name_runs_and_files_can_be_mixed(run, dataset_file):
    archive("one", root=run)
    for a, b in [("one", run / "results"), ("one", run / "results/data"), (dataset_file,) * 2]:
        assert compare(a, b, root=run).exit_code == 0


def test_round_off_is_within_tolerance(dataset_file):
    def shift(dataset):
        dataset["growth_rate"][...] = dataset.growth_rate * (1 + 1e-12)

    found = compare(dataset_file, edited(dataset_file, shift))
    assert found.verdict == Verdict.within_tolerance
    assert found.exit_code == 0


def test_largest_difference_and_its_place_are_told(dataset_file):
    def shift(dataset):
        dataset["growth_rate"][3, 7] += 0.25
        dataset["growth_rate"][4, 1] -= 0.125

    found = compare(dataset_file, edited(dataset_file, shift))
    assert found.exit_code == 1
    entry = next(v for v in found.datasets[0].variables if v.name == "growth_rate")
    assert entry.differing == 2
    assert entry.largest_absolute == pytest.approx(0.25)
    assert entry.where["alpha1"] == pytest.approx(3 * np.pi / 12)
    assert entry.where["alpha2"] == pytest.approx(7 * np.pi / 12)


def test_flipped_flags_are_counted(dataset_file):
    def flip(dataset):
        stable = dataset.regime_linear.values.ravel() == 0
        dataset.regime_linear.values.ravel()[np.flatnonzero(stable)[:4]] = 2

    found = compare(dataset_file, edited(dataset_file, flip))
    entry = next(v for v in found.datasets[0].variables if v.name == "regime_linear")
    assert entry.differing == 4
    assert entry.flips == {"stable → divergence": 4}


def test_changed_parameters_are_listed(tmp_path, write_run):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b", mu=0.4)
    found = compare(a / "results", b / "results")
    assert found.parameters == {"parameters.mu": (0.3, 0.4)}
    assert found.exit_code == 1


def test_coarse_and_fine_grids_are_aligned(tmp_path, write_run):
    a, b = write_run(tmp_path / "a", points=13), write_run(tmp_path / "b", points=37)
    found = compare(a / "results", b / "results")
    assert found.exit_code == 0
    assert found.datasets[0].notes[0] == "alpha1: compared on 13 shared points of 13 and 37"
    assert found.parameters == {"linear.points": (13, 37)}


def test_grids_without_common_points_are_refused(dataset_file):
    moved = load(dataset_file).assign_coords(alpha1=load(dataset_file).alpha1 + 0.01)
    moved.alpha1.attrs = load(dataset_file).alpha1.attrs
    path = save(moved, dataset_file.with_name("moved.nc"))
    found = compare(dataset_file, path)
    assert found.exit_code == 2
    assert "the grids of alpha1 share 0 of 13 and 13 points" in found.datasets[0].reason


def test_missing_datasets_are_a_difference(tmp_path, write_run):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    shutil.copy(a / "results/data/stability_map.nc", a / "results/data/second.nc")
    found = compare(a / "results", b / "results")
    assert found.exit_code == 1
    assert next(d for d in found.datasets if d.name == "second").reason.startswith("only in")


def test_damaged_and_foreign_files_are_not_comparable(dataset_file, tmp_path):
    damaged = tmp_path / "damaged.nc"
    damaged.write_bytes(dataset_file.read_bytes()[:-2000])
    foreign = tmp_path / "foreign.nc"
    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(foreign)
    for other, reason in [(damaged, "truncated"), (foreign, "not written by squealpipe")]:
        found = compare(dataset_file, other)
        assert found.exit_code == 2
        assert reason in found.datasets[0].reason
    assert compare(dataset_file, tmp_path / "nothing").exit_code == 2
    assert "no archive, folder or file" in compare(dataset_file, tmp_path / "nothing").reason
    empty = tmp_path / "empty"
    empty.mkdir()
    assert "holds no dataset" in compare(dataset_file, empty).reason


TABLE = DatasetSchema(
    name="probe",
    title="Probe",
    coordinates={"t": Variable(dims=("t",), units="s")},
    variables={
        "x": Variable(dims=("t",), nan_allowed=True, rtol=1e-3, atol=1e-6),
        "wall": Variable(volatile=True, optional=True),
        "event": Variable(dims=("event",), optional=True),
    },
)


def one(a, b, **entry):
    entry = Variable(dims=("t",), nan_allowed=True, **entry)
    return difference("x", xr.DataArray(a, dims="t"), xr.DataArray(b, dims="t"), entry)


@pytest.mark.parametrize(
    ("a", "b", "verdict"),
    [
        ([np.nan], [np.nan], Verdict.equal),
        ([np.inf], [np.inf], Verdict.equal),
        ([0.0], [-0.0], Verdict.equal),
        ([np.nan], [1.0], Verdict.different),
        ([np.inf], [-np.inf], Verdict.different),
        ([np.inf], [1e308], Verdict.different),
        ([1.0], [1.0005], Verdict.within_tolerance),
        ([1.0], [1.002], Verdict.different),
        ([0.0], [5e-7], Verdict.within_tolerance),
        ([0.0], [5e-6], Verdict.different),
        ([1e308], [-1e308], Verdict.different),
        ([], [], Verdict.equal),
    ],
)
def test_verdicts_at_the_edges(a, b, verdict):
    assert one(a, b, rtol=1e-3, atol=1e-6).verdict == verdict
    assert one(b, a, rtol=1e-3, atol=1e-6).verdict == verdict


def test_text_and_lists_of_different_length():
    assert one(["a", "b"], ["a", "c"]).verdict == Verdict.different
    longer = one([1.0, 2.0, 3.0], [1.0, 2.0])
    assert longer.verdict == Verdict.different
    assert "3 against 2 along t" in longer.reason


def test_volatile_variables_are_no_part_of_the_verdict(monkeypatch):
    monkeypatch.setattr("squealpipe.store.compare.find", {"probe": TABLE}.get)
    a = build(TABLE, {"x": [1.0, 2.0], "wall": 3.0}, {"t": [0.0, 1.0]})
    b = build(TABLE, {"x": [1.0, 2.0], "wall": 4.0}, {"t": [0.0, 1.0]})
    found = compare_datasets("probe", a, b)
    assert found.verdict == Verdict.equal
    assert next(v for v in found.variables if v.name == "wall").verdict == Verdict.different
    c = build(TABLE, {"x": [1.0, 2.0], "event": [1.0]}, {"t": [0.0, 1.0]})
    assert compare_datasets("probe", a, c).verdict == Verdict.different


def test_alignment_is_by_value_not_by_position():
    a = xr.Dataset({"x": ("t", [1.0, 2.0, 3.0])}, {"t": [0.0, 1.0, 2.0]})
    b = xr.Dataset({"x": ("t", [3.0, 1.0])}, {"t": [2.0 + 1e-12, 0.0]})
    left, right, notes = align(a, b)
    np.testing.assert_array_equal(left.x, [1.0, 3.0])
    np.testing.assert_array_equal(right.x, [1.0, 3.0])
    assert notes == ["t: compared on 2 shared points of 3 and 2"]
    names = xr.Dataset({"x": ("s", [1, 2])}, {"s": ["F3", "F2a"]})
    others = xr.Dataset({"x": ("s", [2, 1])}, {"s": ["F2a", "F3"]})
    left, right, _ = align(names, others)
    np.testing.assert_array_equal(left.x, right.x)
