"""The boundary of kept contact in two readings of the sign of friction: followed once or twice."""

import math

import numpy as np
import pytest

from squealpipe.brake.curves import contact
from squealpipe.parameters import Parameters

ANGLES = {name: np.array([0.0, math.pi / 2, math.pi]) for name in ("alpha1", "alpha2")}


def square(speed, model, time=6.0, **parameters):
    params = Parameters(belt_speed=speed, **parameters)
    options = {"t_end": time * params.time_unit, "tol": 1e-9, "workers": 1}
    return contact.Square(params, {}, ANGLES, options, model)


def followed(*squares):
    """Lines of each, and how many runs were made for it."""
    contact._latest.clear()
    found = []
    for each in squares:
        made = []
        run = each._run
        each._run = lambda places, *args, run=run, made=made, **options: (
            made.append(len(places)) or run(places, *args, **options)
        )
        found.append((contact.lines_of(each, 11, 12), sum(made)))
    return found


@pytest.mark.parametrize(
    "speed", [100.0, pytest.param(-100.0, marks=pytest.mark.release), 0.8]
)
def test_the_second_reading_has_the_boundary_that_it_has_alone(speed):
    """At 100 it is taken from the first one; over a slow belt masses stick, and it differs."""
    (_, runs), (second, more) = followed(
        square(speed, "A1-as-printed"), square(-speed, "A1")
    )
    other = square(-speed, "A1")
    ((alone, _),) = followed(other)
    assert np.array_equal(second.place, alone.place)
    assert np.array_equal(second.residual, alone.residual)
    assert (more < 0.1 * runs) == (abs(speed) > 1.0)


@pytest.mark.release
def test_other_motions_are_followed_anew():
    fast = square(100.0, "A1-as-printed")
    for other in (
        square(100.0, "A1"),
        square(-100.0, "A1", mu=0.31),
        square(-99.0, "A1"),
    ):
        (_, runs), (_, more) = followed(fast, other)
        assert more > 0.5 * runs


def test_masses_as_fast_as_the_belt_are_found_by_few_runs_that_see_speeds():
    fluttering, axis = square(60.0, "A1", time=150.0), np.linspace(0.02, 0.97, 21)
    places = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    run, seen = fluttering._run, []
    fluttering._run = lambda places, model, tracked: (
        seen.append(len(places) * ("vx" in tracked))
        or run(places, model, tracked=tracked)
    )
    fluttering.reserve(places)
    fast = run(places, "A1-no-separation", tracked=("vx",)).early_max_vx >= 60.0
    assert fast.any()
    assert np.array_equal(fluttering.faster[0][0], places[fast])
    assert sum(seen) < 10


def test_a_place_at_a_jump_of_the_reserve_has_a_time_of_touching():
    """The slope is zero on both sides of a jump from clipped reserve to clipped reserve."""
    place = np.array([[0.3, 0.4]])
    with np.errstate(all="raise"):
        time = square(100.0, "A1").touch_time(place, np.zeros((1, 2)))
    assert np.isfinite(time).all()
