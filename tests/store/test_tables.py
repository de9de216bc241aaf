"""Datasets for other programs, read back by the libraries that read them elsewhere."""

import numpy as np
import pandas as pd
import pytest
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
