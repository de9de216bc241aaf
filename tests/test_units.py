"""Numbers with a unit: exact, of the right kind, or refused with what to write."""

import math
import re
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealpipe import Contact, Structure, simulate
from squealpipe.parameters import UNITS_OF_INPUTS, Parameters
from squealpipe.ranges import parse_range, read_fixed, read_values
from squealpipe.structures import elastic_pad
from squealpipe.units import (
    UnitError,
    conversion,
    has_unit,
    in_si,
    plain_unit,
    with_unit,
)

ROUNDED_ONCE = {
    ("0.57 mm", "m"): 5.7e-4,
    ("7.2 km/h", "m s-1"): 2.0,
    ("7.2kmh", "m s-1"): 2.0,
    ("-7.2 km/h", "m s-1"): -2.0,
    ("−7.2 km/h", "m s-1"): -2.0,
    ("7 kN/mm", "N m-1"): 7e6,
    ("7e3 N/mm", "N m-1"): 7e6,
    ("40 lbf/in", "N m-1"): 40 * 4.4482216152605 / 0.0254,
    ("42 N s/m", "N s m-1"): 42.0,
    ("42 N·s/m", "N s m-1"): 42.0,
    ("42 Ns/m", "N s m-1"): 42.0,
    ("42 kg/s", "N s m-1"): 42.0,
    ("0.042 N s mm-1", "N s m-1"): 42.0,
    ("450 g", "kg"): 0.45,
    ("10 bar", "Pa"): 1e6,
    ("1 N/mm²", "Pa"): 1e6,
    ("40 cm^2", "m2"): 4e-3,
    ("40 cm2", "m2"): 4e-3,
    ("3 kp", "N"): 3 * 9.80665,
    ("30 %", "1"): 0.3,
    (".5 µm", "m"): 5e-7,
    ("12 1/mm", "m-1"): 12e3,
    ("20ms", "s"): 0.02,
    ("981 cm/s²", "m s-2"): 9.81,
}


@pytest.mark.parametrize(("text", "units"), ROUNDED_ONCE)
def test_a_text_is_the_number_that_it_says(text, units):
    assert in_si(text, units) == ROUNDED_ONCE[text, units]


@pytest.mark.parametrize("text", ["1e6", "1E6", "-2e-3", "3"])
def test_a_number_has_no_unit(text):
    assert not has_unit(text)


@given(st.integers(1, 10**9), st.integers(-12, 3))
def test_a_unit_does_not_change_the_double(digits, power):
    """What is written in mm is the double of the same decimal in m, so that ids agree."""
    assert in_si(f"{digits}e{power} mm", "m") == float(f"{digits}e{power - 3}")


REFUSED = {
    (
        "4 kN",
        "m",
    ): "that is a force; a length is needed, like 0.57 mm; a force goes to preload_force",
    ("3 furlong/s", "m"): "that is a speed; a length is needed",
    ("3 K", "m"): "kelvin does not fit; a length is needed",
    ("30 deg", "1"): "that is an angle; a number without a unit, or in %",
    ("30", "m"): "a length is needed, like 0.57 mm",
    ("3 smoot/", "m"): "unknown unit 'smoot/'; a length is needed",
    ("3 __import__('os')", "m"): "a length is needed",
    ("0,57 mm", "m"): "write a decimal point: 0.57 mm",
    ("1,500 N", "N"): "write 1.500 N or 1500 N",
    ("1.500,5 N", "N"): "a force is needed, like 4 kN",
    (
        "4 kN",
        "s m-1",
    ): "that is a force; a value in s/m is needed, like 1 s/m; a force goes to",
}


@pytest.mark.parametrize(("text", "units"), REFUSED)
def test_another_kind_or_an_ambiguous_number_is_refused_with_the_remedy(text, units):
    with pytest.raises(UnitError) as caught:
        in_si(text, units, UNITS_OF_INPUTS)
    assert REFUSED[text, units] in str(caught.value)


def test_parameters_take_texts_and_quantities_of_pint():
    import pint

    length = pint.UnitRegistry().Quantity(0.57, "mm")
    written = Parameters(preload=length, belt_speed="7.2 km/h", mu="45 %")
    assert written == Parameters(preload=5.7e-4, belt_speed=2.0, mu=0.45)
    assert written.with_(k3="7 kN/mm").k3 == 7e6
    with pytest.raises(
        ValueError, match=r"preload = '4 kN': that is a force; .* preload_force"
    ):
        Parameters(preload="4 kN")
    with pytest.raises(
        ValueError, match=r"preload = '0\.57': a finite number is needed"
    ):
        Parameters(preload="0.57")


def test_sweeps_take_units_and_no_decimal_comma_slips_through():
    assert read_values("belt_speed", "3.6km/h:7.2km/h:2") == [1.0, 2.0]
    assert read_values("preload", ["1 mm", 0.002]) == [1e-3, 2e-3]
    assert read_fixed("t_end", "20 ms") == 0.02
    for text in ("0,57 mm", "1:10 km/h:3"):
        with pytest.raises(ValueError, match="unit"):
            read_values("belt_speed", text)
    with pytest.raises(ValueError, match="a time is needed"):
        read_fixed("t_end", "20 mm")
    assert parse_range("0,0.5") == [0.0, 0.5]


def test_plain_numbers_do_not_wait_for_pint():
    code = (
        "import sys; import squealpipe; from squealpipe.parameters import Parameters\n"
        "import squealpipe.study.configuration.settings as s; s.read_study(s.PAPER)\n"
        "Parameters(mu=0.2); assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_values_are_shown_as_people_write_them():
    shown = {
        (4000.0, "N"): "4 kN",
        (5.714e-4, "m"): "0.5714 mm",
        (3e-6, "m"): "3 µm",
        (7e6, "N m-1"): "7 kN/mm",
        (42.43, "N s m-1"): "42.43 N s/m",
        (1e6, "Pa"): "1 MPa",
        (0.3, "1"): "0.3",
    }
    assert {key: with_unit(*key) for key in shown} == shown
    assert [plain_unit(units) for units in ("rad s-1", "m2", "s-1", "N m-1")] == [
        "rad/s",
        "m²",
        "1/s",
        "N/m",
    ]


@pytest.mark.parametrize(
    ("unit", "other", "factor"),
    [
        ("Hz", "rad/s", math.tau),
        ("Hz", "rpm", 60.0),
        ("rad/s", "rpm", 30.0 / math.pi),
        ("rpm", "kHz", 1.0 / 60e3),
        ("1/s", "1/ms", 1e-3),
        ("m", "mm", 1e3),
    ],
)
def test_turns_are_counted_once(unit, other, factor):
    assert conversion(unit, other) == pytest.approx(factor)
    assert conversion(other, unit) == pytest.approx(1.0 / factor)


@pytest.mark.parametrize("frequency", ["Hz", "kHz", "rad/s", "rpm"])
def test_a_growth_rate_is_no_frequency(frequency):
    assert conversion("1/s", frequency) is None
    assert conversion(frequency, "1/s") is None


PAD = Parameters(k1=1e7, k2=1e7, k3=7e6, mass=0.45, preload=5e-4, length1=0.02)


def test_functions_take_units():
    in_words = simulate(
        PAD,
        "22 deg",
        "0.4pi",
        t_end="0.4 ms",
        tol="1e-8 %",
        initial_state=["0.1 mm", 0, 0, "3.6 km/h"],
    )
    in_si = simulate(
        PAD,
        math.radians(22.0),
        0.4 * math.pi,
        t_end=4e-4,
        tol=1e-10,
        initial_state=[1e-4, 0.0, 0.0, 1.0],
    )
    assert in_words.identical(in_si)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"t_end": "2 mm"}, "t_end = '2 mm': that is a length; a time is needed, like"),
        ({"t_end": "2,5 ms"}, "t_end = '2,5 ms': write a decimal point: 2.5 ms"),
        ({"alpha1": "0,4"}, "alpha1 = '0,4': write a decimal point: 0.4"),
        ({"initial_state": [0, "0,1", 0, 0]}, "write a decimal point: 0.1"),
        ({"t_end": "long"}, "t_end = 'long': numbers are needed, not text"),
        ({"alpha1": "22 mm"}, "that is a length; an angle is needed, like 22 deg"),
        ({"times": ["1 ms", "2 mm"]}, "a length goes to preload or length1 or length2"),
        ({"initial_state": ["1 s", 0, 0, 0]}, "that is a time; a length is needed"),
    ],
)
def test_functions_name_a_quantity_of_another_kind(asked, says):
    arguments = {"alpha1": 0.4, "alpha2": 0.8, "t_end": 1e-3} | asked
    with pytest.raises(ValueError, match=re.escape(says)):
        simulate(PAD, **arguments)


def test_structures_take_units():
    contact = Contact("pad", {0: 1.0}, {1: 1.0}, "7 kN/mm", "0.2 kN")
    assert (contact.stiffness, contact.preload) == (7e6, 200.0)
    pad = Structure(
        np.eye(2),
        1e6 * np.eye(2),
        contacts=[contact],
        belt_speed="7.2 km/h",
        mu="30 %",
        modal_damping="1 %",
    )
    assert (pad.belt_speed, pad.mu, pad.modal_damping) == (2.0, 0.3, 0.01)
    assert pad.complex_modes(frequency_max="1 kHz").identical(
        pad.complex_modes(frequency_max=1000.0)
    )
    with pytest.raises(ValueError, match="preload = '1 mm': that is a length; a force"):
        Contact("pad", {0: 1.0}, {1: 1.0}, 1.0, "1 mm")
    one = elastic_pad(contacts=2, preload="0.8 kN", young="8 GPa", length="60 mm")
    assert [contact.preload for contact in one.contacts] == [400.0, 400.0]
    with pytest.raises(ValueError, match="that is a length; a force is needed"):
        elastic_pad(preload="0.5 mm")
    # of the pad's mass and preload it is a factor
    for factor in ({"mass": "2 kg"}, {"preload": "2 mm"}):
        with pytest.raises(ValueError, match=next(iter(factor))):
            one.complex_modes(n_modes=4, **factor)


@pytest.mark.parametrize(
    ("text", "hertz"), [("2 kHz", 2000.0), ("50 Hz", 50.0), ("0.1 MHz", 1e5)]
)
def test_frequencies(text, hertz):
    assert in_si(text, "Hz") == hertz


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("300 rad/s", "that is a rate of rotation, in rad/s 2π times a frequency"),
        ("3 1/s", "does not fit; a frequency is needed, like 2 kHz"),
        ("3 mm", "that is a length; a frequency is needed"),
    ],
)
def test_what_is_no_frequency(text, says):
    with pytest.raises(UnitError, match=says):
        in_si(text, "Hz")
