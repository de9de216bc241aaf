"""Tables as instruments, Excel and papers write them: read rightly, or refused with a remedy."""

import re

import pytest

from squealpipe import Parameters
from squealpipe.laws.contact_laws import own_law_rules as contact_rules
from squealpipe.laws.friction_laws import own_law_rules as friction_rules
from squealpipe.laws.sheets import shown_as
from squealpipe.laws.table_files import read_pairs
from squealpipe.study.configuration.settings import ConfigError, read_study

SI = [(0.0, 0.5), (0.1, 0.45), (1.5, 0.3)]
"""What every table of friction below says."""

READ = {
    "plain": "speed,coefficient\n0,0.5\n0.1,0.45\n1.5,0.3\n",
    "any name": "speed, mu\n0, 0.5\n0.1, 0.45\n1.5, 0.3\n",
    "German Excel": "speed;µ\n0;0,5\n0,1;0,45\n1,5;0,3\n",
    "German, three decimals": "speed;µ\n0,000;0,500\n0,100;0,450\n1,500;0,300\n",
    "French": "speed;coefficient de frottement\n0,0;0,50\n0,1;0,45\n1,5;0,30\n",
    "Italian, km/h": "speed [km/h];attrito\n0;0,5\n0,36;0,45\n5,4;0,3\n",
    "Polish, tabs": "speed\twspółczynnik\n0\t0,5\n0,1\t0,45\n1,5\t0,3\n",
    "English, quoted": '"speed","mu"\n"0","0.5"\n"0.1","0.45"\n"1.5","0.3"\n',
    "quoted decimal commas": 'speed,mu\n"0","0,5"\n"0,1","0,45"\n"1,5","0,3"\n',
    "Excel's sep": "sep=;\nspeed;mu\n0;0.5\n0.1;0.45\n1.5;0.3\n",
    "spaces": "speed   mu\n0.0     0.50\n0.1     0.45\n1.5     0.30\n",
    "spaces and commas": "speed mu\n0,0 0,50\n0,1 0,45\n1,5 0,30\n",
    "bars": "speed | mu\n0 | 0.5\n0.1 | 0.45\n1.5 | 0.3\n",
    "comments": "# rig 4\nspeed,mu\n# first\n0,0.5\n0.1,0.45\n\n1.5,0.3\n",
    "percent comments": "% rig 4\nspeed,mu\n0,0.5\n0.1,0.45\n1.5,0.3\n",
    "preamble": "Rig;4\nDate;2024-05-01\n\nspeed;mu\n0;0,5\n0,1;0,45\n1,5;0,3\n",
    "units in brackets": "speed (mm/s), mu (-)\n0, 0.5\n100, 0.45\n1500, 0.3\n",
    "units by DIN": "speed / (mm/s);mu / %\n0;50\n100;45\n1500;30\n",
    "units by in": "speed in m/s;mu in %\n0;50\n0,1;45\n1,5;30\n",
    "units row": "speed;mu\nmm/s;-\n0;0,5\n100;0,45\n1500;0,3\n",
    "units row in brackets": "speed;mu\n[km/h];[%]\n0;50\n0,36;45\n5,4;30\n",
    "Windows line ends": "speed;mu\r\n0;0,5\r\n0,1;0,45\r\n1,5;0,3\r\n",
    "exponents": "speed,mu\n0.00E+00,5.0E-01\n1.0E-01,4.5E-01\n1.5E+00,3.0E-01\n",
    "German exponents": "speed;mu\n0,0E+0;5,0E-1\n1,0E-1;4,5E-1\n1,5E+0;3,0E-1\n",
    "trailing separators": "speed;mu;;\n0;0,5;;\n0,1;0,45;;\n1,5;0,3;;\n",
    "further columns": "time,speed,force,coefficient\n1,0,9,0.5\n2,0.1,9,0.45\n3,1.5,8,0.3\n",
    "no leading zero": "speed,mu\n0,.5\n.1,.45\n1.5,.3\n",
    "German thousands": "speed [mm/s];mu\n0,0;0,5\n100,0;0,45\n1.500,0;0,3\n",
    "French thousands": "speed [mm/s];mu\n0;0,5\n100;0,45\n1\u202f500,0;0,3\n",
    "Swiss thousands": "speed [mm/s];mu\n0;0.5\n100;0.45\n1'500;0.3\n",
    "English thousands": 'speed [mm/s],mu\n0,0.5\n100,0.45\n"1,500.0",0.3\n',
    "Indian thousands": 'speed [µm/s],mu\n0,0.5\n"1,00,000",0.45\n"15,00,000",0.3\n',
    "Fortran exponents": "speed mu\n0.0D+00 0.50D+00\n0.1D+00 0.45D+00\n1.5D+00 0.30D+00\n",
    "exponents of papers": "speed;mu\n0;5×10^-1\n1·10⁻¹;0.45\n1.5;0.3\n",
    "units in cells": "speed;mu\n0 m/s;50 %\n100 mm/s;45 %\n5.4 km/h;30 %\n",
    "single quotes": "'speed';'mu'\n'0';'0.5'\n'0.1';'0.45'\n'1.5';'0.3'\n",
    "Excel's quoted numbers": '"speed","mu"\n="0",="0.5"\n="0.1",="0.45"\n="1.5",="0.3"\n',
    "units between blanks": "speed (m/s)   mu (-)\n0.0   0.5\n0.1   0.45\n1.5   0.3\n",
    "a unit and a word": "speed [km/h] filtered,mu\n0,0.5\n0.36,0.45\n5.4,0.3\n",
    "a tight slash": "speed/mm/s,mu/%\n0,50\n100,45\n1500,30\n",
    "a unit as last word": "speed_kmh,mu\n0,0.5\n0.36,0.45\n5.4,0.3\n",
    "a unit of two words": "speed_mm_s,mu\n0,0.5\n100,0.45\n1500,0.3\n",
    "a unit in capitals": "speed [KM/H],mu\n0,0.5\n0.36,0.45\n5.4,0.3\n",
    "a line break in a name": '"speed\n[mm/s]","mu"\n0,0.5\n100,0.45\n1500,0.3\n',
    "units row beside dates": "t;speed;coefficient\nd;mm/s;-\n1;0;0,5\n2;100;0,45\n3;1500;0,3\n",
    "names first": "sample,speed,coefficient\nA,0,0.5\nA,0.1,0.45\nB,1.5,0.3\n",
    "dates first": "t,speed,coefficient\n2024-03-01,0,0.5\n2024-03-02,.1,.45\n2024-03-03,1.5,.3\n",
    "numbers before the header": "rig,7\nspeed,2 m/s\n2024,3\nspeed,mu\n0,0.5\n0.1,0.45\n1.5,0.3\n",
    "the header again": "speed;mu\nmm/s;-\n0;0,5\nspeed;mu\nmm/s;-\n100;0,45\n1500;0,3\n",
    "remarks behind numbers": "speed,mu\n0,0.5 # at rest, new\n0.1,0.45 ; warm\n1.5,0.3\n",
    "MATLAB's names": "speed_km_h_,mu___\n0,0.5\n0.36,0.45\n5.4,0.3\n",
    "numpy's header": "# speed mu\n0 0.5\n0.1 0.45\n1.5 0.3\n",
    "gnuplot's header": "# rig 4\n# speed mu\n# km/h %\n0 50\n0.36 45\n5.4 30\n",
    "wide signs of East Asia": "speed（km/h），μ\n０，0.5\n0.36，0.45\n5.4，0.3\n",
    "signs of no width": "\ufeff\ufeffspeed\u200b,mu\n0,0.5\n0.1,0.45\n1.5,0.3\n\x1a",
    "Russian units": "speed, км/ч;коэффициент\n0;0,5\n0,36;0,45\n5,4;0,3\n",
    "Norwegian units": "speed [km/t];friksjon\n0;0,5\n0,36;0,45\n5,4;0,3\n",
    "a dash for a minus": "speed;mu\n0;50e–2\n0,1;45e–2\n1,5;30e–2\n",
    "Markdown": "| speed | mu |\n|---|---|\n| 0 | 0.5 |\n| 0.1 | 0.45 |\n| 1.5 | 0.3 |\n",
    "LaTeX": "speed & mu \\\\\n\\midrule\n0 & 0.5 \\\\\n0.1 & 0.45 \\\\\n1.5 & 0.3 \\\\\n",
}
CHOSEN = {
    "columns by name": (
        "t;v (km/h);T;µ [%]\n0;0;20;50\n1;0,36;21;45\n2;5,4;22;30\n",
        ("v", "µ"),
    ),
    "whole headers": ("v (km/h);µ [%]\n0;50\n0,36;45\n5,4;30\n", ("v (km/h)", "µ [%]")),
}
ENCODINGS = ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252")

REFUSED = {
    "a row longer than its header": (
        "speed,mu\n0,0,45\n0,1,0,4\n",
        "row 2 has 3 cells under 2 names: 0, 0, 45; with decimal commas separate the columns",
        "speed;mu\n0;0,45\n0,1;0,4\n",
    ),
    "thousands by comma": (
        "speed in mm/s;mu\n0;1\n1,500;0\n",
        "row 3: the comma of '1,500' may separate thousands; write 1.500 or 1500",
        "speed in mm/s;mu\n0;1\n1500;0\n",
    ),
    "thousands by point": (
        "speed in mm/s;mu\n0;0,5\n1.500;0,3\n",
        "has a comma and '1.500' in row 3 a point; write one decimal sign throughout",
        "speed in mm/s;mu\n0;0,5\n1500;0,3\n",
    ),
    "whole numbers with points": (
        "speed in mm/s;mu\n0;1\n1.500;0\n",
        "row 3: the point of '1.500' may separate thousands; write 1.5000 or 1500",
        "speed in mm/s;mu\n0;1\n1500;0\n",
    ),
    "rows longer by a remark": (
        "speed,coefficient\n0,0.5,new\n1,0.3,worn\n",
        "else give every column a name",
        "speed,coefficient,remark\n0,0.5,new\n1,0.3,worn\n",
    ),
    "a second table": (
        "speed,mu\n0,0.5\n1,0.3\nspeed,wear\n0,1\n1,2\n",
        "row 4 is the header of a second table; save each as a file of its own",
        "speed,mu\n0,0.5\n1,0.3\n",
    ),
    "an unknown unit in a row": (
        "speed,mu\nrev-ish,-\n0,0.5\n1,0.3\n",
        "row 2: 'rev-ish' is no number, nor a unit that is known; write a number there, or a unit",
        "speed,mu\nkm/h,-\n0,0.5\n1,0.3\n",
    ),
    "brackets without a unit": (
        "speed,mu (dynamic)\n0,0.5\n1,0.3\n",
        "in % is needed, like 30 %; or take it out of the name, if it is no unit",
        "speed,mu dynamic\n0,0.5\n1,0.3\n",
    ),
    "a rate of rotation": (
        "speed [U/min],mu\n0,0.5\n100,0.3\n",
        "that is a rate of rotation, a speed only when multiplied by the radius",
        "speed,mu\n0,0.5\n1.57,0.3\n",
    ),
    "an error of Excel": (
        "speed;mu\n0;0,5\n#NV;0,4\n1;0,3\n",
        "row 3: '#NV' is no number; write a number there, or take the row out",
        "speed;mu\n0;0,5\n1;0,3\n",
    ),
    "no text": (
        "\0\1\2",
        "is no text file; save the table as CSV in UTF-8, or as .xlsx",
        "speed;mu\n0;0,5\n",
    ),
    "a first speed above 0": (
        "speed,mu\n0.1,0.5\n1,0.3\n",
        (
            "row 2: the first speed is 0.1; add a row at speed 0, whose value is the static "
            "coefficient"
        ),
        "speed,mu\n0,0.5\n0.1,0.5\n1,0.3\n",
    ),
    "a coefficient above 2": (
        "speed,mu\n0,50\n1,30\n",
        "row 2: a coefficient of 50.0 is above 2; if it is in per cent, write [%] behind",
        "speed,mu [%]\n0,50\n1,30\n",
    ),
    "speeds that do not ascend": (
        "speed,mu\n0,0.5\n1,0.3\n0.5,0.4\n",
        "row 4: speed 0.5 after 1.0; sort the rows so that it ascends",
        "speed,mu\n0,0.5\n0.5,0.4\n1,0.3\n",
    ),
    "a speed twice": (
        "speed,mu\n0,0.5\n0,0.3\n",
        "one row for each value",
        "speed,mu\n0,0.5\n",
    ),
    "an unknown column": (
        "v,T,mu\n0,1,0.5\n1,1,0.3\n",
        (
            "has no column 'speed'; its columns: v, T, mu; name one of them 'speed', or write "
            "speed_column: with its name"
        ),
        "speed,T,coefficient\n0,1,0.5\n1,1,0.3\n",
    ),
    "a unit of another kind": (
        "speed (mm),mu\n0,0.5\n1,0.3\n",
        "column 'speed (mm)' in 'mm': that is a length; a speed is needed, like 7.2 km/h",
        "speed (mm/s),mu\n0,0.5\n1,0.3\n",
    ),
    "an empty cell": (
        "speed;mu\n0;0,5\n1;\n",
        "row 3: an empty cell; write a number there, or take the row out",
        "speed;mu\n0;0,5\n",
    ),
    "a word": (
        "speed;mu\n0;0,5\n1;n/a\n",
        "row 3: 'n/a' is no number",
        "speed;mu\n0;0,5\n1;0,3\n",
    ),
    "a negative coefficient": (
        "speed;mu\n0;0,5\n1;-0,3\n",
        "row 3: coefficient = -0.3; finite numbers from 0 on are needed; take the row out, or",
        "speed;mu\n0;0,5\n1;0,3\n",
    ),
    "no header": (
        "0;0,5\n1;0,3\n",
        "has no header; write a first row like speed;coefficient",
        "speed;coefficient\n0;0,5\n1;0,3\n",
    ),
    "a unit in a comment alone": (
        "# units: km/h, -\nspeed,mu\n0,0.5\n3.6,0.3\n",
        "row 1 speaks of km/h, and column 'speed' has no unit; write it behind the name, like",
        "# units: km/h, -\nspeed [km/h],mu\n0,0.5\n3.6,0.3\n",
    ),
    "a unit above the header alone": (
        "Dimension;mm/s\nspeed;mu\n0;0,5\n100;0,3\n",
        "row 1 speaks of mm/s, and column 'speed' has no unit",
        "Dimension;mm/s\nspeed [mm/s];mu\n0;0,5\n100;0,3\n",
    ),
    "an unknown unit behind a comma": (
        "speed, km/hr-ish;mu\n0;0,5\n1;0,3\n",
        "unknown unit 'km/hr-ish'; a speed is needed, like 7.2 km/h; or take it out of the name",
        "speed;mu\n0;0,5\n1;0,3\n",
    ),
    "a word below a name, beside a unit": (
        "speed;mu\nkm/h;mean\n0;0,5\n3,6;0,3\n",
        (
            "row 2: 'mean' is no number, nor a unit that is known; write a number there, or a unit "
            "of coefficient, or - for none"
        ),
        "speed;mu\nkm/h;-\n0;0,5\n3,6;0,3\n",
    ),
    "a table on its side": (
        "speed;0;0,5;1\nmu;0,5;0,4;0,3\n",
        "the names stand in its first column: turn it, so that each name stands above its numbers",
        "speed;mu\n0;0,5\n0,5;0,4\n1;0,3\n",
    ),
    "an unknown separator": (
        "speed^mu\n0^0.5\n1^0.3\n",
        "only 'speed^mu'; separate the cells of a row with ; or a tab",
        "speed;mu\n0;0.5\n1;0.3\n",
    ),
    "no rows": ("speed;mu\n", "has no rows below its header", "speed;mu\n0;0,5\n"),
}
"""What is wrong → the file, what is said, and the file after the remedy was followed."""


@pytest.mark.parametrize("name", READ)
def test_tables_of_many_programs_are_read(name, tmp_path):
    path = tmp_path / "friction.csv"
    path.write_bytes(READ[name].encode())
    assert read_pairs(path, friction_rules.columns) == SI


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_encodings_of_windows_and_instruments(encoding, tmp_path):
    path = tmp_path / "friction.txt"
    path.write_bytes(READ["German Excel"].encode(encoding))
    assert read_pairs(path, friction_rules.columns) == SI
    assert Parameters(friction_law=str(path)).static_mu == 0.5


@pytest.mark.parametrize("name", CHOSEN)
def test_further_columns_are_chosen_by_name(name, tmp_path):
    text, chosen = CHOSEN[name]
    path = tmp_path / "friction.csv"
    path.write_text(text, encoding="utf-8")
    assert read_pairs(path, friction_rules.columns, chosen) == SI


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_known_is_refused_and_the_remedy_works(name, tmp_path):
    text, says, mended = REFUSED[name]
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=rf"bad\.csv.*{re.escape(says)}"):
        read_pairs(path, friction_rules.columns)
    path.write_text(mended, encoding="utf-8")
    assert read_pairs(path, friction_rules.columns)


def test_sheets_of_excel(tmp_path):
    openpyxl = pytest.importorskip("openpyxl", reason="of the extra export")
    book = openpyxl.Workbook()
    heads = (["rig 4"], ["speed", "T", "mu"], ["km/h", "K", "%"])
    for row in (*heads, [0, 1, 50], [0.36, 2, 45], [5.4, 3, 30]):
        book.active.append(row)
    path = tmp_path / "friction.xlsx"
    book.save(path)
    assert read_pairs(path, friction_rules.columns, (None, "mu")) == SI
    book.create_sheet("notes")["A1"] = "of the rig"
    book.save(path)
    assert read_pairs(path, friction_rules.columns, (None, "mu")) == SI
    book.create_sheet("more")["A1"] = "speed"
    book.save(path)
    with pytest.raises(ValueError, match=r": Sheet, notes, more; save the one"):
        read_pairs(path, friction_rules.columns, (None, "mu"))
    path.write_text("speed,mu")
    with pytest.raises(ValueError, match=r"friction\.xlsx is no Excel file"):
        read_pairs(path, friction_rules.columns)


def test_excel_shows_per_cent_and_stores_no_value_of_a_new_formula(tmp_path):
    openpyxl = pytest.importorskip("openpyxl", reason="of the extra export")
    book = openpyxl.Workbook()
    for row in (["speed", "friction [%]"], [0, 0.5], [0.1, 0.45], [1.5, 0.3]):
        book.active.append(row)
    for cell in book.active["B"]:
        cell.number_format = "0%"
    path = tmp_path / "friction.xlsx"
    book.save(path)
    assert read_pairs(path, friction_rules.columns) == SI
    book.active["A3"] = "=1/10"
    book.save(path)
    with pytest.raises(ValueError, match=r"row 3: the formula in A3 has no stored"):
        read_pairs(path, friction_rules.columns)


def test_excel_is_read_as_people_see_it(tmp_path):
    openpyxl = pytest.importorskip("openpyxl", reason="of the extra export")
    book = openpyxl.Workbook()
    sheet = book.active
    for row in (["compression", "force [kN]"], [0, 0], [0.2, 400], [1.2, 12345.6]):
        sheet.append(row)
    for row in sheet.iter_rows(min_row=2):
        row[0].number_format = '0.00" mm";[Red]-0.00\\ "mm"'
        row[1].number_format = "#,##0.0,"  # in thousands
    hidden = book.create_sheet("old")
    hidden.sheet_state = "hidden"
    for row in (["compression", "force"], [0, 0], [1, 1]):
        hidden.append(row)
    path = tmp_path / "contact.xlsx"
    book.save(path)
    assert read_pairs(path, contact_rules.columns) == [
        (0, 0),
        (2e-4, 400),
        (1.2e-3, 12345.6),
    ]
    sheet.row_dimensions[3].hidden = True
    book.save(path)
    with pytest.raises(ValueError, match="row 3 is hidden, by a filter maybe; show it"):
        read_pairs(path, contact_rules.columns)


@pytest.mark.parametrize(
    ("form", "shown"),
    [
        ("General", (0, "")),
        ("0.00E+00", (0, "")),
        ("#,##0.00_);[Red]\\(#,##0.00\\)", (0, "")),
        ("_-* #,##0.00\\ _€_-;-* #,##0.00\\ _€_-", (0, "")),
        ("[$-407]0.00", (0, "")),
        ("0.0 %", (2, "%")),
        ("0.00 [$km/h]", (0, "km/h")),
        ("0.00\\ \\k\\N", (0, "kN")),
        ("0.0,,", (-6, "")),
    ],
)
def test_formats_of_excel(form, shown):
    assert shown_as(form) == shown


def test_a_contact_in_kilonewtons_over_micrometres(tmp_path):
    path = tmp_path / "contact.csv"
    path.write_text(
        "compression [µm];Kraft [kN]\n0;0\n50;0,2\n100;0,9\n", encoding="utf-8"
    )
    assert read_pairs(path, contact_rules.columns) == [
        (0.0, 0.0),
        (5e-5, 200.0),
        (1e-4, 900.0),
    ]


def test_a_configuration_names_columns_and_the_file_at_fault(tmp_path):
    (tmp_path / "rig.csv").write_text(CHOSEN["columns by name"][0], encoding="utf-8")
    study = tmp_path / "pad.yaml"
    law = "{table: rig.csv, speed_column: v, value_column: µ}"
    study.write_text(f"parameters:\n  friction_law: {law}\n", encoding="utf-8")
    assert (
        read_study(study).parameters.friction_law == "linear 0.0:0.5 0.1:0.45 1.5:0.3"
    )
    study.write_text(
        "parameters:\n  friction_law: {table: rig.csv}\n", encoding="utf-8"
    )
    with pytest.raises(
        ConfigError, match=r"rig\.csv has no column 'speed'; .*speed_column:"
    ):
        read_study(study)
