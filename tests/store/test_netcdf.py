"""A dataset file is whole and valid or absent; whatever is read was judged first."""

import contextlib
import datetime
import errno
import os
import re
import resource
import signal
from pathlib import Path
from unittest.mock import Mock

import netCDF4
import numpy as np
import pytest
import xarray as xr

from squealpipe.brake.linear.maps import stability_map
from squealpipe.parameters import Parameters
from squealpipe.schema import SchemaError
from squealpipe.store import StoreError, load, produce, save
from squealpipe.store.keys import stated_key
from squealpipe.store.provenance import stamped
from squealpipe.store.sealed import SEAL_MARK
from squealpipe.store.whole_files import checksum, whole_file

ANGLES = np.linspace(0, np.pi, 31)


@pytest.fixture
def dataset():
    return stability_map(Parameters(), ANGLES, ANGLES)


@pytest.fixture
def path(tmp_path, dataset):
    return save(dataset, tmp_path / "map.nc")


def seal(path):
    """Have a file that another program wrote end as ours do."""
    line = SEAL_MARK + checksum(path).encode() + b"\n"
    with path.open("ab") as file:
        file.write(line)


def test_what_is_saved_is_loaded(dataset, path):
    back = load(path)
    added = {"commit", "history", "dataset_id"}
    assert set(back.attrs) - set(dataset.attrs) == added
    xr.testing.assert_identical(
        back, dataset.assign_attrs({name: back.attrs[name] for name in added})
    )
    assert back.growth_rate.dtype == np.float64
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_file_is_cf_and_compressed(path):
    with netCDF4.Dataset(path) as file:
        assert file.Conventions == "CF-1.11"
        regime = file["regime_linear"]
        assert regime.flag_meanings == "stable flutter divergence"
        assert regime.filters()["zlib"]
        assert "_FillValue" not in regime.ncattrs()
        assert file["growth_rate"].units == "s-1"


def test_what_a_reader_sees_beside_the_values_is_covered_too(path):
    with netCDF4.Dataset(path, "a") as file:
        file["growth_rate"].setncattr("units", "h-1")
    with pytest.raises(StoreError, match="was changed or damaged since"):
        load(path)


@pytest.mark.parametrize("share", [0.02, 0.5, 0.97, 1.0])
def test_one_byte_that_changed_is_noticed_wherever_it_lies(path, share):
    content = bytearray(path.read_bytes())
    content[int(share * (len(content) - 1)) - 1] ^= 1
    path.write_bytes(content)
    with pytest.raises(StoreError, match="was changed or damaged since"):
        load(path)


def values(dataset):
    dataset["growth_rate"] = dataset.growth_rate * 3


def parameters(dataset):
    dataset.attrs["parameters"] = dataset.attrs["parameters"].replace("0.3", "0.4")


def long_name(dataset):
    dataset.growth_rate.attrs["long_name"] = "decay rate"


@pytest.mark.parametrize("edit", [values, parameters, long_name])
def test_an_edited_dataset_loses_its_key_and_says_so(tmp_path, dataset, edit):
    path = produce(
        lambda: dataset, config={}, output=tmp_path / "data/map.nc", key="0" * 16
    )
    assert stated_key(path) == f"{'0' * 16} data/map.nc"
    again = save(load(path), path)  # what nobody edited keeps it
    assert stated_key(again) == f"{'0' * 16} data/map.nc"
    changed = load(path)
    edit(changed)
    with pytest.warns(UserWarning, match="edited after its task made it"):
        save(changed, path)
    assert stated_key(path) is None
    assert "edited; what was data/map.nc" in load(path).history.splitlines()[0]


def test_an_edited_dataset_without_a_digest_loses_its_key_too(tmp_path, dataset):
    """Those of 1.0.0 have their id alone."""
    path = produce(
        lambda: dataset, config={}, output=tmp_path / "data/map.nc", key="0" * 16
    )
    old = load(path)
    del old.attrs["key_content"]
    assert stated_key(save(old, path)) == f"{'0' * 16} data/map.nc"
    values(old)
    with pytest.warns(UserWarning, match="edited after its task made it"):
        assert stated_key(save(old, path)) is None


@pytest.mark.parametrize(
    "value",
    [None, True, {"a": 1}, datetime.date(2026, 1, 1), [1, None], [[1], [1, 2]], 1j],
)
def test_an_attribute_that_no_file_holds_is_named_with_text_that_can_stand_for_it(
    dataset, path, value
):
    with pytest.raises(
        StoreError, match=r"attrs\['note'\] = .* cannot be written"
    ) as told:
        save(dataset.assign_attrs(note=value), path)
    remedy = re.search(r"write (dataset.attrs.*), or delete it", str(told.value))[1]
    exec(remedy, {"dataset": dataset})  # noqa: S102 (our own message, followed)
    assert load(save(dataset, path)).attrs["note"] == str(value)


@pytest.mark.parametrize("name", ["", 3, "a/b", "_NCProperties", "a" * 300])
def test_an_attribute_with_a_name_that_no_file_holds_is_named(dataset, path, name):
    with pytest.raises(StoreError, match="give it a name of letters"):
        save(dataset.assign_attrs({name: "text"}), path)


def test_ids_of_inputs_are_those_of_the_files_that_the_task_read(tmp_path):
    made = [stability_map(Parameters(mu=mu), [1.0], [2.0]) for mu in (0.1, 0.2)]
    path = save(made[0], tmp_path / "input.nc")

    def task():
        save(made[1], path)  # another job, meanwhile
        return made[0]

    before = stamped(lambda: made[0], config={}, inputs=[path]).attrs["inputs"]
    assert stamped(task, config={}, inputs=[path]).attrs["inputs"] == before


@pytest.mark.parametrize("kind", ["device", "pipe", "folder", "link"])
def test_what_is_no_regular_file_is_never_replaced(dataset, tmp_path, kind):
    target = tmp_path / "target.nc"
    make = {
        "device": lambda: target.symlink_to("/dev/null"),
        "pipe": lambda: os.mkfifo(target),
        "folder": target.mkdir,
        "link": lambda: target.symlink_to(tmp_path),
    }
    make[kind]()
    with pytest.raises(StoreError, match="not a regular file"):
        save(dataset, target)
    assert not target.is_file()


def test_files_of_an_archive_are_never_replaced(dataset, path, tmp_path):
    (tmp_path / "manifest.sha256").write_text("")
    before = path.read_bytes()
    with pytest.raises(StoreError, match="part of the archive"):
        save(dataset, path)
    assert path.read_bytes() == before


def test_foreign_unknown_and_damaged_files_are_refused(tmp_path, dataset, path):
    foreign, text, bad = (
        tmp_path / f"{name}.nc" for name in ("foreign", "text", "bad")
    )
    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(foreign)
    text.write_text("no dataset")
    for each in (foreign, text):
        with pytest.raises(StoreError, match="or another program wrote it"):
            load(each)
    damaged = dataset.copy(deep=True)
    damaged["regime_linear"][0, 0] = 9
    for wrong, message in (
        (dataset.assign_attrs(schema="colour_map"), "no schema 'colour_map'"),
        (damaged, r"flags \[9\] that have no meaning"),
    ):
        wrong.to_netcdf(bad)
        seal(bad)
        with pytest.raises(SchemaError, match=message):
            load(bad)
    with pytest.raises(SchemaError, match="'validity_map' was expected"):
        load(path, schema="validity_map")
    for missing in (tmp_path / "none.nc", tmp_path):
        with pytest.raises(FileNotFoundError, match="make it with snakemake"):
            load(missing)


def test_a_dataset_of_nobody_is_refused_in_two_lines(tmp_path, dataset):
    with pytest.raises(SchemaError, match="states no schema") as caught:
        save(xr.Dataset({"x": ("t", [1.0])}), tmp_path / "x.nc")
    assert "to_netcdf" in str(caught.value)
    for name, says in (("colour_map", ""), ("stability_maps", "'stability_map'")):
        with pytest.raises(SchemaError, match=f"no schema '{name}'.*{says}") as caught:
            save(dataset.assign_attrs(schema=name), tmp_path / "x.nc")
        assert len(str(caught.value)) < 80
    assert not list(tmp_path.iterdir())


def test_a_home_folder_is_found(tmp_path, monkeypatch, dataset):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert save(dataset, "~/map.nc") == tmp_path / "map.nc"
    assert load(Path("~/map.nc")).identical(load(tmp_path / "map.nc"))
    with (
        pytest.raises(StoreError, match="the shell did not replace ~"),
        whole_file(Path("~/other.csv")),
    ):
        pass
    assert [each.name for each in tmp_path.iterdir()] == ["map.nc"]


def test_claimed_sizes_beyond_memory_are_refused(tmp_path):
    with netCDF4.Dataset(tmp_path / "bomb.nc", "w") as file:
        file.createDimension("t", 2**45)
        file.createVariable("x", "f8", ("t",), chunksizes=(1024,), zlib=True)
    seal(tmp_path / "bomb.nc")
    with pytest.raises(StoreError, match="more than this machine has"):
        load(tmp_path / "bomb.nc")


@pytest.mark.parametrize(
    "break_it",
    [
        lambda d: d.drop_vars("outcome"),
        lambda d: d.assign(extra=1.0),
        lambda d: d.assign(growth_rate=d.growth_rate.astype(int)),
        lambda d: d.assign(growth_rate=d.growth_rate.T),
        lambda d: d.assign(regime_linear=d.regime_linear + np.int8(99)),
        lambda d: d.assign_attrs(schema_version=99),
        lambda d: d.assign_attrs(schema=None),
    ],
)
def test_invalid_datasets_leave_the_earlier_file(path, dataset, break_it):
    before = path.read_bytes()
    with pytest.raises(SchemaError):
        save(break_it(dataset), path)
    assert path.read_bytes() == before
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


@contextlib.contextmanager
def no_space():
    """Files cannot grow past a few kilobytes, as on a full disk; pytest's own log neither."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (6000, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, handler)


@contextlib.contextmanager
def failing_rename():
    """The last step fails."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            Path, "replace", Mock(side_effect=OSError(errno.EIO, "Input/output error"))
        )
        yield


@pytest.mark.parametrize("fault", ["no space", "read only", "rename"])
def test_a_write_that_fails_leaves_the_earlier_file(path, fault, read_only):
    before = path.read_bytes()
    larger = stability_map(Parameters(), *[np.linspace(0, np.pi, 201)] * 2)
    hinder = {"no space": no_space, "rename": failing_rename}
    hindered = hinder[fault]() if fault in hinder else read_only(path.parent)
    with hindered, pytest.raises(StoreError, match="free space or fix permissions"):
        save(larger, path)
    assert path.read_bytes() == before
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]
