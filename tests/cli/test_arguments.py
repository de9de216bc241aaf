"""Angles, numbers and ranges as people type them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealpipe.cli.arguments import parse_angle, parse_number, parse_range


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("0.4pi", 0.4 * math.pi),
        ("2pi/5", 2 * math.pi / 5),
        ("72deg", 2 * math.pi / 5),
        ("1.25", 1.25),
        ("1.25rad", 1.25),
        ("pi", math.pi),
        ("-pi/2", -math.pi / 2),
        ("-0.5pi", -math.pi / 2),
        ("5*pi/6", 5 * math.pi / 6),
        ("0.83π", 0.83 * math.pi),
        ("90°", math.pi / 2),
        (" 1e-3 ", 1e-3),
        ("0", 0.0),
    ],
)
def test_angle_forms(text, angle):
    assert parse_angle(text) == pytest.approx(angle, rel=1e-15)


@pytest.mark.parametrize("text", ["", "abc", "pi/0", "1,2", "0.4pie", "nan", "inf", "1e999", "4 5"])
def test_what_is_no_angle_is_refused_with_the_forms(text):
    with pytest.raises(ValueError, match=r"write 0\.4pi, 2pi/5, 72deg or radians"):
        parse_angle(text)


@given(st.floats(-1e6, 1e6))
def test_radians_are_read_exactly(value):
    assert parse_angle(repr(value)) == value


@pytest.mark.parametrize("text", ["", "x", "nan", "inf"])
def test_what_is_no_number_is_refused(text):
    with pytest.raises(ValueError, match="is no number"):
        parse_number(text)


def test_linear_range_has_both_ends():
    values = parse_range("0:pi:31", parse_angle)
    assert (values[0], values[-1], len(values)) == (0.0, math.pi, 31)
    assert values[10] == pytest.approx(math.pi / 3)


def test_log_range_has_constant_ratio():
    values = parse_range("0.1:100:4:log")
    assert values == pytest.approx([0.1, 1, 10, 100])
    assert parse_range("-1:-100:3:log") == pytest.approx([-1, -10, -100])


def test_list():
    assert parse_range("0.1,0.2,4") == [0.1, 0.2, 4.0]


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("0:1", "no range"),
        ("0:1:2:cube", "no range"),
        ("0:1:x", "no range"),
        ("0:1:1", "ask for 2 or more"),
        ("0:1:3:log", "neither 0"),
        ("1,,2", "no number"),
    ],
)
def test_bad_ranges_name_the_form(text, part):
    with pytest.raises(ValueError, match=part):
        parse_range(text)
