"""Angles, numbers, ranges and sweeps as people write them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealpipe.inputs import parse_angle
from squealpipe.ranges import (
    longest,
    parse_range,
    read_fixed,
    read_values,
    sweep_config,
)

FORMS = {
    "0.4pi": 0.4,
    "2pi/5": 0.4,
    "72deg": 0.4,
    "1.25": 1.25 / math.pi,
    "1.25rad": 1.25 / math.pi,
    "pi": 1.0,
    "-pi/2": -0.5,
    "-0.5pi": -0.5,
    "5*pi/6": 5 / 6,
    "0.83π": 0.83,
    "90°": 0.5,
    " 1e-3 ": 1e-3 / math.pi,
    "0": 0.0,
}


@pytest.mark.parametrize("text", FORMS)
def test_angle_forms(text):
    assert parse_angle(text) == pytest.approx(FORMS[text] * math.pi, rel=1e-15)


@pytest.mark.parametrize(
    "text", ["", "abc", "pi/0", "1,2", "0.4pie", "nan", "inf", "1e999", "4 5"]
)
def test_what_is_no_angle_is_refused_with_the_forms(text):
    with pytest.raises(ValueError, match=r"write 0\.4pi, 2pi/5, 72deg or radians"):
        parse_angle(text)


@given(st.floats(-10.0, 10.0))
def test_radians_are_read_exactly_up_to_a_full_turn(value):
    for text in (repr(value), f"{value!r}rad"):
        if abs(value) > 6.2832:
            with pytest.raises(ValueError, match="more than a full turn"):
                parse_angle(text)
        elif abs(value) < 6.2831:
            assert parse_angle(text) == value


def test_ranges_and_lists():
    values = parse_range("0:pi:31", parse_angle)
    assert (values[0], values[-1], len(values)) == (0.0, math.pi, 31)
    assert values[10] == pytest.approx(math.pi / 3)
    assert parse_range("0.1:100:4:log") == pytest.approx([0.1, 1, 10, 100])
    assert parse_range("-1:-100:3:log") == pytest.approx([-1, -10, -100])
    assert parse_range("0.1,0.2,4") == [0.1, 0.2, 4.0]
    assert longest({"mu": [1], "k3": [1, 2], "alpha1": [0, 1]}) == "k3"


@pytest.mark.parametrize(
    ("read", "name", "given_", "value"),
    [
        (read_values, "mu", "0:0.6:3", [0.0, 0.3, 0.6]),
        (read_values, "mu", 1, [1.0]),
        (read_values, "mu", (0, 0.5, "0.6"), [0.0, 0.5, 0.6]),
        (read_values, "belt_speed", "1:100:3:log", [1.0, 10.0, 100.0]),
        (read_values, "alpha1", "0:pi:3", [0.0, math.pi / 2, math.pi]),
        (read_values, "alpha1", ["0.5pi", 2], [math.pi / 2, 2.0]),
        (read_values, "mode", "1,2", [1, 2]),
        (read_values, "mode", [1.0, 2], [1, 2]),
        (read_fixed, "alpha1", "0.3pi", 0.3 * math.pi),
        (read_fixed, "alpha2", 1, 1.0),
        (read_fixed, "k3", "1", 1.0),
        (read_fixed, "mode", "1", 1),
        (read_fixed, "t_end", 100.0, 100),
        (read_fixed, "tol", "1e-9", 1e-9),
        (read_fixed, "method", "hbm", "hbm"),
        (read_fixed, "times", "0:1:3", [0.0, 0.5, 1.0]),
        (read_fixed, "times", (0, 0.5), [0.0, 0.5]),
        (read_fixed, "sigma", None, None),
    ],
)
def test_values_may_be_text_numbers_or_lists_and_keep_their_kind(
    read, name, given_, value
):
    found = read(name, given_)
    assert found == (
        pytest.approx(value, rel=1e-15) if isinstance(value, list) else value
    )
    assert type(found) is type(value)
    if isinstance(value, list):
        assert list(map(type, found)) == list(map(type, value))


@pytest.mark.parametrize(
    ("name", "given_", "part"),
    [
        ("mu", "0.3pi", "a number without a unit"),
        ("mu", True, "'True' is not a number"),
        ("mu", None, "not a number"),
        ("mu", [math.inf], "not a number"),
        ("mu", [[1]], "not a number"),
        ("alpha1", "north", "write 0.4pi"),
        ("mode", "1:2:3", "1.5 is not a whole number"),
    ],
)
def test_what_is_no_value_is_refused(name, given_, part):
    with pytest.raises(ValueError, match=part):
        read_values(name, given_)


def test_a_sweep_has_one_form_and_no_parameter_stands_twice_in_it():
    def form(**changes):
        numbers = {"mu": 0.3, "k3": 0.75, "mass": 1.0}
        return sweep_config(**{**plan, "parameters": numbers, **changes})

    plan = {"task": "stability_map", "vary": {"mu": [0.1, 0.2]}}
    plan |= {"fixed": {"alpha1": 1.0, "alpha2": 2.0, "k3": 0.5}}
    assert form() == {**plan, "parameters": {"mass": 1.0}}
    assert form(parameters={"mu": 0.9, "k3": 2.0, "mass": 1.0}) == form()
    with pytest.raises(ValueError, match="mu is both fixed and varied"):
        form(fixed={"mu": 0.1})


@pytest.mark.parametrize(
    ("task", "name", "text"),
    [
        ("own.py:oscillator", "k1", "7 kN/mm"),
        ("own.py:oscillator", "x0", "1mm,2mm"),
        ("pad.yaml:complex_modes", "preload", "1mm,2mm"),
    ],
)
def test_names_of_a_system_are_not_those_of_the_brake(task, name, text):
    """k1 of a system is not in N/m, and a preload of modes is a factor."""
    with pytest.raises(ValueError, match="no unit is declared"):
        read_values(name, text, task)


def test_what_systems_and_structures_share_has_units():
    assert read_values("alpha1", "400", "own.py:oscillator") == [400.0]
    assert read_values("t_end", "20 ms", "own.py:oscillator") == [0.02]
    assert read_values("mu", "10%,20%", "pad.yaml:complex_modes") == [0.1, 0.2]
    assert read_fixed("times", ["1 ms", 0.002]) == [1e-3, 2e-3]
