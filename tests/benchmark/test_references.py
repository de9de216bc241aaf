"""Two independent ways agree on every reference to 15 digits over the growth."""

import math

import mpmath
import numpy as np
import pytest

from squealpipe.benchmark.problems import all_data, references
from tests.benchmark.make_references import (
    LARGEST_DISAGREEMENT,
    WRITTEN,
    LongDouble,
    derivative,
    disagreement,
    extrapolation,
    many_digits,
    reference_of,
)

DATA = {data["name"]: data for data in all_data() if "unknowable" not in data}
SLOW = {
    "relaxation",
    "long flight",
    "dry friction",
    "stick–slip",
    "bouncing ball",
    "A1: very stiff contact",
    "A1: chaotic hammering",
    "A1: stick release",
    "A1: separation in stick",
    "A1: simultaneous events",
    "A1: hammering",
    "relief valve",
    "chaotic impacts",
    "A1: near-pivot passage",
    "A1: grazing contact",
}


MINUTES = {
    "A1: very stiff contact",
    "A1: chaotic hammering",
    "A1: stick release",
    "A1: hammering",
    "A1: simultaneous events",
    "relaxation",
}
"""Extrapolated only when references are made: none is written on which both ways disagree."""
CASES = [name for name in DATA if name not in MINUTES]
LONG = SLOW - {"dry friction", "stick–slip", "A1: grazing contact"}
"""Computed anew in the long tier: references are written once."""
LONG_EXTRAPOLATIONS = LONG | {"dry friction", "A1: grazing contact"}
"""The release tier checks the last two by long double alone."""


def tier(name, long=LONG):
    """What marks a problem whose reference is computed anew."""
    return pytest.mark.long if name in long else pytest.mark.release


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=tier(n, LONG_EXTRAPOLATIONS)) for n in CASES]
)
def test_extrapolation_agrees(name):
    assert disagreement(references()[name], extrapolation(DATA[name])) < (
        LARGEST_DISAGREEMENT
    )


QUICK = {"two gates", "shaken table", "A1: grazing contact"}
QUICKEST = {"two gates"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[tier(n)] * (n not in QUICKEST)) for n in DATA]
)
def test_long_double_gives_what_is_shipped(name):
    """And where it is not slow, what some hundred displaced runs give."""
    shipped, is_quick = references()[name], name in QUICK or name not in SLOW
    if is_quick:
        found = reference_of(DATA[name])
    else:
        motion = LongDouble(DATA[name])()
        found = {"kinds": motion.kinds, "state": motion.state.astype(float).tolist()}
    assert found["kinds"] == shipped["kinds"]
    digits = 0.0 if name in QUICK else 1e-15  # the same bits, if the C library is
    assert found["state"] == pytest.approx(shipped["state"], rel=digits, abs=0.0)
    if is_quick:
        assert found["margin"] == shipped["margin"]
        if name in QUICK:
            assert found["growth"] == pytest.approx(shipped["growth"], rel=1e-3)


@pytest.mark.release
def test_derivative_by_both_ways():
    data = next(data for data in DATA.values() if "derivative" in data)
    step = np.longdouble(2.0**-11)
    found = derivative(data, lambda changed: LongDouble(changed)(), np.longdouble, step)
    assert references()[data["name"]]["derivative"] == pytest.approx(
        float(found), rel=1e-14
    )


def test_a_small_enough_displacement_leaves_the_events_what_they_are():
    sure = [name for name, data in DATA.items() if "tie" not in data]
    assert [name for name in sure if references()[name]["margin"] < 1e-15] == []


def test_closed_forms():
    ball = references()["bouncing ball"]["times"]
    flights = [math.sqrt(2.0)] + [
        2.0 * math.sqrt(2.0) * 0.9**n for n in range(1, len(ball))
    ]
    assert ball == pytest.approx(
        [math.fsum(flights[: n + 1]) for n in range(len(ball))], rel=1e-14
    )
    for depth in ("0.001", "1e-06", "1e-09"):
        first, second, *_ = references()[f"tangency, depth {depth}"]["times"]
        assert second - first == pytest.approx(
            2.0 * math.acos(1.0 - float(depth)), rel=1e-6
        )
    warm, cold, *_ = references()["thermostat"]["times"]
    assert (warm, cold) == pytest.approx(
        (math.log(2.0), 2.0 * math.log(2.0)), rel=1e-15
    )
    assert references()["light barrier"]["times"] == pytest.approx(
        [1 - 0.02**0.5, 1 + 0.02**0.5]
    )
    assert references()["saved instants"]["times"] == [1.0, 3.0, 5.0]


def _closed_forms():
    """Problem → times of its events in 45 digits, from parameters that are doubles."""
    mpf, log, sqrt = mpmath.mpf, mpmath.log, mpmath.sqrt
    flights, times = 2 * sqrt(mpf(2)), [sqrt(mpf(2))]
    for n in range(1, len(references()["bouncing ball"]["times"])):
        times.append(times[-1] + flights * mpf(0.9) ** n)
    barrier = sqrt(1 - 2 * mpf(0.49))
    forms = {
        "bouncing ball": times,
        "light barrier": [1 - barrier, 1 + barrier],
        "two gates": [sqrt(2 * (1 - mpf(level))) for level in (0.5, 0.499)],
        "thermostat": [log(mpf(2))],
    }
    # cooled from 1 towards 0, heated from 1/2 towards 2, in turn
    spans = [log(mpf(2)), log(mpf(3) / 2)]
    for n in range(1, len(references()["thermostat"]["times"])):
        forms["thermostat"].append(forms["thermostat"][-1] + spans[(n - 1) % 2])
    for depth in ("0.001", "1e-06", "1e-09", "1e-14"):
        name = f"tangency, depth {depth}"
        rise = mpmath.asin(mpf(DATA[name]["parameters"]["level"]))
        turns = (0, 2 * mpmath.pi)
        forms[name] = [t + turn for turn in turns for t in (rise, mpmath.pi - rise)]
    return forms


def test_closed_forms_in_thirty_digits():
    with mpmath.workdps(45):
        for name, times in _closed_forms().items():
            written = references()[name]["digits"]["times"]
            for text, truth in zip(written, times, strict=True):
                assert abs(mpmath.mpf(text) - truth) < truth * 10.0 ** (1 - WRITTEN)


@pytest.mark.parametrize("name", DATA)
def test_digits_are_those_of_the_doubles(name):
    reference = references()[name]
    digits, allowed = reference["digits"], 1e-15
    for key, growth in (
        ("state", [reference["growth"]] * len(reference["state"])),
        ("times", reference["time_growth"]),
    ):
        for text, number, factor in zip(
            digits[key], reference[key], growth, strict=True
        ):
            assert abs(float(text) - number) <= allowed * factor * max(1, abs(number))
    assert float(digits.get("derivative", 0.0)) == pytest.approx(
        reference.get("derivative", 0.0), rel=1e-14
    )


@pytest.mark.parametrize(
    "name",
    [
        "kept at zero",
        pytest.param("chaotic impacts", marks=pytest.mark.release),
        pytest.param("stick–slip", marks=pytest.mark.release),
        pytest.param("A1: hammering", marks=pytest.mark.long),
    ],
)
def test_another_order_and_step_give_the_same_digits(name):
    motion, digits = many_digits(DATA[name], 44), references()[name]["digits"]
    with mpmath.workdps(44):
        pairs = [*zip(motion.state, digits["state"], strict=True)]
        pairs += [*zip(motion.times, digits["times"], strict=True)]
        for value, text in pairs:
            error = abs(value - mpmath.mpf(text)) / max(1, abs(value))
            assert error < 10.0 ** (1 - WRITTEN)
