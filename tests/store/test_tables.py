"""Datasets for other programs, read back by the libraries that read them elsewhere."""

import gc
import re
import subprocess
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

from squealpipe import convert, save, simulate
from squealpipe.cli import run as command
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from tests.former import FORMER


@pytest.fixture(scope="module")
def motion():
    return simulate(FORMER, 5 * np.pi / 6, 5 * np.pi / 6, t_end=20.0)


def test_matlab_holds_arrays_units_and_the_meanings_of_flags(motion, tmp_path):
    convert(motion, tmp_path / "run.mat")
    found = loadmat(tmp_path / "run.mat", squeeze_me=True, simplify_cells=True)
    np.testing.assert_array_equal(found["x"], motion.x)
    np.testing.assert_array_equal(found["event_kind"], motion.event_kind)
    assert found["units"]["normal_force"] == "N"
    assert "0: separation" in found["meanings"]["event_kind"]


@pytest.mark.parametrize(
    ("ending", "library"), [(".xlsx", "openpyxl"), (".parquet", "pyarrow")]
)
def test_tables_have_units_in_their_header_and_flags_in_words(
    ending, library, motion, tmp_path
):
    pytest.importorskip(library, reason="the extra export is not installed")
    files = convert(motion, tmp_path / f"run{ending}")
    if ending == ".xlsx":
        sheets = pd.read_excel(files[0], sheet_name=None)
        assert list(sheets) == ["time", "event", "about"]
        table, events = sheets["time"], sheets["event"]
    else:
        assert [path.name for path in files] == ["run.parquet", "run.event.parquet"]
        table, events = map(pd.read_parquet, files)
        assert "config" in table.attrs or "parameters" in table.attrs
    np.testing.assert_allclose(table["vx [m s-1]"], motion.vx, rtol=1e-15)
    assert events["event_kind"][0] == "separation"


def odd():
    """A system of a user's own, whose names are no MATLAB's or Excel's."""
    names = [
        "_x",
        "x_",
        "θ",
        "a" * 70,
        "a" * 71,
        "units",
        "meanings",
        "attributes",
        "end",
        "1a",
    ]
    variables = {name: ("t", [number, 2.0]) for number, name in enumerate(names)}
    return xr.Dataset(
        variables | {"kind": ("t", ["=1+1", "a\x01b"])},
        attrs={"title": '=HYPERLINK("http://x")', "system": "=1+1"},
    )


def test_matlab_gets_every_array_under_a_name_of_its_own(tmp_path):
    convert(odd(), tmp_path / "odd.mat")
    found = loadmat(tmp_path / "odd.mat", squeeze_me=True, simplify_cells=True)
    short = {name: key for key, name in found["names"].items()}
    for number, name in enumerate(map(str, odd().data_vars)):
        assert re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,62}", short[name])
        if name != "kind":
            assert found[short[name]].tolist() == [number, 2.0]
    assert short["x_"] == "x_"
    assert found["attributes"]["system"] == "=1+1"


def test_texts_are_no_formulas_in_excel(tmp_path):
    openpyxl = pytest.importorskip(
        "openpyxl", reason="the extra export is not installed"
    )
    convert(odd(), tmp_path / "odd.xlsx")
    book = openpyxl.load_workbook(tmp_path / "odd.xlsx")
    cells = [cell for sheet in book for row in sheet.iter_rows() for cell in row]
    assert {cell.data_type for cell in cells} <= {"s", "n"}
    assert {"=1+1", "a?b", '=HYPERLINK("http://x")'} <= {cell.value for cell in cells}


def test_sheets_with_long_names_do_not_take_each_others_place(tmp_path):
    pytest.importorskip("openpyxl", reason="the extra export is not installed")
    dims = ["a" * 40 + end for end in "xy"] + ["about", "b/c"]
    dataset = xr.Dataset({f"v{i}": (dim, [float(i)]) for i, dim in enumerate(dims)})
    convert(dataset, tmp_path / "long.xlsx")
    sheets = pd.read_excel(tmp_path / "long.xlsx", sheet_name=None)
    assert len(sheets) == 5
    assert sorted(
        sheet.iloc[0, -1] for name, sheet in sheets.items() if name != "about"
    ) == [0.0, 1.0, 2.0, 3.0]


@pytest.mark.parametrize("ending", ["csv", "xlsx", "mat", "parquet"])
def test_single_numbers_alone_are_a_table_too(tmp_path, ending):
    dataset = xr.Dataset({"force": ((), 3.5, {"units": "N"})})
    if ending != "mat":
        pytest.importorskip("openpyxl", reason="the extra export is not installed")
    (file,) = convert(dataset, tmp_path / f"one.{ending}")
    if ending == "csv":
        assert pd.read_csv(file, comment="#").force.item() == 3.5
    assert file.is_file()


def test_files_of_other_programs_are_drawn_and_converted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    xr.Dataset({"note": ("t", ["a", "b", "c"]), "x": ("t", [1.0, 2, 4])}).to_netcdf(
        "mine.nc"
    )
    Path("mine.csv").write_text(
        "# of an oscilloscope\ntime, volt\n0, 1\n0.5, 2\n1, 4\n"
    )
    Path("odd.nc").write_text("no NetCDF")
    for file, values in (("mine.nc", "x"), ("mine.csv", "volt")):
        assert command(["plot", file, "-o", f"{file}.png"]) == 0
        assert command(["convert", file, "-o", f"{file}.mat"]) == 0
        assert loadmat(f"{file}.mat", squeeze_me=True)[values].tolist() == [1, 2, 4]
    Path("excel.csv").write_text("time;volt\n0,5;1,25\n1;2\n")  # in half of Europe
    Path("blanks.csv").write_text("time  volt\n0.5  1.25\n1    2\n")
    Path("marked.csv").write_text("sep=;\ntime;volt\n0.5;1.25\n1;2\n")
    for file in ("excel.csv", "blanks.csv", "marked.csv"):
        assert command(["plot", file]) == 0
        assert command(["convert", file, "-o", f"of_{file}"]) == 0
        assert Path(f"of_{file}").read_text() == (
            f"# of_{Path(file).stem}\n# columns: time, volt\ntime,volt\n0.5,1.25\n1.0,2.0\n"
        )
    Path("units.csv").write_text("time (s)  force (N)\n0.5  1.25\n1  2\n")
    assert command(["convert", "units.csv", "-o", "of_units.csv"]) == 0
    assert Path("of_units.csv").read_text().splitlines()[2:] == [
        "time (s),force (N)",
        "0.5,1.25",
        "1.0,2.0",
    ]
    assert command(["plot", "mine.csv", "--variable", "w", "-o", "w.png"]) == 2
    assert command(["plot", "odd.nc"]) == 2
    assert command(["convert", "odd.nc", "-o", "odd.csv"]) == 2
    told = capsys.readouterr().err
    assert "delete" not in told
    assert told.count("odd.nc cannot be read as NetCDF") == 2


def test_a_missing_library_is_named(motion, tmp_path, monkeypatch):
    monkeypatch.setattr("squealpipe.store.tables.find_spec", lambda _: None)
    with pytest.raises(
        ValueError, match=r"needs openpyxl; pip install 'squealpipe\[export\]'"
    ):
        convert(motion, tmp_path / "run.xlsx")


def test_an_unknown_ending_is_refused(motion, tmp_path):
    with pytest.raises(ValueError, match=r"end the name in \.csv, \.mat"):
        convert(motion, tmp_path / "run.ods")


def test_command_draws_and_converts_a_system_of_ones_own(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    save(impact_oscillator.simulate(20.0), "results/data/own.nc")
    assert command(["plot", "results/data/own.nc"]) == 0, (
        "beside it nothing else may be"
    )
    (tmp_path / "results/data/own.nc").rename("own.nc")
    assert command(["plot", "own.nc"]) == 2
    assert "own.png exists; add --force" in capsys.readouterr().err
    assert command(["plot", "own.nc", "--variable", "v", "-o", "v.svg"]) == 0
    assert command(["plot", "own.nc", "--variable", "w", "-o", "w.svg"]) == 2
    assert "has x, v" in capsys.readouterr().err
    assert command(["convert", "own.nc", "-o", "own.csv"]) == 0
    assert "x [m]" in (tmp_path / "own.csv").read_text()


@pytest.mark.usefixtures("real_pictures")
@pytest.mark.release
def test_a_full_disk_ends_a_workbook_and_a_picture_in_one_message(
    motion, tmp_path, monkeypatch, capsys
):
    """Half a zip file complains again when it is thrown away, half a PDF when it is closed."""
    later: list[object] = []
    monkeypatch.setattr("sys.unraisablehook", later.append)
    monkeypatch.chdir(tmp_path)
    save(motion, tmp_path / "run.nc")
    full = tmp_path / "full"
    full.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=8k", "tmpfs", full]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("a small file system cannot be mounted here (needs root)")
    try:
        for words in ("convert run.nc -o full/run.xlsx", "plot run.nc -o full/run.pdf"):
            assert command(words.split()) == 2
            assert "free space or fix permissions" in capsys.readouterr().err
        gc.collect()
        assert not list(full.iterdir())
    finally:
        subprocess.run(["umount", "-l", full], check=True)
    assert not later
