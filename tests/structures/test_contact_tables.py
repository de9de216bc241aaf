"""Numbers in tables of contacts and files of loads: right as people write them, or refused."""

import datetime

import pytest

from squealpipe.structures.contact_table import read_contacts
from squealpipe.structures.files import read
from squealpipe.structures.structure import Structure
from squealpipe.structures.units import SI, scales_of

HEADER = ("name", "normal", "tangential", "stiffness", "preload")
WRITTEN = {
    "a German sheet": ("p", "2:1,0", "1:1", "8,5e7", "1.234,5"),
    "terms with commas": ("p", "2:0,5 4:0,5", "1:0,5; 3:0,5", "8,5e7", "1.234,5"),
    "wide digits": ("p", "２：１", "１：１", "８．５ｅ７", "１２３４．５"),
    "times ten": ("p", "2:1", "1:1", "8.5×10^7", "1234.5"),
    "Fortran": ("p", "2:1.0D0", "1:1", "8.5D+07", "1.2345D3"),
    "units": ("p", "2:1", "1:1", "85 kN/mm", "1.2345 kN"),
    "Swiss thousands": ("p", "2:1", "1:1", "85'000'000", "1'234.5"),
    "typeset minus": ("p", "2:1 4:−0.5", "1:1", "8.5e7", "1234.5"),
}


def _read(folder, cells, separator="\t", scales=SI):
    path = folder / "contacts.txt"
    path.write_text("\n".join(separator.join(row) for row in (HEADER, cells)))
    return read_contacts(path, None, 4, scales)[0]


@pytest.mark.parametrize("what", WRITTEN)
@pytest.mark.parametrize("separator", ["\t", "|"])
def test_numbers_are_what_the_table_says(what, separator, tmp_path):
    contact = _read(tmp_path, WRITTEN[what], separator)
    assert (contact.stiffness, contact.preload) == (8.5e7, 1234.5)
    half = what == "terms with commas"
    expected = {1: 0.5, 3: 0.5} if half else {1: 1.0}
    if what == "typeset minus":
        expected[3] = -0.5
    assert contact.normal == expected
    assert contact.tangential == ({0: 0.5, 2: 0.5} if half else {0: 1.0})


REFUSED = {
    "one or thousand": ((*WRITTEN["units"][:3], "8e7", "1.000"), "1.0000 or 1000"),
    "1,000 or 1": ((*WRITTEN["units"][:3], "8e7", "1,000"), "1.000 or 1000"),
    "Python's own": ((*WRITTEN["units"][:3], "1_000", "1"), "a number is needed"),
    "not a number": ((*WRITTEN["units"][:3], "nan", "1"), "a number is needed"),
    "infinite": ((*WRITTEN["units"][:3], "8e7", "inf"), "a number is needed"),
    "hexadecimal": ((*WRITTEN["units"][:3], "0x1p4", "1"), "unknown unit"),
    "too large": ((*WRITTEN["units"][:3], "1e999", "1"), "a finite number is needed"),
    "a coefficient": (("p", "2:1.000", "1:1", "8e7", "1"), "1.0000 or 1000"),
    "with a unit": (("p", "2:1mm", "1:1", "8e7", "1"), "a coefficient has no unit"),
    "of mass": (("p", "2:1", "1:1", "8e7", "3 kg"), "that is a mass"),
    "two signs": (("p", "2:0.5", "1:0,5", "8e7", "1"), "write one decimal sign"),
    "no coefficient": (("p", "2", "1:1", "8e7", "1"), "is no direction"),
    "half a row": (("p", "2.5:1", "1:1", "8e7", "1"), "have no labels"),
    "row zero": (("p", "0:1", "1:1", "8e7", "1"), "degrees of freedom are 1 to 4"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_ambiguous_or_no_number_is_refused(what, tmp_path):
    cells, says = REFUSED[what]
    with pytest.raises(ValueError, match=says) as caught:
        _read(tmp_path, cells)
    assert "contacts.txt, line 2" in str(caught.value)


def test_numbers_without_a_unit_are_in_those_of_the_file(tmp_path):
    cells = ("p", "2:1", "1:1", "85,0", "1,2 kN")
    contact = _read(tmp_path, cells, ";", scales_of("mm-t-s"))
    assert (contact.stiffness, contact.preload) == (85e3, 1200.0)


@pytest.mark.parametrize(
    ("cell", "says"),
    [
        (datetime.time(2, 1), "format the column as text"),
        (datetime.timedelta(hours=25, minutes=1), "format the column as text"),
        (datetime.datetime(2026, 1, 2), "format the column as text"),
        ("2:1", None),
    ],
)
def test_what_excel_took_for_a_time_is_refused_with_the_remedy(cell, says, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(HEADER)
    book.active.append(["p", cell, "1:1", 8.5e7, "4000"])
    path = tmp_path / "contacts.xlsx"
    book.save(path)
    if says is None:
        (contact,) = read_contacts(path, None, 4, SI)
        assert (contact.stiffness, contact.preload) == (8.5e7, 4000.0)
        return
    with pytest.raises(ValueError, match=r"line 2: normal = .*like 12:1") as caught:
        read_contacts(path, None, 4, SI)
    assert says in str(caught.value)


def test_text_of_a_sheet_may_have_thousands(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(HEADER)
    book.active.append(["p", "2:1", "1:1", 8.5e7, "1.000"])
    path = tmp_path / "contacts.xlsx"
    book.save(path)
    with pytest.raises(
        ValueError, match=r"'1.000' is text, and its point may separate"
    ):
        read_contacts(path, None, 4, SI)


LOADS = {
    "1.5\n-2\n": [1.5, -2.0],
    "1.5 -2\n": [1.5, -2.0],
    "1,5;-2,0\n": [1.5, -2.0],
    "# N\n1.5D0\n−2\n": [1.5, -2.0],
    "1.500e+00\n-2.000e+00\n": [1.5, -2.0],
    "1.500\n-0.250\n": [1.5, -0.25],
    "1'500.5\n2\n": [1500.5, 2.0],
    "1.500\n2\n": "may separate thousands; write 1.5000 or 1500",
    "1_500\n2\n": "line 1: '1_500' is no number",
    "nan\n2\n": "line 1: 'nan' is no number",
    "1.5 N\n2\n": "line 1: '1.5 N' is no number",
    "1 2\n3 4\n": "it has several columns",
    "1e400\n2\n": "finite numbers are needed",
}


@pytest.mark.parametrize("text", LOADS)
def test_loads_are_read_as_tables_are(text, tmp_path):
    matrix = (
        "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1.0\n2 2 1.0\n"
    )
    (tmp_path / "m.mtx").write_text(matrix)
    (tmp_path / "load.txt").write_text(text)
    source = tmp_path / "pad.yaml"
    source.write_text("mass: m.mtx\nstiffness: m.mtx\nload: load.txt\n")
    if isinstance(LOADS[text], str):
        with pytest.raises(ValueError, match=LOADS[text]):
            read(source, Structure)
    else:
        assert read(source, Structure).load.tolist() == LOADS[text]
