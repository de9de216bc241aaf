"""Quantities and tables as people write them every day: right, or refused by name."""

# ruff: noqa: E501 (tables as people write them)

import datetime
import math

import openpyxl
import pytest

from squealpipe.inputs import parse_angle, parse_number
from squealpipe.laws.contact_laws import own_law_rules as contact_rules
from squealpipe.laws.friction_laws import own_law_rules as friction_rules
from squealpipe.laws.table_files import read_pairs
from squealpipe.units import UnitError, in_si

# fmt: off
QUANTITIES = {
    ('450g', 'kg'): 0.45,
    ('450 grams', 'kg'): 0.45,
    ('0.45 Kg', 'kg'): None,
    ('1 lb', 'kg'): 0.45359237,
    ('16 oz', 'kg'): 0.45359237,
    ('2 kilos', 'kg'): None,
    ('1e-3 t', 'kg'): 1,
    ('1 Mg', 'kg'): 1000,
    ('1 mg', 'kg'): 1e-06,
    ('450 gramm', 'kg'): None,
    ('0.45 kilograms', 'kg'): 0.45,
    ('½ kg', 'kg'): None,
    ('5 10 kg', 'kg'): None,
    ('1/2 kg', 'kg'): None,
    ('4.5E-01kg', 'kg'): 0.45,
    ('+0.45 kg', 'kg'): 0.45,
    ('450 G', 'kg'): None,
    ('450 000 mg', 'kg'): None,
    ("450'000 mg", 'kg'): None,
    ('\t0.45 kg ', 'kg'): 0.45,
    ('0.45\u202fkg', 'kg'): 0.45,
    ('0.45 ㎏', 'kg'): None,
    ('４５０ g', 'kg'): None,
    ('0,45 kg', 'kg'): None,
    ('450 gm', 'kg'): None,
    ('1 slug', 'kg'): 14.593902937206366,
    ('4000N', 'N'): 4000,
    ('4 kilonewton', 'N'): 4000,
    ('4 kilo-newton', 'N'): None,
    ('4 k N', 'N'): None,
    ('400 kp', 'N'): 3922.66,
    ('900 lb', 'N'): None,
    ('1 kip', 'N'): 4448.2216152605,
    ('4 kn', 'N'): None,
    ('0.4 t', 'N'): None,
    ('4kN', 'N'): 4000,
    ('4 KN', 'N'): None,
    ('4 dyn', 'N'): 4e-05,
    ('7 kN / mm', 'N m-1'): 7000000.0,
    ('7 N/µm', 'N m-1'): 7000000.0,
    ('7 N/μm', 'N m-1'): 7000000.0,
    ('7 MN/m', 'N m-1'): 7000000.0,
    ('7 kN per mm', 'N m-1'): 7000000.0,
    ('7 kN*mm^-1', 'N m-1'): 7000000.0,
    ('7 kN mm-1', 'N m-1'): 7000000.0,
    ('7 kN·mm⁻¹', 'N m-1'): 7000000.0,
    ('7 kN/mm²', 'N m-1'): None,
    ('40 lbf/in', 'N m-1'): 7005.073409859,
    ('7 kN/millimeter', 'N m-1'): 7000000.0,
    ('1 kgf/mm', 'N m-1'): 9806.65,
    ('570 µm', 'm'): 0.00057,
    ('570 μm', 'm'): 0.00057,
    ('0.57 Mm', 'm'): None,
    ('0.02 in', 'm'): 0.000508,
    ('0.02"', 'm'): None,
    ('2 thou', 'm'): 5.08e-05,
    ('1 mil', 'm'): None,
    ('0.57 millimetres', 'm'): 0.00057,
    ('1 ft 2 in', 'm'): None,
    ('57e-2mm', 'm'): 0.00057,
    ('1_000 mm', 'm'): None,
    ('1 000 mm', 'm'): None,
    ('nan mm', 'm'): None,
    ('inf mm', 'm'): None,
    ('0x10 mm', 'm'): None,
    ('1.0D3 mm', 'm'): None,
    ('1e3 mm', 'm'): 1.0,
    ('5 MM', 'm'): None,
    ('0.57 mm mm', 'm'): None,
    ('0.57', 'm'): None,
    ('', 'm'): None,
    ('mm', 'm'): None,
    ('0.57 mm 3', 'm'): None,
    ('7.2 kph', 'm s-1'): 2,
    ('7.2 km/hr', 'm s-1'): 2,
    ('2 m.s-1', 'm s-1'): 2,
    ('2 m/sec', 'm s-1'): 2,
    ('2 m s^-1', 'm s-1'): 2,
    ('120 m/min', 'm s-1'): 2,
    ('7.2 Km/h', 'm s-1'): None,
    ('7.2 km/H', 'm s-1'): None,
    ('300 rpm', 'm s-1'): None,
    ('2 ms', 'm s-1'): None,
    ('2 m / s', 'm s-1'): 2,
    ('4.4704 mph', 'm s-1'): 1.998447616,
    ('2 m/s²', 'm s-1'): None,
    ('7.2 km h^-1', 'm s-1'): 2,
    ('7.2 kmh', 'm s-1'): 2,
    ('20msec', 's'): 0.02,
    ('0.02 secs', 's'): 0.02,
    ('1 min', 's'): 60,
    ('1:30', 's'): None,
    ('2 hours', 's'): 7200,
    ('20 mS', 's'): None,
    ('20 Ms', 's'): None,
    ('20 µs', 's'): 2e-05,
    ('1 h 30 min', 's'): None,
    ('2 d', 's'): 172800,
    ('1 m', 's'): None,
    ('2 khz', 'Hz'): None,
    ('120 rpm', 'Hz'): None,
    ('2000 1/s', 'Hz'): None,
    ('2 KHz', 'Hz'): None,
    ('2000 cps', 'Hz'): None,
    ('2000Hz', 'Hz'): 2000,
    ('30%', '1'): 0.3,
    ('30 pct', '1'): None,
    ('300 ‰', '1'): 0.3,
    ('3/10', '1'): None,
    ('0,3', '1'): None,
    ('30 percent', '1'): 0.3,
    ('5 mu', '1'): None,
    ('0.3 -', '1'): None,
    ('30 % ', '1'): 0.3,
    ('30 %%', '1'): None,
    ('42 N.s/m', 'N s m-1'): 42,
    ('42 N*s/m', 'N s m-1'): 42,
    ('42 N/m/s', 'N s m-1'): None,
    ('42 N/(m/s)', 'N s m-1'): 42,
    ('42 kg/s', 'N s m-1'): 42,
    ('42 Nsm⁻¹', 'N s m-1'): None,
    ('42 N s m⁻¹', 'N s m-1'): 42,
    ('42 N/m', 'N s m-1'): None,
    ('10 Bar', 'Pa'): None,
    ('1 N/mm2', 'Pa'): 1000000.0,
    ('10 kg/cm2', 'Pa'): None,
    ('10 kgf/cm^2', 'Pa'): 980665,
    ('1 Mpa', 'Pa'): None,
    ('1 MPa', 'Pa'): 1000000.0,
    ('10 hPa', 'Pa'): 1000,
    ('40 cm**2', 'm2'): 0.004,
    ('4000 mm²', 'm2'): 0.004,
    ('40 sqcm', 'm2'): None,
    ('6.2 in^2', 'm2'): 0.003999992,
    ('40 cm x cm', 'm2'): None,
    ('40 cm', 'm2'): None,
    ('40 cm^3', 'm2'): None,
    ('900 lbf', 'N'): 4003.3994537344497,
    ('0.3 N/N', '1'): 0.3,
    ('750 mmHg', 'Pa'): 99991.79056125,
}
"""Text and CF unit → the number in SI; None: refused."""
ANGLES = {
    '22 deg': 22,
    '22°': 22,
    '22º': None,
    '22 degrees': 22,
    '0.4 rad': 22.918311805232932,
    '400 mrad': 22.918311805232932,
    '22 grad': None,
    "22° 30'": None,
    '0.1 turn': 36,
    '22 Grad': None,
    'pi/4': 45,
    'π/4': 45,
    '0.25π': 45,
    '45': None,
    '1/4 pi': None,
    'pi': 180,
    '-pi/2': -90,
    '2*pi/5': 72,
    '22,5 deg': None,
    '22_5 deg': None,
    '1_0': None,
    'nan': None,
    'inf': None,
    '': None,
    '0.25 pi': 45,
    '22deg': 22,
    '22 °': 22,
    '400 deg': None,
    '22 ° ': 22,
    '22d': None,
    '3.14': 179.9087476710785,
    '50 gon': 45,
}
"""Text → degrees."""
NUMBERS = {
    ('0.3', '1'): 0.3,
    ('1_000', None): None,
    ('1,000', None): None,
    ('nan', None): None,
    ('inf', None): None,
    ('1e3', None): 1000,
    ('0x10', None): None,
    ('１０', None): 10,
    ('', None): None,
    (' 5 ', None): 5,
    ('1e400', None): None,
    ('٣', None): 3,
    ('true', None): None,
    ('1.000.000', None): None,
    ('+5', None): 5,
    ('--5', None): None,
    ('5-', None): None,
    ('1e', None): None,
    ('infinity', None): None,
    ('1d3', None): None,
    ('5 %', None): None,
}
FALLING = [(0.0, 0.5), (1.0, 0.4), (10.0, 0.3)]
STIFFENING = [(0.0, 0.0), (1e-4, 100.0), (1e-3, 2500.0)]
FRICTIONS = {
    'speed;mu\n0;0,5\n1;0,4\n10;0,3': FALLING,
    'speed;mu\n0;0,500\n1;0,400\n10;0,300': FALLING,
    'speed,mu\n0,.5\n1,.4\n10,.3\n': FALLING,
    'speed,mu\n0,0,5\n1,0,4\n10,0,3': None,
    'speed mu\n0 0.5\n1 0.4\n10 0.3 0.2': None,
    'speed;mu\n0;0.5\n1;0,4\n10;0.3': None,
    'speed;mu\n0;0.5\n1;n/a\n10;0.3': None,
    'speed;mu\n0;0.5\n1;\n10;0.3': None,
    'speed;mu\n0;0.5\n1;NaN\n10;0.3': None,
    'speed;mu\n0;0.5\n1;inf\n10;0.3': None,
    'speed;mu\n0;0.5\n1;0.4*\n10;0.3': None,
    'speed;mu\n0;0.5\n1;~0.4\n10;0.3': None,
    'speed;mu\n0;0.5\n1;0.4±0.02\n10;0.3': None,
    'speed;mu\n0;0.5\n1;<0.4\n10;0.3': None,
    'speed;mu\n0;0.5\n1;0_4\n10;0.3': None,
    'speed;mu\n0;0.5\n1_0;0.4\n10;0.3': None,
    'speed [m/s];mu\n0;0.5\n1;0.4\n1.0e1;0.3': FALLING,
    'speed [mm/s];mu [%]\n0;50\n1.000;40,0\n10.000;30,0': None,
    'speed [mm/s];mu\n0;0,5\n1.000;0,4\n10.000;0,3': None,
    'speed [mm/s]\tmu\n0\t0.5\n1,000\t0.4\n10,000\t0.3': None,
    'speed [mm/s],mu\n0,0.5\n"1,000",0.4\n"10,000",0.3': None,
    'speed (km/h);mu\n0;0.5\n3.6;0.4\n36;0.3': FALLING,
    'speed [kmph];mu\n0;0.5\n3.6;0.4\n36;0.3': FALLING,
    'speed [KMPH];mu\n0;0.5\n3.6;0.4\n36;0.3': FALLING,
    'speed [rpm];mu\n0;0.5\n3.6;0.4\n36;0.3': None,
    'speed [ms];mu\n0;0.5\n1;0.4\n10;0.3': None,
    'speed [m/S];mu\n0;0.5\n1;0.4\n10;0.3': None,
    'Speed,Mu\n0,0.5\n1,0.4\n10,0.3': FALLING,
    'SPEED,MU\n0,0.5\n1,0.4\n10,0.3': FALLING,
    'v,mu\n0,0.5\n1,0.4\n10,0.3': None,
    '0,0.5\n1,0.4\n10,0.3': None,
    '': None,
    'speed,mu\n': None,
    'speed,mu\n0,0.5\n10,0.3\n1,0.4': None,
    'speed,mu\n0,0.5\n1,0.4\n1,0.4\n10,0.3': None,
    'speed,mu\n-1,0.5\n1,0.4\n10,0.3': None,
    'speed,mu\n0,-0.5\n1,0.4\n10,0.3': None,
    'speed,mu\n0,50\n1,40\n10,30': None,
    'speed,mu [%]\n0,50\n1,40\n10,30': FALLING,
    'speed,mu (pct)\n0,50\n1,40\n10,30': None,
    'speed,mu/percent\n0,50\n1,40\n10,30': FALLING,
    'speed,mu in %\n0,50\n1,40\n10,30': FALLING,
    'speed,mu\n0 m/s,0.5\n1 m/s,0.4\n36 km/h,0.3': FALLING,
    'speed,mu\n0,50 %\n1,40 %\n10,30 %': FALLING,
    'speed,mu\n0,0.5\n1,40 %\n10,0.3': FALLING,
    'speed,mu\n0,1/2\n1,0.4\n10,0.3': None,
    'speed,mu\n0,½\n1,0.4\n10,0.3': None,
    'speed,mu\n0,5e-1\n1,4e-1\n1e1,3e-1': FALLING,
    'speed,mu\n0,5E-01\n1,4E-01\n1E+01,3E-01': FALLING,
    'speed,mu\n0,5.0D-01\n1,4D-1\n1D1,3d-1': FALLING,
    'speed,mu\n٠,٠.٥\n١,٠.٤\n': None,
    'speed;mu\n0;0·5\n1;0·4\n10;0·3': None,
    'speed\tmu\n0\t0.5\n1\t0.4\n10\t0.3\n\n\n': FALLING,
    'speed\tmu\n0\t0.5\n1\t0.4\n10\t0.3\nmean\t0.4': None,
    'speed;mu\n0;0.5\n1;0.4\n#REF!;0.3': None,
}
CONTACTS = {
    'compression [mm];force [kN]\n0;0\n0,1;0,1\n1;2,5': STIFFENING,
    'compression [mm];force [N]\n0;0\n0,1;100\n1;2.500': None,
    'compression [mm];force [N]\n0;0\n0,1;100\n1,0;2.500,0': STIFFENING,
    'compression [µm],force\n0,0\n100,100\n1000,2500': STIFFENING,
    'compression [mm],force [kg]\n0,0\n0.1,100\n1,2500': None,
    'compression [mm],force kg\n0,0\n0.1,100\n1,2500': None,
    'compression [mm],force_kg\n0,0\n0.1,100\n1,2500': None,
    'compression [mm],force [kgf]\n0,0\n0.1,10.197162129779282\n1,254.92905324448205': STIFFENING,
    'compression [mm],force [ton]\n0,0\n0.1,1\n1,2': None,
    'compression [mm],force [t]\n0,0\n0.1,1\n1,2': None,
    'compression [mm],force [tf]\n0,0\n0.1,0.010197162129779282\n1,0.25492905324448205': STIFFENING,
    'compression [mm],force [lb]\n0,0\n0.1,1\n1,2': None,
    'compression [mil],force [N]\n0,0\n0.1,1\n1,2': None,
    'compression [Mm],force [N]\n0,0\n0.1,1\n1,2': None,
    'compression mm,force N\n0,0\n0.1,100\n1,2500': STIFFENING,
    'compression_mm,force_kN\n0,0\n0.1,0.1\n1,2.5': STIFFENING,
    'compression [mm],force [KN]\n0,0\n0.1,0.1\n1,2.5': None,
    'compression [MM],force [N]\n0,0\n0.1,100\n1,2500': None,
    'compression [mm],force [Newton]\n0,0\n0.1,100\n1,2500': STIFFENING,
    'compression,force\nmm,kN\n0,0\n0.1,0.1\n1,2.5': STIFFENING,
    'compression,force\n(mm),(kN)\n0,0\n0.1,0.1\n1,2.5': STIFFENING,
    'compression,force\n# in mm and kN\n0,0\n0.1,0.1\n1,2.5': None,
}
SHEETS = [
    ([['speed', 'mu'], [0, 0.5], [1, 0.4], [10, 0.3]], FALLING),
    ([['speed', 'mu'], ['0', '0.5'], ['1', '0.4'], ['10', '0.3']], FALLING),
    ([['speed', 'mu'], ['0', '0,5'], ['1', '0,4'], ['10', '0,3']], FALLING),
    ([['speed', 'mu'], [0, 0.5], [1, '0,4'], [10, 0.3]], None),
    ([['speed [mm/s]', 'mu'], [0, 0.5], ['1.000', 0.4], ['10.000', 0.3]], None),
    ([['speed [mm/s]', 'mu'], [0, 0.5], ['1,000', 0.4], ['10,000', 0.3]], None),
    ([['speed [mm/s]', 'mu'], [0, 0.5], [1000, 0.4], [10000, 0.3]], FALLING),
    ([['speed', 'mu'], [0, 0.5], [1, True], [10, 0.3]], None),
    ([['speed', 'mu'], [0, 0.5], [datetime.time(1, 0), 0.4], [10, 0.3]], None),
    ([['speed', 'mu'], [0, 0.5], [datetime.datetime(2026, 1, 1, 0, 0), 0.4], [10, 0.3]], None),
    ([['speed', 'mu'], [0, 0.5], [1, None], [10, 0.3]], None),
    ([['speed', 'mu'], [0, 0.5], [1, '4.000'], [10, 0.3]], None),
    ([['speed', 'mu'], [0, "'0.5"], [1, 0.4], [10, 0.3]], None),
    ([['compression [mm]', 'force [N]'], [0, 0], [0.1, 100], [1, '2500 N']], STIFFENING),
    ([['compression [mm]', 'force [N]'], [0, 0], [0.1, 100], [1, '2.5 kN']], STIFFENING),
    ([['compression [mm]', 'force [N]'], [0, 0], [0.1, 100], [1, 1234.567]], [(0, 0), (0.0001, 100), (0.001, 1234.567)]),
    ([['compression [mm]', 'force [N]'], [0, 0], [0.125, 100], [1.125, 1234]], [(0, 0), (0.000125, 100), (0.001125, 1234)]),
]
# fmt: on


def _is(found, expected):
    return math.isclose(found, expected, rel_tol=1e-12)


@pytest.mark.parametrize(("text", "units"), QUANTITIES)
def test_quantities(text, units):
    if (expected := QUANTITIES[text, units]) is None:
        with pytest.raises(UnitError):
            in_si(text, units)
    else:
        assert _is(in_si(text, units), expected)


@pytest.mark.parametrize("text", ANGLES)
def test_angles(text):
    if (expected := ANGLES[text]) is None:
        with pytest.raises(ValueError, match=r"write|full turn"):
            parse_angle(text)
    else:
        assert _is(math.degrees(parse_angle(text)), expected)


@pytest.mark.parametrize(("text", "units"), NUMBERS)
def test_numbers(text, units):
    if (expected := NUMBERS[text, units]) is None:
        with pytest.raises(ValueError, match="is not a number"):
            parse_number(text, units)
    else:
        assert parse_number(text, units) == expected


def _check(path, columns, expected):
    if expected is None:
        with pytest.raises(ValueError, match=path.name):  # it names the file
            read_pairs(path, columns)
        return
    found = read_pairs(path, columns)
    assert len(found) == len(expected)
    for pair, wanted in zip(found, expected, strict=True):
        assert all(map(_is, pair, wanted))


@pytest.mark.parametrize("text", FRICTIONS)
def test_tables_of_friction(text, tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    _check(path, friction_rules.columns, FRICTIONS[text])


@pytest.mark.parametrize("text", CONTACTS)
def test_tables_of_contact(text, tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    _check(path, contact_rules.columns, CONTACTS[text])


@pytest.mark.parametrize(("rows", "expected"), SHEETS)
def test_sheets_of_excel(rows, expected, tmp_path):
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    path = tmp_path / "table.xlsx"
    book.save(path)
    _check(
        path,
        friction_rules.columns
        if rows[0][0].startswith("speed")
        else contact_rules.columns,
        expected,
    )
